"""The folder "Compare side by side", and the state of the panes for their page (`js/beside`)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import viser

from app.panel.settings import SceneSettings
from app.render.handles.channel import Channel, Message
from app.render.handles.viser_types import ViserEvent
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
    """The folder, and the state of the panes for the page."""

    def __init__(self, gui: viser.GuiApi, channel: Channel, settings: SceneSettings, beside: ComparisonCalls) -> None:
        """settings: with the presets to compare with."""
        self.gui, self.channel, self.settings, self.beside = gui, channel, settings, beside
        channel.listen("panes", str, self.act)

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

    def act(self, message: Message[str]) -> None:
        """Show the lab alone again."""
        if message.value == "end":
            self.beside.end()

    def update(self) -> None:
        """Update the list of presets, and the panes for the page."""
        names = self.settings.presets
        if self.choice.options != names:
            self.choice.options = names
        self.channel.tell("panes", [pane._asdict() for pane in self.beside.panes()])
