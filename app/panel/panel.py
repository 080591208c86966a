"""The control panel, generated from a scene's parameters. Callbacks only touch the panel, and post commands.

Every callback is a coroutine, so that all of them run on viser's event loop, one after the other: two changes at once
cannot lose each other.
"""

import dataclasses
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias, cast

import viser

from app.lab import task
from app.lab.workbook import Workbook
from app.messages import BaseParams, KeptState, PlotRow, Reset, RunOn, Take
from app.panel.changes import Changes
from app.panel.compare import Beside, Compare
from app.panel.controls import Controls
from app.panel.display import Display, add_switches
from app.panel.files import MakeReplay
from app.panel.guide import GuideTab
from app.panel.head import Actions, Head
from app.panel.history import History, Settings
from app.panel.keys import KEYS, add_keys
from app.panel.plots import Plots
from app.panel.readings import Readings
from app.panel.recorder import Recorder
from app.panel.recording_files import Plotted
from app.panel.remedy import ControlRemedies
from app.panel.share import Share
from app.panel.task_setups import setup_of_task
from app.panel.timeline import Timeline
from app.render.cameras import ClientCamera, client_cameras, place_camera
from app.render.html import Html, fill, note
from app.render.viser_types import ViserEvent
from app.scenes.contract import Advice, AnyKind, AnySnapshot, AnyView, Awaited, PostCommand, SpringParams
from app.scenes.own_setups import own_files
from app.scenes.setups import FILES, Setup, file_name, make_setup
from sim.parameters import Value, changed_names, effect_of_change

if TYPE_CHECKING:
    from app.lab.session import Session
    from app.panel.code_panel import CodePanel
    from app.panel.stability_map import StabilityMapPanel

STATUS_INTERVAL = 0.25  # [s]
MARKS_INTERVAL = 0.5  # [s]
OWN = "Mine: {}"  # name of the user's own set-ups in the list of presets
OPEN_GROUP = "Main"  # the group of parameters that starts open
VIEW_GROUPS = ("Look", "Plots")  # the groups that stand in the tab of the view
CONTROLS, LAB, SHARE, VIEW = "Controls", "Lab", "Share", "View"  # the tabs

# Takes a scene to show, its parameters if any, and a camera for one browser if any.
OpenScene: TypeAlias = Callable[[str, BaseParams | None, ClientCamera | None], None]


