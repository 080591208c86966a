"""Linear dispersion: one fluid, two layers, viscosity, films. Pure numpy; every function takes arrays of k.

Choose `omega` for water, `two_layer` for oil on water, `viscous_root` and `viscous_two_layer` for how fast a wave
decays on either. Limits: small slopes (Stokes's third order adds (ka)^2/2 to the speed); the viscous roots are those of
deep fluid.
Sources: H. Lamb, Hydrodynamics (1932), articles named at each function.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from sim import dispersion as linear
from sim.interruption import raise_if_stopped
from sim.ocean.fluids.viscous_layers import Layers, surface_roots
from sim.validation import (
    argument_error,
    check_frequencies,
    check_kind,
    check_number,
    check_positive,
    check_wavenumbers,
)
from sim.water import EARTH_GRAVITY, SEA_DENSITY

INF = math.inf
CRITICAL = 1.3114687221932  # nu k^2/omega0 above which a wave no longer oscillates: the quartic's double root
CRITICAL_FILM = 1.2703246811008881  # the same under a film
LONG = 1e-6  # kd that stands for 0 in the ratios of modes
EVANESCENT = 18.0  # kd beyond which the far mode is under 2e-8 of the near one and lost in rounding


def omega(
    k: Any, gravity: float = EARTH_GRAVITY, depth: float = INF, tension: float = 0.0, density: float = SEA_DENSITY
) -> Any:
    """Angular frequency [rad/s] of waves of wavenumber k [rad/m], any shape.

    gravity [m/s2] and density [kg/m3] above 0; depth [m] above 0 or inf; tension [N/m] 0 or above.
    Raises ValueError otherwise. Lamb, Art. 228-229 and 266-267.

    >>> round(float(omega(0.1)), 4)  # [rad/s], deep water
    0.9905
    """
    k, s = _checked(k, gravity, depth, tension, density)
    return linear.omega(k, gravity, depth, s)[()]


def phase_speed(
    k: Any, gravity: float = EARTH_GRAVITY, depth: float = INF, tension: float = 0.0, density: float = SEA_DENSITY
) -> Any:
    """Phase speed omega/k [m/s]; at k = 0 sqrt(g depth), inf where depth is. Arguments and errors as for `omega`.

    >>> round(float(phase_speed(0.1)), 3)  # [m/s]
    9.905
    """
    k, s = _checked(k, gravity, depth, tension, density)
    return linear.phase_speed(k, gravity, depth, s)[()]


def group_speed(
    k: Any, gravity: float = EARTH_GRAVITY, depth: float = INF, tension: float = 0.0, density: float = SEA_DENSITY
) -> Any:
    """Group speed d omega/dk [m/s]; at k = 0 sqrt(g depth), inf where depth is. Arguments and errors as for `omega`.

    >>> round(float(group_speed(0.1)), 3)  # [m/s], half of the phase speed on deep water
    4.952
    """
    k, s = _checked(k, gravity, depth, tension, density)
    return linear.group_speed(k, gravity, depth, s)[()]


def wavenumber(
    omega: Any, gravity: float = EARTH_GRAVITY, depth: float = INF, tension: float = 0.0, density: float = SEA_DENSITY
) -> Any:
    """Wavenumber [rad/m] of waves of angular frequency omega [rad/s], any shape: the inverse of `omega`.

    Raises ValueError for a frequency that is negative or not finite, and as `omega`.

    >>> round(float(wavenumber(1.0, depth=10.0)), 4)  # [rad/m]
    0.1216
    """
    w = check_frequencies("omega", omega)
    _, s = _checked(0.0, gravity, depth, tension, density)
    return linear.wavenumber(w, gravity, depth, s)[()]


def two_layer(
    k: Any,
    upper_density: float,
    thickness: float,
    lower_density: float,
    gravity: float = EARTH_GRAVITY,
    depth: float = INF,
    surface_tension: float = 0.0,
    interface_tension: float = 0.0,
) -> tuple[Any, Any]:
    """(surface, interface) angular frequencies [rad/s] of a layer of fluid on another.

    upper_density, lower_density [kg/m3]; thickness [m] of the upper layer; depth [m] of the lower one, or inf;
    tensions [N/m]. Raises ValueError if a value is not allowed or the upper fluid is the heavier.
    Reduces to Lamb, Art. 231, without tension.
    """
    k, X_surface, X_interface, _ = _two_layer_roots(
        k, upper_density, thickness, lower_density, gravity, depth, surface_tension, interface_tension
    )
    return np.sqrt(X_surface)[()], np.sqrt(X_interface)[()]


class ModeRatios(NamedTuple):
    """Ratios of a mode's amplitude at its far boundary to that at its own. Negative: they move in antiphase."""

    surface: Any  # interface height over surface height, in the surface mode
    interface: Any  # surface height over interface height, in the interfacial mode


