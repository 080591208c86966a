"""The unified spectrum of Elfouhaily, Chapron, Katsaros, Vandemark (1997, JGR 102:15781): swell to ripples.

Choose it for the slopes: its capillary range is measured, not extrapolated. Equation numbers are the paper's.
The paper's spectrum is symmetric in direction; here its whole energy runs ahead of the wind.
"""

import dataclasses
import math

import numpy as np

from sim.numerics.angles import within_half_turn
from sim.ocean.spectra.record import Conditions, Spectrum
from sim.parameters import parameter
from sim.water import EARTH_GRAVITY

KM_WATER = 370.0  # [rad/m] wavenumber of the slowest wave on clean water under 9.81 m/s2, eq. 24


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgeConditions(Conditions):
    """Conditions of a sea of given wave age."""

    inverse_wave_age: float = parameter(
        0.84, 0.84, 5.0, "", "0.84 is a fully developed sea, 5 a very young one", title="Inverse wave age Ω"
    )


def density(kx: np.ndarray, ky: np.ndarray, c: AgeConditions) -> np.ndarray:
    """S(kx, ky) [m4] = B (1 + Delta cos 2 theta)/(2 pi k^4), doubled ahead of the wind, 0 behind; eq. 67."""
    k = np.hypot(kx, ky)
    B, Delta = curvature(k, c)
    theta = within_half_turn(np.arctan2(ky, kx) - c.wind_direction)
    # Half the weight straight across the wind, where both halves meet.
    ahead = 2.0 * np.heaviside(np.round(np.cos(theta), 12), 0.5)
    return ahead * B * (1.0 + Delta * np.cos(2.0 * theta)) / (2.0 * math.pi * k**4)


def frequency(w: np.ndarray, c: AgeConditions) -> np.ndarray:
    """S(omega) [m2 s] = B/k^3 dk/domega, eq. 30."""
    k = c.wavenumber(w)
    return curvature(k, c)[0] / k**3 / c.group_speed(k)


def curvature(k: np.ndarray, c: AgeConditions) -> tuple[np.ndarray, np.ndarray]:
    """B = B_l + B_h of wavenumbers k [rad/m], and the fraction Delta that differs along and across the wind."""
    g, U, Omega = c.gravity, c.wind_speed, c.inverse_wave_age
    s = c.tension / c.density if c.tension > 0.0 else EARTH_GRAVITY / KM_WATER**2
    km = math.sqrt(g / s)
    cm = math.sqrt(2.0 * g / km)
    speed = np.sqrt(g / k + s * k)
    kp = g / U**2 * Omega**2
    cp = U / Omega
    u_star = friction_velocity(c)

    # Long waves, eq. 31-34: B_l = 1/2 alpha_p (c_p/c) F_p
    root = np.sqrt(k / kp)
    gamma = 1.7 if Omega <= 1.0 else 1.7 + 6.0 * math.log10(Omega)
    sigma = 0.08 * (1.0 + 4.0 * Omega**-3)
    L_PM = np.exp(-1.25 * (kp / k) ** 2)
    J_p = gamma ** np.exp(-((root - 1.0) ** 2) / (2.0 * sigma**2))
    F_p = L_PM * J_p * np.exp(-Omega / math.sqrt(10.0) * (root - 1.0))
    B_l = 0.5 * 6e-3 * math.sqrt(Omega) * cp / speed * F_p

    # Short waves, eq. 40, 41, 44: B_h = 1/2 alpha_m (c_m/c) F_m
    steepness = math.log(u_star / cm)
    alpha_m = 1e-2 * max(1.0 + (1.0 if u_star <= cm else 3.0) * steepness, 0.0)
    F_m = L_PM * np.exp(-0.25 * (k / km - 1.0) ** 2)
    B_h = 0.5 * alpha_m * cm / speed * F_m

    # Spreading, eq. 57-59
    Delta = np.tanh(0.25 * math.log(2.0) + 4.0 * (speed / cp) ** 2.5 + 0.13 * u_star / cm * (cm / speed) ** 2.5)
    return B_l + B_h, Delta


def friction_velocity(c: AgeConditions) -> float:
    """u* [m/s] from U10 by the roughness z0 = 3.7e-5 U^2/g (U/c_p)^0.9, eq. 66, and the log law, eq. 60-61."""
    z0 = 3.7e-5 * c.wind_speed**2 / c.gravity * c.inverse_wave_age**0.9
    return 0.41 * c.wind_speed / math.log(max(10.0 / z0, 2.0))


def peak(c: AgeConditions) -> float:
    """omega = sqrt(g k_p) = Omega g/U10 [rad/s], the paper's peak parameter."""
    return c.inverse_wave_age * c.gravity / c.wind_speed


SPECTRUM = Spectrum(
    "elfouhaily",
    "Elfouhaily and others 1997: unified, from swell to capillary waves",
    density,
    None,
    peak,
    AgeConditions,
    frequency,
)
