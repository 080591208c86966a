"""Random acts and undos in two labs side by side: each keeps its own history, and both have one clock and one sky.

The model is that of one lab, twice. It knows what the labs have in common, and that a beginning in one restarts the
other.
"""

import collections
import itertools
import random
from collections.abc import Callable

import pytest

from app.messages import StepOnce, TogglePlay
from app.scenes.comparisons import shared_parameters, with_shared
from app.scenes.contract import FRAME_INTERVAL
from app.server.beside import SharedRecord
from app.server.loop.shared_clock import Seat, SharedClock
from tests.app.server.loop.test_acts import Lab

PAIRS = (
    ("rope", "rope"), ("rope", "cloth"), ("race", "rope"), ("cloth", "race"), ("square_sea", "square_sea"),
    ("square_sea", "rope"),
)  # fmt: skip
MAX_ACTS = 10


class Pane(Lab):
    """One of the labs, with the parts of a viewer that the record of both needs."""

    is_open = True

    def __init__(self, name: str, rng: random.Random, events: "collections.deque[Callable[[], None]]") -> None:
        """events: takes calls that viser's event loop would make."""
        super().__init__(name, rng, compiles=False)
        self.call = events.append

    def settle(self) -> None:
        """Nothing: both settle together."""

    def speed(self) -> None:
        """A number that both labs have."""
        self.set({"speed": self.rng.choice([0.5, 1.0, 2.0])})

    def begin_anew(self) -> None:
        """Note that the other lab restarted this run."""
        run = self.model.screen.run
        run.time, run.arrays, run.moments = 0.0, None, []

    def move_on(self) -> None:
        """Note that time has passed."""
        self.model.screen.run.time = self.model.screen.run.arrays = None

    def look_at_time(self) -> None:
        """Take the time of the run as it is, if it is not known."""
        run = self.model.screen.run
        run.time = self.loop.scene.time if run.time is None else run.time


