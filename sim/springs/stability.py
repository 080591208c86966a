"""Largest stable step of a net: its extreme modes, and each integrator's limit at their damping.

Explicit integrators blow up from the top of the spectrum, a sawtooth along the links. An integrator declares the
largest stable step of an oscillator of any frequency and damping rate, so a net's largest stable step is the least of
these over the modes that can become unstable first: the stiffest, the most damped, and one across the links. With
isotropic damping that is the most damped transverse mode. It is damped as strongly as a longitudinal one, but less
stiff, so that in a soft rope it is the more overdamped. With axial damping it is the stiffest transverse mode. Each
mode's damping is its Rayleigh quotient, exact where D is a combination of K and M, as along a straight rope. Where D is
no such combination, as in a cloth, two more modes lie between the stiffest and the most damped one, and the step is
right to 1 % (`springtide stability`). Explicit Euler's limit depends on the least damped of all modes and is only a
guide.

Stable is not yet right. Beside the stable step stands the one up to which a method is right to 1 %, of the damping and
the oscillation of the motion that gravity causes (`sim.springs.analysis.accuracy`). That motion is one of a few smooth
modes, as the net's weight in any direction moves them. What no spring holds swings as a pendulum of the net's size.

A net that is about to land has stiffer modes when it has. `landed_modes` estimates them from the present ones. Contact
of the net with itself is that of the present state.

Each link is given the stiffness it would have at the largest strain now present in the net: a slack line is about to be
taut, and a wave carries the strain of one link of a stiffening rope to the others. Larger strains later need a shorter
step.
"""

import functools
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.numerics.root import narrowed
from sim.springs.analysis.accuracy import (
    STILL,
    Motion,
    coarse_shapes,
    longest_accurate,
    motion_errors,
    motion_of,
)
from sim.springs.analysis.strain import strain_range
from sim.springs.forces import OWN
from sim.springs.forces.matrices import DAMPING, FRICTION, STIFFEST, TRANSVERSE
from sim.springs.integrators import Integrator, discover, integrator_named
from sim.springs.integrators.implicit.tangent import has_friction, lanczos, products, quotients
from sim.springs.laws import largest_stiffness
from sim.springs.near.near_pairs import count_touching
from sim.springs.net import Net
from sim.springs.points.cells import faces
from sim.springs.points.each_link import TINY
from sim.springs.points.face_places import FACE_PART, face_reach
from sim.springs.points.line_arrays import LineArrays
from sim.springs.points.point_system import PointSystem, check_system
from sim.springs.state import State, check_state
from sim.validation import check_kind, check_positive

VECTORS = 32  # of Lanczos: the stiffest frequency to 0.1 % on nets of any size
TOUCHING = 12  # equal spheres that can touch one of them
SLIDING = (0.0, 0.5, 1.0)  # shares of a landed mode; the shortest of their steps limits
LEAST_SLIDING = 1e-6  # below, friction does not count
SAME = 1.0 - 1e-6  # product of two unit vectors that are one
ROUNDS = 2  # of the fastest overdamped mode, which is then right to 0.1 %
STIFF = 0.4  # omega^2 over the largest one, above which a less damped mode may become unstable first
DAMPED = 0.2  # damping ratio of the stiffest mode of a net, below which it is the first
SECANTS = 8  # most of them, to 1e-4 of a step
NEARLY = 1e-7  # relative width at which the search for a stiffness ends
TOLERANCE = 0.01  # relative error of oscillation and damping up to which a step is right
SHAPES_ALONG, SHAPES_ACROSS = 12, 4  # coarse shapes of the motion along a rope, and along each side of a cloth
FURTHER, LARGEST_RATIO = 4.0, 3.0  # ratio of the ends of its steps, and the logarithm of the largest first one


