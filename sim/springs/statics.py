"""Exact equilibria of ropes: the chain of links itself, not a continuum. Whatever an integrator does, it ends here."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.records import equal_to_itself
from sim.springs.laws import TAUT, check_law, law_of, of_arrays
from sim.springs.net import Family, Net
from sim.validation import ConvergenceError, argument_error, as_array, check_kind, check_number, check_positive

ITERATIONS = 200  # of Newton: a dozen is usual


@equal_to_itself
class Equilibrium(NamedTuple):
    """A rope at rest."""

    x: NDArray[np.float64]  # (points, 3) [m]
    tension: NDArray[np.float64]  # (points - 1,) [N] of each link, from point 0 on


def hanging_chain(net: Net) -> Equilibrium:
    """The rope `net` hanging from its pinned point 0, away from floor and sphere: link i of n carries the points
    below it, and is as long as its law says at their weight.

    Raises ValueError if the net is no rope, is pinned elsewhere too, or has links without stiffness.

    >>> from sim.springs import rope
    >>> hanging_chain(rope(points=10, mass=1.0, gravity=10.0)).tension[[0, -1]].tolist()  # [N] first and last link
    [90.0, 10.0]
    """
    family = single_family(net)
    if net.pinned != {(0, 0)}:
        raise argument_error("net", sorted(net.pinned), "a rope pinned at point 0 only")
    g = math.hypot(*net.gravity)
    # Without gravity any straight shape is at rest: along -x, as `rope` lays it.
    down = np.asarray(net.gravity) / g if g > 0.0 else np.array([-1.0, 0.0, 0.0])
    tension = g * net.masses[0, :0:-1].cumsum()[::-1]
    depth = np.concatenate([[0.0], np.cumsum(law_of(net.law).length(net.law, family.stiffness, family.rest, tension))])
    return Equilibrium(net.x0[:, 0, 0] + depth[:, None] * down, tension)


def catenary(
    points: int,
    length: float,
    span: float,
    rise: float,
    stiffness: float,
    mass: ArrayLike,
    gravity: float,
    law: Any = "spring",
) -> Equilibrium:
    """The discrete elastic catenary between pins at (0, 0, 0) and (span, 0, rise) [m], hanging in the x-z plane.

    length: rest length of the whole [m]; stiffness [N/m] per link; mass [kg] of every point, or (points,) of each;
    gravity [m/s^2] along -z, above 0 where the rope is not stretched straight; law: as of `rope`.

    With the first link's tension (H, V) the others carry (H, V + (i - 1) m g), each link is the vector
    l(T_i) (H, V_i)/T_i with l the length at a tension, and H and V follow from where the last one ends (H. M. Irvine,
    Cable Structures, 1981, for the continuum). The end is the gradient of sum_i (l T_i - U(l)), U the energy, which is
    convex: Newton's method with a line search on that, less (span, rise) . (H, V), comes to the one answer from any
    start.

    Raises ValueError, naming the argument, its value and what is allowed, and ConvergenceError.

    >>> rest = catenary(points=9, length=2.0, span=1.0, rise=0.0, stiffness=1e4, mass=0.1, gravity=9.81)
    >>> round(float(rest.x[4, 2]), 3)  # [m] of its middle
    -0.81
    """
    if not isinstance(points, int | np.integer) or isinstance(points, bool) or points < 2:
        raise argument_error("points", points, "a whole number of at least 2")
    check_positive("length", length, "m")
    check_number("span", span, "m")
    check_number("rise", rise, "m")
    check_positive("stiffness", stiffness, "N/m")
    masses = as_array("mass", mass, f"at least 0 kg, one number or {points} of them")
    if masses.shape not in ((), (points,)) or not ((masses >= 0.0) & (masses < math.inf)).all():
        raise argument_error("mass", mass, f"at least 0 kg, one number or {points} of them")
    check_number("gravity", gravity, "m/s^2")
    links = int(points) - 1
    rest = length / links
    numbers = check_law(law)
    link_law = law_of(numbers)
    length_at, energy_at, slope_at = link_law.length, of_arrays(link_law.energy), of_arrays(link_law.stiffness)
    load = gravity * np.concatenate([[0.0], np.broadcast_to(masses, (links + 1,))[1:-1].cumsum()])
    end = np.array([span, rise])
    reach = math.hypot(span, rise)
    small = 1e-11 * (length + reach)
    if not load.any() and reach < length - small:
        raise argument_error("span", span, "a distance at which gravity or stretch keeps every link taut")

    def value(force):
        T = np.hypot(force[0], force[1] + load)
        lengths = length_at(numbers, stiffness, rest, T)
        return float((lengths * T - energy_at(numbers, stiffness, rest, lengths)).sum() - end @ force)

    def gap_and_jacobian(force):
        H, V = force[0], force[1] + load
        T = np.maximum(np.hypot(H, V), 1e-300)
        lengths = length_at(numbers, stiffness, rest, T)
        # Each link's compliance: across it l/T, and along it 1 over its stiffness, of a taut one.
        across, taut = lengths / T, np.maximum(lengths, (1.0 + TAUT) * rest)
        more = (1.0 / slope_at(numbers, stiffness, rest, taut) - across) / T**2
        hh, vv, hv = (across + more * H * H).sum(), (across + more * V * V).sum(), (more * H * V).sum()
        return np.array([(across * H).sum(), (across * V).sum()]) - end, np.array([[hh, hv], [hv, vv]])

    # Half the weight hangs on each end; the pull is that of a rope as steep as it is long, or of the stretch.
    stretch = max(reach / length - 1.0, 0.0) * stiffness * rest
    force = np.array([math.copysign(abs(load[-1]) / 4.0 + stretch + 1e-9 * stiffness * rest, span), -load[-1] / 2.0])
    force, gap, iterations = minimise(value, gap_and_jacobian, force, 0.1 * small)
    left = float(np.hypot(*gap))
    if not left <= small:
        raise ConvergenceError("the catenary of a rope", f"{left:.3g} m at its last point", iterations)
    H, V = force[0], force[1] + load
    T = np.hypot(H, V)
    links_xz = (length_at(numbers, stiffness, rest, T) / T)[:, None] * np.stack([np.full_like(V, H), V], axis=1)
    x = np.zeros((links + 1, 3))
    x[1:, 0], x[1:, 2] = np.cumsum(links_xz, axis=0).T
    x[-1] = span, 0.0, rise
    return Equilibrium(x, T)


def minimise(value: Any, gap_and_jacobian: Any, force: Any, small: float) -> tuple[Any, Any, int]:
    """The least of a convex value(force), the gap there, its gradient, and the iterations taken: Newton's method with
    a line search.

    gap_and_jacobian(force): gradient (2,) and its derivative (2, 2). small: of a gap that may be the last.
    """
    gap, jacobian = gap_and_jacobian(force)
    iterations = 0
    while iterations < ITERATIONS:
        iterations += 1
        step = -np.linalg.solve(jacobian, gap)
        slope, before = float(gap @ step), value(force)
        share = 1.0
        while True:
            new = force + share * step
            new_gap, new_jacobian = gap_and_jacobian(new)
            # Near the end the values differ by less than round-off, and the gap decides.
            if np.hypot(*new_gap) < np.hypot(*gap) or value(new) <= before + 1e-4 * share * slope:
                break
            share *= 0.5
            if share < 1e-12:
                break
        if np.hypot(*new_gap) >= np.hypot(*gap) and np.hypot(*gap) <= small:
            break
        force, gap, jacobian = new, new_gap, new_jacobian
    return force, gap, iterations


def equilibrium(net: Net) -> Equilibrium:
    """Rest state of the rope `net`, hanging from point 0 or from both its ends; without floor and sphere.

    Raises ValueError and ConvergenceError as `hanging_chain` and `catenary` do, and ValueError if gravity is not
    along z.
    """
    family = single_family(net)
    last = net.shape[1] - 1
    if net.pinned == {(0, 0)}:
        return hanging_chain(net)
    if last == 0 or net.pinned != {(0, 0), (0, last)}:
        raise argument_error("net", sorted(net.pinned), "a rope pinned at point 0, and at the last one or not")
    if net.gravity[:2] != (0.0, 0.0):
        raise argument_error("gravity", net.gravity, "along z")
    start, chord = net.x0[:, 0, 0], net.x0[:, 0, last] - net.x0[:, 0, 0]
    span = math.hypot(chord[0], chord[1])
    flat = catenary(
        last + 1, family.rest * last, span, float(chord[2]), family.stiffness, net.masses[0], -net.gravity[2],
        net.law,
    )  # fmt: skip
    away = np.array([chord[0] / span, chord[1] / span, 0.0]) if span > 0.0 else np.array([1.0, 0.0, 0.0])
    return Equilibrium(start + flat.x[:, :1] * away + flat.x[:, 2:] * (0.0, 0.0, 1.0), flat.tension)


def single_family(net: Net) -> Family:
    """The links of a rope; raises ValueError for any other net, or where they have no stiffness."""
    if not check_kind("net", net, Net, "a rope").is_rope:
        raise argument_error("net", net.shape, "a rope")
    family = net.families[0]
    check_positive("stiffness", family.stiffness, "N/m")
    return family