class Pair:
    """Two labs on one clock without threads, and their models."""

    def __init__(self, names: tuple[str, str], rng: random.Random) -> None:
        self.rng, self.clock = rng, SharedClock()
        self.events: collections.deque[Callable[[], None]] = collections.deque()
        self.panes = [Pane(name, rng, self.events) for name in names]
        record = SharedRecord(lambda: self.panes)  # type: ignore[arg-type, return-value]
        self.seats = [Seat(self.clock) for _ in self.panes]
        self.clock.seats = tuple(self.seats)
        for pane, seat in zip(self.panes, self.seats, strict=True):
            pane.loop.join(seat)
            pane.settings.watchers.append(lambda pane=pane: record.take(pane, pane.settings.params))  # type: ignore[misc]
            record.join(pane)  # type: ignore[arg-type]
        self.acting: Pane | None = None  # the lab whose acts the loops have not handled
        self.settle()
        for pane in self.panes:
            pane.model.screen.params = pane.settings.params
            pane.settings.history.settings.clear()

    def tell(self) -> None:
        """Make the calls that wait for viser's event loops; what follows comes much later."""
        while self.events:
            self.events.popleft()()
        for pane in self.panes:
            pane.settings.history.changed_at -= 100.0  # [s]

    def settle(self) -> None:
        """Handle everything that waits, in any order."""
        self.tell()
        for _ in range(6):
            for pane in self.rng.sample(self.panes, 2):
                pane.loop.tick(0.0)
        self.acting = None

    def do(self, pane: Pane, act: Callable[[], None]) -> None:
        """An act in one lab, and what follows in the model of the other.

        Acts of one lab may be merged. Those of two labs within a frame have no order.
        """
        model, other = pane.model, self.other(pane)
        if self.acting not in (None, pane):
            self.settle()
        run = model.screen.run
        act()
        if model.screen.run is not run and act not in (pane.moment, pane.pull, pane.place):
            (other.begin_anew if self.acting is None else other.move_on)()
        self.acting = pane
        self.share(pane, other)

    def other(self, pane: Pane) -> Pane:
        """The lab beside one."""
        return self.panes[1 - self.panes.index(pane)]

    def share(self, pane: Pane, other: Pane) -> None:
        """The other lab takes what both have, as an act of its own, and runs or stands still as this one does."""
        self.tell()
        params = with_shared(other.model.screen.params, pane.model.screen.params)
        if params != other.model.screen.params:
            other.model.act(params, begins=False)
        if pane.model.screen.running is None:  # a run that came and went unseen
            self.settle()
            pane.model.screen.running = pane.loop.run.running
        other.model.screen.running = pane.model.screen.running

    def speed_in_both(self) -> None:
        """One number is set in both labs before either knows of the other: the last change counts."""
        first, last = self.rng.sample(self.panes, 2)
        before = last.model.screen.params
        for pane in (first, last):
            pane.set({"speed": self.rng.choice([0.25, 0.75, 1.5])})
        self.share(*((last, first) if last.model.screen.params != before else (first, last)))

    def step(self) -> None:
        """A step in either lab, which is no act."""
        self.see()
        self.rng.choice(self.panes).settings.post(StepOnce(2))
        before = [pane.loop.scene.time for pane in self.panes]
        for pane in self.panes:
            pane.model.screen.running = False
            pane.move_on()
        self.see()
        assert max(pane.loop.scene.time - time for pane, time in zip(self.panes, before, strict=True)) > 0.0

    def play(self) -> None:
        """Play or pause in either lab; the clock goes on for some frames."""
        self.see()
        self.rng.choice(self.panes).settings.post(TogglePlay())
        for pane in self.panes:
            pane.model.screen.running = not pane.model.screen.running
        for _ in range(self.rng.randint(1, 4)):
            for pane in self.rng.sample(self.panes, 2):
                pane.loop.tick(FRAME_INTERVAL)
        for pane in self.panes:
            pane.move_on()
        self.see()

    def see(self) -> None:
        """Compare both labs with their models, and with each other."""
        self.settle()
        for pane in self.panes:
            pane.look_at_time()
            pane.see()
        first, second = self.panes
        for name in shared_parameters(first.settings.params, second.settings.params):
            assert getattr(first.settings.params, name) == getattr(second.settings.params, name), name
        assert first.loop.run.running == second.loop.run.running
        if not first.loop.run.running:
            reached = [seat.reached for seat in self.seats]
            steps = [pane.loop.scene.step for pane in self.panes]
            assert abs(reached[0] - reached[1]) < max(steps) + 1e-9
            assert max(reached) <= self.clock.time + 1e-9


def play_sequence(names: tuple[str, str], seed: int) -> None:
    rng = random.Random(f"{names} {seed}")
    pair = Pair(names, rng)
    pair.see()
    for _ in range(rng.randint(1, MAX_ACTS)):
        pane = rng.choice(pair.panes)
        acts = [
            pane.look, pane.force, pane.several, pane.start, pane.preset, pane.reset, pane.plots, pane.advice,
            pane.moment, pane.pull, pane.place, pane.speed, *[pane.undo] * 5, *[pane.redo] * 3,
        ]  # fmt: skip
        if rng.random() < 0.1:
            pair.speed_in_both()
        else:
            pair.do(pane, rng.choice(acts))
        between = rng.random()
        if between < 0.25:
            pair.step()
        elif between < 0.45:
            pair.play()
        elif between < 0.8:
            pair.see()
    pair.see()


@pytest.mark.parametrize("names", PAIRS, ids=" beside ".join)
def test_acts_in_either_lab_are_undone_there_and_what_both_share_follows(names: tuple[str, str]) -> None:
    for seed in range(8):
        play_sequence(names, seed)


@pytest.mark.stress
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("names", PAIRS, ids=" beside ".join)
def test_many_acts_in_either_lab_are_undone_there_and_what_both_share_follows(names: tuple[str, str]) -> None:
    """2,000 sequences in all."""
    for seed in itertools.islice(itertools.count(1000), 334):
        play_sequence(names, seed)
