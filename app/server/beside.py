"""Two or three labs side by side: the first one, and a lab in each further pane, on one clock and under one sky."""

import contextlib
import threading
import traceback
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from typing import Protocol

import viser

from app.messages import Ask, BaseParams, Checkpoint
from app.panel.settings import SceneSettings
from app.panel.sharing.compare import PaneWords
from app.scenes.comparisons import check_count, headings, middle_of, shared_parameters, with_shared
from app.scenes.setups import Setup
from app.server.loop.shared_clock import Seat, SharedClock
from app.server.loop.sim_loop import SimLoop
from app.server.loop.snapshots import kept_state
from app.server.requests import SceneRequests

FIRST_TIMEOUT = 5.0  # [s] for the first lab to hand over its state or its parameters


class PaneLab(Protocol):
    """The parts of a `Viewer` that a comparison needs."""

    server: viser.ViserServer
    requests: SceneRequests
    ended: bool
    comparison: "ComparedLabs | None"

    @property
    def is_open(self) -> bool:
        """True if a scene is open."""
        ...

    @property
    def settings(self) -> SceneSettings:
        """The settings of the scene."""
        ...

    @property
    def loop(self) -> SimLoop:
        """The loop of the scene."""
        ...

    def open(
        self,
        name: str,
        params: BaseParams | None = None,
        *,
        paused: bool = False,
        given_up: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Show a scene. Returns False if the request was cancelled before the scene was ready."""
        ...

    def is_given_up(self, number: int) -> bool:
        """True if the lab has ended, or another scene was requested after request `number`."""
        ...

    def visitors(self) -> list[int]:
        """Identifiers of the connected browsers."""
        ...

    def call(self, action: Callable[[], None]) -> None:
        """Call a function on viser's event loop, soon."""
        ...

    def stop_opening(self) -> None:
        """Give up a scene that is waiting to be compiled."""
        ...

    def shut(self) -> None:
        """End the lab."""
        ...


class SharedRecord:
    """The parameters that labs side by side have in common; each lab sends to it and shows it.

    Every change of a lab runs on its own event loop, so that the lab never sees half of a change.
    """

    def __init__(self, labs: Callable[[], Sequence[PaneLab]]) -> None:
        """labs: those that are side by side now."""
        self.labs = labs
        self.writing = threading.Lock()
        self.values: dict[str, tuple[object, BaseParams]] = {}  # the last value of each, with the record that set it
        self.seen: dict[PaneLab, BaseParams] = {}  # the last known parameters of each lab
        self.told: set[PaneLab] = set()  # labs that are showing the record at present

    def join(self, viewer: PaneLab) -> None:
        """Take in a lab that shows a new scene: the first lab brings its parameters, another one shows the record."""
        viewer.call(lambda: self.enter(viewer))

    def enter(self, viewer: PaneLab) -> None:
        """See `join`."""
        if not viewer.is_open:
            return
        self.seen[viewer] = viewer.settings.params
        if viewer is self.labs()[0]:
            self.write(viewer, vars(viewer.settings.params))
        else:
            self.show(viewer)

    def take(self, source: PaneLab, params: BaseParams) -> None:
        """Record the changes that a person made in a lab, and not those that the record itself caused."""
        before, self.seen[source] = vars(self.seen.get(source, params)), params
        if source not in self.told:
            self.write(source, {name: value for name, value in vars(params).items() if before.get(name) != value})

    def write(self, source: PaneLab, values: Mapping[str, object]) -> None:
        """Take a lab's values of common parameters, and show them in the other labs."""
        params = source.settings.params
        for viewer in self.labs():
            if viewer is source or not viewer.is_open:
                continue
            common = shared_parameters(params, viewer.settings.params).keys() & values.keys()
            with self.writing:
                self.values.update({name: (values[name], params) for name in common})
            if common:
                viewer.call(lambda viewer=viewer: self.show(viewer))

    def show(self, viewer: PaneLab) -> None:
        """Show the record in a lab, bounded to the ranges there."""
        if not viewer.is_open:
            return
        settings = viewer.settings
        with self.writing:
            values = dict(self.values)
        shared_values = {name: v for name, (v, of) in values.items() if name in shared_parameters(of, settings.params)}
        self.told.add(viewer)
        try:
            settings.set_all(shared_values)
        finally:
            self.told.discard(viewer)


class ComparedLabs:
    """The labs of a comparison: the first one stays unchanged, the others end with the comparison."""

    def __init__(self, first: PaneLab, make_pane: Callable[[int], PaneLab]) -> None:
        """make_pane: makes the lab of a number from 2, with nothing open."""
        self.first, self.make_pane = first, make_pane
        self.viewers: tuple[PaneLab, ...] = (first,)
        self.clock = SharedClock()
        self.seats: dict[PaneLab, Seat] = {}  # of the loops that run
        self.changing, self.ended = threading.Lock(), False  # of `seats`
        self.left: tuple[SimLoop, BaseParams, Checkpoint] | None = None  # the run of the first lab, as it was before
        self.shared = SharedRecord(lambda: self.viewers)

    def begin(self, others: Sequence[Setup], *, resume: bool) -> None:
        """Open the others, then start all together. An error leaves the first lab as it was, and is raised.

        resume: the run of the first lab continues from here when the comparison ends.
        """
        first, request = self.first, self.first.requests.number
        self.left = self.kept() if resume else None
        try:
            for number, setup in enumerate(others, 2):
                pane = self.make_pane(number)
                self.viewers = (*self.viewers, pane)
                pane.comparison = self
                params, paused = with_shared(setup.params, first.settings.params), not first.loop.run.running
                is_there = pane.open(setup.scene, params, paused=paused, given_up=lambda: first.is_given_up(request))
                if not is_there or first.is_given_up(request):
                    self.end()
                    return
        except BaseException:
            self.end()
            raise
        first.comparison = self
        self.seat(first)
        shared: Future[None] = Future()  # until the record has the parameters of the first lab, before a change
        first.call(lambda: shared.set_result(None))
        with contextlib.suppress(TimeoutError):
            shared.result(FIRST_TIMEOUT)

    def kept(self) -> tuple[SimLoop, BaseParams, Checkpoint] | None:
        """The run of the first lab, to be resumed later; None if it does not answer."""
        loop = self.first.loop
        answer: Future[object] = Future()
        loop.commands.put(Ask(lambda: kept_state(loop.run), answer))
        try:
            state = answer.result(FIRST_TIMEOUT)
        except Exception:
            return None
        return (loop, self.first.settings.params, state) if isinstance(state, Checkpoint) else None

    def seat(self, viewer: PaneLab) -> None:
        """Give the lab's loop a seat at the clock, in place of its earlier loop's; all labs start again.

        The common parameters are set in this lab too.
        """
        loop, seat = viewer.loop, Seat(self.clock)
        with self.changing:
            if self.ended:
                return
            self.seats[viewer] = seat
            self.place()
            loop.commands.put(Ask(lambda: loop.join(seat), Future()))
        if self.first.is_open:
            self.shared.join(viewer)

    def leave(self, viewer: PaneLab) -> None:
        """Remove the seat of a lab whose loop has ended or halted: the others no longer wait for it."""
        with self.changing:
            self.seats.pop(viewer, None)
            self.place()

    def place(self) -> None:
        """Put the seats at the clock, in the order of the labs."""
        self.clock.seats = tuple(self.seats[viewer] for viewer in self.viewers if viewer in self.seats)

    def audience(self) -> int:
        """Number of browsers that see all panes: the clock stands still until all panes are connected."""
        return min(len(viewer.visitors()) for viewer in self.viewers)

    def words(self) -> tuple[PaneWords, ...]:
        """Titles of the panes on the page."""
        viewers = [viewer for viewer in self.viewers if viewer.is_open]
        if len(viewers) < len(self.viewers):
            return tuple(PaneWords("", (0.0, 0.0), connected=True) for _ in self.viewers)
        panes = [(viewer.settings.kind, viewer.settings.params) for viewer in viewers]
        middles = [middle_of(kind.name, params) for kind, params in panes]
        connected = [bool(viewer.visitors()) for viewer in viewers]
        return tuple(PaneWords(*pane) for pane in zip(headings(panes), middles, connected, strict=True))

    def end(self) -> None:
        """End the other labs; the first one resumes from its earlier state, if it is still the same run."""
        first, others = self.first, self.viewers[1:]
        self.viewers = (first,)
        first.comparison = None
        with self.changing:
            self.ended = True
            self.clock.seats = ()
            if first in self.seats:
                loop = first.loop
                loop.commands.put(Ask(lambda: loop.join(None), Future()))
        for viewer in others:
            viewer.shut()
        if self.left is not None and first.is_open and first.loop is self.left[0]:
            _, params, state = self.left
            first.call(lambda: first.settings.resume(params, state))


class Comparisons:
    """Begins and ends comparisons, one after the other, on separate threads."""

    def __init__(self, first: PaneLab, make_pane: Callable[[int], PaneLab]) -> None:
        self.first, self.make_pane = first, make_pane
        self.lock = threading.Lock()
        self.opening: ComparedLabs | None = None  # a comparison whose labs are being opened

    def begin(self, setups: Sequence[Setup], with_first: bool) -> None:
        """Show set-ups beside the first lab; with_first: the first of them in the first lab.

        Raises ValueError for too few or too many of them.
        """
        check_count(setups if with_first else [*setups, *setups[:1]])
        with self.lock:
            if self.first.ended:
                return
            if self.first.comparison is not None:
                self.first.comparison.end()
            if with_first and not self.first.open(setups[0].scene, setups[0].params):
                return  # another scene was requested
            self.opening = ComparedLabs(self.first, self.make_pane)
            try:
                self.opening.begin(setups[1:] if with_first else setups, resume=not with_first)
            finally:
                self.opening = None

    def want(self, setups: Sequence[Setup], with_first: bool) -> None:
        """Begin on a separate thread; returns at once."""
        threading.Thread(target=self.try_to, args=(lambda: self.begin(setups, with_first),), daemon=True).start()

    def end(self) -> None:
        """Show the first lab alone, on a separate thread."""
        threading.Thread(target=self.try_to, args=(self.end_now,), daemon=True).start()

    def end_now(self, timeout: float = -1.0) -> None:
        """Show the first lab alone. timeout: [s] to wait for one that is being opened; -1: no limit."""
        if not self.lock.acquire(timeout=timeout):
            return
        try:
            if self.first.comparison is not None:
                self.first.comparison.end()
        finally:
            self.lock.release()

    def stop_opening(self) -> None:
        """Give up a comparison that waits to be compiled, as the first lab ends."""
        for labs in (self.opening, self.first.comparison):
            if labs is not None and labs.first is self.first:
                for viewer in labs.viewers[1:]:
                    viewer.stop_opening()

    def try_to(self, action: Callable[[], None]) -> None:
        """Run the action; show its error on every page."""
        try:
            action()
        except Exception as error:
            if not isinstance(error, ValueError):
                traceback.print_exc()
            for client in self.first.server.get_clients().values():
                client.add_notification("Couldn't open a second pane", str(error), color="red")
