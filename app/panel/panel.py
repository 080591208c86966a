"""The control panel, generated from a scene's parameters. The simulation polls `read`; callbacks only touch the panel.

Every callback is a coroutine, so that all of them run on viser's event loop, one after the other: two changes at once
cannot lose each other.
"""

import dataclasses
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, TypeAlias, cast

import viser

from app.lab import task
from app.lab.workbook import Workbook
from app.messages import (
    BaseParams,
    Command,
    KeptState,
    Load,
    Pause,
    Play,
    PlotRow,
    Reset,
    StepOnce,
    TogglePlay,
)
from app.panel.compare import Beside, Compare
from app.panel.control import Control
from app.panel.display import Display, add_quality
from app.panel.files import MakeReplay
from app.panel.guide import Guide
from app.panel.history import History, Settings
from app.panel.plots import Plots
from app.panel.questions import Questions
from app.panel.recorder import Recorder
from app.panel.recording_files import Plotted
from app.panel.share import Share
from app.render.cameras import ClientCamera, place_camera
from app.render.html import ERROR_COLOUR, GOOD_COLOUR, WARNING_COLOUR, Html, coloured, fill, note
from app.render.viser_types import ViserEvent
from app.scenes import scene_named
from app.scenes.contract import AnyKind, AnySnapshot, AnyView, PostCommand, SpringParams
from app.scenes.own_setups import own_files
from app.scenes.setups import Setup
from sim.parameters import Value, changed_names, check_record, in_words, parameters_of
from sim.validation import argument_error

if TYPE_CHECKING:
    from app.lab.session import Session
    from app.panel.code_panel import CodePanel
    from app.panel.stability_map import StabilityMapPanel