class Mode(NamedTuple):
    """A vibration that may exceed an integrator's limit first."""

    stiffness: float  # u K u / u M u = omega^2 [1/s^2]
    links: float  # the links' part of it [1/s^2]
    rate: float  # gamma = u D u / u M u = 2 zeta omega [1/s]
    sliding: float = 0.0  # share of u M u that slides on floor or sphere, which friction damps at up to 1/h
    mixed: bool = False  # its form depends on how much stiffness and damping weigh

    @property
    def omega(self) -> float:
        """[rad/s]; 0 if only damping acts."""
        return math.sqrt(max(self.stiffness, 0.0))

    @property
    def zeta(self) -> float:
        """Without friction; infinite if only damping acts."""
        if self.omega > 0.0:
            return 0.5 * self.rate / self.omega
        return math.inf if self.rate > 0.0 else 0.0

    def with_links(self, scale: float) -> "Mode":
        """The same vibration with every link `scale` times as stiff."""
        return self._replace(stiffness=self.stiffness + (scale - 1.0) * self.links, links=scale * self.links)


class Gauge(NamedTuple):
    """The mode nearest to its limit, for the live display."""

    omega: float  # [rad/s]; 0 if only damping acts
    zeta: float  # infinite if only damping acts
    h_omega: float
    limit: float  # largest stable h omega at this zeta
    critical_step: float  # [s]
    step: float  # h [s]
    highest: float  # highest frequency of the net [rad/s], at which another method may be nearest to its limit
    accurate_step: float = math.nan  # [s] up to which the method is right; NaN: not assessed
    error: float = math.nan  # relative error of oscillation and damping at `step`; NaN: not assessed
    accurate_method: str = ""  # where the method is stable but not right: one that is both at `step`, or ""
    landed_step: float = math.inf  # [s] estimate of the largest stable step in contact with floor or sphere

    @property
    def share(self) -> float:
        """The step over the largest stable one: above 1 the motion grows."""
        return self.step / self.critical_step if self.critical_step > 0.0 else math.inf

    @property
    def is_too_long_landed(self) -> bool:
        """True if the step is stable now, but by estimate not where all points touch floor or sphere."""
        return self.share <= 1.0 and self.step > self.landed_step

    @property
    def is_wrong(self) -> bool:
        """True if the step is stable, but its oscillation or damping is not right to `TOLERANCE`."""
        return self.share <= 1.0 and self.error > TOLERANCE


def most_touching(net: Net, x: NDArray[np.float64] | None) -> int:
    """Largest number of others that a particle, or two links of a chain, touch at x (3, rows, cols) [m].

    Without x it is the number of equal spheres that touch one.
    """
    if x is None:
        return TOUCHING
    touching = np.zeros(x[0].size, np.int64)
    count_touching(np.ascontiguousarray(x).reshape(-1), net.kernel_view(1.0), touching)
    raise_if_stopped()
    return int(touching.max()) * (2 if net.is_chain else 1)


def faces_are_near(net: Net, x: NDArray[np.float64]) -> bool:
    """False if no face of a cloth at x (3, rows, cols) [m] touches the sphere, where that stands at the net's epoch."""
    p = net.kernel_view(1.0)
    return bool(face_reach(np.ascontiguousarray(x).reshape(-1), p.epoch, p) > 0.0)


def sphere_depth(net: Net) -> float:
    """Largest factor of the sphere's damping: of the lab's law the depth, which no bound holds below the radius.

    1 with the other law.
    """
    return max(1.0, net.sphere[3] + net.radius) if net.sphere and net.contact.law == "lab" else 1.0


