"""The folder "Compare side by side", and the line that the page with the panes (`js/beside.html`) reads."""

# pyright: reportPrivateUsage=false

import json
from collections.abc import Callable, Sequence
from typing import NamedTuple

import viser

from app.panel.settings import SceneSettings
from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import fill, join, note
from app.scenes.comparisons import COMPARISONS
from app.scenes.setups import Setup


class PaneWords(NamedTuple):
    """Title of a pane, the middle of its scene [m], and whether a browser is connected to it."""

    heading: str
    middle: tuple[float, float]
    connected: bool


class ComparisonCalls(NamedTuple):
    """Calls to the viewer. Each returns at once."""

    compare: Callable[[Sequence[Setup], bool], None]  # show set-ups beside the lab; True: the first one in the lab
    end: Callable[[], None]  # show the lab alone
    panes: Callable[[], tuple[PaneWords, ...]]  # words of each pane; () for a lab alone


class CompareFolder:
    """The folder, and a line that only the page reads."""

    def __init__(self, gui: viser.GuiApi, buttons: GuiHandle, settings: SceneSettings, beside: ComparisonCalls) -> None:
        """buttons: that play, step and reset. settings: with the presets to compare with.

        The line and its button are outside the tabs: the page reads them even if no tab was opened.
        """
        self.settings, self.beside, self.buttons = settings, beside, buttons
        self.shown: tuple[PaneWords, ...] | None = None
        self.line = gui.add_html("")
        self.end: GuiHandle = gui.add_button("One lab again", visible=False)
        self.end.on_click(self.on_end)
        self.gui = gui

    def add(self) -> None:
        """Add the folder, in the open container."""
        gui = self.gui
        with gui.add_folder("Compare side by side", expand_by_default=False):
            self.choice = gui.add_dropdown(
                "Compare with", self.settings.presets, hint="Shows your settings next to a preset"
            )
            self.start = gui.add_button("Show side by side")
            self.start.on_click(self.on_start)
            links = (
                fill('<a target="_top" href="./?compare={}">{}</a>', name, comparison.title)
                for name, comparison in COMPARISONS.items()
            )
            gui.add_html(note(fill("Ready-made comparisons: {}", join(links, " · "))))
        self.update()

    async def on_start(self, event: ViserEvent) -> None:
        """Show the present set-up beside the chosen preset."""
        name = str(self.choice.value)
        if event.client_id is not None and name in self.settings.presets:
            self.beside.compare([self.settings.setup_of(name)], False)

    async def on_end(self, event: ViserEvent) -> None:
        """Show the lab alone again."""
        if event.client_id is not None:
            self.beside.end()

    def update(self) -> None:
        """Update the list of presets and the line for the page."""
        names = self.settings.presets
        if self.choice.options != names:
            self.choice.options = names
        panes = self.beside.panes()
        if panes == self.shown:
            return
        self.shown = panes
        said = json.dumps([pane._asdict() for pane in panes])
        words = fill(
            '<span data-springtide-beside="{}" data-buttons="{}" data-end="{}"></span>',
            said, uuid_of(self.buttons), uuid_of(self.end),
        )  # fmt: skip
        self.line.content = str(words)
