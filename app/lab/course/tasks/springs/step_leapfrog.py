"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Method, Mistake, require
from app.lab.diagnosis.oscillator import amplitude, amplitudes, oscillate, step_inputs


def step_leapfrog(x, v, h, acceleration):
    """One step of leapfrog: the new positions [m] and velocities [m/s], both of shape (n, 3).

    v_half = v + h/2 a(x), x_new = x + h v_half, v_new = v_half + h/2 a(x_new).
    (The half steps make x and v known at the same time. The form with x in the middle is right too.)

    x, v: positions [m] and velocities [m/s], shape (n, 3). h: time step [s]. acceleration: a function;
    acceleration(x, v) gives the accelerations [m/s2], shape (n, 3); for v give it the velocity that you have.
    """
    x, v = np.asarray(x), np.asarray(v)
    v_half = v + h / 2 * acceleration(x, v)
    x_new = x + h * v_half
    return x_new, v_half + h / 2 * acceleration(x_new, v_half)


def inputs(rng):
    return step_inputs(rng, with_velocity=False)


def position_in_the_middle(x, v, h, acceleration):
    middle = x + h / 2 * v
    v = v + h * acceleration(middle, v)
    return middle + h / 2 * v, v


ALTERNATIVES = (position_in_the_middle,)
METHOD = Method((step_leapfrog, position_in_the_middle), with_velocity=False)


def velocity_first(x, v, h, acceleration):
    v = v + h * acceleration(x, v)
    return x + h * v, v


def position_first(x, v, h, acceleration):
    x = x + h * v
    return x, v + h * acceleration(x, v)


def euler(x, v, h, acceleration):
    return x + h * v, v + h * acceleration(x, v)


def one_kick(x, v, h, acceleration):
    v = v + h / 2 * acceleration(x, v)
    return x + h * v, v


def old_force(x, v, h, acceleration):
    a = acceleration(x, v)
    return x + h * (v + h / 2 * a), v + h * a


MISTAKES = (
    Mistake(
        "no half step",
        "The velocity makes a whole step, then the position: that is the symplectic Euler method, of first order. "
        "Leapfrog moves v by half a step before and half a step after x.",
        velocity_first,
    ),
    Mistake(
        "position before velocity",
        "x moves first, with the velocity of the start, and then v by a whole step. Move v by half a step first.",
        position_first,
    ),
    Mistake("Euler", "This is explicit Euler: both come from the start of the step.", euler),
    Mistake("second half step forgotten", "The velocity stays half a step behind. Add h/2 a(x_new).", one_kick),
    Mistake(
        "force not computed again",
        "Both half steps of v use the acceleration at the old position. The second needs the one at x_new.",
        old_force,
    ),
)

CURVE = Curve("steps of h omega = 0.5", "amplitude of an oscillator", np.arange(1.0, 31.0), amplitudes)


def behaviour(student):
    """Time runs back, energy stays, and a step of h omega = 2 is the limit."""
    x, v = oscillate(student, 0.5, 100)
    size = amplitude(x, v)
    require(size.max() < 1.1, "the amplitude of an oscillator grows; with leapfrog it does not")
    require(size[-50:].max() > 0.9, "the amplitude of an oscillator shrinks; with leapfrog it does not")
    require(
        np.abs(oscillate(student, 1.9, 60)[0]).max() < 4.0,
        "an oscillator leaves its bounds at a step at which leapfrog is stable",
    )
    errors = [abs(oscillate(student, 4.0 / steps, steps)[0][-1] - np.cos(4.0)) for steps in (40, 80)]
    ratio = errors[0] / max(errors[1], 1e-15)
    require(
        ratio > 3.0,
        f"half the step made the error only {ratio:.1f} times smaller: that is not the second order",
    )
