"""The ropes of a race, which differ in method, step or stiffness only, on one clock, against a reference run.

All ropes and the reference meet at the end of each tick, a multiple of the longest step; steps that do not divide the
tick are shortened equally. A rope that diverges stops at its last good state and says why. A rope with a method that
accepts no damping never starts on a damped net. The others continue.
"""

import copy
import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.race.parameters import RaceParams, method_of
from app.scenes.springs.divergence import short_divergence_text
from app.scenes.springs.net_motion import NetMotion, rope_lengths
from sim.frames import steps_for
from sim.springs import INTEGRATORS, Integrator, Net
from sim.springs.analysis.extremes import extremes
from sim.springs.analysis.reference_run import TRUST_FACTOR, ReferenceRun
from sim.springs.stability import Gauge
from sim.springs.state import State, advance

MAX_EQUAL_COST_STEP = 0.1  # [s] longest step that the rule "same cost" gives
MIN_COST_TRIAL_STEPS, MAX_COST_TRIAL_STEPS = 4, 24  # steps in which the evaluations of an implicit method are counted
COST_TRIAL_POINT_STEPS = 2400  # points times steps of that trial
TIMING_POINT_EVALS = 10_000  # evaluations times points of one timing of a step, at most
TIMING_REPEATS = 3  # timings; the shortest counts
MIN_TIMING_STEPS, MAX_TIMING_STEPS = 3, 200
MAX_TICK = 1 / 30  # [s] search limit for a common multiple of the steps, where the longest step is shorter
MAX_SHORTENING = 0.02  # of itself that a step may lose where it does not divide the tick
MAX_STIFFNESS = 1e9  # [N/m], the same as of the parameter


class Result(NamedTuple):
    """The result of one rope so far."""

    number: int
    integrator: str
    step: float  # [s]
    stiffness: float  # [N/m]
    gauge: Gauge
    evals: float  # recent force evaluations a step
    corrections: float  # recent corrections a step; 0 for explicit methods
    step_time: float  # [s] of processor time that a step takes
    error: float  # [m] largest distance of a point from the reference run; NaN without one
    error_floor: float  # [m] smallest error that the reference run can tell; NaN without one
    numerical_dissipation: float  # [J] that the method took, negative where it fed the motion
    failure: str  # reason why it has stopped, or ""


class RaceReadings(NamedTuple):
    """The results, and the state of the reference run."""

    results: tuple[Result, ...]
    reference_horizon: float | None  # [s] when chaos made the reference run meaningless
    no_reference: str  # reason, or ""