def mode_ratios(
    k: Any,
    upper_density: float,
    thickness: float,
    lower_density: float,
    gravity: float = EARTH_GRAVITY,
    depth: float = INF,
    surface_tension: float = 0.0,
    interface_tension: float = 0.0,
) -> ModeRatios:
    """Amplitude ratios of the two modes; arguments and errors as for `two_layer`.

    0 beyond k thickness = 18; at k = 0 the limit for long waves.
    """
    check_positive("thickness", thickness, "m", allow_infinite=True)
    k = check_wavenumbers("k", k)
    k = np.maximum(k, 0.0 if math.isinf(thickness) else LONG / min(thickness, depth))
    k, X_surface, X_interface, G1 = _two_layer_roots(
        k, upper_density, thickness, lower_density, gravity, depth, surface_tension, interface_tension
    )
    kd = np.where(k > 0.0, k, 1.0) * thickness
    seen = (kd < EVANESCENT) & (k > 0.0)
    kd = np.minimum(kd, EVANESCENT)
    # From the upper potential: eta_int/eta_surf = cosh kd - (k G1 / omega^2) sinh kd
    with np.errstate(divide="ignore", invalid="ignore"):
        down = np.cosh(kd) - k * G1 / X_surface * np.sinh(kd)
        up = 1.0 / (np.cosh(kd) - k * G1 / X_interface * np.sinh(kd))
    return ModeRatios(np.where(seen, down, 0.0)[()], np.where(seen, up, 0.0)[()])


def viscous_root(k: Any, viscosity: float, gravity: float = EARTH_GRAVITY, film: bool = False) -> tuple[Any, Any]:
    """(omega [rad/s], decay rate [1/s]) of a wave on deep fluid of kinematic viscosity [m2/s].

    film: the surface cannot be stretched, "oil on troubled waters". omega is 0 where the motion creeps without
    oscillating; the rate is then that of the slower root. Raises ValueError for a negative or non-finite argument, or
    gravity not above 0. Lamb, Art. 349 and 351.
    """
    k = check_wavenumbers("k", k)
    check_number("viscosity", viscosity, "m2/s", 0.0)
    check_kind("film", film, bool, "True or False")
    w, rate = damped_root(omega(k, gravity), viscosity * k**2, film)
    return w[()], rate[()]