STATUS_INTERVAL = 0.25  # [s]
MARKS_INTERVAL = 0.5  # [s]
BUSY_SHOWN_FROM = 0.5  # [s] that a step has taken, from which the status line says so
Key = Literal["space", "G", "N", "P", "R", "U", "1", "2", "3", "4", "5", "6", "7", "8", "9"]
DIGITS: tuple[Key, ...] = ("1", "2", "3", "4", "5", "6", "7", "8", "9")
OWN = "Mine: {}"  # name of the user's own set-ups in the list of presets
OPEN_GROUPS = 1  # the first groups of parameters start open
BUTTONS: dict[str, Command] = {"Play": Play(), "Pause": Pause(), "Step": StepOnce(), "Reset": Reset()}


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
        questions: Questions,
    ) -> None:
        """post: takes commands for the simulation. open_scene: takes a scene to show instead; both at once.

        workbook: the tasks of the lab, shown above the parameters. session: of a student's folder. wake: has the
        recording looked at once more. make_replay: makes the page of a replay. beside: shows other set-ups beside this
        one; None where this one is beside another.
        changed: is told of parameters that were set. questions: of visitors, which outlive the panel.
        """
        self.server, self.kind, self.view, self.post = server, kind, view, post
        self.open_scene, self.beside, self.changed = open_scene, beside, changed
        self.gui = gui = server.gui
        # Parameters as set now, and how many presets were loaded: read by another thread.
        self.state: tuple[BaseParams, int] = params, 0
        self.status_at = self.marks_at = 0.0
        self.halted: str = ""
        self.visitors = 0
        self.history = History()
        self.plots = Plots(server, kind)
        # Who needs dark or large text finds the switches first.
        self.display = Display(gui, view)
        # The block stays in sight while the rest is scrolled (page.css): what says "springtide-panel" is in it.
        with gui.add_folder("Lab") as self.lab:
            self.add_chooser(scenes)
            presets = tuple(kind.presets)
            self.own = own_presets(kind)  # name in the list -> set-up of the user
            # Name of the preset that was loaded last; at first the one that the parameters differ from the least.
            self.loaded = min(presets, key=lambda name: len(changed_names(self.params_of(name), params)))
            self.preset = gui.add_dropdown(
                "Preset", (*presets, *self.own), hint="Loads all settings and starts again from rest"
            )
            self.preset.on_update(self.on_preset)
            self.running = True  # as the buttons show it
            self.buttons = gui.add_button_group("", button_names(self.running))
            self.buttons.on_click(self.on_button)
            self.tools = gui.add_button_group("", ("Reset view", "Plots", "Undo"))
            self.tools.on_click(self.on_tool)
            self.status = gui.add_html("")
            self.code_line = None if session is None else gui.add_html("")
            self.readout = gui.add_html("")
        self.guide = None if workbook is None else Guide(gui, kind, workbook, self.set_up)
        self.code: CodePanel | None = None
        if session is not None:
            from app.panel import code_panel  # only `springtide lab DIR` pays for it

            self.code = code_panel.CodePanel(gui, session, kind.name)
        self.help = gui.add_html("")
        keys = fill(
            '<div class="springtide-note">'
            "<b>Space</b> play or pause · <b>N</b> step · <b>R</b> reset · <b>V</b> reset view · <b>P</b> plots · "
            "<b>G</b> grid · <b>U</b> undo · <b>1-9</b> presets</div>"
        )
        gui.add_html(str(keys))
        self.map: StabilityMapPanel | None = None
        if kind.stability_map is not None:
            from app.panel import stability_map  # no sea imports what springs need

            read = cast(Callable[[], SpringParams], lambda: self.params)
            with gui.add_folder("Stability map", expand_by_default=False):
                self.map = stability_map.StabilityMapPanel(gui, kind.stability_map, read, self.set)
        self.controls: dict[str, Control] = {}
        self.folders: dict[str, viser.GuiFolderHandle] = {}
        for name, parameter in parameters_of(params).items():
            if parameter.group not in self.folders:
                is_open = len(self.folders) < OPEN_GROUPS
                self.folders[parameter.group] = gui.add_folder(parameter.group, expand_by_default=is_open)
            folder = self.folders[parameter.group]
            with folder:
                self.controls[name] = Control(gui, folder, name, parameter, self.reader(name), self.on_change)
        self.camera: ClientCamera | None = None  # of the set-up that is being loaded, for the viewer to place
        self.recorder = Recorder(kind.packing)
        self.share = Share(self, wake, make_replay, questions)
        self.compare = (
            None if beside is None else Compare(gui, self.buttons, self.comparable_names, self.comparable, beside)
        )
        add_quality(gui)
        self.notes: dict[str, viser.GuiHtmlHandle] = {}
        self.hide()
        self.show_preset()
        self.add_keys()

    @property
    def params(self) -> BaseParams:
        """The parameters as set now."""
        return self.state[0]

    def reader(self, name: str) -> Callable[[], Value]:
        """A function that reads the present value of one parameter."""
        return lambda: getattr(self.params, name)

    def add_chooser(self, scenes: tuple[str, ...]) -> None:
        """The list of scenes, where there is more than one."""
        if len(scenes) > 1:
            add_scene_chooser(self.gui, scenes, self.kind.name, lambda name: self.open_scene(name, None, None))

    def add_keys(self) -> None:
        """Keyboard and command palette. W A S D Q E and the arrows already move the camera."""
        actions: list[tuple[str, Key | None, Callable[[], None]]] = [
            ("Play or pause", "space", lambda: self.post(TogglePlay())),
            ("Single step", "N", lambda: self.post(StepOnce())),
            ("Reset", "R", lambda: self.post(Reset())),
            ("Plots", "P", self.toggle_plots),
            ("Grid", "G", lambda: self.set("grid", not self.params.grid)),
            ("Undo", "U", self.undo),
        ]
        for number, preset in enumerate(self.kind.presets, 1):
            # The presets after the ninth are in the command palette and the list only.
            key = DIGITS[number - 1] if number <= len(DIGITS) else None
            actions.append((f"Preset: {preset}", key, lambda preset=preset: self.load(preset)))
        for label, key, action in actions:
            command = self.gui.add_command(label, hotkey=key)

            @command.on_trigger
            async def _(_: ViserEvent, action: Callable[[], None] = action) -> None:
                action()

        self.gui.add_command("Reset view", hotkey="V").on_trigger(self.reset_view)

    def read(self) -> tuple[BaseParams, int]:
        """The parameters as set now, and the number of the last preset; polled by the simulation once a frame."""
        return self.state

    def set(self, name: str, value: object) -> None:
        """Set one parameter, as its control would; on viser's event loop."""
        self.controls[name].set(value)

    def on_change(self, name: str, value: Value) -> None:
        """A control was set."""
        params, number = self.state
        if getattr(params, name) == value:
            return
        self.history.note(Settings(params, self.loaded), name)
        self.state = dataclasses.replace(params, **{name: value}), number
        self.hide()
        self.show_preset()
        self.changed(self.params)

    def hide(self) -> None:
        """Hide the controls that mean nothing just now, and the folders in which nothing is left."""
        hidden = self.kind.hidden(self.params)
        shown: set[str] = set()
        for name, control in self.controls.items():
            control.show(name not in hidden)
            if name not in hidden:
                shown.add(control.parameter.group)
        for group, folder in self.folders.items():
            if folder.visible != (group in shown):
                folder.visible = group in shown

    async def on_preset(self, event: ViserEvent) -> None:
        """A browser has chosen a preset; viser also calls this where `show_preset` assigns it, without a client."""
        if event.client_id is not None and event.target.value in (*self.kind.presets, *self.own):
            self.load(event.target.value)

    def params_of(self, preset: str) -> BaseParams:
        """The parameters of a preset. The hull from a file, which is not a parameter, stays."""
        own = self.own.get(preset)
        params = own.params if own else check_record(type(self.params), self.kind.presets[preset])
        return with_fields_of(self.params, params)

    def comparable_names(self) -> tuple[str, ...]:
        """Names of set-ups for a comparison: presets, and the user's own set-ups."""
        return (*self.kind.presets, *self.own)

    def comparable(self, name: str) -> Setup:
        """One of them."""
        return self.own[name] if name in self.own else Setup(self.kind.name, self.params_of(name), {}, name)

    def load(self, preset: str) -> None:
        """Every parameter as the preset has it, and the scene from its start: one command."""
        self.load_params(self.params_of(preset), preset)

    def set_up(self, setup: task.Setup) -> None:
        """Show the set-up of a task. Raises ValueError if there is no such scene, preset or parameter."""
        _, params, preset = params_of_setup(setup)
        if setup.scene == self.kind.name:
            self.load_params(with_fields_of(self.params, params), preset)
        else:
            self.open_scene(setup.scene, params, None)

    def show_setup(self, setup: Setup, client: int | None) -> None:
        """Show a set-up from a link or a file, with its camera for one browser."""
        camera = None if setup.camera is None or client is None else ClientCamera(client, *setup.camera)
        if setup.scene != self.kind.name:
            self.open_scene(setup.scene, setup.params, camera)
            return
        self.camera = camera
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
        number = self.state[1] + 1
        self.history.note(Settings(self.params, self.loaded), preset)
        self.take(params, preset, number)
        self.post(Load(params, number))

    def resume(self, params: BaseParams, state: KeptState) -> None:
        """Have the scene go on from a state, with the parameters that it had then: one command."""
        number = self.state[1] + 1
        self.history.note(Settings(self.params, self.loaded), "moment")
        self.take(params, self.loaded, number)
        self.post(Load(params, number, state))

    def undo(self) -> None:
        """The settings before the last change of a parameter or preset."""
        settings = self.history.take_last()
        if settings is not None:
            known = settings.preset in (*self.kind.presets, *self.own)  # a set-up of the user may be gone
            self.take(settings.params, settings.preset if known else next(iter(self.kind.presets)), self.state[1])

    def take(self, params: BaseParams, preset: str, number: int) -> None:
        """Take and show parameters. preset: that they come from. number: how many presets have been loaded."""
        self.state, self.loaded = (params, number), preset
        for name, control in self.controls.items():
            control.show_value(getattr(params, name))
        self.hide()
        self.show_preset()
        self.changed(self.params)

    def show_preset(self) -> None:
        """The list of presets, with "(changed)" where a parameter is not as the preset has it.

        "(changed)" is an entry of its own, so that the preset itself can be chosen again.
        """
        look = {name for name, parameter in parameters_of(self.params).items() if parameter.affects == "look"}
        changed = changed_names(self.params_of(self.loaded), self.params) - look
        shown = f"{self.loaded} (changed)" if changed else self.loaded
        text = note(fill("{} {}", Html(self.kind.help), self.kind.about.get(self.loaded, "")))
        if self.help.content != text:
            self.help.content = text
        options = (*self.kind.presets, *self.own, *((shown,) if changed else ()))
        if self.preset.options != options:
            self.preset.options = options
        if self.preset.value != shown:
            self.preset.value = shown

    async def on_button(self, event: ViserEvent) -> None:
        """Play or pause, step, reset: the action on the label of the pressed button."""
        self.post(BUTTONS[event.target.value])

    async def on_tool(self, event: ViserEvent) -> None:
        """Reset the view, open or close the plots, undo a change."""
        match event.target.value:
            case "Plots":
                self.toggle_plots()
            case "Undo":
                self.undo()
            case _:
                await self.reset_view(event)

    async def reset_view(self, event: ViserEvent) -> None:
        """Put the camera of this browser where a new one would be."""
        if event.client is not None:
            place_camera(event.client.camera, *self.view.first_view(self.params), self.view.FIELD_OF_VIEW)

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
        if snapshot.status.halted != self.halted:
            self.halted = snapshot.status.halted
            self.status_at = 0.0
            if self.halted:
                self.notify(self.halted)
        if snapshot.status.running != self.running:
            self.running = snapshot.status.running
            self.buttons.options = button_names(self.running)
            self.status_at = 0.0
        visitors = len(self.server.get_clients())
        if visitors != self.visitors:
            self.visitors = visitors
            self.status_at = 0.0
        refresh = now - self.status_at >= STATUS_INTERVAL
        if refresh:
            self.status_at = now
            self.status.content = str(status_line(snapshot, busy, visitors))
            readout = self.view.readout(snapshot)
            self.readout.content = note(Html(readout))
            if self.code is not None:
                self.code.update({} if self.guide is None else self.guide.values)
            if self.code_line is not None and self.code is not None:
                self.code_line.content = note(self.code.headline())
        if now - self.marks_at >= MARKS_INTERVAL:
            self.marks_at = now
            for name, text in self.view.marks(snapshot).items():
                self.controls[name].write(text)
            self.write_notes(self.view.notes(snapshot))
            if self.map is not None:
                self.map.draw()
        if self.guide is not None:
            self.guide.update(snapshot, refresh)
        self.share.update()
        if self.compare is not None:
            self.compare.update()

    def write_notes(self, notes: dict[str, str]) -> None:
        """Foldable texts below the controls, as HTML: made once, then kept up to date."""
        for heading, text in notes.items():
            if heading not in self.notes:
                with self.gui.add_folder(heading, expand_by_default=False):
                    self.notes[heading] = self.gui.add_html("")
            self.notes[heading].content = note(Html(text))

    def notify(self, text: str) -> None:
        """Tell every browser."""
        for client in self.server.get_clients().values():
            client.add_notification("Paused", text, color="red", auto_close_seconds=10.0)

    def close(self) -> None:
        """Stop the threads of this panel, and keep unfinished input."""
        if self.guide is not None:
            self.guide.flush()
        if self.map is not None:
            self.map.close()


