"""A race: up to six ropes that differ in method, step or stiffness only, on one clock, against a reference.

All ropes and the reference meet at the end of each tick, a multiple of the longest step; steps that do not divide it
are shortened equally. A rope that diverges is held where it last was good, and says why; one
that refuses (an undamped method on a damped net) never starts. The others race on.
"""

import dataclasses
import math
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.rope.parameters import MOST_ROPES, Params
from sim.springs import INTEGRATORS, Integrator, Net
from sim.springs.analysis.extremes import extremes
from sim.springs.analysis.reference_run import TRUST_FACTOR, ReferenceRun
from sim.springs.stability import Gauge, gauge
from sim.springs.state import State, advance, energy, steps_for

LONGEST = 0.1  # [s] that a step of equal cost may take
TRIAL = 24  # steps, fewer of long ropes, that the cost of an implicit method is judged by
TIMED = 10_000  # evaluations of a point that timing a step takes each time, at most
REPEATS = 3  # times, of which the least counts
LONGEST_TICK = 1 / 30  # [s], or the longest step: how far a multiple of it is looked for that suits the others
SHORTENED = 0.02  # part of itself that a step may lose to make the tick a multiple of it
STIFFEST = 1e9  # [N/m], as of the parameter


class Standing(NamedTuple):
    """How a rope of the race fares."""

    number: int
    integrator: str
    step: float  # [s]
    stiffness: float  # [N/m]
    gauge: Gauge
    evals: float  # force evaluations a step, lately
    corrections: float  # Newton's, a step, lately; 0 of explicit methods
    cost: float  # [s] a step takes
    error: float  # [m] largest distance of a point from the reference; NaN where there is none
    certain: float  # [m] below which the reference says nothing of that error; NaN where there is none
    taken: float  # [J] that the method took, or gave if negative, beyond what damping takes
    out: str  # why it is out of the race, or ""


class RaceReadings(NamedTuple):
    """The standings, and of the reference: when chaos took it [s], and why there is none."""

    standings: tuple[Standing, ...]
    horizon: float | None
    no_ghost: str


def method_of(params: Params, number: int) -> str:
    """The method of rope `number`, from 1."""
    return params.integrator if number == 1 else getattr(params, f"integrator_{number}")


