"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Counted, Curve, Method, Mistake, require
from app.lab.diagnosis.oscillator import amplitudes, oscillate, oscillator, step_inputs


def step_rk4(x, v, h, acceleration):
    """One step of the Runge-Kutta method of fourth order: new positions [m] and velocities [m/s], shape (n, 3).

    With the state y = (x, v) and its derivative f(y) = (v, a(x, v)):
    f1 = f(y), f2 = f(y + h/2 f1), f3 = f(y + h/2 f2), f4 = f(y + h f3), y_new = y + h/6 (f1 + 2 f2 + 2 f3 + f4).

    x, v: positions [m] and velocities [m/s], shape (n, 3). h: time step [s]. acceleration: a function;
    acceleration(x, v) gives the accelerations [m/s2], shape (n, 3).
    """
    x, v = np.asarray(x), np.asarray(v)
    v1, a1 = v, acceleration(x, v)
    v2, a2 = v + h / 2 * a1, acceleration(x + h / 2 * v1, v + h / 2 * a1)
    v3, a3 = v + h / 2 * a2, acceleration(x + h / 2 * v2, v + h / 2 * a2)
    v4, a4 = v + h * a3, acceleration(x + h * v3, v + h * a3)
    return x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


inputs = step_inputs
METHOD = Method((step_rk4,))


def first_force(x, v, h, acceleration):
    a = acceleration(x, v)
    return x + h * v + h**2 / 2 * a, v + h * a


def euler(x, v, h, acceleration):
    return x + h * v, v + h * acceleration(x, v)


def midpoint(x, v, h, acceleration):
    middle = v + h / 2 * acceleration(x, v)
    return x + h * middle, v + h * acceleration(x + h / 2 * v, middle)


MISTAKES = (
    Mistake(
        "keeps the first force",
        "The acceleration is computed once. Compute it again at each of the four states.",
        first_force,
    ),
    Mistake("Euler", "This is explicit Euler: only f1 counts.", euler),
    Mistake("midpoint method", "This is the midpoint method, of second order: only f2 counts.", midpoint),
)

CURVE = Curve("steps of h omega = 0.5", "amplitude of an oscillator", np.arange(1.0, 31.0), amplitudes)


def behaviour(student):
    """An evaluation for each of f1 to f4, and the fourth order."""
    counted = Counted(oscillator)
    student(np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3)), 0.1, counted)
    number = len(counted.calls)
    require(number >= 4, f"the acceleration is computed {number} times in a step: once for each of f1 to f4 is needed")
    errors = []
    for steps in (20, 40):
        x, _ = oscillate(student, 4.0 / steps, steps)
        errors.append(abs(x[-1] - np.cos(4.0)))
    ratio = errors[0] / max(errors[1], 1e-15)
    require(
        ratio > 12.0,
        f"half the step made the error only {ratio:.1f} times smaller: that is not the fourth order",
    )