def params_of_setup(setup: task.Setup) -> tuple[AnyKind, BaseParams, str]:
    """The scene of a task of the lab, its parameters, and the preset that they come from.

    Raises ValueError where there is no such scene, preset or parameter.
    """
    kind = scene_named(setup.scene)
    preset = setup.preset or next(iter(kind.presets))
    if preset not in kind.presets:
        raise argument_error("preset", preset, "one of " + ", ".join(kind.presets))
    return kind, check_record(kind.params, {**kind.presets[preset], **setup.parameters}), preset


def own_presets(kind: AnyKind) -> dict[str, Setup]:
    """The user's own set-ups of a scene, by their names in the list of presets."""
    return {OWN.format(name): setup for name, (_, setup) in own_files(kind).items()}


def with_fields_of(old: BaseParams, new: BaseParams) -> BaseParams:
    """`new`, with the hull from a file, which is not a parameter, as in `old`."""
    kept = {f.name: getattr(old, f.name) for f in dataclasses.fields(old) if "parameter" not in f.metadata}
    return dataclasses.replace(new, **kept)


def button_names(running: bool) -> tuple[str, str, str]:
    """Labels of the buttons: the first names its next action."""
    return "Pause" if running else "Play", "Step", "Reset"


def add_scene_chooser(
    gui: viser.GuiApi, scenes: tuple[str, ...], shown: str | None, open_scene: Callable[[str], None]
) -> None:
    """The list of scenes, each with its name in words."""
    names = {in_words(name): name for name in scenes}
    chooser = gui.add_dropdown("Scene", tuple(names), initial_value=None if shown is None else in_words(shown))

    @chooser.on_update
    async def _(event: ViserEvent) -> None:
        if event.client_id is not None:
            open_scene(names[event.target.value])