def evals_of(net: Net, record: Integrator, h: float) -> float:
    """Force evaluations a step of h [s] takes: as declared, or of implicit methods in a trial from the start."""
    if not record.implicit:
        return float(record.evals)
    state = State.at_rest(net)
    advance(net, state, record, h, max(4, min(TRIAL, 2400 // net.shape[1])))
    return max(float(record.evals), state.force_evals / state.steps)


def step_of(params: Params, number: int, net: Net) -> float:
    """The step [s] that rope `number` is given by the rule of the race."""
    if number == 1 or params.race_steps == "same step":
        return params.time_step
    if params.race_steps == "own steps":
        return getattr(params, f"step_{number}")
    record = INTEGRATORS[method_of(params, number)]
    budget = params.time_step / evals_of(net, INTEGRATORS[params.integrator], params.time_step)  # [s] an evaluation
    h = params.time_step
    # What Newton's method takes depends on the step in turn.
    for _ in range(2 if record.implicit else 1):
        h = min(LONGEST, budget * evals_of(net, record, h))
    return h


def stiffened(net: Net, ratio: float) -> Net:
    """The net with links `ratio` times as stiff, at most STIFFEST."""
    return net.with_stiffness(min(STIFFEST, ratio * net.families[0].stiffness))


def tick_of(steps: list[float]) -> float:
    """The time [s] between meetings of all: the least multiple of the longest step that shortens no step by much."""
    longest = max(steps)
    multiples = range(1, max(1, int(LONGEST_TICK / longest * (1 + 1e-9))) + 1)

    def loss(multiple: int) -> float:
        tick = multiple * longest
        return max(1.0 - tick / (steps_for(tick, step) * step) for step in steps)

    return longest * next((m for m in multiples if loss(m) <= SHORTENED), min(multiples, key=loss))


class Lane:
    """One rope of the race."""

    def __init__(self, number: int, net: Net, record: Integrator, step: float, tick: float) -> None:
        """step: [s] as given; the one taken divides `tick` [s]."""
        self.number, self.record = number, record
        self.substeps = steps_for(tick, step)
        self.step = tick / self.substeps
        self.state = State.at_rest(net)
        self.out = ""
        self.cost = 0.0
        self.counted = (0, 0)  # evaluations and steps when last looked at
        self.evals, self.corrections = float(record.evals), 0.0
        self.gauge = gauge(net, record, self.step, self.state)
        self.take(net)
        if record.undamped_only and net.is_damped:
            self.out = "takes no damping: set damping and drag to 0, the floor off"
        self.look()

    def take(self, net: Net) -> None:
        """The net as the parameters have it now: a new account of energy, new bounds."""
        self.net = net
        self.state.dissipated = self.state.work = 0.0
        self.initial = energy(net, self.state).total
        sag = net.mass * abs(net.gravity[2]) / max(net.families[0].stiffness, 1e-9)
        n = net.shape[1] - 1
        length = n * net.families[0].rest
        # A swinging rope pulls at a point with some thrice its weight; further out it is no picture of a rope.
        reach = extremes(self.state.x, self.state.v).reach
        self.bound = 0.5 + 1.2 * max(length + 2.0 * sag * n * (n + 1), reach)

    @property
    def stiffness(self) -> float:
        """[N/m] of its links."""
        return self.net.families[0].stiffness

    def advance(self, net: Net, ticks: int) -> None:
        """Take the steps of so many ticks; net: as it moves meanwhile."""
        if self.out:
            return
        good = self.state.copy()
        advance(net, self.state, self.record, self.step, ticks * self.substeps, with_account=True)
        if not extremes(self.state.x, self.state.v).reach < self.bound:  # nor is a NaN
            when = self.state.t
            self.state = good
            self.out = self.verdict(when)

    def verdict(self, when: float) -> str:
        """Why it is out, at time `when` [s]."""
        g = self.gauge
        if g.h_omega > g.limit:
            return f"diverged at {when:.2f} s: h ω = {g.h_omega:.3g} is over {g.limit:.3g}"
        return f"diverged at {when:.2f} s: too sudden for the step, though h ω = {g.h_omega:.3g} of {g.limit:.3g}"

    def pin(self, position: tuple[float, float, float]) -> None:
        """Put the root to rest at a place [m]."""
        self.state.x[:, 0, 0] = position
        self.state.v[:, 0, 0] = 0.0

    def look(self) -> None:
        """Judge stability and cost of the state as it is."""
        if self.out:
            return
        self.gauge = gauge(self.net, self.record, self.step, self.state)
        self.cost = self.timed()
        evals, steps = self.state.force_evals, self.state.steps
        if steps > self.counted[1]:
            if self.record.implicit:
                self.evals = (evals - self.counted[0]) / (steps - self.counted[1])
                self.corrections = max(0.0, self.evals - self.record.evals_outside_newton)
            self.counted = evals, steps

    def timed(self) -> float:
        """Time [s] of a step from here: the least of a few calls of steps each, without what calling costs."""
        each = self.evals * self.state.x.size / 3
        many = int(np.clip(TIMED / each, 3, 200))
        least = [math.inf, math.inf]
        for _ in range(REPEATS if many > 3 else 1):
            for i, steps in enumerate((1, many)):
                copy = self.state.copy()
                start = time.perf_counter()
                advance(self.net, copy, self.record, self.step, steps)
                least[i] = min(least[i], time.perf_counter() - start)
        now = max(0.0, least[1] - least[0]) / (many - 1)
        # Down at once, up slowly: what disturbs a timing lengthens it.
        return now if not 0.0 < self.cost < now else 0.9 * self.cost + 0.1 * now

    def total(self) -> float:
        """Stored energy [J]."""
        return energy(self.net, self.state).total

    def taken(self) -> float:
        """Energy [J] that is neither stored nor damped nor paid out: what the method itself took."""
        return self.initial + self.state.work - self.state.dissipated - self.total()


class Race:
    """All lanes, the reference of each, and the clock."""

    def __init__(self, net: Net, params: Params) -> None:
        """net: of rope 1, at rest at time 0."""
        self.ratio = params.stiffness_ratio
        numbers = range(1, params.ropes + 1)
        nets = [stiffened(net, self.ratio ** (number - 1)) for number in numbers]
        steps = [step_of(params, number, own) for number, own in zip(numbers, nets, strict=True)]
        self.tick = tick_of(steps)  # [s]
        self.t = 0.0
        self.lanes = [
            Lane(number, own, INTEGRATORS[method_of(params, number)], step, self.tick)
            for number, own, step in zip(numbers, nets, steps, strict=True)
        ]
        # Ropes of one stiffness share a reference.
        count = params.ropes if self.ratio != 1.0 else 1
        self.ghosts = [ReferenceRun(nets[i], params.length, count) for i in range(count)]

    @staticmethod
    def line_up(params: Params) -> tuple:
        """What a race is made of: a change of any of these starts it anew."""
        names = [f"{what}_{number}" for what in ("integrator", "step") for number in range(2, MOST_ROPES + 1)]
        first = ("ropes", "points", "length", "units", "integrator", "time_step", "race_steps", "stiffness_ratio")
        return tuple(getattr(params, name) for name in (*first, *names))

    def ghost_of(self, lane: Lane) -> ReferenceRun:
        return self.ghosts[min(lane.number, len(self.ghosts)) - 1]

    def take(self, net: Net) -> None:
        """New parameters of the same ropes; the motion goes on."""
        for lane in self.lanes:
            lane.take(stiffened(net, self.ratio ** (lane.number - 1)))
            lane.look()
        for ghost, lane in zip(self.ghosts, self.lanes, strict=False):
            ghost.update(lane.net)

    def advance(self, moving: Net, ticks: int) -> tuple[int, int]:
        """Advance all by so many ticks; moving: rope 1's net as root and pull move meanwhile.

        Returns how many force evaluations and steps that took, the references' apart.
        """
        duration = ticks * self.tick
        before = self.counts()
        for lane in self.lanes:
            lane.advance(dataclasses.replace(moving, families=lane.net.families), ticks)
        for ghost, lane in zip(self.ghosts, self.lanes, strict=False):
            ghost.advance(dataclasses.replace(moving, families=lane.net.families), self.t, duration)
        self.t += duration
        after = self.counts()
        return after[0] - before[0], after[1] - before[1]

    def counts(self) -> tuple[int, int]:
        """Force evaluations and steps of all lanes."""
        return sum(lane.state.force_evals for lane in self.lanes), sum(lane.state.steps for lane in self.lanes)

    def pin(self, position: tuple[float, float, float]) -> None:
        """All roots to rest at a place [m]."""
        for lane in self.lanes:
            if not lane.out:
                lane.pin(position)
        for ghost in self.ghosts:
            ghost.pin(position)

    def look(self) -> None:
        for lane in self.lanes:
            lane.look()

    def error(self, lane: Lane) -> float:
        """Largest distance [m] of a point from the reference; NaN where rope or reference is out."""
        return math.nan if lane.out else self.ghost_of(lane).distance(lane.state.x)

    def certain(self, lane: Lane) -> float:
        """What an error must exceed [m] to be the method's own; NaN where there is no reference."""
        ghost = self.ghost_of(lane)
        return TRUST_FACTOR * ghost.separation if ghost.is_available and ghost.horizon is None else math.nan

    def standings(self) -> RaceReadings:
        found = tuple(
            Standing(
                lane.number, lane.record.name, lane.step, lane.stiffness, lane.gauge, lane.evals,
                lane.corrections, lane.cost, self.error(lane), self.certain(lane), lane.taken(), lane.out,
            )
            for lane in self.lanes
        )  # fmt: skip
        lost = [ghost.horizon for ghost in self.ghosts if ghost.horizon is not None]
        return RaceReadings(found, min(lost, default=None), next((g.failure for g in self.ghosts if g.failure), ""))

    def points(self) -> NDArray[np.float64]:
        """(ropes, points, 3) [m], all from the one root."""
        return np.stack([lane.state.x[:, 0].T for lane in self.lanes])

    def ghost_points(self) -> NDArray[np.float64] | None:
        """The same of the references, or None where one is missing."""
        ghosts = [self.ghost_of(lane) for lane in self.lanes]
        if any(not ghost.is_available or ghost.horizon is not None for ghost in ghosts):
            return None
        return np.stack([ghost.x.T for ghost in ghosts])
