"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def damping_length(viscosity, time):
    """The length l [m] of the lab's damping that is equivalent to a viscosity over a time.

    The damping multiplies the power of each wave by exp(-k^2 l^2). Viscosity lowers the amplitude by exp(-2 nu k^2 t),
    and power is the square of the amplitude: l = 2 sqrt(nu t).

    viscosity: nu [m2/s], kinematic. time: t [s].
    """
    return 2 * np.sqrt(viscosity * time)


def inputs(rng):
    return 10.0 ** rng.uniform(-6.0, -2.0), rng.uniform(2.0, 600.0)


EXAMPLES = ((1e-3, 600.0), (1e-6, 1.0), (1e-6, 86400.0))


MISTAKES = (
    Mistake(
        "amplitude instead of power",
        "This equals the loss of the amplitude. The damping acts on the power, which falls with 4 nu k^2.",
        lambda n, t: np.sqrt(2 * n * t),
    ),
    Mistake("root forgotten", "This is l^2: take the root.", lambda n, t: 4 * n * t),
    Mistake("factor 2 forgotten", "The factor 2 is missing.", lambda n, t: np.sqrt(n * t)),
    Mistake("root of the viscosity only", "The time belongs under the root as well.", lambda n, t: 2 * np.sqrt(n) * t),
    Mistake("root of the time only", "The viscosity belongs under the root as well.", lambda n, t: 2 * n * np.sqrt(t)),
    Mistake("divided by the time", "The damping grows with the time.", lambda n, t: 2 * np.sqrt(n / t)),
    Mistake("time not used", "The longer viscosity acts, the more it damps.", lambda n, t: 2 * np.sqrt(n)),
)

CURVE = Curve(
    "time [s]",
    "damping length for 1e-3 m2/s [m]",
    np.linspace(0.0, 600.0, 40),
    lambda f, x: [f(1e-3, t) for t in x],
)


def behaviour(student):
    """The two laws of damping agree."""
    n, t, k = 1e-3, 60.0, 3.0
    power = np.exp(-((k * student(n, t)) ** 2))
    require(abs(power - np.exp(-2 * n * k**2 * t) ** 2) < 1e-3, "exp(-k^2 l^2) must be the square of exp(-2 nu k^2 t)")
