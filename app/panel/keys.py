"""The keys of the lab, which are in the command palette too."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from app.messages import StepOnce, TogglePlay
from app.render.html import Html
from app.render.viser_types import ViserEvent

if TYPE_CHECKING:
    from app.panel.panel import Panel

Key = Literal["space", "G", "N", "P", "R", "U", "1", "2", "3", "4", "5", "6", "7", "8", "9"]
DIGITS: tuple[Key, ...] = ("1", "2", "3", "4", "5", "6", "7", "8", "9")
KEYS = Html(
    "<b>Space</b> play or pause · <b>N</b> step · <b>R</b> reset · <b>V</b> reset camera · <b>P</b> plots · "
    "<b>G</b> grid · <b>U</b> undo · <b>C</b> to the first control · <b>1-9</b> presets"
)


def add_keys(panel: "Panel") -> None:
    """Keyboard and command palette. W A S D Q E and the arrows already move the camera."""
    actions: list[tuple[str, Key | None, Callable[[], None]]] = [
        ("Play or pause", "space", lambda: panel.post(TogglePlay())),
        ("Single step", "N", lambda: panel.post(StepOnce())),
        ("Reset", "R", panel.reset),
        ("Plots", "P", panel.toggle_plots),
        ("Grid", "G", lambda: panel.set("grid", not panel.params.grid)),
        ("Undo", "U", panel.undo),
    ]
    for number, preset in enumerate(panel.kind.presets, 1):
        # The presets after the ninth are in the command palette and the list only.
        key = DIGITS[number - 1] if number <= len(DIGITS) else None
        actions.append((f"Preset: {preset}", key, lambda preset=preset: panel.load(preset)))
    for label, key, action in actions:
        command = panel.gui.add_command(label, hotkey=key)

        @command.on_trigger
        async def _(_: ViserEvent, action: Callable[[], None] = action) -> None:
            action()

    panel.gui.add_command("Reset camera", hotkey="V").on_trigger(panel.reset_view)