def viscous_two_layer(
    k: Any,
    upper_density: float,
    upper_viscosity: float,
    thickness: float,
    lower_density: float,
    lower_viscosity: float,
    gravity: float = EARTH_GRAVITY,
    surface_tension: float = 0.0,
    interface_tension: float = 0.0,
    film: bool = False,
) -> tuple[Any, Any]:
    """(omega [rad/s], decay rate [1/s]) of the surface wave on a layer of viscous fluid on deep viscous fluid.

    densities [kg/m3]; dynamic viscosities [Pa s], above 0; thickness [m]; tensions [N/m]; film: the upper surface
    cannot be stretched. The exact linear problem, see `sim.ocean.fluids.viscous_layers`; the root is the one that
    grows out of the surface mode of `two_layer` with the viscosities. omega is 0 where the motion creeps without
    oscillating. Raises ValueError if a value is not allowed or the upper fluid is the heavier.
    """
    k, X_surface, X_interface, G1 = _two_layer_roots(
        k, upper_density, thickness, lower_density, gravity, INF, surface_tension, interface_tension
    )
    check_positive("thickness", thickness, "m")
    check_positive("upper_viscosity", upper_viscosity, "Pa s")
    check_positive("lower_viscosity", lower_viscosity, "Pa s")
    check_kind("film", film, bool, "True or False")
    w, rate = np.zeros_like(k), np.zeros_like(k)
    moving = k > 0.0
    if moving.any():
        wavenumbers = k[moving]
        layers = Layers(
            wavenumbers,
            upper_density,
            upper_viscosity,
            thickness,
            lower_density,
            lower_viscosity,
            G1[moving],
            (lower_density - upper_density) * gravity + interface_tension * wavenumbers**2,
            np.sqrt(X_surface[moving]),
            np.sqrt(X_interface[moving]),
        )
        w[moving], rate[moving] = surface_roots(layers, film)
    return w[()], rate[()]