def evals_of(net: Net, record: Integrator, h: float) -> float:
    """Force evaluations of a step of h [s]: as declared; for implicit methods counted in a trial from the start."""
    if not record.implicit:
        return float(record.evals)
    state = State.at_rest(net)
    steps = max(MIN_COST_TRIAL_STEPS, min(MAX_COST_TRIAL_STEPS, COST_TRIAL_POINT_STEPS // net.shape[1]))
    advance(net, state, record, h, steps)
    return max(float(record.evals), state.force_evals / state.steps)


def step_of(params: RaceParams, number: int, net: Net) -> float:
    """The step [s] that the rule of the race gives to rope `number`."""
    if number == 1 or params.race_steps == "same step":
        return params.time_step
    if params.race_steps == "own steps":
        return getattr(params, f"step_{number}")
    record = INTEGRATORS[method_of(params, number)]
    time_per_eval = params.time_step / evals_of(net, INTEGRATORS[params.integrator], params.time_step)  # [s]
    h = params.time_step
    # The evaluations of an implicit method depend on the step in turn.
    for _ in range(2 if record.implicit else 1):
        h = min(MAX_EQUAL_COST_STEP, time_per_eval * evals_of(net, record, h))
    return h


def stiffened(net: Net, ratio: float) -> Net:
    """The net with links `ratio` times as stiff, at most MAX_STIFFNESS."""
    return net.with_stiffness(min(MAX_STIFFNESS, ratio * net.families[0].stiffness))


def tick_of(steps: list[float]) -> float:
    """The time [s] between meetings of all ropes: the least multiple of the longest step that shortens no step much."""
    longest = max(steps)
    multiples = range(1, max(1, int(MAX_TICK / longest * (1 + 1e-9))) + 1)

    def loss(multiple: int) -> float:
        tick = multiple * longest
        return max(1.0 - tick / (steps_for(tick, step) * step) for step in steps)

    return longest * next((m for m in multiples if loss(m) <= MAX_SHORTENING), min(multiples, key=loss))


def race_bound(net: Net, state: State) -> float:
    """Largest reach [m] of a rope that races: closer than alone, as the picture also shows where it has stopped."""
    # A swinging rope pulls a point with about three times its weight.
    length, stretch = rope_lengths(net)
    return 0.5 + 1.2 * max(length + 4.0 * stretch, extremes(state.x, state.v).reach)


class Entrant(NetMotion):
    """The motion of one rope of the race."""

    def __init__(
        self,
        number: int,
        net: Net,
        method: Integrator,
        step: float,
        tick: float,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """step: [s] as the rule gives it; the one taken divides `tick` [s]. clock: [s], to time a step."""
        self.number, self.clock = number, clock
        self.substeps = steps_for(tick, step)  # a tick
        super().__init__(net, method, tick / self.substeps, race_bound)
        self.failure = ""
        self.step_time = 0.0  # [s]
        self.stability = self.gauge()
        self.check_damping()
        self.assess_stability()

    def change_net(self, net: Net, *, still_pins: bool = False) -> None:
        """Continue with another net; a rope whose method allows no damping stops if the net has some."""
        super().change_net(net, still_pins=still_pins)
        self.check_damping()
        self.assess_stability()

    def check_damping(self) -> None:
        """Stop the rope if the net is damped and its method allows no damping."""
        if not self.failure and self.method.undamped_only and self.net.is_damped:
            self.failure = "allows no damping: set damping and air drag to 0, and switch the floor off"

    def after(self, net: Net, ticks: int) -> tuple[State, str]:
        """The state after `ticks` ticks, the last good one where it diverges, and why it has stopped, or "".

        net: with the motions of root and pull. The entrant itself stays as it is.
        """
        if self.failure:
            return self.state, self.failure
        state = self.state.copy()
        self.take_steps(net, state, ticks * self.substeps)
        if self.holds(extremes(state.x, state.v)):
            return state, ""
        return self.state, short_divergence_text(state.t, self.stability)

    def assess_stability(self) -> None:
        """Compare the step with its limit in the present state, and measure its cost."""
        if self.failure:
            return
        self.stability = self.gauge()
        self.step_time = self.timed_step()
        self.count_evals()

    def timed_step(self) -> float:
        """Time [s] of a step from here: the shortest of a few runs of many steps, minus the cost of one call."""
        point_evals = self.evals * self.state.x.size / 3
        many = int(np.clip(TIMING_POINT_EVALS / point_evals, MIN_TIMING_STEPS, MAX_TIMING_STEPS))
        shortest = [math.inf, math.inf]
        for _ in range(TIMING_REPEATS if many > MIN_TIMING_STEPS else 1):
            for i, steps in enumerate((1, many)):
                trial = self.state.copy()
                start = self.clock()
                self.take_steps(self.net, trial, steps, with_account=False)
                shortest[i] = min(shortest[i], self.clock() - start)
        now = max(0.0, shortest[1] - shortest[0]) / (many - 1)
        # Down at once, up slowly: what disturbs a timing makes it longer.
        return now if not 0.0 < self.step_time < now else 0.9 * self.step_time + 0.1 * now


class Race:
    """All entrants, the reference run of each, and the clock."""

    def __init__(self, net: Net, params: RaceParams, clock: Callable[[], float] = time.perf_counter) -> None:
        """net: of rope 1, at rest at time 0. clock: [s], to time steps."""
        self.ratio = params.stiffness_ratio
        numbers = range(1, params.ropes + 1)
        nets = [stiffened(net, self.ratio ** (number - 1)) for number in numbers]
        steps = [step_of(params, number, own) for number, own in zip(numbers, nets, strict=True)]
        self.tick = tick_of(steps)  # [s]
        self.t = 0.0  # [s]
        self.entrants = [
            Entrant(number, own, INTEGRATORS[method_of(params, number)], step, self.tick, clock)
            for number, own, step in zip(numbers, nets, steps, strict=True)
        ]
        # Ropes of the same stiffness share a reference run.
        count = params.ropes if self.ratio != 1.0 else 1
        self.references = [ReferenceRun(nets[i], params.length, count) for i in range(count)]

    def reference_of(self, entrant: Entrant) -> ReferenceRun:
        """The reference run of one rope."""
        return self.references[min(entrant.number, len(self.references)) - 1]

    def change_net(self, net: Net) -> None:
        """Continue with other forces. net: of rope 1."""
        for entrant in self.entrants:
            entrant.change_net(stiffened(net, self.ratio ** (entrant.number - 1)))
        for reference, entrant in zip(self.references, self.entrants, strict=False):
            reference.update(entrant.net)

    def nets_with(self, moving: Net) -> list[Net]:
        """The net of each entrant. moving: that of rope 1 with the motions of root and pull."""
        return [dataclasses.replace(moving, families=entrant.net.families) for entrant in self.entrants]

    def advance(self, nets: Sequence[Net], ticks: int) -> None:
        """Advance all by `ticks` ticks. nets: of `nets_with`.

        Until all have arrived the race stays as it is: a solve may be ended early, or others look at it meanwhile.
        """
        duration = ticks * self.tick
        arrivals = [entrant.after(net, ticks) for entrant, net in zip(self.entrants, nets, strict=True)]
        references = copy.deepcopy(self.references)
        for reference, net in zip(references, nets, strict=False):
            reference.advance(net, self.t, duration)
        for entrant, (state, failure) in zip(self.entrants, arrivals, strict=True):
            entrant.state, entrant.failure = state, failure
        self.references = references
        self.t += duration

    def move_root(self, position: Vector) -> None:
        """Put the roots of all that have not failed to rest at a position [m]."""
        for entrant in self.entrants:
            if not entrant.failure:
                entrant.place_pin(0, position)
        for reference in self.references:
            reference.pin(position)

    def assess_stability(self) -> None:
        """Compare each step with its limit, and measure its cost."""
        for entrant in self.entrants:
            entrant.assess_stability()

    def error(self, entrant: Entrant) -> float:
        """Largest distance [m] of a point from the reference run; NaN after a failure or without a reference."""
        return math.nan if entrant.failure else self.reference_of(entrant).distance(entrant.state.x)

    def error_floor(self, entrant: Entrant) -> float:
        """Smallest error [m] that the reference run can tell; NaN if there is no reference."""
        reference = self.reference_of(entrant)
        return TRUST_FACTOR * reference.separation if reference.is_available and reference.horizon is None else math.nan

    def readings(self) -> RaceReadings:
        """The results at this time."""
        results = tuple(
            Result(
                number=e.number,
                integrator=e.integrator,
                step=e.step,
                stiffness=e.stiffness,
                gauge=e.stability,
                evals=e.evals,
                corrections=e.corrections,
                step_time=e.step_time,
                error=self.error(e),
                error_floor=self.error_floor(e),
                numerical_dissipation=e.numerical_dissipation(),
                failure=e.failure,
            )
            for e in self.entrants
        )
        lost = [reference.horizon for reference in self.references if reference.horizon is not None]
        return RaceReadings(
            results, min(lost, default=None), next((r.failure for r in self.references if r.failure), "")
        )

    def points(self) -> NDArray[np.float64]:
        """(ropes, points, 3) [m], all from the same root."""
        return np.ascontiguousarray([entrant.state.x[:, 0].T for entrant in self.entrants])

    def reference_points(self) -> NDArray[np.float64] | None:
        """(ropes, points, 3) [m] of the reference runs, or None if one is missing."""
        references = [self.reference_of(entrant) for entrant in self.entrants]
        if any(not reference.is_available or reference.horizon is not None for reference in references):
            return None
        return np.ascontiguousarray([reference.x.T for reference in references])
