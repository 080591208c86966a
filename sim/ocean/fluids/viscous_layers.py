"""The surface wave on a layer of viscous fluid on deep viscous fluid: the root of the exact linear problem.

In each fluid the vertical velocity is w = P + Q, times e^(ikx + st): P'' = k^2 P is the potential part, which carries
the pressure -rho s P'/k^2, and Q'' = m^2 Q, m^2 = k^2 + s/nu, the rotational part, which carries none. Six constants
(four in the layer, two below) meet six conditions: shear and normal stress at the surface, both velocities, shear and
normal stress at the interface. Here four of the constants are eliminated by hand. The remaining determinant is written
as that of fluids without viscosity plus terms that vanish with it. So a decay of 1e-8 of the frequency keeps its
digits, which the 6 x 6 determinant would lose.

Sources: H. Lamb, Hydrodynamics (1932), Art. 349 and 351, for one fluid; Landau and Lifshitz, Fluid Mechanics, Sec. 62
and problems, for the conditions at an interface.
"""

from typing import Any, NamedTuple

import numpy as np

from sim.interruption import raise_if_stopped

NEAR = 0.15  # shift of the root, as a fraction of the frequency, up to which it is found at once, without steps
START = 1e-3  # such a shift where the steps begin
GROWTH = 0.2  # of the logarithm of the viscosities in a step
MAX_STEPS = 200
DETOUR = 0.3  # angle [rad] of the viscosities in the complex plane on the way
TURNS = 12  # steps in which that angle is taken back at the end
ITERATIONS = 40
TOLERANCE = 1e-13  # of the shift
SMALLEST_SHIFT = 1e-300


class Layers(NamedTuple):
    """Two fluids, the constants of their waves of wavenumber k, and the two modes without viscosity; arrays (n,)."""

    k: np.ndarray  # [rad/m], above 0
    upper_density: float  # [kg/m3]
    upper_viscosity: float  # dynamic [Pa s], above 0
    thickness: float  # [m]
    lower_density: float  # [kg/m3]
    lower_viscosity: float  # dynamic [Pa s], above 0
    surface_restoring: np.ndarray  # G1 = g + surface tension k^2/upper density [m/s2]
    interface_restoring: np.ndarray  # G2 = (lower - upper density) g + interface tension k^2 [kg/(m2 s2)]
    surface_omega: np.ndarray  # [rad/s] of the surface mode without viscosity
    interface_omega: np.ndarray  # [rad/s] of the interfacial one

    def of(self, which: np.ndarray) -> "Layers":
        """The layers at some of the wavenumbers."""
        return self._replace(
            **{n: getattr(self, n)[which] for n in ("k", "surface_restoring", "interface_restoring",
                                                    "surface_omega", "interface_omega")}
        )  # fmt: skip


