"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Curve, Mistake, require
from app.lab.diagnosis.differences import Case


def spectrum(k, wind, amplitude, gravity):
    """The power [m4] of the waves with wave vector k in a wind, by Phillips as Tessendorf writes it.

    P = A exp(-1/(|k| L)^2)/|k|^4 (k_hat . w_hat)^2, with L = |w|^2/g, the longest wave of the wind, and the unit
    vectors k_hat of k and w_hat of the wind. P(0) = 0.

    k: wave vector [rad/m], shape (2,). wind: velocity w [m/s], shape (2,). amplitude: A. gravity: g [m/s2].
    """
    size, speed = np.linalg.norm(k), np.linalg.norm(wind)
    if size == 0:
        return 0.0
    longest = speed**2 / gravity
    cosine = np.dot(k, wind) / (size * speed)
    return amplitude * np.exp(-1 / (size * longest) ** 2) / size**4 * cosine**2


def inputs(rng):
    """Wave vectors near the peak, among them now and then 0."""
    wind = rng.normal(size=2)
    wind *= rng.uniform(3.0, 8.0) / np.linalg.norm(wind)
    gravity = rng.uniform(5.0, 12.0)
    k = rng.normal(size=2)
    k *= rng.uniform(0.7, 2.0) * gravity / (wind @ wind) / np.linalg.norm(k)
    return k * (rng.random() > 0.15), wind, rng.uniform(0.5, 2.0), gravity


# Wave vectors of a grid: along and across the wind, on both axes, short and long ones; calm and stormy winds.
EXAMPLES = tuple(
    (np.array(k), np.array(wind), 0.01, g)
    for k in ((0.5, 0.0), (0.0, 0.5), (-0.25, 0.0), (0.0, -0.3), (0.3, 0.3), (4.0, 1.0))
    for wind, g in (((7.0, 0.0), 9.81), ((5.0, 5.0), 9.81), ((0.0, 12.0), 2.1135), ((8.0, -3.0), 45.53))
)  # fmt: skip


def variant(length=lambda U, g: U**2 / g, power=4, sign=-1.0, directed=2, normed=True, cut=True):
    """A function that makes a mistake: another part of the formula."""

    def function(k, wind, A, g):
        size, speed = np.linalg.norm(k), np.linalg.norm(wind)
        if size == 0:
            return 0.0
        cosine = np.dot(k, wind) / (size * speed if normed else 1.0)
        value = A / size**power * cosine**directed
        return value * np.exp(sign / (size * length(speed, g)) ** 2) if cut else value

    return function


MISTAKES = (
    Mistake("speed not squared", "L is |w|/g here. It is |w|^2/g.", variant(lambda U, g: U / g)),
    Mistake("gravity forgotten", "L is |w|^2 here. Divide by g.", variant(lambda U, g: U**2)),
    Mistake("k squared instead of its fourth power", "The power is divided by |k|^2. It is |k|^4.", variant(power=2)),
    Mistake("sign reversed in the exponent", "The exponent is -1/(k L)^2: long waves die out.", variant(sign=1.0)),
    Mistake(
        "cosine not squared", "The cosine is not squared: half of all waves get negative power.", variant(directed=1)
    ),
    Mistake("direction forgotten", "Waves across the wind are as high as those along it.", variant(directed=0)),
    Mistake("vectors not of unit length", "k . w must be divided by |k| |w|.", variant(normed=False)),
    Mistake(
        "no longest wave", "The factor exp(-1/(k L)^2) is missing: the longest waves have no bound.", variant(cut=False)
    ),
    Mistake(
        "wavelength for wavenumber",
        "2 pi/|k|, the wavelength, stands where the wavenumber |k| belongs, also below k . w.",
        lambda k, w, A, g: spectrum(k * 2 * np.pi / (k @ k), w, A, g) * ((k @ k) / 2 / np.pi) ** 2 if k.any() else 0.0,
    ),
    Mistake(
        "wavelength for wavenumber",
        "2 pi/|k|, the wavelength, stands where the wavenumber |k| belongs.",
        lambda k, w, A, g: spectrum(k * 2 * np.pi / (k @ k), w, A, g) if k.any() else 0.0,
    ),
    Mistake(
        "k L not squared",
        "The exponent is -1/(k L). It is -1/(k L)^2.",
        lambda k, w, A, g: (
            0.0 if not k.any() else variant(cut=False)(k, w, A, g) * np.exp(-g / (np.linalg.norm(k) * (w @ w)))
        ),
    ),
)

CASES = (Case("at k = 0", lambda k, wind, A, g: not k.any()),)
CURVE = Curve(
    "wavenumber along the wind [rad/m]",
    "power [m4]",
    np.linspace(0.1, 1.0, 40),
    lambda f, x: [f(np.array([k, 0.0]), np.array([7.0, 0.0]), 0.01, 9.81) for k in x],
)


def behaviour(student):
    """Nothing at k = 0 and across the wind; the same power against the wind; higher in a storm."""
    k, wind = np.array([0.2, 0.1]), np.array([6.0, 2.0])
    require(student(0 * k, wind, 1.0, 9.81) == 0.0, "at k = 0 the power must be 0")
    require(abs(student(np.array([-0.1, 0.3]), wind, 1.0, 9.81)) < 1e-6, "across the wind the power must be 0")
    along = student(k, wind, 1.0, 9.81)
    require(
        abs(student(-k, wind, 1.0, 9.81) - along) <= 1e-3 * along, "waves against the wind have the same power here"
    )
    require(student(k, 3.0 * wind, 1.0, 9.81) > along, "a storm must make long waves higher")