class Panel:
    """The panel of one scene."""

    def __init__(
        self,
        server: viser.ViserServer,
        kind: AnyKind,
        view: AnyView,
        params: BaseParams,
        post: PostCommand,
        *,
        scenes: tuple[str, ...] = (),
        open_scene: OpenScene = lambda name, params, camera: None,
        workbook: Workbook | None = None,
        wake: Callable[[], None],
        make_replay: MakeReplay,
        session: "Session | None" = None,
        beside: Beside | None = None,
        changed: Callable[[BaseParams], None] = lambda params: None,
        changes: Changes,
    ) -> None:
        """post: takes commands for the simulation. open_scene: takes a scene to show instead; both at once.

        workbook: the tasks of the lab, shown above the parameters. session: of a student's folder. wake: has the
        recording looked at once more. make_replay: makes the page of a replay. beside: shows other set-ups beside this
        one; None where this one is beside another. changed: takes parameters that were set. changes: of the server.
        """
        self.server, self.kind, self.view, self.post = server, kind, view, post
        self.open_scene, self.beside, self.changed = open_scene, beside, changed
        self.gui = gui = server.gui
        self.params = params  # as set now; other threads read them
        self.status_at = self.marks_at = 0.0
        self.history = History()
        self.plots = Plots(server, kind)
        self.display = Display(gui, view)
        self.own = own_presets(kind)  # name in the list -> set-up of the user
        # Name of the preset that was loaded last; at first the one that the parameters differ from the least.
        self.loaded = self.nearest_preset(params)
        first_views = self.open_first_view_of, self.place_first_view
        actions = Actions(post, self.reset, self.load, *first_views, self.toggle_plots, self.undo, self.follow)
        self.head = Head(gui, kind, view, scenes, actions)
        self.shown = Controls(gui, lambda: self.params, self.on_change)
        self.controls, self.folders = self.shown.own, self.shown.folders
        self.cameras: tuple[ClientCamera, ...] = ()  # of what is being loaded, for the viewer to place
        self.remedies = ControlRemedies(gui, self.controls, self.follow)
        self.recorder = Recorder(kind.packing)
        self.timeline = Timeline(self, wake)
        self.share = Share(self, wake, make_replay, changes)
        self.guide: GuideTab | None = None
        self.code: CodePanel | None = None
        self.map: StabilityMapPanel | None = None
        self.compare = (
            None if beside is None else Compare(gui, self.head.buttons, self.comparable_names, self.comparable, beside)
        )
        self.fill_tabs(workbook, session)
        self.shown.show(kind.hidden(params))
        self.show_preset()
        add_keys(self)

    def fill_tabs(self, workbook: Workbook | None, session: "Session | None") -> None:
        """The tabs. Who works in a folder of exercises finds these first, others the controls."""
        has_folder = workbook is not None and workbook.folder is not None
        names = (LAB, CONTROLS, SHARE, VIEW) if has_folder else (CONTROLS, LAB, SHARE, VIEW)
        group = self.gui.add_tab_group()
        tabs = {name: group.add_tab(name) for name in names if name != LAB or workbook is not None}
        with tabs[CONTROLS]:
            self.add_controls(tabs[CONTROLS])
        if workbook is not None:
            self.guide = GuideTab(self.gui, self.kind, workbook, self.set_up, tabs[LAB], self.shown)
            if session is not None:
                from app.panel import code_panel  # only `springtide lab DIR` pays for it

                with tabs[LAB]:
                    self.code = code_panel.CodePanel(self.gui, session, self.kind.name)
        with tabs[SHARE]:
            self.share.add()
            if self.compare is not None:
                self.compare.add()
        with tabs[VIEW]:
            add_switches(self.gui)
            for name in VIEW_GROUPS:
                self.shown.add_group(name, is_open=True)

    def add_controls(self, tab: viser.GuiTabHandle) -> None:
        """The tab of the controls: the parameters by their groups, the readings, the stability map, and the help."""
        gui, kind = self.gui, self.kind
        groups = dict.fromkeys(parameter.group for parameter in self.shown.parameters.values())
        for name in groups:
            if name not in VIEW_GROUPS:
                self.shown.add_group(name, is_open=name == OPEN_GROUP)
            if name == OPEN_GROUP:
                self.run_on = None if kind.awaited is None else self.add_run_on(kind.awaited)
                self.readings = Readings(gui, self.view, tab, lambda command: self.post(command))
        if kind.stability_map is not None:
            from app.panel import stability_map  # no sea imports what springs need

            read = cast(Callable[[], SpringParams], lambda: self.params)
            with gui.add_folder("Stability map", expand_by_default=False):
                self.map = stability_map.StabilityMapPanel(gui, kind.stability_map, read, self.set)
        with gui.add_folder("Help", expand_by_default=False):
            self.help = gui.add_html("")

    def add_run_on(self, event: Awaited) -> viser.GuiButtonHandle:
        """The button that runs on to an event."""
        button = self.gui.add_button(event.label, visible=event.offered(self.params), hint=event.hint)

        @button.on_click
        async def _(_: ViserEvent) -> None:
            self.post(RunOn(event.reached))

        return button

    def set(self, name: str, value: object) -> None:
        """Set one parameter, as its control would; on viser's event loop."""
        self.controls[name].set(value)

    def on_change(self, name: str, value: Value) -> None:
        """A control was set."""
        if getattr(self.params, name) == value:
            return
        params = dataclasses.replace(self.params, **{name: value})
        run = self.history.note(self.settings, name, begins=effect_of_change(self.params, params) == "start")
        self.take(Take(params, run=run), self.loaded)

    @property
    def settings(self) -> Settings:
        """The present settings, for an undo."""
        return Settings(self.params, self.loaded, cameras=client_cameras(self.server))

    def reset(self) -> None:
        """Begin the scene again."""
        self.post(Reset(self.history.note(self.settings, "reset", begins=True)))

    def take(self, command: Take, preset: str) -> None:
        """Take parameters, show them, and have the simulation take them too. preset: that they come from."""
        self.params, self.loaded = command.params, preset
        self.post(command)
        self.shown.show(self.kind.hidden(self.params))
        if self.run_on is not None and self.kind.awaited is not None:
            self.run_on.visible = self.kind.awaited.offered(self.params)
        self.show_preset()
        self.changed(self.params)

    def params_of(self, preset: str) -> BaseParams:
        """The parameters of a preset. The hull from a file, which is not a parameter, stays."""
        own = self.own.get(preset)
        return with_fields_of(self.params, (own or make_setup(self.kind, preset)).params)

    def nearest_preset(self, params: BaseParams) -> str:
        """Name of the preset that parameters differ from the least."""
        return min(self.kind.presets, key=lambda name: len(changed_names(self.params_of(name), params)))

    def comparable_names(self) -> tuple[str, ...]:
        """Names of set-ups for a comparison: presets, and the user's own set-ups."""
        return (*self.kind.presets, *self.own)

    def comparable(self, name: str) -> Setup:
        """One of them."""
        return self.own[name] if name in self.own else Setup(self.kind.name, self.params_of(name), {}, name)

    def load(self, preset: str) -> None:
        """Every parameter as the preset has it, and the scene from its start: one command."""
        self.load_params(self.params_of(preset), preset)

    def set_up(self, setup: task.TaskSetup) -> None:
        """Show the set-up of a task. Raises ValueError if there is no such scene, preset or parameter."""
        self.show_setup(setup_of_task(setup), None)

    def show_setup(self, setup: Setup, client: int | None) -> None:
        """Show a set-up from a link or a file, with its camera for one browser."""
        camera = None if setup.camera is None or client is None else ClientCamera(client, *setup.camera)
        if setup.scene != self.kind.name:
            self.open_scene(setup.scene, setup.params, camera)
            return
        self.cameras = () if camera is None else (camera,)
        self.load_params(with_fields_of(self.params, setup.params), setup.preset or next(iter(self.kind.presets)))

    def show_own(self, chosen: str = "") -> None:
        """Read the user's own set-ups again. chosen: the one that the parameters are those of, if any."""
        self.own = own_presets(self.kind)
        if chosen:
            self.loaded = OWN.format(chosen)
        if self.loaded not in (*self.kind.presets, *self.own):
            self.loaded = next(iter(self.kind.presets))
        self.show_preset()

    def keep_curves(self, on: bool) -> float | None:
        """Keep the curves that the plots have, to be drawn beside those of the runs that follow; or drop them.

        Returns the time [s] of the last that is kept; None where nothing is.
        """
        return self.plots.keep(on)

    def plotted(self) -> Plotted:
        """The rows of the plots that are kept, and the whole charts of now."""
        return Plotted(tuple(self.plots.rows), self.plots.curves)

    def load_params(self, params: BaseParams, preset: str) -> None:
        """Take parameters, and the scene from its start: one command. preset: that they come from."""
        run = self.history.note(self.settings, preset, begins=True)
        self.take(Take(params, start=True, run=run), preset)

    def resume(self, params: BaseParams, state: KeptState) -> None:
        """Have the scene go on from a state, with the parameters that it had then: one command."""
        run = self.history.note(self.settings, "moment", begins=True)
        self.take(Take(params, state=state, run=run), self.loaded)

    def undo(self) -> None:
        """The settings before the last change, and the run that had them if that change has begun another."""
        run, settings = self.history.run, self.history.take_last()
        if settings is None:
            return
        known = settings.preset in (*self.kind.presets, *self.own)  # a set-up of the user may be gone
        back = settings.run != run
        self.cameras = settings.cameras if back else ()
        take = Take(settings.params, start=back, run=settings.run, back=back)
        self.take(take, settings.preset if known else next(iter(self.kind.presets)))

    def show_preset(self) -> None:
        """Show which preset is loaded, and whether a parameter that matters is not as it has it."""
        look = {name for name, parameter in self.shown.parameters.items() if parameter.affects == "look"}
        changed = changed_names(self.params_of(self.loaded), self.params) - look
        files = [file_name(path) for field in FILES.values() if (path := getattr(self.params, field, ""))]
        other = ", ".join(files) or f"{self.loaded} (changed)"
        self.head.show_preset((*self.kind.presets, *self.own), self.loaded, other if changed else "")
        self.help.content = note(fill("{} {}<br>{}", Html(self.kind.help), self.kind.about.get(self.loaded, ""), KEYS))

    async def reset_view(self, event: ViserEvent) -> None:
        """Put the camera of this browser where a new one would be."""
        if event.client is not None:
            self.place_first_view(event.client)

    def open_first_view_of(self, scene: str) -> None:
        """Show another scene as it is shown first."""
        self.open_scene(scene, None, None)

    def place_first_view(self, client: viser.ClientHandle) -> None:
        """Put the camera of a browser where a new one would be."""
        place_camera(client.camera, *self.view.first_view(self.params), self.view.FIELD_OF_VIEW)

    def follow(self, advice: Advice) -> None:
        """Set the parameter of an advice, and start again."""
        self.set(advice.name, advice.value)
        self.reset()

    def toggle_plots(self) -> None:
        """Open all plots, or close them where one is open."""
        shown = [c for name, c in self.controls.items() if name in self.kind.plots or name in self.kind.curves]
        on = not any(getattr(self.params, control.name) for control in shown)
        for control in shown:
            control.set(on)

    def update(self, snapshot: AnySnapshot, rows: list[PlotRow], busy: float = 0.0) -> None:
        """Show the state of the loop at a few hertz, and at once if it starts, stops or halts.

        rows: new plot rows. busy: [s] that the present tick has taken.
        """
        now = time.monotonic()
        shown = self.recorder.shown
        self.plots.update(snapshot, rows, None if shown is None else shown.time)
        visitors = len(self.server.get_clients())
        hidden = frozenset[str]() if self.guide is None else self.guide.workbook.hidden()
        stale = self.head.is_stale(snapshot, visitors) or (self.code is not None and self.code.is_stale)
        refresh = stale or now - self.status_at >= STATUS_INTERVAL
        if refresh:
            self.status_at = now
            self.head.show(snapshot, busy, visitors)
            self.readings.show(snapshot, hidden)
            if self.code is not None:
                self.head.show_code(self.code.update({} if self.guide is None else self.guide.values))
        if now - self.marks_at >= MARKS_INTERVAL:
            self.marks_at = now
            for name, text in self.view.marks(snapshot).items():
                self.controls[name].write("" if name in hidden else text)
            if self.kind.advice is not None:
                self.remedies.show(self.kind.advice(snapshot))
            if self.map is not None:
                self.map.draw()
        if self.guide is not None:
            self.guide.update(snapshot, refresh)
        self.share.update()
        self.timeline.update(running=snapshot.status.running)
        if self.compare is not None:
            self.compare.update()

    def close(self) -> None:
        """Stop the threads of this panel, and keep unfinished input."""
        if self.guide is not None:
            self.guide.flush()
        if self.map is not None:
            self.map.close()


def own_presets(kind: AnyKind) -> dict[str, Setup]:
    """The user's own set-ups of a scene, by their names in the list of presets."""
    return {OWN.format(name): setup for name, (_, setup) in own_files(kind).items()}


def with_fields_of(old: BaseParams, new: BaseParams) -> BaseParams:
    """`new`, with the hull from a file, which is not a parameter, as in `old`."""
    kept = {f.name: getattr(old, f.name) for f in dataclasses.fields(old) if "parameter" not in f.metadata}
    return dataclasses.replace(new, **kept)
