"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def wave_decay(amplitude, wavenumber, viscosity, time):
    """The amplitude [m] that viscosity leaves of a wave on deep water after a time.

    a = a0 exp(-2 nu k^2 t) (Lamb, Hydrodynamics, article 348). The energy falls twice as fast.

    amplitude: a0 [m]. wavenumber: k [rad/m]. viscosity: nu [m2/s], kinematic. time: t [s].
    """
    return amplitude * np.exp(-2 * viscosity * wavenumber**2 * time)


def inputs(rng):
    k = rng.uniform(0.5, 5.0)
    return rng.uniform(0.1, 2.0), k, rng.uniform(0.005, 0.02), rng.uniform(0.2, 1.0) / (0.02 * k**2)


EXAMPLES = ((1.0, 2.0, 0.005, 60.0), (0.7, 3.0, 0.01, 0.0), (0.01, 60.0, 1e-6, 30.0))


MISTAKES = (
    Mistake(
        "rate of the energy",
        "The energy falls with 4 nu k^2, the amplitude with 2 nu k^2.",
        lambda a, k, n, t: a * np.exp(-4 * n * k**2 * t),
    ),
    Mistake("factor 2 forgotten", "The rate is 2 nu k^2.", lambda a, k, n, t: a * np.exp(-n * k**2 * t)),
    Mistake(
        "wavenumber not squared",
        "The rate is 2 nu k^2: k is squared.",
        lambda a, k, n, t: a * np.exp(-2 * n * k * t),
    ),
    Mistake("wave grows", "The wave grows: the exponent is negative.", lambda a, k, n, t: a * np.exp(2 * n * k**2 * t)),
    Mistake(
        "exponential forgotten",
        "The amplitude falls along a line and becomes negative.",
        lambda a, k, n, t: a * (1 - 2 * n * k**2 * t),
    ),
    Mistake(
        "factor instead of amplitude",
        "Multiply by the amplitude at the start.",
        lambda a, k, n, t: np.exp(-2 * n * k**2 * t),
    ),
    Mistake(
        "wavelength for wavenumber",
        "k is taken for a wavelength. It is a wavenumber, 2 pi/wavelength.",
        lambda a, k, n, t: a * np.exp(-2 * n * (2 * np.pi / k) ** 2 * t),
    ),
    Mistake("rate instead of amplitude", "This is the rate of decay.", lambda a, k, n, t: 2 * n * k**2),
)

CURVE = Curve("time [s]", "amplitude [m]", np.linspace(0.0, 60.0, 25), lambda f, x: [f(1.0, 2.0, 0.005, t) for t in x])


def behaviour(student):
    """Nothing at once; twice the time squares the fraction that is left; water of 1 m wavelength."""
    require(abs(student(0.7, 3.0, 0.01, 0.0) - 0.7) < 1e-5, "at time 0 nothing must be lost")
    share = student(1.0, 3.0, 0.01, 5.0)
    require(
        abs(student(1.0, 3.0, 0.01, 10.0) - share**2) < 1e-5,
        "in twice the time the fraction that is left must be squared",
    )
