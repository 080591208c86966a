"""The keys of the lab, which are also in the command palette."""

from collections.abc import Callable
from typing import Literal

import viser

from app.messages import StepOnce, TogglePlay
from app.panel.settings import SceneSettings
from app.render.handles.viser_types import ViserEvent
from app.render.markup.html import Html

Key = Literal["space", "G", "N", "P", "R", "U", "Y", "Z", "1", "2", "3", "4", "5", "6", "7", "8", "9"]
Modifier = Literal["cmd/ctrl", "cmd/ctrl+shift"]
DIGITS: tuple[Key, ...] = ("1", "2", "3", "4", "5", "6", "7", "8", "9")
KEYS = Html(
    "<b>Space</b> play or pause · <b>N</b> step · <b>R</b> reset · <b>V</b> reset camera · <b>P</b> plots · "
    "<b>G</b> grid · <b>U</b> or <b>Ctrl+Z</b> undo · <b>Ctrl+Shift+Z</b> or <b>Ctrl+Y</b> redo · "
    "<b>C</b> to the first control · <b>L</b> projector · <b>1-9</b> presets · "
    "<b>Tab</b> to the next control, on a Mac to buttons with Option"
)


def add_keys(gui: viser.GuiApi, settings: SceneSettings, reset_view: Callable[[viser.ClientHandle], None]) -> None:
    """Keyboard and command palette. W A S D Q E and the arrows already move the camera."""
    actions: list[tuple[str, Key | None, Modifier | None, Callable[[], None]]] = [
        ("Play or pause", "space", None, lambda: settings.post(TogglePlay())),
        ("Single step", "N", None, lambda: settings.post(StepOnce())),
        ("Reset", "R", None, settings.reset),
        ("Plots", "P", None, settings.toggle_plots),
        ("Grid", "G", None, lambda: settings.set("grid", not settings.params.grid)),
        ("Undo", "U", None, settings.undo),
        ("Undo", "Z", "cmd/ctrl", settings.undo),
        ("Redo", "Z", "cmd/ctrl+shift", settings.redo),
        ("Redo", "Y", "cmd/ctrl", settings.redo),  # with Cmd the key is the browser's: js/panel/keys.js
    ]
    for number, preset in enumerate(settings.kind.presets, 1):
        # The presets after the ninth are in the command palette and the list only.
        key = DIGITS[number - 1] if number <= len(DIGITS) else None
        actions.append((f"Preset: {preset}", key, None, lambda preset=preset: settings.load(preset)))
    for label, key, modifier, action in actions:
        command = gui.add_command(label, hotkey=key, modifier=modifier)

        @command.on_trigger
        async def _(_: ViserEvent, action: Callable[[], None] = action) -> None:
            action()

    command = gui.add_command("Reset camera", hotkey="V")

    @command.on_trigger
    async def _(event: ViserEvent) -> None:
        if event.client is not None:
            reset_view(event.client)