def gershgorin(net: Net, x: NDArray[np.float64] | None = None) -> tuple[float, float]:
    """Upper bounds of frequency [rad/s] and damping rate [1/s], from Gershgorin's discs: of springs in any state, of
    links that stiffen in those whose links are stretched no more than the most stretched at x (None: x0).

    omega^2 <= max_i (2 sum_j k_ij + contact + grab)/m_i and gamma <= max_i (2 sum_j b_ij + drag + contact + grab)/m_i,
    the first tight for a long uniform rope, 4 k/m. Of a net's contact with itself as many others push a particle as
    touch one at x (3, rows, cols) [m] or, without x, as equal spheres can; no face of a cloth, if none touches the
    sphere at x. Air and friction are left out, and the motion of the place at which a turning link or face touches the
    sphere.
    """
    rows, cols = net.shape
    stiffness, damping = np.zeros((2, rows, cols))
    reach = largest_stiffness(net.law, *strain_range(net, net.x0 if x is None else x))
    for f in net.families:
        i, j = slice(0, max(0, rows - f.di)), slice(max(0, -f.dj), max(0, cols - max(0, f.dj)))
        ratios = net.link_ratios(f.di, f.dj)
        far = slice(f.di, rows), slice(j.start + f.dj, max(0, j.stop + f.dj))
        for end in ((i, j), far):
            stiffness[end] += 2.0 * reach * f.stiffness * ratios
            damping[end] += 2.0 * f.damping * ratios
    # A point between links or faces that touch the sphere has the force of all.
    on_sphere = (net.sphere is not None) * (2.0 if net.links_touch else 1.0)
    if net.faces_touch and (x is None or faces_are_near(net, x)):
        on_sphere += FACE_PART * np.bincount(faces(rows, cols).ravel(), minlength=rows * cols).reshape(rows, cols)
    damping += net.drag + ((net.floor is not None) + on_sphere * sphere_depth(net)) * net.contact.damping
    stiffness += ((net.floor is not None) + on_sphere) * net.contact.stiffness
    if net.thickness > 0.0:
        touching = most_touching(net, x)
        damping += 2.0 * touching * net.contact.damping
        stiffness += 2.0 * touching * net.contact.stiffness
    if net.grab is not None:
        stiffness[net.grab.row, net.grab.col] += net.grab.stiffness
        damping[net.grab.row, net.grab.col] += net.grab.damping
    for numbers in net.forces:
        most_stiffness, most_damping = OWN[type(numbers)].bound(numbers)
        stiffness += most_stiffness
        damping += most_damping
    free = net.inverse_masses().reshape(rows, cols)
    return math.sqrt(float((free * stiffness).max())), float((free * damping).max())


def sawtooth(x: NDArray[np.float64], p: Any) -> NDArray[np.float64]:
    """A unit vector (3 rows cols,) near the stiffest mode: neighbours move against each other along their links.

    A rope's top mode is almost exactly a sawtooth, so that Lanczos starts close to its result. The fixed noise keeps
    other stiff parts, such as a point in contact, from being orthogonal to the start.
    """
    u = 0.1 * np.random.default_rng(0).standard_normal(x.shape)
    u += against_along_lines(x, p) if isinstance(p, LineArrays) else against_along_rows(x)
    free = p.inverse_masses > 0.0
    if isinstance(p, LineArrays):
        free[p.nodes :] = True  # bodies
    flat = u.reshape(3, -1) * free
    return flat.ravel() / max(math.sqrt(float((flat * flat).sum())), 1e-300)


