"""The settings of the open scene: its parameters, their preset, and the history for Undo."""

import dataclasses
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

import viser

from app.formats.formatting import with_unit
from app.lab.course import task
from app.messages import (
    BaseParams,
    Begin,
    Change,
    Checkpoint,
    Command,
    GoBack,
    GoOn,
    GrabTo,
    Place,
    RecordCommand,
    Release,
    Reset,
    Resume,
)
from app.panel.history import EarlierSettings, History, SceneRequest
from app.panel.workbook.task_setups import setup_of_task
from app.render.cameras import ClientCamera, client_cameras
from app.scenes.contract import Advice, AnyKind, PostCommand
from app.scenes.own_setups import own_files
from app.scenes.setups import CHANGES, FILES, Setup, file_name, make_setup, with_changes
from sim.parameters import (
    Effect,
    Parameter,
    Value,
    changed_names,
    clamp_value,
    effect_of_change,
    in_words,
    parameters_of,
)

NO_PARAMS: Mapping[str, BaseParams] = MappingProxyType({})
CAMERA = "camera"  # a thing that a view places, not a person
OWN = "Mine: {}"  # name of the user's own set-ups in the list of presets

OpenScene: TypeAlias = Callable[[SceneRequest], None]


class Placing(NamedTuple):
    """Cameras to place when the first picture of a run is shown."""

    act: int  # that begins the run
    first_view: bool  # place every camera like that of a new browser
    cameras: tuple[ClientCamera, ...] = ()  # of single browsers, placed afterwards


