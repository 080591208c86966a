"""Numbers of the scene's file: changed in the panel, and sent to the browser within the file."""

import viser

from app.panel.settings import SceneSettings
from app.render.handles.viser_types import ViserEvent
from app.render.markup.html import fill, note
from app.scenes.contract import FileEditing
from sim.quantities import read_number, write_number
from sim.validation import ConvergenceError, argument_error, check_positive

APPLY, SAVE = "Apply", "Save file"


class FileNumbers:
    """The folder, in the open container; it is shown while a file is open."""

    def __init__(self, gui: viser.GuiApi, editing: FileEditing, settings: SceneSettings) -> None:
        self.editing, self.settings = editing, settings
        things = editing.numbers(settings.params)
        self.fields: dict[str, viser.GuiTextHandle] = {}
        self.choice_numbers: tuple[str, dict[str, float]] | None = None  # the choice, and its numbers
        if not things:
            return
        with gui.add_folder(editing.title, expand_by_default=False):
            self.chooser = gui.add_dropdown(editing.thing, tuple(things))
            for name, value in things[self.chooser.value].items():
                self.fields[name] = gui.add_text(name, write_number(value))
            buttons = gui.add_button_group("", (APPLY, SAVE))
            self.line = gui.add_html("")

        @self.chooser.on_update
        async def _(_: ViserEvent) -> None:
            self.say("")
            self.show()

        @buttons.on_click
        async def _(event: ViserEvent) -> None:
            if event.client is None:
                return
            try:
                if event.target.value == APPLY:
                    self.apply()
                else:
                    name, content = editing.content(settings.params)
                    event.client.send_file_download(name, content, save_immediately=True)
                    self.say(f"{name} was sent to the browser.")
            except (ValueError, ConvergenceError) as reason:
                self.say(str(reason))

    def show(self) -> None:
        """Show the numbers of the chosen thing, unless they are already shown: some may be half typed."""
        if not self.fields:
            return
        now = self.chooser.value, dict(self.editing.numbers(self.settings.params)[self.chooser.value])
        if now != self.choice_numbers:
            self.choice_numbers = now
            for name, value in now[1].items():
                self.fields[name].value = write_number(value)

    def apply(self) -> None:
        """Restart with the numbers in the fields. Raises ValueError or ConvergenceError for an impossible one."""
        values = {name: read(name, field.value) for name, field in self.fields.items()}
        params = self.editing.changed(self.settings.params, self.chooser.value, values)
        self.say("")
        if params != self.settings.params:
            self.settings.begin_with(params)

    def say(self, text: str) -> None:
        """Show a sentence below the buttons."""
        self.line.content = note(fill('<div role="status">{}</div>', text)) if text else ""


def read(name: str, text: str) -> float:
    """The number above 0 in a text, in the unit of the name or with another unit. Raises ValueError."""
    title, _, unit = name.removesuffix("]").partition(" [")
    try:
        value = read_number(text, unit)
    except ValueError as reason:
        raise argument_error(title, text, f"above 0 {unit}; {reason}") from None
    return check_positive(title, value, unit)
