"""Six degrees of freedom for many bodies: pressure of two fluids, added mass, drag, pulls and collisions.

Of body i, where all but the drag and the fluid are in its own principal directions:

  (m + A) dv/dt = F_p + m g + A a_f - drag(v - u) + pull,     (I + J) dw/dt = M_p - drag(w) + pull

F_p, M_p are the exact integrals of the hydrostatic pressure over the wet hull (hydrostatics.py) under the surface
of `Water`, in the gravity g + a that a particle riding the surface feels (a its upward acceleration). The fluid
there accelerates at a_f = (-(g + a) slope, a), as linear waves do at their surface, so that a small hull that
displaces its weight moves as the fluid does: its response to a long wave is 1. A, J are the added masses in the
proportion in which the hull's surface is wet; drag per axis is rho S/2 (b v + C |v| v/2) with S the wetted area.

A hull that wets more of its surface shares its momentum with the fluid that it begins to carry,
(m + A)(v - u) = const (von Karman 1929, NACA TN 321); a hull that leaves the water gets nothing back. So a change of
A takes energy and never gives any.

**Step.** Leapfrog, half a drift, the kick, half a drift: forces at the middle of the substep change the velocity.
Buoyancy alone is explicit; drag is solved exactly over the step and the pull implicitly, so neither limits it. The
limit is omega h < 2 with omega the fastest heave or roll, the period is short by (omega h)^2/24, and the energy
error stays bounded. Since F_p and A decrease together as a hull leaves the water, omega is bounded whatever the density
(`frequency_bound`), and `step` divides the frame until omega h <= MAX_PHASE, for each body on its own. Rotation sets
no limit: each drift keeps the angular momentum of the solid, so that spin stays bounded.

Not modelled: waves that a body made and that act back on it (the linear drag stands for their loss), the decay of the
wave's pressure with depth beyond first order, coupling of added masses between axes and their moment at steady speed
(Munk), air.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.floating.body import Fleet
from sim.floating.body_collisions import collide
from sim.floating.fluid_state import Water
from sim.floating.hydrostatics import add_pressure
from sim.floating.rigid import add_pull, after_drag, drift, make_scratch, set_inverse, set_rotation
from sim.jit import kernel
from sim.validation import argument_error

MAX_PHASE = 0.4  # of omega h in a substep: periods are within 0.7 %, and waves may add to gravity
MAX_SUBSTEPS = 512  # of a body in one call of `step`


class MotionCoefficients(NamedTuple):
    """The coefficients of motion, one set for all bodies."""

    gravity: float = 9.81  # [m/s2]
    linear_drag: float = 0.3  # b [m/s]: loss to waves; 0.24 for a hemisphere of 1 m at 1 rad/s (Capytaine: 379 kg/s)
    quadratic_drag: float = 1.0  # C, of a bluff body
    added_mass: float = 1.0  # factor on the values of added_mass.py
    restitution: float = 0.3  # of collisions
    pull_rate: float = 12.0  # [rad/s] of the critically damped pull


STANDARD = MotionCoefficients()
LIMITS = {
    "gravity": (1e-3, 1e4, "m/s2"), "linear_drag": (0.0, 1e6, "m/s"), "quadratic_drag": (0.0, 1e6, ""),
    "added_mass": (0.0, 100.0, ""), "restitution": (0.0, 1.0, ""), "pull_rate": (0.0, 1e4, "rad/s"),
}  # fmt: skip


def frequency_bound(fleet: Fleet, density: float, coefficients: MotionCoefficients) -> np.ndarray:
    """Upper bound (n,) [rad/s] of the frequencies of each body in fluid of at most `density` [kg/m3].

    Along axis i the force changes with depth by at most rho g S_i/2, with S_i the wetted area of the whole hull, and
    the added mass is at least in proportion to the area that is wet: omega^2 <= rho g S_i/2 / (m + rho a_i/2). About
    the axis the same holds with the bound of the restoring moment, where the mean of two shares may be half the
    greater one. The sum bounds any coupling of the two.
    """
    hulls, q = fleet.hulls, fleet.hull
    weight = density * coefficients.gravity
    carried = coefficients.added_mass * density / 2
    heave = weight * hulls.wetted_area[q] / 2 / (fleet.mass[:, None] + carried * hulls.added_mass[q])
    inertia = fleet.density[:, None] * np.einsum("qii->qi", hulls.inertia)[q]
    roll = weight * hulls.restoring_bound[q] / (inertia + carried * hulls.added_inertia[q] / 2)
    return np.sqrt(heave.max(axis=1, initial=0.0) + roll.max(axis=1, initial=0.0))


def step(
    fleet: Fleet,
    water: Water,
    duration: float,
    coefficients: MotionCoefficients = STANDARD,
    substeps: int | None = None,
) -> int:
    """Advance all bodies by `duration` [s] in place; returns how many pairs touched.

    substeps: the same number for each body, or None for as many as each needs. Raises ValueError for bad arguments
    and FloatingPointError, naming the body, where a state is no longer finite; the fleet is then as it was.
    """
    for name, (low, high, unit) in LIMITS.items():
        if not low <= getattr(coefficients, name) <= high:
            raise argument_error(name, getattr(coefficients, name), f"{low:g} to {high:g} {unit}".rstrip())
    if not 0 < duration < math.inf:
        raise argument_error("duration", duration, "above 0 s, finite")
    if len(water.height) != len(fleet.mass):
        raise argument_error("water", f"{len(water.height)} samples", f"one for each of {len(fleet.mass)} bodies")
    if not 0 < water.upper <= water.lower < math.inf:
        raise argument_error("water", (water.upper, water.lower), "densities above 0, the lower at least the upper")
    if substeps is None:
        bound = frequency_bound(fleet, water.lower, coefficients)
        count = np.ceil(np.maximum(duration * bound / MAX_PHASE, 1.0))
        greatest = count.max(initial=1.0)
        if not greatest <= MAX_SUBSTEPS:
            longest = duration * MAX_SUBSTEPS / greatest
            raise argument_error("duration", duration, f"at most {longest:.3g} s for bodies this stiff")
        counts = count.astype(np.int64)
    elif substeps >= 1:
        counts = np.full(len(fleet.mass), int(substeps), dtype=np.int64)
    else:
        raise argument_error("substeps", substeps, "a whole number from 1")
    state = fleet[:7]
    before = [array.copy() for array in state]
    advance(fleet, water, MotionCoefficients(*(float(value) for value in coefficients)), counts, float(duration))
    # Checked here and not in the kernel: its compiler may take x - x for 0, and with that a NaN for finite.
    finite = np.isfinite(np.column_stack(state)).all(axis=1)
    if not finite.all():
        failed = int(np.argmin(finite))
        place = before[0][failed].tolist()
        for array, old in zip(state, before, strict=True):
            array[:] = old
        raise FloatingPointError(f"body {failed}: its state is no longer finite; it was at {place} m")
    return collide(fleet, float(coefficients.restitution))


@kernel
def advance(fleet, water, coefficients, counts, duration):
    """Advance every body by `duration` [s] on its own, each in as many substeps as counts (n,) says."""
    depth = np.empty((2, fleet.hulls.x.shape[1]))
    scratch = make_scratch()
    for i in range(fleet.mass.size):
        h = duration / counts[i]
        for s in range(counts[i]):
            set_rotation(fleet.rotation, i, scratch.R)
            drift(fleet, i, h / 2.0, scratch)
            set_load(fleet, water, i, (s + 0.5) * h, coefficients.gravity, depth, scratch)
            kick(fleet, water, coefficients, i, h, scratch)
            drift(fleet, i, h / 2.0, scratch)


@kernel
def felt_gravity(water, i, gravity):
    """g + a [m/s2] that a particle riding the surface feels; a surface in free fall presses on nothing."""
    return max(gravity + water.acceleration[i], 0.0)


@kernel
def set_load(fleet, water, i, t, gravity, depth, scratch):
    """Set force, moment and wetted (3,) of the fluids' pressure on body i, in body axes.

    t [s] is the time since the frame began: the surface rises meanwhile as the fluid does. depth (2, n) is scratch.
    """
    hulls, q, R, pressure = fleet.hulls, fleet.hull[i], scratch.R, scratch.pressure
    first, last = hulls.vertex_start[q], hulls.vertex_start[q + 1]
    first_face, last_face = hulls.face_start[q], hulls.face_start[q + 1]
    scratch.force[:] = 0.0
    scratch.moment[:] = 0.0
    scratch.wetted[:] = 0.0
    pressure[:] = 0.0
    fleet.wet_volume[i] = 0.0
    dx, dy = fleet.position[i, 0] - water.at[i, 0], fleet.position[i, 1] - water.at[i, 1]
    sx, sy = water.slope[i, 0], water.slope[i, 1]
    # kinematic condition at the surface: d eta/dt = w - u . slope
    rise = water.velocity[i, 2] - water.velocity[i, 0] * sx - water.velocity[i, 1] * sy
    top = water.height[i] + sx * dx + sy * dy + rise * t - fleet.position[i, 2]
    level = water.relief.size == 0 and water.interface_relief.size == 0
    if level and top < -hulls.radius[q] * np.sqrt(1.0 + sx * sx + sy * sy):
        return  # the body is in the air
    set_depth(hulls.x, first, last, R, top, sx, sy, depth[0])
    start = fleet.vertex_start[i] - first
    if water.relief.size > 0:
        for v in range(first, last):
            depth[0, v] += water.relief[start + v]
    g = felt_gravity(water, i, gravity)
    add_pressure(hulls.x, hulls.faces, hulls.area, first_face, last_face, depth[0], water.upper, pressure)
    # int d n_z dA over the wet surface is the volume below the surface, with the sign of the outward normal
    upper = -(R[2, 0] * pressure[0] + R[2, 1] * pressure[1] + R[2, 2] * pressure[2])
    fleet.wet_volume[i, 0] = upper / water.upper
    if water.lower > water.upper:
        sx, sy = water.interface_slope[i, 0], water.interface_slope[i, 1]
        top = water.interface[i] + sx * dx + sy * dy + water.interface_rise[i] * t - fleet.position[i, 2]
        set_depth(hulls.x, first, last, R, top, sx, sy, depth[1])
        if water.interface_relief.size > 0:
            for v in range(first, last):
                depth[1, v] += water.interface_relief[start + v]
        for v in range(first, last):  # where the interface is above the surface there is no upper fluid
            depth[1, v] = min(depth[1, v], depth[0, v])
        difference = water.lower - water.upper
        add_pressure(hulls.x, hulls.faces, hulls.area, first_face, last_face, depth[1], difference, pressure)
        both = -(R[2, 0] * pressure[0] + R[2, 1] * pressure[1] + R[2, 2] * pressure[2])
        fleet.wet_volume[i, 1] = (both - upper) / difference
        fleet.wet_volume[i, 0] -= fleet.wet_volume[i, 1]
    for c in range(3):
        scratch.force[c] = -g * pressure[c]
        scratch.moment[c] = -g * pressure[3 + c]
        scratch.wetted[c] = pressure[6 + c]


@kernel(noalias=True)
def set_depth(x, first, last, R, top, sx, sy, depth):
    """Set depth (n,) [m] of vertices first to last of x (3, n) below a plane.

    The plane has slope (sx, sy) and is `top` [m] above the body's centre; R (3, 3) takes x to world axes.
    """
    # eta - z = top + (sx, sy, -1) . R x
    gx = sx * R[0, 0] + sy * R[1, 0] - R[2, 0]
    gy = sx * R[0, 1] + sy * R[1, 1] - R[2, 1]
    gz = sx * R[0, 2] + sy * R[1, 2] - R[2, 2]
    for v in range(first, last):
        depth[v] = top + gx * x[0, v] + gy * x[1, v] + gz * x[2, v]


@kernel
def kick(fleet, water, coefficients, i, h, scratch):
    """Change velocity and spin of body i by the forces of one substep of h [s]."""
    R, v, w = scratch.R, scratch.v, scratch.w
    force = scratch.force
    fleet.buoyancy[i] = R[2, 0] * force[0] + R[2, 1] * force[1] + R[2, 2] * force[2]
    set_velocity(fleet, water, coefficients, i, h, scratch)
    set_angular_velocity(fleet, coefficients, i, h, scratch)
    if fleet.pull_limit[i] > 0.0:
        add_pull(fleet, i, h, coefficients.pull_rate, scratch)
    for c in range(3):
        fleet.velocity[i, c] = R[c, 0] * v[0] + R[c, 1] * v[1] + R[c, 2] * v[2]
        fleet.spin[i, c] = R[c, 0] * w[0] + R[c, 1] * w[1] + R[c, 2] * w[2]


@kernel
def set_velocity(fleet, water, coefficients, i, h, scratch):
    """Set mass (3,), and v (3,) after h [s] of forces and drag on body i; keep what is wet for the next substep."""
    R, mass, v, force, wetted = scratch.R, scratch.mass, scratch.v, scratch.force, scratch.wetted
    hulls, q, m = fleet.hulls, fleet.hull[i], fleet.mass[i]
    g = felt_gravity(water, i, coefficients.gravity)
    ax, ay, az = -g * water.slope[i, 0], -g * water.slope[i, 1], water.acceleration[i]
    u0, u1, u2 = water.velocity[i, 0], water.velocity[i, 1], water.velocity[i, 2]
    v0, v1, v2 = fleet.velocity[i, 0], fleet.velocity[i, 1], fleet.velocity[i, 2]
    for c in range(3):
        added_per_wetted = coefficients.added_mass * hulls.added_mass[q, c] / hulls.wetted_area[q, c]
        mass[c] = m + added_per_wetted * wetted[c]
        wets_more = 0.0 <= fleet.wetted[i, c] < wetted[c]  # then momentum is shared with the fluid it begins to carry
        momentum_share = (m + added_per_wetted * fleet.wetted[i, c]) / mass[c] if wets_more else 1.0
        fleet.wetted[i, c] = wetted[c]
        fluid_acceleration = R[0, c] * ax + R[1, c] * ay + R[2, c] * az
        total = force[c] - m * coefficients.gravity * R[2, c] + (mass[c] - m) * fluid_acceleration
        flow = R[0, c] * u0 + R[1, c] * u1 + R[2, c] * u2
        relative = momentum_share * (R[0, c] * v0 + R[1, c] * v1 + R[2, c] * v2 - flow) + h * total / mass[c]
        drag = wetted[c] / 2.0 / mass[c]
        v[c] = flow + after_drag(relative, coefficients.linear_drag * drag, coefficients.quadratic_drag / 2.0 * drag, h)


@kernel
def set_angular_velocity(fleet, coefficients, i, h, scratch):
    """Set inertia and inverse_inertia (3, 3), and w (3,) after h [s] of moments and drag on body i."""
    R, w, moment, wetted = scratch.R, scratch.w, scratch.moment, scratch.wetted
    inertia, inverse = scratch.inertia, scratch.inverse_inertia
    hulls, q = fleet.hulls, fleet.hull[i]
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        share = (wetted[a] / hulls.wetted_area[q, a] + wetted[b] / hulls.wetted_area[q, b]) / 2.0
        for d in range(3):
            inertia[c, d] = fleet.density[i] * hulls.inertia[q, c, d]
        inertia[c, c] += coefficients.added_mass * hulls.added_inertia[q, c] * share
    set_inverse(inertia, inverse)
    w0, w1, w2 = fleet.spin[i, 0], fleet.spin[i, 1], fleet.spin[i, 2]
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        undragged = R[0, c] * w0 + R[1, c] * w1 + R[2, c] * w2
        undragged += h * (inverse[c, 0] * moment[0] + inverse[c, 1] * moment[1] + inverse[c, 2] * moment[2])
        # a face wet over S that rotates about an axis at radius r: drag S r^2 w, S r^3 |w| w
        ra, rb = hulls.radius_of_gyration[q, a], hulls.radius_of_gyration[q, b]
        linear = (wetted[a] * rb * rb + wetted[b] * ra * ra) / 2.0 / inertia[c, c]
        quadratic = (wetted[a] * rb**3 + wetted[b] * ra**3) / 2.0 / inertia[c, c]
        w[c] = after_drag(
            undragged, coefficients.linear_drag * linear, coefficients.quadratic_drag / 2.0 * quadratic, h
        )
