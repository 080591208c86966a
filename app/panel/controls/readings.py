"""The scene's texts among the controls: short permanent ones, and foldable ones."""

from collections.abc import Callable
from typing import NamedTuple

import viser

from app.panel.recording.tables_csv import has_table, tables_csv
from app.render.handles.viser_types import ViserEvent
from app.render.markup.html import Html, note
from app.scenes.contract import AnySnapshot, AnyView, PostCommand

ORDER_STEP = 1e-3  # between the places of two folders
CSV = "Table as CSV"
WITHHELD = "Hidden until you have answered the questions of this task."


class Note(NamedTuple):
    """A foldable text."""

    folder: viser.GuiFolderHandle
    text: viser.GuiHtmlHandle
    save: viser.GuiButtonGroupHandle  # its tables


class Readings:
    """The texts, made in the open container."""

    def __init__(
        self,
        gui: viser.GuiApi,
        view: AnyView,
        tab: viser.GuiTabHandle,
        post: PostCommand,
        name_file: Callable[[str], str],
    ) -> None:
        """tab: the container, in which a folder is made when a scene first has a text for it.

        post: takes commands for the simulation. name_file: name of a file, of its end.
        """
        self.gui, self.view, self.tab, self.post, self.name_file = gui, view, tab, post, name_file
        self.readout = gui.add_html("")
        self.notes: dict[str, Note] = {}

    def show(self, snapshot: AnySnapshot, hidden: frozenset[str]) -> None:
        """Update all texts; a folder without a text is hidden.

        hidden: headings of texts that would answer a question of the workbook.
        """
        self.readout.content = note(Html(self.view.readout(snapshot)))
        for heading, text in self.view.notes(snapshot).items():
            if heading not in self.notes:
                self.add_folder(heading)
            folder, line, save = self.notes[heading]
            line.content = note(WITHHELD if heading in hidden else Html(text))
            folder.visible = bool(text)
            save.visible = has_table(line.content)

    def add_folder(self, heading: str) -> None:
        """Make a folder, below the short texts and the folders before."""
        order = self.readout.order + 0.5 + ORDER_STEP * len(self.notes)
        with self.tab, self.gui.add_folder(heading, order=order, expand_by_default=False) as folder:
            text = self.gui.add_html("")
            save = self.gui.add_button_group("", (CSV,), visible=False)
            self.notes[heading] = Note(folder, text, save)

            @save.on_click
            async def _(event: ViserEvent) -> None:
                if event.client is not None and has_table(text.content):
                    name = self.name_file(f"-{heading.lower().replace(' ', '-')}.csv")
                    content = tables_csv(text.content).encode("utf-8-sig")  # Excel takes it for UTF-8 by its mark
                    event.client.send_file_download(name, content, save_immediately=True)

            if commands := self.view.BUTTONS.get(heading):
                buttons = self.gui.add_button_group("", tuple(commands))

                @buttons.on_click
                async def _(event: ViserEvent) -> None:
                    self.post(commands[event.target.value])