def damped_root(natural: Any, rate: Any, film: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """(omega, decay rate) from the inviscid frequency omega0 [rad/s] and nu k^2 [1/s], arrays of one shape.

    With theta = nu k^2/omega0 and m = sqrt(1 + s/(nu k^2)), Re m > 0, Re s < 0:
    clean surface: (s + 2 nu k^2)^2 + omega0^2 = 4 nu^2 k^4 m (Lamb, Art. 349, eq. 13), the quartic
    (m^2 + 1)^2 - 4 m + 1/theta^2 = 0;
    film, no velocity along the surface: s^2 + omega0^2 (1 - 1/m) = 0, the quartic m (m - 1)(m + 1)^2 + 1/theta^2 = 0.
    For weak viscosity the film's decay is k sqrt(nu omega0/8) (Lamb, Art. 351).
    """
    natural, rate = np.broadcast_arrays(np.asarray(natural, np.float64), np.asarray(rate, np.float64))
    w, decay = natural.copy(), np.zeros_like(natural)
    moving = (natural > 0.0) & (rate > 0.0)
    theta = np.divide(rate, natural, out=np.zeros_like(natural), where=moving)
    # Below this the decay is under the rounding of the frequency, and 1/theta^2 would overflow.
    moving &= theta > 1e-100
    critical = CRITICAL_FILM if film else CRITICAL
    waves, creeping = moving & (theta < critical), moving & (theta >= critical)
    if waves.any():
        s = _oscillating_film(theta[waves]) if film else _oscillating(theta[waves])
        w[waves], decay[waves] = natural[waves] * s.imag, -natural[waves] * s.real
    if creeping.any():
        w[creeping], decay[creeping] = 0.0, natural[creeping] * _aperiodic(theta[creeping], film)
    return w, decay


def _checked(k: Any, gravity: float, depth: float, tension: float, density: float) -> tuple[np.ndarray, float]:
    """k as an array and s = sigma/rho, every argument checked."""
    check_positive("gravity", gravity, "m/s2")
    check_positive("depth", depth, "m", allow_infinite=True)
    return check_wavenumbers("k", k), check_number("tension", tension, "N/m", 0.0) / check_positive(
        "density", density, "kg/m3"
    )


def _two_layer_roots(
    k: Any, rho1: float, d: float, rho2: float, g: float, h2: float, s1: float, s12: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """k, X = omega^2 of the surface and of the interfacial mode, and G1 = g + s1 k^2/rho1."""
    k = check_wavenumbers("k", k)
    check_positive("upper_density", rho1, "kg/m3")
    check_positive("thickness", d, "m", allow_infinite=True)
    check_positive("gravity", g, "m/s2")
    check_positive("depth", h2, "m", allow_infinite=True)
    check_number("surface_tension", s1, "N/m", 0.0)
    check_number("interface_tension", s12, "N/m", 0.0)
    check_positive("lower_density", rho2, "kg/m3")
    if rho2 < rho1:
        raise argument_error("lower_density", rho2, f"at least the upper density, {rho1:g} kg/m3")
    G1, G2 = g + s1 * k**2 / rho1, (rho2 - rho1) * g + s12 * k**2
    t1, t2 = linear.tanh_depth(k, d), linear.tanh_depth(k, h2)
    # X^2 (rho2 + rho1 t1 t2) - X k [rho2 G1 t1 + (rho1 G1 + G2) t2] + k^2 G1 G2 t1 t2 = 0,
    # divided by cosh kd coth kh2, so that nothing overflows. The small root by Vieta.
    A = rho2 + rho1 * t1 * t2
    B = k * (rho2 * G1 * t1 + (rho1 * G1 + G2) * t2)
    C = k**2 * G1 * G2 * t1 * t2
    X_surface = (B + np.sqrt(np.maximum(B**2 - 4.0 * A * C, 0.0))) / (2.0 * A)
    X_interface = np.divide(C, A * X_surface, out=np.zeros_like(k), where=X_surface > 0.0)
    return k, X_surface, X_interface, G1


def _oscillating(theta: np.ndarray) -> Any:
    """The root s/omega0 with Im s > 0, for theta below CRITICAL."""
    inverse = 1.0 / theta**2
    m = np.sqrt(1j / theta - 1.0)
    for _ in range(80):  # Newton: 4 to 6 turns, more only where the double root is near
        raise_if_stopped()
        change = ((m * m + 1.0) ** 2 - 4.0 * m + inverse) / (4.0 * m * (m * m + 1.0) - 4.0)
        m = m - change
        if np.all(np.abs(change) <= 1e-15 * np.abs(m)):
            break
    # s = -2 theta + i sqrt(1 - e), e = 4 theta^2 m, written so that a small decay keeps its digits.
    e = 4.0 * theta**2 * m
    return -2.0 * theta + 1j - 1j * e / (1.0 + np.sqrt(1.0 - e))


def _oscillating_film(theta: np.ndarray) -> Any:
    """The same under a film, for theta below CRITICAL_FILM."""
    inverse = 1.0 / theta**2
    m = np.sqrt(1j / theta) + 0.25
    for _ in range(80):
        raise_if_stopped()
        change = (m * (m - 1.0) * (m + 1.0) ** 2 + inverse) / (((4.0 * m + 3.0) * m - 2.0) * m - 1.0)
        m = m - change
        if np.all(np.abs(change) <= 1e-15 * np.abs(m)):
            break
    # s = i sqrt(1 - 1/m), written so that a small decay keeps its digits.
    return 1j - 1j / m / (1.0 + np.sqrt(1.0 - 1.0 / m))


def _aperiodic(theta: np.ndarray, film: bool) -> np.ndarray:
    """The slower decay rate over omega0 where nothing oscillates: m = 1 - delta, delta small when theta is large."""
    inverse = 1.0 / theta**2
    delta = 0.25 * inverse
    for _ in range(80):
        raise_if_stopped()
        # The quartic of `damped_root` in delta, and its derivative.
        if film:
            f = delta * (-4.0 + delta * (8.0 + delta * (-5.0 + delta))) + inverse
            change = f / (-4.0 + delta * (16.0 + delta * (-15.0 + 4.0 * delta)))
        else:
            f = delta * (-4.0 + delta * (8.0 + delta * (-4.0 + delta))) + inverse
            change = f / (-4.0 + delta * (16.0 + delta * (-12.0 + 4.0 * delta)))
        delta = delta - change
        if np.all(np.abs(change) <= 1e-15 * delta):
            break
    return theta * delta * (2.0 - delta)
