"""The handle of a lab beside a notebook, and its opening."""

import atexit
import contextlib
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from app.messages import Advance, Ask, Pause, Play
from app.notebook.dataset import to_dataset
from app.notebook.output import Output, cell_of_now
from app.notebook.picture import Still, take_still
from app.scenes import scene_named
from app.scenes.contract import AnyKind
from app.scenes.setups import make_setup, preset_setup, read_query, with_values, write_query
from app.server.served_scene import ServedScene
from app.server.viewer import Viewer
from app.server.web.access import Access, make_key
from sim.parameters import check_value, parameters_of, unknown_parameter
from sim.validation import argument_error, check_number, is_whole_number

if TYPE_CHECKING:
    import xarray

HOST = "127.0.0.1"
MAX_WAIT = 1e6  # [s] of simulated time
MIN_HEIGHT, MAX_HEIGHT = 200, 4000  # [pixels] of the output
POLL_INTERVAL = 0.05  # [s] between two checks of an awaited result, so that the kernel can be interrupted
CALL_TIMEOUT = 20.0  # [s] for viser's event loop to answer
LAST_TIMEOUT = 2.0  # [s] for the last picture; without it an earlier one stays
T = TypeVar("T")


class Lab:
    """A lab that runs beside the notebook. The parameters of its scene are attributes, to read and to set.

    With `with app.show(...) as lab:` it ends with the block.
    """

    def __init__(self, viewer: Viewer, key: str, output: Output) -> None:
        """key: the secret in the address of its page."""
        set_own = super().__setattr__
        set_own("_viewer", viewer)
        set_own("_key", key)
        set_own("_output", output)

    @property
    def scene(self) -> str:
        """Name of the scene that is open."""
        return self._kind.name

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._open.loop.latest.status.time

    @property
    def running(self) -> bool:
        """True if the clock runs. It stands still while no browser watches."""
        return self._open.loop.run.running

    @property
    def link(self) -> str:
        """The set-up as an address, "?scene=...": `app.show` takes it, and so does any page of the lab."""
        settings = self._open.settings
        return write_query(settings.kind, settings.params, settings.loaded)

    @property
    def address(self) -> str:
        """Address of the page, for a browser on the kernel's machine. Anyone who has it can control the lab."""
        return f"http://{HOST}:{self._open.port}/{self._key}/"

    def set(self, **values: float | str) -> None:
        """Set parameters. Raises ValueError, and sets none, if one is not allowed."""
        known = parameters_of(self._params)
        for name in values:
            if name not in known:
                raise unknown_parameter(name, known)
        good = {name: check_value(name, known[name], plain(value)) for name, value in values.items()}
        settings = self._open.settings

        self._on_event_loop(lambda: settings.set_all(good))

    def wait(self, seconds: float) -> float:
        """Let the lab run for `seconds` [s] of simulated time, to a whole step; returns the time then [s].

        Afterwards the clock continues or stands still as before. With a browser the lab runs at its speed, without
        one as fast as it can. Raises ValueError for what is not a time, DivergenceError if the run stops
        before, and RuntimeError if it is reset or another scene is opened meanwhile.
        """
        check_number("seconds", seconds, "s", 0.0, MAX_WAIT)
        answer: Future[float] = Future()
        served = self._open.served
        served.commands.put(Advance(float(seconds), answer))
        return self._result_of(answer, served)

    def reset(self) -> None:
        """Restart the run with the present parameters."""
        self._on_event_loop(self._open.settings.reset)

    def play(self) -> None:
        """Let the clock run."""
        self._open.commands.put(Play())

    def pause(self) -> None:
        """Stop the clock."""
        self._open.commands.put(Pause())

    def data(self) -> "xarray.Dataset":
        """Present state of the lab, with units in `attrs`; needs the extra `jupyter`.

        Over `t` [s] the values of the plots since the run began, at most 20,000 of each; at the time `now` [s] the
        state, the measures and the other charts of the scene.
        """
        viewer, kind = self._open, self._kind
        loop, scene = viewer.loop, viewer.loop.scene
        return self._asked(lambda: to_dataset(kind, scene, loop.run.snapshots.kept_rows, self.link))

    def picture(self, width: int = 960, height: int = 540) -> Still:
        """A picture [pixels] of a browser's view, which stays in the notebook.

        Raises RuntimeError if no browser shows the lab, and TimeoutError if one does not draw.
        """
        return take_still(self._open, width, height)

    def stop(self) -> None:
        """End the lab. Its last picture stays in the output cell."""
        viewer: Viewer = self._viewer
        if viewer.ended:
            return
        with contextlib.suppress(RuntimeError, TimeoutError):
            if viewer.audience():
                self._output.still = take_still(viewer, *self._output.still_size, timeout=LAST_TIMEOUT)
        viewer.shut()
        self._output.end()

    def __enter__(self) -> "Lab":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def __getattr__(self, name: str) -> Any:
        # IPython reads names that begin with "_" from every object; they are no parameters.
        if not name.startswith("_") and name in parameters_of(self._params):
            return getattr(self._params, name)
        raise AttributeError(str(unknown_parameter(name, parameters_of(self._params))))

    def __setattr__(self, name: str, value: Any) -> None:
        if hasattr(type(self), name):
            raise AttributeError(f"{name}: not a parameter, so it cannot be set")
        self.set(**{name: value})

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *({} if self._viewer.ended else parameters_of(self._params))]

    def __repr__(self) -> str:
        if self._viewer.ended:
            return "<a lab that was stopped>"
        return f"<lab of the scene {self.scene}, t = {self.time:.2f} s>"

    @property
    def _open(self) -> Viewer:
        """The viewer. Raises RuntimeError if the lab was stopped."""
        self._check_open()
        return self._viewer

    @property
    def _kind(self) -> AnyKind:
        return self._open.settings.kind

    @property
    def _params(self) -> Any:
        """The parameters as set now."""
        return self._open.settings.params

    def _check_open(self) -> None:
        if self._viewer.ended:
            raise RuntimeError("this lab was stopped; app.show opens a new one")

    def _asked(self, read: Callable[[], T]) -> T:
        """Result of `read`, called between two steps of the simulation."""
        answer: Future[Any] = Future()
        served = self._open.served
        served.commands.put(Ask(read, answer))
        return self._result_of(answer, served)

    def _result_of(self, answer: "Future[T]", served: ServedScene) -> T:
        """The answer of a scene. Raises RuntimeError if it is closed before it has answered."""
        try:
            while True:
                with contextlib.suppress(TimeoutError):
                    return answer.result(POLL_INTERVAL)
                self._check_open()
                if not served.is_open:
                    raise RuntimeError("another scene was opened in the meantime")
        finally:
            answer.cancel()  # after an interrupt of the kernel the lab must not wait for it

    def _on_event_loop(self, action: Callable[[], None]) -> None:
        """Call a function on viser's event loop, and wait for it."""
        done: Future[None] = Future()

        def run() -> None:
            try:
                action()
            except Exception as error:
                done.set_exception(error)
            else:
                done.set_result(None)

        self._viewer.server.get_event_loop().call_soon_threadsafe(run)
        done.result(CALL_TIMEOUT)


