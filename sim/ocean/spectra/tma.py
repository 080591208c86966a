"""JONSWAP in finite depth: the TMA spectrum (Bouws and others 1985, JGR 90:975). Choose it near a coast."""

import math

import numpy as np

from sim.ocean.spectra import jonswap
from sim.ocean.spectra.record import Spectrum


def depth_factor(k: np.ndarray, depth: float) -> np.ndarray:
    """phi = tanh^2(kh)/(1 + 2kh/sinh 2kh), exact (Kitaigorodskii), 1 on infinite depth."""
    if math.isinf(depth):
        return np.ones_like(k)
    kh = k * depth
    # 2kh/sinh 2kh = 4kh e^-2kh/(1 - e^-4kh), which does not overflow
    return np.tanh(kh) ** 2 / (1.0 + 4.0 * kh * np.exp(-2.0 * kh) / -np.expm1(-4.0 * kh))


def density(kx: np.ndarray, ky: np.ndarray, c: jonswap.FetchConditions) -> np.ndarray:
    """S(kx, ky) [m4] of jonswap, times phi."""
    return jonswap.density(kx, ky, c) * depth_factor(np.hypot(kx, ky), c.depth)


def frequency(w: np.ndarray, c: jonswap.FetchConditions) -> np.ndarray:
    """S(omega) [m2 s] of jonswap, times phi."""
    return jonswap.frequency(w, c) * depth_factor(c.wavenumber(w), c.depth)


SPECTRUM = Spectrum(
    "tma",
    "TMA 1985: JONSWAP limited by depth",
    density,
    None,
    jonswap.peak,
    jonswap.FetchConditions,
    frequency,
)