class SceneSettings:
    """The settings of one scene. Each act of a person is one change, with one entry in the history.

    Each change posts one command, then calls the watchers.

    Changes come on viser's event loop, one after the other; other threads read `params`.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        kind: AnyKind,
        params: BaseParams,
        post: PostCommand,
        open_scene: OpenScene = lambda request: None,
        first_params: Mapping[str, BaseParams] = NO_PARAMS,
        history: History | None = None,
        preset: str = "",
    ) -> None:
        """post: takes commands for the simulation. open_scene: takes another scene to show. Both return at once.

        first_params: by scene, with the files that the lab has for other scenes. history: of the lab before this scene;
        None: the scene is its first one. preset: of the parameters, if it is known.
        """
        self.server, self.kind, self.post, self.open_scene = server, kind, post, open_scene
        self.params, self.first_params = params, first_params
        self.own = own_presets(kind)  # name in the list -> the user's set-up
        # Name of the last preset loaded; at first the one nearest to the parameters, if it is not known.
        self.loaded = preset if preset in self.presets else self.nearest_preset(params)
        self.history = history or History()
        self.pulling: set[int] = set()  # browsers that drag a point
        self.is_open = True  # False once another scene replaces it
        self.placing: Placing | None = None  # for the viewer; the last one counts
        self.watchers: list[Callable[[], None]] = []  # called after each change, to show it

    @property
    def presets(self) -> tuple[str, ...]:
        """Names of the presets, and of the user's own set-ups."""
        return (*self.kind.presets, *self.own)

    def params_of(self, preset: str) -> BaseParams:
        """The parameters of a preset. The hull from a file, which is not a parameter, stays."""
        return self.params_of_setup(self.own.get(preset) or make_setup(self.kind, preset))

    def params_of_setup(self, setup: Setup) -> BaseParams:
        """The parameters of a set-up, with the file that the lab has for its scene, changed as the set-up says.

        Raises ValueError as `with_changes`.
        """
        return with_changes(with_fields_of(self.params_with_files(setup.scene), setup.params), setup)

    def shows(self, setup: Setup) -> bool:
        """True if the parameters are those of a set-up. Raises ValueError as `with_changes`."""
        return setup.scene == self.kind.name and self.params_of_setup(setup) == self.params

    def params_with_files(self, scene: str) -> BaseParams | None:
        """Parameters of a scene that have the files of the lab for it, if there are any."""
        return self.params if scene == self.kind.name else self.first_params.get(scene)

    def nearest_preset(self, params: BaseParams) -> str:
        """Name of the preset nearest to the parameters."""
        return min(self.kind.presets, key=lambda name: len(changed_names(self.params_of(name), params)))

    def setup_of(self, preset: str) -> Setup:
        """The set-up of a preset."""
        return self.own[preset] if preset in self.own else Setup(self.kind.name, self.params_of(preset), {}, preset)

    @property
    def other_name(self) -> str:
        """Name shown instead of the loaded preset's if an effective parameter, or a file, differs from it; else ""."""
        look = {name for name, parameter in parameters_of(self.params).items() if parameter.affects == "look"}
        is_edited = tuple(getattr(self.params, CHANGES, ())) != tuple(self.setup_of(self.loaded).changes)
        if not is_edited and not changed_names(self.params_of(self.loaded), self.params) - look:
            return ""
        files = [file_name(path) for field in FILES.values() if (path := getattr(self.params, field, ""))]
        name = ", ".join(files) or self.loaded
        return f"{name} (changed)" if is_edited or not files else name

    # ----- changes

    def set(self, name: str, value: object, client: int | None = None) -> None:
        """Set one parameter, bounded to its range. client: the browser in which a person did."""
        self.set_all({name: value}, client)

    def set_all(self, values: Mapping[str, object], client: int | None = None, *, restarts: bool = False) -> None:
        """Set parameters, each bounded to its range: one change. restarts: restart the scene in any case."""
        known = parameters_of(self.params)
        good = {name: clamp_value(known[name], value) for name, value in values.items()}
        changed = [name for name, value in good.items() if value != getattr(self.params, name)]
        if not changed and not restarts:
            return
        params = dataclasses.replace(self.params, **good)
        is_number = len(changed) == 1 and not known[changed[0]].choices and known[changed[0]].kind is not bool
        effect: Effect = "start" if restarts else self.effect_of(params)
        words = in_words(changed[0]) if len(changed) == 1 else "new values" if changed else "restart"
        number = changed[0] if is_number and not restarts else ""
        act = self.history.note(self.now(words), number=number, client=client, begins=effect == "start")
        self.take(Change(params, effect, act), self.loaded)

    def toggle_plots(self) -> None:
        """Open all plots, or close them if one is open."""
        plots = [name for name in parameters_of(self.params) if name in self.kind.plots or name in self.kind.curves]
        self.set_all(dict.fromkeys(plots, not any(getattr(self.params, name) for name in plots)))

    def follow(self, advice: Advice) -> None:
        """Set the parameter of an advice, and start again."""
        self.set_all({advice.name: advice.value}, restarts=True)

    def load(self, preset: str) -> None:
        """Load all parameters of the preset, and restart the scene."""
        self.load_params(self.params_of(preset), preset)

    def load_params(self, params: BaseParams, preset: str, cameras: tuple[ClientCamera, ...] = ()) -> None:
        """Take parameters, and restart the scene. preset: their source. cameras: of single browsers."""
        before = self.now(f"preset {preset}", client_cameras(self.server))
        act = self.history.note(before, begins=True, runs=True)
        self.placing = Placing(act, first_view=True, cameras=cameras)
        self.take(Begin(params, act), preset)

    def set_up(self, setup: task.TaskSetup) -> None:
        """Show the set-up of a task. Raises ValueError for an unknown scene, preset or parameter."""
        self.show_setup(setup_of_task(setup), None)

    def show_setup(self, setup: Setup, client: int | None) -> None:
        """Show a set-up from a link or a file, with its camera for one browser. Raises ValueError as `with_changes`."""
        camera = None if setup.camera is None or client is None else ClientCamera(client, *setup.camera)
        params = self.params_of_setup(setup)
        if setup.scene != self.kind.name:
            self.open_scene(SceneRequest(setup.scene, params, () if camera is None else (camera,)))
            return
        self.load_params(params, setup.preset or next(iter(self.kind.presets)), () if camera is None else (camera,))

    def open_first_view_of(self, scene: str) -> None:
        """Show another scene in its first view."""
        self.open_scene(SceneRequest(scene))

    def resume(self, params: BaseParams, state: Checkpoint) -> None:
        """Resume the scene from a checkpoint, with its parameters."""
        act = self.history.note(self.now("going back in time"), begins=True, runs=True)
        self.take(Resume(params, state, act), self.loaded)

    def begin_with(self, params: BaseParams) -> None:
        """Restart the scene with other parameters, leaving the cameras in place."""
        act = self.history.note(self.now("new values"), begins=True, runs=True)
        self.take(Begin(params, act), self.loaded)

    def reset(self) -> None:
        """Restart the scene."""
        self.post(Reset(self.history.note(self.now("reset"), begins=True)))
        self.tell()

    def drag(self, command: Command) -> None:
        """Pass a command of a view on; the first one of a drag is an act."""
        thing = ""
        if isinstance(command, GrabTo) and command.client not in self.pulling:
            self.pulling.add(command.client)
            thing = "a pull"
        elif isinstance(command, Release):
            self.pulling.discard(command.client)
        elif isinstance(command, Place) and command.thing != CAMERA:
            thing = f"moving the {command.thing}"
        if thing:
            act, number = self.history.act, "" if isinstance(command, GrabTo) else thing
            new = self.history.note(self.now(thing), number=number, begins=True)
            if new != act:
                self.post(GoOn(new))
                self.tell()
        self.post(command)

    def undo(self) -> None:
        """Restore the settings before the last act, and their run if that act began another."""
        self.go_to(self.history.last, self.history.take_last)

    def redo(self) -> None:
        """Restore the settings after the act that was undone last, and their run as it was left."""
        self.go_to(self.history.next, self.history.take_next)

    def go_to(
        self, settings: EarlierSettings | None, take: Callable[[EarlierSettings], EarlierSettings | None]
    ) -> None:
        """Restore settings of the history, if there are any. take: takes them out, given the present ones.

        Those of another scene are taken out once it is opened.
        """
        if settings is None:
            return
        if settings.scene != self.kind.name:
            self.open_scene(SceneRequest(settings.scene, settings.params, settings.cameras, settings))
            return
        act = self.history.act
        take(self.now("", client_cameras(self.server) if settings.cameras else ()))
        self.restore(act, settings)

    def history_of_next(self, scene: str, earlier: EarlierSettings | None) -> History:
        """The history of the scene that replaces this one. earlier: see `SceneRequest`."""
        now = self.now(f"scene {in_words(scene)}", client_cameras(self.server))
        return self.history.for_other_scene(now, earlier)

    def restore(self, act: int, settings: EarlierSettings) -> None:
        """Show settings from the history. act: of the present run."""
        self.pulling.clear()  # a point that is still held begins another drag
        known = settings.preset in self.presets  # a set-up of the user may have been removed
        if settings.cameras:
            self.placing = Placing(settings.act, first_view=False, cameras=settings.cameras)
        command = (
            Change(settings.params, self.effect_of(settings.params), act)
            if settings.act == act
            else GoBack(settings.params, settings.act, settings.runs)
        )
        self.take(command, settings.preset if known else next(iter(self.kind.presets)))

    def read_own(self, chosen: str = "") -> None:
        """Read the user's own set-ups again. chosen: the one with the present parameters, if any."""
        self.own = own_presets(self.kind)
        if chosen:
            self.loaded = OWN.format(chosen)
        if self.loaded not in self.presets:
            self.loaded = next(iter(self.kind.presets))
        self.tell()

    def now(self, words: str, cameras: tuple[ClientCamera, ...] = ()) -> EarlierSettings:
        """The present settings, for the history.

        words: the act that is about to change them. cameras: of all browsers, if they are about to be placed.
        """
        return EarlierSettings(self.kind.name, self.params, self.loaded, cameras=cameras, words=words)

    @property
    def undo_words(self) -> str:
        """The act that an undo takes back, and the settings that come back; "" without an act."""
        return self.words_to(self.history.last, "back to")

    @property
    def redo_words(self) -> str:
        """The act that a redo repeats, and the settings that follow; "" without an act."""
        return self.words_to(self.history.next, "forward to")

    def words_to(self, settings: EarlierSettings | None, way: str) -> str:
        """The act between the present settings and others of the history, and the name of these; "" without others.

        The run of another scene is not kept.
        """
        if settings is None:
            return ""
        if settings.scene != self.kind.name:
            return f"{way} {in_words(settings.scene)}, in a new run"
        if settings.preset != self.loaded:
            return f"{settings.words}, {way} {settings.preset}"
        changed, parameters = changed_names(self.params, settings.params), parameters_of(self.params)
        if len(changed) != 1 or not parameters.keys() >= set(changed):  # numbers of a file have no control
            return settings.words
        (name,) = changed
        value = value_in_words(parameters[name], getattr(settings.params, name))
        return f"{settings.words}, {way} {value}"

    def effect_of(self, params: BaseParams) -> Effect:
        """Effect of a change from the present parameters; that of none is as small as that of a look."""
        return effect_of_change(self.params, params) or "look"

    def take(self, command: RecordCommand, preset: str) -> None:
        """Take parameters, and pass them to the simulation. preset: their source."""
        self.params, self.loaded = command.params, preset
        self.post(command)
        self.tell()

    def tell(self) -> None:
        """Call every watcher. The first error of one is raised after the last, so that it silences no other."""
        errors: list[Exception] = []
        for watcher in self.watchers:
            try:
                watcher()
            except Exception as error:
                errors.append(error)
        if errors:
            raise errors[0]


def own_presets(kind: AnyKind) -> dict[str, Setup]:
    """The user's own set-ups of a scene, by their names in the list of presets."""
    return {OWN.format(name): setup for name, (_, setup) in own_files(kind).items()}


def value_in_words(parameter: Parameter, value: Value) -> str:
    """A value of a parameter, as the panel shows it."""
    if parameter.choices:
        return parameter.title_of(str(value))
    return ("on" if value else "off") if isinstance(value, bool) else with_unit(float(value), parameter.unit)


def with_fields_of(old: BaseParams | None, new: BaseParams) -> BaseParams:
    """`new` with the files of `old` and the other fields that are not parameters."""
    if old is None:
        return new
    others = {f.name: getattr(old, f.name) for f in dataclasses.fields(old) if "parameter" not in f.metadata}
    return dataclasses.replace(new, **others)