def plain(value: object) -> object:
    """A number of numpy's as one of Python's."""
    return value.item() if isinstance(value, np.generic) else value


# id -> (cell, execution, lab, its viewer) of the labs that run in this kernel
LABS: dict[int, tuple[str, str, Lab, Viewer]] = {}


def show_lab(scene: str, preset: str, parameters: Mapping[str, object], *, paused: bool, height: int, port: int) -> Lab:
    """See `app.show`."""
    kind, params = read_setup(scene, preset, {name: plain(value) for name, value in parameters.items()})
    if not is_whole_number(height) or not MIN_HEIGHT <= height <= MAX_HEIGHT:
        raise argument_error("height", height, f"{MIN_HEIGHT} to {MAX_HEIGHT} pixels")
    if not is_whole_number(port) or not 0 <= port <= 65535:
        raise argument_error("port", port, "0 to 65535")
    cell, execution = cell_of_now()
    stop_former(cell, execution)
    key = make_key()
    try:
        viewer = Viewer(HOST, int(port), compile_ahead=True, access=Access(key=key))
    except OSError as error:
        raise OSError(f"port: {port} cannot be used ({error.strerror or error}); 0 takes any free one") from None
    output = Output(viewer.port, key, int(height))
    lab = Lab(viewer, key, output)
    output.show()
    try:
        viewer.open(kind.name, params, paused=bool(paused))
    except BaseException:
        viewer.shut()
        output.end()
        raise
    LABS[id(lab)] = (cell, execution, lab, viewer)
    keep_still(viewer, output)
    return lab


def read_setup(scene: str, preset: str, parameters: Mapping[str, object]) -> tuple[AnyKind, Any]:
    """The scene and its parameters. Raises ValueError if they are not allowed."""
    if not isinstance(scene, str) or not isinstance(preset, str):
        raise argument_error("scene, preset", (scene, preset), "names")
    if "?" in scene:
        setup = read_query(scene[scene.index("?") :])
    else:
        setup = make_setup(scene_named(scene), "" if preset else None, parameters)
    kind = scene_named(setup.scene)
    if preset:
        base_setup = preset_setup("preset", preset, kind)
        setup = with_values(setup, base_setup.values)
        for option, file in base_setup.files.items():
            warnings.warn(f"The {option} {file} is not in {preset}: this lab runs without it", stacklevel=4)
    return kind, with_values(setup, parameters).params


def stop_former(cell: str, execution: str) -> None:
    """End the labs opened by an earlier execution of this cell, and forget those that have ended."""
    for name, (other, earlier, lab, viewer) in list(LABS.items()):
        if cell and other == cell and earlier != execution:
            lab.stop()
        if viewer.ended:
            del LABS[name]


def keep_still(viewer: Viewer, output: Output) -> None:
    """Put a picture into the notebook once a browser has drawn the lab."""

    def keep() -> None:
        while not viewer.ended and output.still is None:
            time.sleep(0.5)
            if viewer.audience() and viewer.is_open:
                with contextlib.suppress(RuntimeError, TimeoutError):
                    output.show_still(take_still(viewer, *output.still_size))

    threading.Thread(target=output.context.run, args=(keep,), name="still picture", daemon=True).start()


@atexit.register
def stop_all() -> None:
    """End the compiler processes when the notebook's kernel ends."""
    for _, _, _, viewer in LABS.values():
        viewer.shut()
