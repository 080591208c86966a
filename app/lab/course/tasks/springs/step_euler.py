"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Method, Mistake, require
from app.lab.diagnosis.oscillator import amplitude, amplitudes, oscillate, step_inputs


def step_euler(x, v, h, acceleration):
    """One step of explicit Euler: the new positions [m] and velocities [m/s], both of shape (n, 3).

    x_new = x + h v, v_new = v + h a(x, v): both from the state at the start of the step.

    x, v: positions [m] and velocities [m/s], shape (n, 3). h: time step [s]. acceleration: a function;
    acceleration(x, v) gives the accelerations [m/s2], shape (n, 3).
    """
    x, v = np.asarray(x), np.asarray(v)
    return x + h * v, v + h * acceleration(x, v)


inputs = step_inputs
METHOD = Method((step_euler,))


def velocity_first(x, v, h, acceleration):
    v = v + h * acceleration(x, v)
    return x + h * v, v


def position_first(x, v, h, acceleration):
    x = x + h * v
    return x, v + h * acceleration(x, v)


def swapped(x, v, h, acceleration):
    return v + h * acceleration(x, v), x + h * v


MISTAKES = (
    Mistake(
        "velocity before position",
        "The position is moved with the new velocity. That is the symplectic Euler method, which is stable for longer; "
        "explicit Euler uses the velocity at the start of the step.",
        velocity_first,
    ),
    Mistake(
        "position before velocity",
        "The acceleration is taken at the new position. Explicit Euler takes it at the start of the step: compute it "
        "before x changes.",
        position_first,
    ),
    Mistake("results swapped", "It returns (v, x). Return the positions first.", swapped),
)

CURVE = Curve("steps of h omega = 0.5", "amplitude of an oscillator", np.arange(1.0, 31.0), amplitudes)


def behaviour(student):
    """The amplitude of an oscillator grows by sqrt(1 + z^2) in each step, with z = h omega."""
    z, steps = 0.3, 20
    size = amplitude(*oscillate(student, z, steps))
    expected = (1.0 + z * z) ** (0.5 * np.arange(1, steps + 1))
    require(
        np.allclose(size, expected, rtol=1e-3),
        "the amplitude of an oscillator does not change from step to step as with explicit Euler",
    )
