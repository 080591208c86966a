"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def mixture_viscosity(oil_viscosity, water_viscosity, oil_fraction):
    """The viscosity [Pa s] of oil and water that are mixed as if they dissolved in each other, by Arrhenius (1887).

    ln mu = phi ln mu_oil + (1 - phi) ln mu_water.

    oil_viscosity, water_viscosity: mu [Pa s]. oil_fraction: phi, the fraction of the oil in the volume, 0 to 1.
    """
    return np.exp(oil_fraction * np.log(oil_viscosity) + (1 - oil_fraction) * np.log(water_viscosity))


def inputs(rng):
    return np.exp(rng.uniform(-4.0, 0.0)), np.exp(rng.uniform(-7.0, -5.0)), rng.uniform(0.1, 0.9)


EXAMPLES = ((0.1, 0.001, 0.0), (0.1, 0.001, 1.0), (5.0, 0.0018, 0.5), (0.001, 0.001, 0.3))


MISTAKES = (
    Mistake(
        "products for powers",
        "The fractions are factors here. They are the exponents: mu = mu_oil^phi mu_water^(1 - phi).",
        lambda oil, water, phi: phi * oil * (1 - phi) * water,
    ),
    Mistake(
        "arithmetic mean",
        "This is the mean of the viscosities. Arrhenius takes the mean of their logarithms.",
        lambda o, w, f: f * o + (1 - f) * w,
    ),
    Mistake(
        "fractions swapped",
        "The fraction of the oil is given to the water.",
        lambda o, w, f: mixture_viscosity(w, o, f),
    ),
    Mistake(
        "logarithm not undone",
        "This is the logarithm of the viscosity: take exp of it.",
        lambda o, w, f: f * np.log(o) + (1 - f) * np.log(w),
    ),
    Mistake(
        "two kinds of logarithm",
        "log10 and exp do not undo each other.",
        lambda o, w, f: np.exp(f * np.log10(o) + (1 - f) * np.log10(w)),
    ),
    Mistake(
        "two kinds of logarithm",
        "np.log is the natural logarithm: undo it by exp, not by 10**.",
        lambda o, w, f: 10 ** (f * np.log(o) + (1 - f) * np.log(w)),
    ),
    Mistake("fraction not used", "This is the mean for equal parts.", lambda o, w, f: np.sqrt(o * w)),
    Mistake("harmonic mean", "This is the mean of the inverse values.", lambda o, w, f: 1 / (f / o + (1 - f) / w)),
    Mistake("weights do not sum to one", "The water counts in full. Its weight is 1 - phi.", lambda o, w, f: o**f * w),
)

CURVE = Curve(
    "fraction of oil", "viscosity [Pa s]", np.linspace(0.0, 1.0, 21), lambda f, x: [f(0.1, 0.001, p) for p in x]
)


def behaviour(student):
    """Pure oil, pure water, and a value in between."""
    require(abs(student(0.05, 0.001, 1.0) - 0.05) < 1e-5, "pure oil must have the viscosity of oil")
    require(abs(student(0.05, 0.001, 0.0) - 0.001) < 1e-6, "pure water must have the viscosity of water")
    require(abs(student(0.05, 0.001, 0.3) - 3.2336e-3) < 1e-6, "30 % of oil of 50 mPa s in water must make 3.234 mPa s")
