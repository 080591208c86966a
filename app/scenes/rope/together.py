"""Ropes of many parameters at once, for sweeps: those that the lanes of `sim.springs.many` take."""

import dataclasses
import itertools
from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from app.scenes.rope.parameters import Params
from app.scenes.springs.rope_parameters import build_rope
from app.scenes.stepping import steps_to
from sim.springs.many import METHODS, ManyStates, advance_many

if TYPE_CHECKING:
    from app.scenes.rope.scene import RopeScene

MOST_POINTS = 40  # beyond, a rope alone fills the registers: from about 100 on it is faster so


class Clock(NamedTuple):
    """Time and step [s] of a run, for `steps_to`."""

    time: float
    step: float


def key(params: Params) -> Hashable:
    """Ropes with equal keys can move together; None for one that has to move alone.

    A floor is allowed: a rope that comes down to it is found out afterwards.
    """
    plain = params.damping_model == "isotropic" and params.root_swing == 0.0 and not params.sphere
    fits = plain and params.integrator in METHODS and params.points <= MOST_POINTS
    return (params.integrator, params.points) if fits else None


def run(
    make: Callable[[Params], "RopeScene"], cases: Sequence[Params], times: Sequence[float]
) -> "list[Iterator[RopeScene] | None]":
    """Run ropes of equal keys together; for each its scene at the first whole step at or after each of `times` [s].

    make: the scene of some parameters. None where a rope is to be run alone: it touched the floor, or left its bounds.
    """
    samples = [sample_steps(params.time_step, times) for params in cases]
    nets = [build_rope(dataclasses.replace(params, floor=False)) for params in cases]
    found = advance_many(nets, cases[0].integrator, [params.time_step for params in cases], samples)
    return [scenes_of(make(params), found, rope) for rope, params in enumerate(cases)]


def sample_steps(step: float, times: Sequence[float]) -> list[int]:
    """Numbers of steps of `step` [s] that lead to each of `times` [s], from each to the next as a scene takes them."""
    more = itertools.accumulate(
        times, lambda taken, until: taken + steps_to(Clock(taken * step, step), until), initial=0
    )
    return list(more)[1:]


def scenes_of(scene: "RopeScene", found: ManyStates, rope: int) -> "Iterator[RopeScene] | None":
    """The scene at one sample after the other; None where it has to run alone."""
    net, low, high = scene.net, found.low[rope, -1], found.high[rope, -1]
    root = net.x0[:, 0, 0]
    reach = np.maximum(high - root, root - low).max()
    touches = net.floor is not None and low[2] < net.floor + net.radius
    if scene.note or touches or found.diverged[rope].any() or not reach < scene.max_reach:
        return None

    def at_samples() -> "Iterator[RopeScene]":
        for sample in range(found.steps.shape[1]):
            scene.state = found.state(rope, sample)
            yield scene

    return at_samples()
