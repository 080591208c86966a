"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Counted, Curve, Mistake, require
from app.lab.oscillator import amplitudes, oscillate, oscillator, step_inputs


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


def variant(
    weights=(1, 2, 2, 1), divisor=6.0, steps=(0.5, 0.5, 1.0), same_force=False, same_velocity=False, chain=True
):
    """A function that makes a mistake: the method with other weights, stages or forces."""

    def function(x, v, h, acceleration):
        first = acceleration(x, v)
        derivatives = [(v, first)]
        for share in steps:
            dv, da = derivatives[-1 if chain else 0]
            y, w = x + share * h * dv, v + share * h * da
            derivatives.append((v if same_velocity else w, first if same_force else acceleration(y, w)))
        total = [sum(weight * d[part] for weight, d in zip(weights, derivatives, strict=True)) for part in (0, 1)]
        return x + h / divisor * total[0], v + h / divisor * total[1]

    return function


MISTAKES = (
    Mistake(
        "keeps the first force",
        "The acceleration is computed once. Compute it anew at each of the four states.",
        variant(same_force=True),
    ),
    Mistake("weights do not sum to one", "The sum is not divided by 6.", variant(divisor=1.0)),
    Mistake(
        "weights do not sum to one",
        "The weights are 1, 1, 1, 1 over 6, which sum to 4/6. The two middle ones count twice.",
        variant(weights=(1, 1, 1, 1)),
    ),
    Mistake("weights equal", "All four weights are 1/4. They must be 1, 2, 2, 1 over 6.", variant((1, 1, 1, 1), 4.0)),
    Mistake("weights do not sum to one", "The sum is divided by 4 instead of 6.", variant(divisor=4.0)),
    Mistake("weights do not sum to one", "The sum is divided by 3 instead of 6.", variant(divisor=3.0)),
    Mistake("weights swapped", "The weights are 2, 1, 1, 2. The middle ones count twice.", variant((2, 1, 1, 2))),
    Mistake(
        "full steps to the middle", "f2 and f3 are taken a whole step ahead. Use h/2.", variant(steps=(1.0, 1.0, 1.0))
    ),
    Mistake("half step to the end", "f4 is taken half a step ahead. Use h.", variant(steps=(0.5, 0.5, 0.5))),
    Mistake(
        "velocity not advanced in the stages",
        "The positions move with the first velocity only. Each stage has a velocity of its own: v2 = v + h/2 a1.",
        variant(same_velocity=True),
    ),
    Mistake(
        "every stage from the first derivative",
        "f3 and f4 start from f1. Each stage uses the derivative of the stage before it.",
        variant(chain=False),
    ),
    Mistake("Euler", "This is explicit Euler: only f1 counts.", variant((1, 0, 0, 0), 1.0)),
    Mistake(
        "midpoint method", "This is the midpoint method, of second order: only f2 counts.", variant((0, 1, 0, 0), 1.0)
    ),
)

CURVE = Curve("steps of h omega = 0.5", "amplitude of an oscillator", np.arange(1.0, 31.0), amplitudes)


def behaviour(student):
    """Four evaluations a step, and fourth order: half the step, a sixteenth of the error."""
    counted = Counted(oscillator)
    student(np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3)), 0.1, counted)
    require(len(counted.calls) >= 4, f"the acceleration is computed {len(counted.calls)} times in a step, not 4 times")
    errors = []
    for steps in (20, 40):
        x, _ = oscillate(student, 4.0 / steps, steps)
        errors.append(abs(x[-1] - np.cos(4.0)))
    ratio = errors[0] / max(errors[1], 1e-15)
    require(
        ratio > 12.0,
        f"half the step must make the error 16 times smaller; it became {ratio:.1f} times smaller",
    )