def against_along_rows(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Moves (3, rows, cols) of neighbours against each other along rows and columns at x (3, rows, cols)."""
    rows, cols = x.shape[1:]
    u = np.zeros_like(x)
    alternating = (-1.0) ** np.add.outer(np.arange(rows), np.arange(cols))
    for axis, count in ((1, rows), (2, cols)):
        if count > 1:
            along = np.gradient(x, axis=axis)
            u += alternating * along / np.sqrt((along * along).sum(axis=0) + 1e-300)
    return u


def against_along_lines(x: NDArray[np.float64], p: LineArrays) -> NDArray[np.float64]:
    """The same (3, n) of the nodes of lines at x (3, n), whose links follow each other in their table."""
    start, end = p.ends.T
    along = x[:, end] - x[:, start]
    along *= (-1.0) ** np.arange(len(start)) / np.sqrt((along * along).sum(axis=0) + 1e-300)
    u = np.zeros_like(x)
    np.add.at(u.T, end, along.T)
    np.subtract.at(u.T, start, along.T)
    return u


def across(x: NDArray[np.float64], p: Any) -> NDArray[np.float64]:
    """The same, (3 rows cols,), at right angles to the links of a net, where they are least stiff."""
    rows, cols = x.shape[1:]
    along = np.gradient(x, axis=2) if cols > 1 else np.gradient(x, axis=1)
    other = np.gradient(x, axis=1) if min(rows, cols) > 1 else np.zeros_like(x)
    # A rope has no second direction: any other direction will do.
    least = np.zeros(3)
    least[int(np.abs(along).sum(axis=(1, 2)).argmin())] = 1.0
    normal = np.cross(along, other if other.any() else least[:, None, None], axis=0)
    alternating = (-1.0) ** np.add.outer(np.arange(rows), np.arange(cols))
    flat = (alternating * normal / np.sqrt((normal * normal).sum(axis=0) + 1e-300)).reshape(3, -1) * (
        p.inverse_masses > 0.0
    )
    return flat.ravel() / max(math.sqrt(float((flat * flat).sum())), 1e-300)


def ritz(
    x: NDArray[np.float64], start: NDArray[np.float64], t: float, p: Any, part: int, stiff: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Lanczos from `start`: rising eigenvalues (m,) of `part` of the tangent about x and `stiff` times STIFFEST; their
    vectors are the columns of the second (m, m), in terms of the rows of the third (m, 3 rows cols)."""
    raise_if_stopped()
    basis, diagonal, beside = lanczos(x, start, t, p, part, stiff, min(VECTORS, x.size))
    across = np.diag(beside, 1)
    values, vectors = np.linalg.eigh(np.diag(diagonal) + across + across.T)
    return values, vectors, basis


def top_vector(
    x: NDArray[np.float64], start: NDArray[np.float64], t: float, p: Any, part: int, stiff: float = 0.0
) -> NDArray[np.float64]:
    """The unit vector (3 rows cols,) of the largest eigenvalue of `part` of the tangent about x and `stiff` times
    STIFFEST."""
    _, vectors, basis = ritz(x, start, t, p, part, stiff)
    return vectors[:, -1] @ basis


def stiff_vectors(
    x: NDArray[np.float64], start: NDArray[np.float64], t: float, p: Any
) -> tuple[NDArray[np.float64], list[NDArray[np.float64]]]:
    """The unit vector (3 rows cols,) of the stiffest mode; of lines and of damped nets also those of the next ones.

    Where the stiffest mode is damped near critically, rkn8 may have a longer limit at it than at the next ones, which
    are damped less.
    """
    values, vectors, basis = ritz(x, start, t, p, STIFFEST)
    modes = vectors.T @ basis
    if not isinstance(p, LineArrays):
        stiffness, _, rate, _ = quotients(x, modes[-1:], t, p)[0]
        if rate * rate < 4.0 * DAMPED * DAMPED * stiffness:
            return modes[-1], []
    return modes[-1], [u for u, value in zip(modes[:-1], values, strict=False) if value > STIFF * values[-1]]


def mixed_vectors(
    x: NDArray[np.float64], stiffest: NDArray[np.float64], damped: NDArray[np.float64], t: float, p: Any
) -> list[NDArray[np.float64]]:
    """Unit vectors (3 rows cols,) between the stiffest and the most damped one; none where these are the same.

    One is that of K/omega^2 + D/gamma, on which symplectic Euler's limit hangs near critical damping. The other is of
    the fastest mode beyond it, which every explicit method's limit hangs on: s^2 M u + s D u + K u = 0 of a real s =
    -mu says that mu is an eigenvalue of D - K/mu, the largest one; its Rayleigh quotient rises towards it.
    """
    (stiffness, *_), (_, _, rate, _) = quotients(x, np.stack([stiffest, damped]), t, p)
    if stiffness <= 0.0 or rate <= 0.0 or abs(stiffest @ damped) > SAME:
        return []
    both = stiffest + damped
    vectors = [top_vector(x, both / np.linalg.norm(both), t, p, DAMPING, rate / stiffness)]
    for _ in range(ROUNDS):
        stiffness, _, rate, _ = quotients(x, damped[None], t, p)[0]
        root = 0.5 * rate + math.sqrt(max(0.25 * rate * rate - stiffness, 0.0))
        if root <= 0.0:
            break
        damped = top_vector(x, damped, t, p, DAMPING, -1.0 / root)
    return [*vectors, damped]


def sliding_vector(x: NDArray[np.float64], start: NDArray[np.float64], t: float, p: Any) -> NDArray[np.float64] | None:
    """The unit vector (3 rows cols,) of the stiffest mode that slides on floor or sphere; None if none does.

    The stiffest mode of all may be normal to the surface, where friction does not act.
    """
    begin = products(x, start[None], t, p, FRICTION)[0]
    if not begin.any():
        return None
    values, vectors, basis = ritz(x, begin / np.linalg.norm(begin), t, p, STIFFEST)
    vector, largest = None, 0.0
    for value, mode in zip(values[::-1], vectors.T[::-1] @ basis, strict=True):
        if value <= largest:
            break  # no mode slides by more than all of it
        slides = value * quotients(x, mode[None], t, p)[0, 3]
        if slides > largest:
            vector, largest = mode, slides
    return vector


def is_damped_anywhere(system: PointSystem, p: Any) -> bool:
    """True if anything is damped: links, contacts, the grab, or declared forces."""
    if not isinstance(system, Net):
        return True
    touched = p.has_floor or p.has_sphere or p.grabbed >= 0 or system.thickness > 0.0
    return bool(p.damped or touched or system.forces)


def top_modes(system: PointSystem, x: NDArray[np.float64] | None = None, t: float = 0.0) -> list[Mode]:
    """The stiffest mode about positions x [m] (None: of the start) at time t [s], then the most damped one and, across
    the links, the most damped one again or, of axially damped nets and lines, the stiffest. Where friction acts, the
    last one is the stiffest that slides.

    x: (3, rows, cols) of a net, (3, n) of lines.
    Points that touch floor, sphere or each other, and the grab, count; `sliding` is the sliding fraction of each mode.
    Air, drag in water and friction on the bed do not count.
    Empty if nothing is free to move.
    """
    x = system.start() if x is None else x
    if not np.isfinite(x).all():
        return []
    p = system.kernel_view(1.0)
    start = sawtooth(x, p)
    flat = np.ascontiguousarray(x).reshape(-1)
    if not start.any():
        return []
    stiffest, next_ones = stiff_vectors(flat, start, t, p)
    parts = []
    if is_damped_anywhere(system, p):
        parts.append((DAMPING, start))
    if p.damped:
        parts.append((TRANSVERSE, start) if p.axial else (DAMPING, across(x, p)))
    vectors = [stiffest, *(top_vector(flat, begin, t, p, part) for part, begin in parts), *next_ones]
    mixed = mixed_vectors(flat, vectors[0], vectors[1], t, p) if parts else []
    if isinstance(system, Net) and has_friction(p):
        slides = sliding_vector(flat, start, t, p)
        if slides is not None:
            vectors.append(slides)
    properties = quotients(flat, np.stack(vectors + mixed), t, p).tolist()
    # Across slack links the stiffness is only round-off: no frequency is better than a wrong one.
    floor = 1e-12 * abs(properties[0][0])
    return [
        Mode(stiffness if stiffness > floor else 0.0, links, rate, sliding, i >= len(vectors))
        for i, (stiffness, links, rate, sliding) in enumerate(properties)
    ]


def step_limit(mode: Mode, integrator: Integrator) -> float:
    """Largest stable step [s] of one mode; inf if nothing drives it."""
    free = integrator.stable_step(mode.omega, mode.rate)
    if mode.sliding < LEAST_SLIDING or free == 0.0 or math.isinf(free):
        return free
    # Friction damps by anything up to its strongest, 1/h, which is more the shorter the step is: the limit is where a
    # step is that of its damping. By secants, as a limit of the methods of high order is a search of its own.
    h, before, missed_before = free, 0.0, 0.0
    for _ in range(SECANTS):
        longest = integrator.stable_step(mode.omega, mode.rate + mode.sliding / h)
        if longest == 0.0:
            return 0.0
        missed = longest - h
        if missed >= 0.0 and h == free:
            return free
        if abs(missed) <= 1e-4 * h:
            break
        slope = (missed - missed_before) / (h - before) if before else -1.0
        before, missed_before = h, missed
        h = min(max(h - missed / slope if slope < 0.0 else h + missed, 0.25 * h), 4.0 * h)
    return min(h, free)


def landed_modes(net: Net, modes: list[Mode]) -> list[Mode]:
    """Estimates of a net's top modes where all of its points touch floor or sphere.

    modes: `top_modes` of a state. A contact adds to a mode's omega^2 and damping rate at most those of the lightest
    point (Weyl's inequality), less the stiffness that the mode has beside its links. That is taken for contact with
    floor or sphere, also where it is of the net with itself or of a grab: there the estimate may be too long. Of what
    slides, contact adds friction instead. A light point that is hardly linked swings on its contact alone. Faces of a
    cloth, which a small sphere touches between its points, are left out. Empty without floor and sphere.
    """
    surfaces = max(net.floor is not None, (net.sphere is not None) * (2.0 if net.links_touch else 1.0))
    lightest = float(net.inverse_masses().max(initial=0.0))
    if not surfaces or lightest == 0.0:
        return []
    stiffness = surfaces * lightest * net.contact.stiffness
    rate = surfaces * lightest * net.contact.damping * sphere_depth(net)
    rubs = net.contact.friction > 0.0 and net.contact.law == "clipped"
    landed = [Mode(stiffness, 0.0, rate)]
    for mode in modes:
        missing = min(max(stiffness - (mode.stiffness - mode.links), 0.0), stiffness) / max(stiffness, TINY)
        for slides in SLIDING if rubs else (0.0,):
            held = missing * (1.0 - slides)
            landed.append(
                mode._replace(
                    stiffness=mode.stiffness + held * stiffness, rate=mode.rate + held * rate,
                    sliding=max(slides, mode.sliding),
                )
            )  # fmt: skip
    return landed


def modes_at(system: PointSystem, state: State | None) -> list[Mode]:
    """The `top_modes` of a state, None: of the start. Raises ValueError for a state of another system."""
    if state is None:
        check_system(system)
    else:
        check_state(system, state)
    return top_modes(system) if state is None else top_modes(system, state.x, state.t)


def critical_step(
    system: PointSystem, integrator: str | Integrator, state: State | None = None, *, landed: bool = False
) -> float:
    """The largest step [s] at which small disturbances of `state` do not grow.

    system: a net or mooring lines. state: None: a net as it was built, or lines in their state of rest. landed: True:
    nor where all points of the net touch floor or sphere; an estimate (`landed_modes`).
    0 if every step is unstable (undamped explicit Euler), inf if none is. Raises ValueError for an unknown
    integrator, and ConvergenceError for lines without a state of rest.

    >>> from sim.springs import critical_step, rope
    >>> round(critical_step(rope(points=10, stiffness=800.0), "leapfrog"), 4)  # [s]
    0.0358
    """
    record = integrator_named(integrator)
    check_kind("landed", landed, bool, "True or False")
    modes = modes_at(system, state)
    more = landed_modes(system, modes) if landed and isinstance(system, Net) else []
    return min((step_limit(mode, record) for mode in modes + more), default=math.inf)


def moved_modes(system: PointSystem, x: NDArray[np.float64] | None = None, t: float = 0.0) -> Motion:
    """The modes about positions x [m] (None: of the start) at time t [s] that a pull on all masses alike moves.

    x: (3, rows, cols) of a net, (3, n) of lines. No modes if nothing is free to move, or nothing holds it.
    """
    x = system.start() if x is None else x
    if not np.isfinite(x).all():
        return STILL
    p = system.kernel_view(1.0)
    flat = np.ascontiguousarray(x).reshape(-1)
    if isinstance(p, LineArrays):
        root_mass = np.sqrt(np.where(p.inverse_masses > 0.0, p.mass, 0.0))
        root_mass[p.nodes :: 2] = np.sqrt(p.mass[p.nodes :: 2])  # displacements of bodies
        loads = np.tile(root_mass, 3)[None]
        if not loads.any():
            return STILL
        shapes = ritz(flat, loads[0] / np.linalg.norm(loads), t, p, STIFFEST)[2]
    else:
        root_mass = np.divide(
            1.0, np.sqrt(p.inverse_masses), out=np.zeros_like(p.inverse_masses), where=p.inverse_masses > 0.0
        )
        loads = np.kron(np.eye(3), root_mass)
        rows, cols = x.shape[1:]
        most = SHAPES_ACROSS if min(rows, cols) > 1 else SHAPES_ALONG
        smooth = np.kron(coarse_shapes(rows, most), coarse_shapes(cols, most)) * root_mass
        smooth = smooth[smooth.any(axis=1)]
        if not len(smooth):
            return STILL
        shapes = np.kron(np.eye(3), smooth)
    stiff, damped = (products(flat, shapes, t, p, part) for part in (STIFFEST, DAMPING))
    span = float(np.ptp(x.reshape(3, -1), axis=1).max())
    return motion_of(shapes, stiff, damped, loads, math.hypot(p.gx, p.gy, p.gz) / span if span > 0.0 else 0.0)


def motion_at(system: PointSystem, state: State | None) -> Motion:
    """The `moved_modes` of a state, None: of the start."""
    return moved_modes(system) if state is None else moved_modes(system, state.x, state.t)


def accurate_step(
    system: PointSystem, integrator: str | Integrator, state: State | None = None, tolerance: float = TOLERANCE
) -> float:
    """The step [s] up to which a method is right: stable, with an error of at most `tolerance`.

    The error is that of oscillation and damping in the motion that gravity causes about `state`, relative to both: the
    mean over its modes, each weighted by how far the weight of the net displaces it (`sim.springs.analysis.accuracy`).
    Ripples that gravity does not cause do not count, nor does a delay by up to a step.

    system: a net or mooring lines. state: None: a net as it was built, or lines in their state of rest.
    0 if no step is right, inf if every step is. Raises ValueError for an unknown integrator or a tolerance that is not
    above 0, and ConvergenceError for lines without a state of rest.

    >>> from sim.springs import accurate_step, rope
    >>> round(accurate_step(rope(points=10, stiffness=800.0), "implicit_euler"), 4)  # [s]
    0.0077
    """
    check_positive("tolerance", tolerance, "")
    record = integrator_named(integrator)
    longest = critical_step(system, record, state)
    return longest_accurate(record.changes, motion_at(system, state), longest, tolerance)


def accurate_methods(
    system: PointSystem, h: float, state: State | None = None, tolerance: float = TOLERANCE
) -> tuple[str, ...]:
    """The methods that are right at steps of h [s], see `accurate_step`: the cheapest first.

    system, state: as of `accurate_step`. Raises ValueError for a step or a tolerance that is not above 0.

    >>> from sim.springs import accurate_methods, rope
    >>> accurate_methods(rope(points=10, stiffness=800.0), 1 / 60)[0]
    'leapfrog'
    """
    check_positive("h", h, "s")
    check_positive("tolerance", tolerance, "")
    return tuple(accurate_at(modes_at(system, state), motion_at(system, state), h, tolerance))


def accurate_at(modes: list[Mode], motion: Motion, h: float, tolerance: float = TOLERANCE) -> Iterator[str]:
    """The methods that are right at steps of h [s], explicit ones first, of fewer force evaluations first.

    modes, motion: `top_modes` and `moved_modes` of the state.
    """
    is_damped = any(mode.rate > 0.0 for mode in modes)
    for record in sorted(discover().values(), key=lambda r: (r.implicit, r.evals, -r.order)):
        if (
            not (record.undamped_only and is_damped)
            and motion_errors(record.changes, motion, np.array([h]))[0] <= tolerance
            and all(step_limit(mode, record) >= h for mode in modes)
        ):
            yield record.name


def critical_stiffness(
    net: Net, integrator: str | Integrator, h: float, state: State | None = None, modes: list[Mode] | None = None
) -> float:
    """The largest stiffness [N/m] of the stiffest links that is stable at step h [s], all families scaled together.

    0 if none is (h too long for the damping or the contacts), inf if all are; positions stay as they are.
    modes: the `top_modes` of the state, if known.
    Raises ValueError for an unknown integrator or a step that is not above 0.
    """
    record = integrator_named(integrator)
    check_positive("h", h, "s")
    stiffest = max((f.stiffness for f in net.families), default=0.0)
    if stiffest == 0.0:
        net, stiffest, modes = net.with_stiffness(1.0), 1.0, None
    scale = 1.0
    for _ in range(3):
        if modes is None:
            modes = modes_at(net.with_stiffness(scale * stiffest), state)
        factor = largest_scale(modes, record, h)
        scale *= factor
        # Beside a contact, and between stiffness and damping, the vectors change with the links' stiffness: repeat
        # from the new ones.
        alike = all(math.isclose(mode.links, mode.stiffness) and not mode.mixed for mode in modes)
        if scale == 0.0 or math.isinf(scale) or alike or math.isclose(factor, 1.0, rel_tol=10.0 * NEARLY):
            break
        modes = None
    return scale * stiffest


def largest_scale(modes: list[Mode], integrator: Integrator, h: float) -> float:
    """Factor by which the links of `modes` may be stiffer at step h [s]: 0 for under 1e-12, inf for over 1e12.

    Few of the modes ever limit the step: the search asks these, and all of them only where it has ended.
    """

    def margin(among: list[Mode], scale: float) -> float:
        step = min((step_limit(mode.with_links(scale), integrator) for mode in among), default=math.inf)
        return math.log(step / h) if step > 0.0 else -math.inf

    scale, limiting = 1.0, list[Mode]()
    while True:
        first = min(modes, key=lambda mode: margin([mode], scale), default=None)
        if first is None or first in limiting or (limiting and margin([first], scale) >= 0.0):
            return scale if limiting else math.inf
        limiting.append(first)
        scale = last_stable(functools.partial(margin, limiting), scale)
        if math.isinf(scale):  # where another mode still may limit the step
            return last_stable(functools.partial(margin, modes), 1.0)
        if scale == 0.0:
            return 0.0


def last_stable(margin: Callable[[float], float], start: float) -> float:
    """The scale of the links' stiffness at which the margin falls below 0: 0 for under 1e-12, inf for over 1e12.

    margin: the logarithm of the largest stable step over the step, of a scale. start: where the search begins.
    """
    low = high = start
    logarithm = margin(start)
    if abs(logarithm) <= NEARLY:
        return start
    # Undamped, a stable step goes as the inverse root of the stiffness: a little beyond that lies the other end.
    ratio, is_stable = math.exp(min(2.2 * abs(logarithm), LARGEST_RATIO)), logarithm >= 0.0
    while (logarithm >= 0.0) == is_stable:
        low, high = (high, high * ratio) if is_stable else (low / ratio, low)
        logarithm = margin(high if is_stable else low)
        ratio = FURTHER
        if low < 1e-12:
            return 0.0
        if high > 1e12:
            return math.inf
    # Steps go nearly as a power of the stiffness, so secants in the logarithms are quick.
    stable, _ = narrowed(lambda s: -margin(math.exp(s)), math.log(low), math.log(high), NEARLY)
    return math.exp(stable)


def gauge(
    net: Net,
    integrator: str | Integrator,
    h: float,
    state: State,
    modes: list[Mode] | None = None,
    motion: Motion | None = None,
) -> Gauge:
    """h omega of the mode nearest to its limit at step h [s], that limit, and whether the step is right.

    modes, motion: the `top_modes` and `moved_modes` of the state, if known.
    """
    modes = modes_at(net, state) if modes is None else modes
    motion, record = motion_at(net, state) if motion is None else motion, integrator_named(integrator)
    # Explicit Euler's limit depends on the least damped mode, which is not among these estimates.
    estimates = landed_modes(net, modes) if record.limit(0.0) > 0.0 else []
    landed = min((step_limit(mode, record) for mode in estimates), default=math.inf)
    return gauge_of(modes, record, h, motion)._replace(landed_step=landed)


def gauge_of(modes: list[Mode], record: Integrator, h: float, motion: Motion = STILL) -> Gauge:
    """The `gauge` of known modes and motion; 0 without modes. Without a motion, accuracy is not assessed."""
    mode = min(modes, key=lambda mode: step_limit(mode, record), default=Mode(0.0, 0.0, 0.0))
    longest = step_limit(mode, record)
    # Of a mode that slides the damping depends on the step, so that the limit is that of the longest step.
    is_sliding = mode.omega > 0.0 and mode.sliding >= LEAST_SLIDING
    limit = longest * mode.omega if is_sliding else record.limit(mode.zeta)
    reading = Gauge(
        mode.omega, mode.zeta, h * mode.omega, limit, longest, h, max((m.omega for m in modes), default=0.0)
    )
    if not len(motion.omega):
        return reading
    reading = reading._replace(
        accurate_step=longest_accurate(record.changes, motion, longest, TOLERANCE),
        error=float(motion_errors(record.changes, motion, np.array([h]))[0]),
    )
    return reading._replace(accurate_method=next(accurate_at(modes, motion, h), "")) if reading.is_wrong else reading
