"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require


def dispersion(k, calm, repeat_time, gravity):
    """The angular frequency [rad/s] that the lab gives a wave on deep water.

    omega = calm floor(sqrt(g k)/w0) w0, with w0 = 2 pi/T: whole multiples of w0 make the sea repeat after the time T.
    calm is 1 for true waves, and less in the storm that is over.

    k: wavenumber [rad/m]. calm: a factor. repeat_time: T [s]. gravity: g [m/s2].
    """
    base = 2 * np.pi / repeat_time
    return calm * np.floor(np.sqrt(gravity * k) / base) * base


def inputs(rng):
    return rng.uniform(0.05, 2.0), rng.uniform(0.2, 0.9), rng.uniform(10.0, 40.0), rng.uniform(2.0, 20.0)


# Waves of the lab's seas, on the Earth and its two planets, which repeat after 20 and 200 s.
EXAMPLES = tuple(
    (k, calm, time, g)
    for k, calm in ((0.05, 1.0), (0.731, 0.7), (3.0, 1.0), (40.0, 1.0)) for time in (20.0, 200.0)
    for g in (9.81, 2.1135, 45.53)
)  # fmt: skip


MISTAKES = (
    Mistake(
        "not rounded",
        "The frequency is not rounded down, so that the sea does not repeat.",
        lambda k, c, T, g: c * np.sqrt(g * k),
    ),
    Mistake(
        "rounded to the nearest",
        "Round down: floor, not round.",
        lambda k, c, T, g: c * np.round(np.sqrt(g * k) * T / (2 * np.pi)) * 2 * np.pi / T,
    ),
    Mistake(
        "rounded up",
        "Round down: floor, not ceil.",
        lambda k, c, T, g: c * np.ceil(np.sqrt(g * k) * T / (2 * np.pi)) * 2 * np.pi / T,
    ),
    Mistake(
        "2 pi forgotten",
        "w0 is 1/T here. An angular frequency is 2 pi/T.",
        lambda k, c, T, g: c * np.floor(np.sqrt(g * k) * T) / T,
    ),
    Mistake("root forgotten", "omega^2 = g k: take the root.", lambda k, c, T, g: dispersion(k**2 * g, c, T, g)),
    Mistake("gravity forgotten", "omega^2 = g k: gravity is missing.", lambda k, c, T, g: dispersion(k, c, T, 1.0)),
    Mistake(
        "scaled before rounding",
        "The factor comes before the rounding. Round first, then scale.",
        lambda k, c, T, g: np.floor(c * np.sqrt(g * k) * T / (2 * np.pi)) * 2 * np.pi / T,
    ),
    Mistake("calm not used", "The factor calm is missing.", lambda k, c, T, g: dispersion(k, 1.0, T, g)),
    Mistake(
        "factor inside the root",
        "calm stands before the root, not in it.",
        lambda k, c, T, g: dispersion(c * k, 1.0, T, g),
    ),
    Mistake(
        "wavelength for wavenumber",
        "2 pi/k, the wavelength, stands where the wavenumber k belongs: omega^2 = g k.",
        lambda k, c, T, g: dispersion(2 * np.pi / k, c, T, g),
    ),
    Mistake(
        "number of turns",
        "This counts the multiples of w0: multiply by w0 again.",
        lambda k, c, T, g: c * np.floor(np.sqrt(g * k) * T / (2 * np.pi)),
    ),
)

CURVE = Curve(
    "wavenumber [rad/m]",
    "frequency [rad/s]",
    np.linspace(0.02, 2.0, 40),
    lambda f, x: [f(k, 1.0, 20.0, 9.81) for k in x],
)


def behaviour(student):
    """Never faster than the true wave, by less than w0; whole turns in the time T."""
    for k in (0.1, 0.37, 1.9):
        omega = student(k, 1.0, 20.0, 9.81)
        true = np.sqrt(9.81 * k)
        require(
            true - 2 * np.pi / 20.0 - 1e-3 < omega < true + 1e-3, "omega must lie below sqrt(g k), by less than 2 pi/T"
        )
        turns = omega * 20.0 / (2 * np.pi)
        require(abs(turns - round(turns)) < 1e-3, "with calm = 1 a wave must make whole turns in the time T")
