"""Motions for the checks of integration methods: a random law of acceleration, and an oscillator."""

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

# The process of a student's functions imports this: annotations in quotes do not load numpy.random, a seventh of it.


def random_acceleration(rng: "np.random.Generator", *, with_velocity: bool) -> Callable[[Any, Any], np.ndarray]:
    """A law acceleration(x, v) [m/s2] for positions and velocities of shape (n, 3), neither linear nor symmetric.

    with_velocity: it depends on the velocity.
    """
    stiffness, cubic, drag = rng.uniform(2.0, 6.0), rng.uniform(0.5, 1.5), rng.uniform(0.5, 2.0)

    def acceleration(x: Any, v: Any) -> np.ndarray:
        x, v = np.asarray(x, np.float64), np.asarray(v, np.float64)
        if x.shape != v.shape or x.ndim != 2 or x.shape[1] != 3:
            raise ValueError(f"positions and velocities must both have shape (n, 3), not {x.shape} and {v.shape}")
        return -stiffness * x - cubic * x**3 + np.roll(x, 1, axis=0) - (drag * v if with_velocity else 0.0)

    return acceleration


def step_inputs(rng: "np.random.Generator", *, with_velocity: bool = True) -> tuple[Any, ...]:
    """Arguments of a step: positions [m] and velocities [m/s] of shape (n, 3), a time step [s], an acceleration."""
    x, v = rng.normal(size=(2, int(rng.integers(2, 5)), 3))
    return x, v, rng.uniform(0.1, 0.4), random_acceleration(rng, with_velocity=with_velocity)


def oscillate(step: Callable[..., Any], z: float, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity after each step of an oscillator of 1 rad/s that starts at x = 1, at rest.

    step: also a student's, whose process makes the steps. z: time step times angular frequency. Returns two arrays of
    shape (steps,).
    """
    x, v = np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3))
    following = getattr(step, "steps_of_oscillator", None) or functools.partial(steps_of_oscillator, step)
    positions, velocities = np.array([(x[0, 0], v[0, 0]) for x, v in following(x, v, z, steps)]).T
    return positions, velocities


def steps_of_oscillator(step: Callable[..., Any], x: Any, v: Any, z: float, steps: int) -> Iterator[Any]:
    """The results of the steps of an oscillator, each from that before.

    Ends at a result that is no pair of arrays of shape (1, 3).
    """
    for _ in range(steps):
        state = step(x, v, z, oscillator)
        yield state
        if not (isinstance(state, tuple | list) and [np.shape(part) for part in state] == [(1, 3), (1, 3)]):
            return
        x, v = state


def amplitudes(step: Callable[..., Any], z: Any) -> np.ndarray:
    """The amplitude of the oscillator after 1, 2, ... steps of 0.5 rad, one for each entry of z."""
    return amplitude(*oscillate(step, 0.5, len(z)))


def oscillator(x: Any, v: Any) -> np.ndarray:
    """The acceleration [m/s2] of an oscillator of 1 rad/s without damping."""
    return -np.asarray(x, np.float64)


def amplitude(x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The amplitude that an oscillator of 1 rad/s has by its energy."""
    return np.sqrt(x**2 + v**2)
