"""The tab "Controls": the parameters by their groups, the readings among them, the stability map, and the help."""

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

import viser

from app.messages import RunOn
from app.panel.controls.controls import Controls
from app.panel.controls.file_numbers import FileNumbers
from app.panel.controls.readings import Readings
from app.panel.controls.remedy import ControlRemedies
from app.panel.keys import KEYS
from app.panel.recording.files import file_name
from app.panel.settings import SceneSettings
from app.render.handles.channel import Channel
from app.render.handles.viser_types import ViserEvent
from app.render.markup.html import Html, faint, fill, note
from app.scenes.contract import AnySnapshot, AnyView, Awaited, SpringParams

if TYPE_CHECKING:
    from app.panel.controls.stability_map import StabilityMapPanel

OPEN_GROUP = "Main"  # the group of parameters that starts open
VIEW_GROUPS = ("Look", "Plots")  # the groups in the tab of the view


class ControlsTab:
    """Content of the tab, made in the open container."""

    def __init__(
        self,
        gui: viser.GuiApi,
        channel: Channel,
        view: AnyView,
        settings: SceneSettings,
        controls: Controls,
        tab: viser.GuiTabHandle,
    ) -> None:
        """controls: all but those of the view are added here."""
        self.gui, self.channel, self.view, self.settings, self.controls = gui, channel, view, settings, controls
        self.remedies = ControlRemedies(gui, controls, settings.follow)
        gui.add_html(note(faint(Html(settings.kind.help))))
        for name in dict.fromkeys(parameter.group for parameter in controls.parameters.values()):
            if name not in VIEW_GROUPS:
                controls.add_group(name, is_open=name == OPEN_GROUP)
            if name == OPEN_GROUP:
                event = settings.kind.awaited
                self.run_on = None if event is None else self.add_run_on(event)
                self.readings = Readings(
                    gui, view, tab, lambda command: settings.post(command), lambda end: file_name(settings, end)
                )
        editing = settings.kind.file_editing
        self.file_numbers = None if editing is None else FileNumbers(gui, editing, settings)
        self.map = self.add_map()
        with gui.add_folder("Help", expand_by_default=False):
            self.help = gui.add_html("")

    def add_run_on(self, event: Awaited) -> viser.GuiButtonHandle:
        """Add the button that runs up to an event."""
        button = self.gui.add_button(event.label, visible=event.offered(self.settings.params), hint=event.hint)

        @button.on_click
        async def _(_: ViserEvent) -> None:
            self.settings.post(RunOn(event.reached))

        return button

    def add_map(self) -> "StabilityMapPanel | None":
        """The folder of the stability map; None if the scene has no map."""
        scene = self.settings.kind.stability_map
        if scene is None:
            return None
        from app.panel.controls import stability_map

        read = cast(Callable[[], SpringParams], lambda: self.settings.params)
        with self.gui.add_folder("Stability map", expand_by_default=False):
            return stability_map.StabilityMapPanel(self.gui, scene, read, self.settings.set_all, self.channel)

    def show_settings(self) -> None:
        """Show the settings beside the controls: the help, and the button of an event to run up to."""
        settings, kind = self.settings, self.settings.kind
        if self.run_on is not None and kind.awaited is not None:
            self.run_on.visible = kind.awaited.offered(settings.params)
        if self.file_numbers is not None:
            self.file_numbers.show()
        self.help.content = note(fill("{}<br>{}", kind.about.get(settings.loaded, ""), KEYS))

    def show_readings(self, snapshot: AnySnapshot, hidden: frozenset[str]) -> None:
        """Update the scene's texts. hidden: headings that would answer a question of the workbook."""
        self.readings.show(snapshot, hidden)

    def show_marks(self, snapshot: AnySnapshot, hidden: frozenset[str]) -> None:
        """Update the lines under the controls, the advice there and the stability map.

        hidden: names of lines that would answer a question of the workbook.
        """
        for name, text in self.view.marks(snapshot).items():
            self.controls[name].write("" if name in hidden else text)
        if self.settings.kind.advice is not None:
            self.remedies.show(self.settings.kind.advice(snapshot))
        if self.map is not None:
            self.map.draw()

    def close(self) -> None:
        """Stop the threads of the tab."""
        if self.map is not None:
            self.map.close()