def surface_roots(layers: Layers, film: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """(omega [rad/s], decay rate [1/s]) of the surface mode, continued from that without viscosity; (n,) each.

    film: the surface cannot be stretched. omega is 0 where the motion creeps without oscillating.
    """
    shift = np.zeros(len(layers.k), np.complex128)
    with np.errstate(all="ignore"):
        first = np.abs(_new_shift(shift, 1.0, layers, film)) / layers.surface_omega
        near = first < NEAR
        if near.any():
            shift[near], is_solved = _solved(shift[near], 1.0, layers.of(near), film)
            near[near] = is_solved
        if not near.all():
            shift[~near] = _continued(first[~near], layers.of(~near), film)
    omega = layers.surface_omega + shift.imag
    # If the motion creeps the root is real, and the computed frequency is only rounding error.
    return np.where(omega > 1e-9 * layers.surface_omega, omega, 0.0), -shift.real


def _continued(first: np.ndarray, layers: Layers, film: bool) -> np.ndarray:
    """The shift of the root as both viscosities grow by equal factors, from where it is small to their values.

    first (n,): the shift, as a fraction of the frequency, that the full viscosities make at once. On the way they are
    complex, with a positive imaginary part: so the two roots that meet where a wave begins to creep are passed on the
    side of the slower one.
    """
    # The shift goes at least as the root of the viscosity.
    logarithm = 2.0 * np.log(np.minimum(START / first, 1.0))
    steps = min(int(np.ceil(-logarithm.min() / GROWTH)) + 1, MAX_STEPS)
    parts = [(step / steps, 1.0) for step in range(steps + 1)] + [(1.0, 1.0 - i / TURNS) for i in range(1, TURNS + 1)]
    shift = np.zeros(len(layers.k), np.complex128)
    growth = np.ones_like(shift)
    for i, (part, angle) in enumerate(parts):
        share = np.exp(logarithm * (1.0 - part) + 1j * DETOUR * angle)
        growing = 1 < i <= steps
        solved, _ = _solved(shift * growth if growing else shift, share, layers, film)
        # Equal factors of the viscosity change the shift by nearly equal factors.
        growth = solved / shift if i > 0 else growth
        shift = solved
    return shift


def _solved(guess: np.ndarray, share: Any, layers: Layers, film: bool) -> tuple[np.ndarray, np.ndarray]:
    """The shift that reproduces itself, near a guess, by the secant method; and where it was found."""
    old = guess
    old_miss = _new_shift(old, share, layers, film) - old
    new = np.where(guess == 0.0, old + old_miss, old + 1e-4 * old)
    done = np.zeros(len(guess), bool)
    for _ in range(ITERATIONS):
        raise_if_stopped()
        miss = _new_shift(new, share, layers, film) - new
        done = np.abs(miss) <= TOLERANCE * np.abs(new) + SMALLEST_SHIFT
        if done.all():
            break
        slope = miss - old_miss
        change = np.where((slope != 0.0) & ~done, -miss * (new - old) / slope, 0.0)
        old, old_miss, new = new, miss, new + change
    return new, done


def _new_shift(shift: np.ndarray, share: Any, layers: Layers, film: bool) -> np.ndarray:
    """Shift of s from i omega0 by which the part of the determinant without viscosity balances the rest at `shift`.

    share: factor on both viscosities.
    """
    k, rho1, mu1, d, rho2, mu2, G1, G2, omega0, omega_interface = layers
    s = 1j * omega0 + shift
    mu1, mu2 = share * mu1, share * mu2
    nu1, nu2 = mu1 / rho1, mu2 / rho2
    m1, m2 = np.sqrt(k**2 + s / nu1), np.sqrt(k**2 + s / nu2)
    a, b = s + 2.0 * nu1 * k**2, 2.0 * nu1 * k**2
    e, E = np.exp(-k * d), np.exp(-m1 * d)
    coth_m, both = (1.0 + E * E) / (1.0 - E * E), 2.0 * E / (1.0 - E * E)  # 1/tanh and 1/sinh of m1 d
    # P and P' at the surface, and at the interface, for two solutions (2, n); k P - P' at the interface; and the part
    # of the determinant without viscosity that is left after its roots are divided out.
    P0, dP0, p, dp, slip, factor = _potentials(k, d, e, rho1, rho2)
    # Q at the surface is known_0 + link_0 q, and Q' at the interface known_1 + link_1 q, with q = Q at the interface.
    if film:
        known_0, link_0 = -dP0 / (m1 * coth_m), both / coth_m
        known_1, link_1 = -dP0 * link_0, -m1 / coth_m
    else:
        known_0, link_0 = -b / a * P0, 0.0
        known_1, link_1 = m1 * both * known_0, -m1 * coth_m
    # q from the velocities and the shear stress at the interface; r is the rotational part of the fluid below.
    more = mu1 - mu2
    jump = (s / nu2) / (m2 + k)  # m2 - k
    stress = 2.0 * more * k**2 / (rho2 * s)
    q = (slip - known_1 + jump * stress * p) / (link_1 - k - jump * (rho1 / rho2 + stress))
    r = (rho1 / rho2 + stress) * q + stress * p
    # Normal stress at the surface (row 0) and at the interface (row 1): without viscosity, and what it adds.
    plain_0 = s**2 * dP0 + G1 * k**2 * P0
    if film:
        extra_0 = G1 * k**2 * (known_0 + link_0 * q)
    else:
        extra_0 = 2.0 * b * (s + 0.5 * b) * dP0 + b * a * m1 * (coth_m * known_0 - both * q)
    plain_1 = rho1 * s**2 * dp - (rho2 * s**2 * k + G2 * k**2) * p
    extra_1 = -rho2 * s**2 * k * (q - r) + 2.0 * more * k**2 * s * (dp + known_1 + link_1 * q) - G2 * k**2 * q
    rest = (
        plain_0[0] * extra_1[1] + extra_0[0] * (plain_1[1] + extra_1[1])
        - plain_0[1] * extra_1[0] - extra_0[1] * (plain_1[0] + extra_1[0])
    )  # fmt: skip
    # The rest of the determinant is factor (s^2 + omega0^2)(s^2 + omega_interface^2).
    return -rest / (factor * (2j * omega0 + shift) * (s**2 + omega_interface**2))


def _potentials(
    k: np.ndarray, d: float, e: np.ndarray, rho1: float, rho2: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """P and P' at the surface, P, P' and k P - P' at the interface, (2, n) each, and the factor of the determinant.

    In a thin layer the two solutions are cosh kz and sinh kz, which stay apart there; in a thick one e^(kz) and
    e^(-k(z + d)), which stay finite.
    """
    thin = k * d < 1.0
    kd = np.where(thin, k * d, 0.0)
    cosh, sinh, one, zero = np.cosh(kd), np.sinh(kd), np.ones_like(k), np.zeros_like(k)
    P0 = np.where(thin, [one, zero], [one, e])
    dP0 = k * np.where(thin, [zero, one], [one, -e])
    p = np.where(thin, [cosh, -sinh], [e, one])
    dp = k * np.where(thin, [-sinh, cosh], [e, -one])
    slip = k * np.where(thin, np.exp(kd) * np.array([one, -one]), [zero, 2.0 * one])
    thick = -(rho2 * (1.0 + e * e) + rho1 * (1.0 - e * e))
    return P0, dP0, p, dp, slip, k**2 * np.where(thin, rho2 * cosh + rho1 * sinh, thick)
