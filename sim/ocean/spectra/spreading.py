"""Directional spreading D(omega/omega_p, theta) [1/rad], with integral 1 over the circle, and Horvath's swell.

Sources: cos2s and its normaliser: Longuet-Higgins, Cartwright, Smith (1963); s of Hasselmann, Dunckel, Ewing (1980,
J. Phys. Oceanogr. 10:1264); sech2 of Donelan, Hamilton, Hui (1985) with Banner's (1990) tail; swell: Horvath (2015),
eq. 44.
"""

import math

import numpy as np

from sim.jit import kernel

SPREADINGS = {  # name -> its title in a list
    "cos2": "cos² θ",
    "cos2s": "cos²ˢ θ/2",
    "hasselmann": "Hasselmann",
    "donelan_banner": "Donelan and Banner",
}


def spread(
    name: str, ratio: np.ndarray, theta: np.ndarray, exponent: float, swell: float, inverse_age: float
) -> np.ndarray:
    """D [1/rad]. ratio: omega/omega_p; theta [rad] from the wind, in [-pi, pi]; exponent: s of cos2s;
    swell: xi of Horvath, 0 to 1; inverse_age: U/c_p. Raises KeyError for an unknown name.
    """
    # Horvath (2015), eq. 44: swell adds s_xi = 16.1 tanh(omega_p/omega) xi^2 to the exponent of cos^2s(theta/2).
    s_swell = 16.1 * np.tanh(1.0 / ratio) * swell**2
    if name == "cos2s":
        return cos2s(exponent + s_swell, theta)
    if name == "hasselmann":
        return cos2s(hasselmann_exponent(ratio, inverse_age) + s_swell, theta)
    base = {"cos2": _cos2, "donelan_banner": _donelan_banner}[name]
    if swell == 0.0:
        return base(ratio, theta)
    return _narrowed(base, ratio, theta, swell)


def cos2s(s: np.ndarray | float, theta: np.ndarray) -> np.ndarray:
    """2^(2s-1)/pi Gamma(s+1)^2/Gamma(2s+1) cos^2s(theta/2), by duplication Gamma(s+1)/(2 sqrt(pi) Gamma(s+1/2))."""
    s = np.asarray(s, np.float64)
    normaliser = np.empty(s.shape)
    set_normaliser(np.ascontiguousarray(s).reshape(-1), normaliser.reshape(-1))
    return normaliser * np.abs(np.cos(0.5 * theta)) ** (2.0 * s)


def hasselmann_exponent(ratio: np.ndarray, inverse_age: float) -> np.ndarray:
    """s = 6.97 p^4.06 below 1.05 omega_p, 9.77 p^(-2.33 - 1.45 (U/c_p - 1.17)) above it, p = omega/omega_p.

    The paper's two fits meet near 1.05 only; each is taken up to where they meet, so that s has no jump.
    """
    above = -2.33 - 1.45 * (inverse_age - 1.17)
    return np.minimum(6.97 * ratio**4.06, 9.77 * np.maximum(ratio, 1.0) ** above)


@kernel(allocates=False)
def set_normaliser(s, normaliser):
    for j in range(s.shape[0]):
        normaliser[j] = math.exp(math.lgamma(s[j] + 1.0) - math.lgamma(s[j] + 0.5)) / (2.0 * math.sqrt(math.pi))


def _cos2(ratio: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """2/pi cos^2 on the half circle ahead of the wind."""
    return np.where(np.cos(theta) > 0.0, 2.0 / math.pi * np.cos(theta) ** 2, 0.0)


def _donelan_banner(ratio: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """beta / (2 tanh(beta pi)) sech^2(beta theta)."""
    p = np.maximum(ratio, 1e-6)
    tail = 10.0 ** (-0.4 + 0.8393 * np.exp(-0.567 * np.log(np.maximum(p, 1.6) ** 2)))  # at small p it would overflow
    beta = np.where(p < 0.95, 2.61 * np.maximum(p, 0.56) ** 1.3, np.where(p < 1.6, 2.28 * p**-1.3, tail))
    return beta / (2.0 * np.tanh(beta * math.pi)) / np.cosh(beta * theta) ** 2


def _narrowed(base, ratio: np.ndarray, theta: np.ndarray, swell: float) -> np.ndarray:
    """base times |cos(theta/2)|^(2 s_xi), normalised by a sum over the circle tabulated in log(omega/omega_p)."""
    grid = np.linspace(math.log(0.05), math.log(100.0), 400)
    circle = np.linspace(-math.pi, math.pi, 256, endpoint=False)

    def product(p: np.ndarray, angle: np.ndarray) -> np.ndarray:
        return base(p, angle) * np.abs(np.cos(0.5 * angle)) ** (2.0 * 16.1 * np.tanh(1.0 / p) * swell**2)

    total = product(np.exp(grid)[:, None], circle[None, :]).sum(axis=1) * (2.0 * math.pi / circle.size)
    return product(ratio, theta) / np.interp(np.log(np.maximum(ratio, 1e-6)), grid, total)