def status_line(snapshot: AnySnapshot, busy: float = 0.0, visitors: int = 1) -> Html:
    """Running or not, the clock, the pace, and why the run stopped; how many browsers share the lab."""
    s = snapshot.status
    state = coloured("Running", GOOD_COLOUR) if s.running else coloured("Paused", WARNING_COLOUR)
    if s.replayed is not None and not s.halted:
        state = coloured("Slow motion", WARNING_COLOUR)
    if s.halted:
        state = coloured("Stopped", ERROR_COLOUR)
    pace = fill("×{:.2f} real time, {:.0f} frames/s", s.actual_speed, s.frame_rate)
    if s.capped:
        pace = fill(
            "{}: ×{:.2f} instead of ×{:g}",
            coloured("slower than real time", WARNING_COLOUR), s.actual_speed, s.speed,
        )  # fmt: skip
    return fill(
        '<div class="springtide-panel" data-state="{}" data-snapshot="{}">{} t = {:.2f} s{}{}{}{}{}{}</div>',
        "running" if s.running else "paused",
        snapshot.serial,  # so that one sees that it is fresh, where its words repeat
        state,
        s.time,
        fill(' · <span class="springtide-pace">{}</span>', pace) if s.running else "",
        fill("<br>The run diverged. These are its last steps.") if s.replayed is not None and not s.halted else "",
        fill("<br>This step has taken {:.1f} s so far.", busy) if busy >= BUSY_SHOWN_FROM else "",
        fill("<br>Faster: {}.", s.faster) if s.faster else "",
        fill("<br>{} browsers share this lab.", visitors) if visitors > 1 else "",
        fill('<div class="springtide-stopped" role="alert">{}</div>', s.halted) if s.halted else "",
    )
