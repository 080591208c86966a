"""The controls of a scene's parameters, which show and set one record."""

import threading
from collections.abc import Iterator, Mapping, Sequence

import viser

from app.panel.controls.control import Control
from app.panel.settings import SceneSettings
from sim.parameters import parameters_of


class Controls(Mapping[str, Control]):
    """All controls of a panel, by the names of their parameters, in the folders of their groups."""

    def __init__(self, gui: viser.GuiApi, settings: SceneSettings) -> None:
        """settings: shown and set by the controls."""
        self.gui, self.settings = gui, settings
        self.parameters = parameters_of(settings.params)
        self.own: dict[str, Control] = {}
        self.again: list[Control] = []  # controls of parameters shown a second time, as in a task
        self.hidden: set[str] = set()  # names of parameters without effect at present
        self.lock = threading.Lock()  # the viewer thread shows others again, the event loop sets them
        self.folders: dict[str, viser.GuiFolderHandle] = {}

    def __getitem__(self, name: str) -> Control:
        return self.own[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.own)

    def __len__(self) -> int:
        return len(self.own)

    def add_group(self, group: str, *, is_open: bool) -> None:
        """Add the folder of a group of parameters, if any, in the open container."""
        names = [name for name, parameter in self.parameters.items() if parameter.group == group]
        if not names:
            return
        self.folders[group] = folder = self.gui.add_folder(group, expand_by_default=is_open)
        with folder:
            for name in names:
                self.own[name] = self.make(folder, name)

    def show_again(self, names: Sequence[str], folder: viser.GuiFolderHandle) -> None:
        """Show these parameters a second time, in a folder, replacing those shown there before."""
        with folder:
            controls = [self.make(folder, name) for name in names]
        with self.lock:
            before, self.again = self.again, controls
            for control in before:
                control.remove()
        self.show(self.hidden)

    def make(self, folder: viser.GuiFolderHandle | viser.GuiTabHandle, name: str) -> Control:
        """Make a control of a parameter, in the open container."""
        return Control(self.gui, folder, name, self.settings)

    def show(self, hidden: set[str]) -> None:
        """Show the record; hide the controls without effect at present, and the folders left empty."""
        self.hidden = hidden
        with self.lock:
            for control in (*self.own.values(), *self.again):
                control.show_value()
                control.show(control.name not in hidden)
        groups = {self.parameters[name].group for name in self.own if name not in hidden}
        for group, folder in self.folders.items():
            folder.visible = group in groups
