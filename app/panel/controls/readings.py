"""The scene's texts among the controls: short ones that are always shown, and foldable ones."""

import viser

from app.render.handles.viser_types import ViserEvent
from app.render.markup.html import Html, note
from app.scenes.contract import AnySnapshot, AnyView, PostCommand

ORDER_STEP = 1e-3  # between the places of two folders
WITHHELD = "Hidden until you have answered the questions of this task."


class Readings:
    """The texts, in the container that is open where this is made."""

    def __init__(self, gui: viser.GuiApi, view: AnyView, tab: viser.GuiTabHandle, post: PostCommand) -> None:
        """tab: the container, in which folders are made when a scene first has a text for them.

        post: takes commands for the simulation.
        """
        self.gui, self.view, self.tab, self.post = gui, view, tab, post
        self.readout = gui.add_html("")
        self.notes: dict[str, tuple[viser.GuiFolderHandle, viser.GuiHtmlHandle]] = {}

    def show(self, snapshot: AnySnapshot, hidden: frozenset[str]) -> None:
        """Bring all texts up to date; a folder without a text is not shown.

        hidden: headings of texts that would answer a question of the workbook.
        """
        self.readout.content = note(Html(self.view.readout(snapshot)))
        for heading, text in self.view.notes(snapshot).items():
            if heading not in self.notes:
                self.add_folder(heading)
            folder, line = self.notes[heading]
            line.content = note(WITHHELD if heading in hidden else Html(text))
            folder.visible = bool(text)

    def add_folder(self, heading: str) -> None:
        """Make a folder, below the short texts and the folders before."""
        order = self.readout.order + 0.5 + ORDER_STEP * len(self.notes)
        with self.tab, self.gui.add_folder(heading, order=order, expand_by_default=False) as folder:
            self.notes[heading] = folder, self.gui.add_html("")
            if commands := self.view.BUTTONS.get(heading):
                buttons = self.gui.add_button_group("", tuple(commands))

                @buttons.on_click
                async def _(event: ViserEvent) -> None:
                    self.post(commands[event.target.value])
