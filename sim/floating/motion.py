"""Six degrees of freedom for many bodies: pressure of two fluids, added mass, drag, pulls and collisions.

Body i, all but the drag and the fluid in its own principal directions:

  (m + A) dv/dt = F_p + m g + A a_f - drag(v - u) + pull,     (I + J) dw/dt = M_p - drag(w) + pull

F_p, M_p are the exact integrals of the hydrostatic pressure over the wet hull (hydrostatics.py) under the surface
of `Water`, in the gravity g + a that a particle riding the surface feels (a its upward acceleration). The fluid
there accelerates at a_f = (-(g + a) slope, a), as linear waves do at their surface, so that a small hull that
displaces its weight moves as the fluid does: its response to a long wave is 1. A, J are the added masses in the
proportion the hull's skin is wet; drag per axis is rho S/2 (b v + C |v| v/2) with S the wet skin.

A hull that wets more skin shares its momentum with the fluid it begins to carry, (m + A)(v - u) = const (von Karman
1929, NACA TN 321); one that leaves gets nothing back. So the change of A takes energy and never gives any.

**Step.** Leapfrog, half a drift, the kick, half a drift: forces at the middle of the substep change the velocity.
Explicit in buoyancy alone; drag is solved exactly over the step and the pull implicitly, so neither limits it. The
limit is omega h < 2 with omega the fastest heave or roll, the period is short by (omega h)^2/24, and the energy
error stays bounded. Since F_p and A shrink together as a hull leaves the water, omega is bounded whatever the density
(`stiffest`), and `step` divides the frame until omega h <= PHASE, for each body on its own. Turning has no limit:
each drift keeps the angular momentum of the solid, so that spin stays bounded.

Not modelled: memory of radiated waves (the linear drag stands for it), the decay of the wave's pressure with depth
beyond first order, coupling of added masses between axes and their moment at steady speed (Munk), air.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.floating.body import Fleet
from sim.floating.body_collisions import collide
from sim.floating.fluid_state import Water
from sim.floating.hydrostatics import add_pressure
from sim.floating.rigid import add_pull, drift, set_inverse, set_turn, slowed
from sim.jit import kernel
from sim.validation import argument_error

PHASE = 0.4  # greatest omega h of a substep: periods within 0.7 %, and room for waves that add to gravity
MOST_SUBSTEPS = 512


class Laws(NamedTuple):
    """The coefficients of motion, one set for all bodies."""

    gravity: float = 9.81  # [m/s2]
    linear_drag: float = 0.3  # b [m/s]: waves made; 0.24 for a hemisphere of 1 m at 1 rad/s (Capytaine: 379 kg/s)
    quadratic_drag: float = 1.0  # C, of a bluff body
    added_mass: float = 1.0  # times added_mass.py
    restitution: float = 0.3  # of collisions
    pull_rate: float = 12.0  # [rad/s] of the critically damped pull


STANDARD = Laws()
LIMITS = {
    "gravity": (1e-3, 1e4, "m/s2"), "linear_drag": (0.0, 1e6, "m/s"), "quadratic_drag": (0.0, 1e6, ""),
    "added_mass": (0.0, 100.0, ""), "restitution": (0.0, 1.0, ""), "pull_rate": (0.0, 1e4, "rad/s"),
}  # fmt: skip


def stiffest(fleet: Fleet, density: float, laws: Laws) -> np.ndarray:
    """Upper bound (n,) [rad/s] of the frequencies of each body in fluid of at most `density` [kg/m3].

    Along axis i the force changes with depth by at most rho g S_i/2, S_i the skin, and no less fluid than in
    proportion to the skin that is wet is carried along: omega^2 <= rho g S_i/2 / (m + rho a_i/2). About it the same
    with the bound of the twist, where the mean of two shares may be half the greater one. The sum bounds any
    coupling of the two.
    """
    shapes, q = fleet.shapes, fleet.hull
    weight = density * laws.gravity
    carried = laws.added_mass * density / 2
    along = weight * shapes.skin[q] / 2 / (fleet.mass[:, None] + carried * shapes.along[q])
    inertia = fleet.density[:, None] * np.einsum("qii->qi", shapes.inertia)[q]
    about = weight * shapes.twist[q] / (inertia + carried * shapes.about[q] / 2)
    return np.sqrt(along.max(axis=1, initial=0.0) + about.max(axis=1, initial=0.0))


def step(fleet: Fleet, water: Water, duration: float, laws: Laws = STANDARD, substeps: int | None = None) -> int:
    """Advance all bodies by `duration` [s] in place; returns how many pairs touched.

    substeps: the same number for each body, or None for as many as each needs. Raises ValueError for bad arguments
    and FloatingPointError, naming the body, where a state is no longer finite; the fleet is then as it was.
    """
    for name, (lo, hi, unit) in LIMITS.items():
        if not lo <= getattr(laws, name) <= hi:
            raise argument_error(name, getattr(laws, name), f"{lo:g} to {hi:g} {unit}".rstrip())
    if not 0 < duration < math.inf:
        raise argument_error("duration", duration, "above 0 s, finite")
    if len(water.height) != len(fleet.mass):
        raise argument_error("water", f"{len(water.height)} samples", f"one for each of {len(fleet.mass)} bodies")
    if not 0 < water.upper <= water.lower < math.inf:
        raise argument_error("water", (water.upper, water.lower), "densities above 0, the lower at least the upper")
    if substeps is None:
        count = np.ceil(np.maximum(duration * stiffest(fleet, water.lower, laws) / PHASE, 1.0))
        worst = count.max(initial=1.0)
        if not worst <= MOST_SUBSTEPS:
            longest = duration * MOST_SUBSTEPS / worst
            raise argument_error("duration", duration, f"at most {longest:.3g} s for bodies this stiff")
        counts = count.astype(np.int64)
    elif substeps >= 1:
        counts = np.full(len(fleet.mass), int(substeps), dtype=np.int64)
    else:
        raise argument_error("substeps", substeps, "a whole number from 1")
    state = fleet[:6]
    before = [array.copy() for array in state]
    advance(fleet, water, Laws(*(float(value) for value in laws)), counts, float(duration))
    # here and not in the kernel: its compiler may take x - x for 0, and with that a NaN for finite
    finite = np.isfinite(np.column_stack(state)).all(axis=1)
    if not finite.all():
        failed = int(np.argmin(finite))
        place = before[0][failed].tolist()
        for array, old in zip(state, before, strict=True):
            array[:] = old
        raise FloatingPointError(f"body {failed}: its state is no longer finite; it was at {place} m")
    return collide(fleet, float(laws.restitution))


@kernel
def advance(fleet, water, laws, counts, duration):
    """One frame of every body on its own, each in as many substeps as counts (n,) says."""
    n = fleet.mass.size
    depth = np.empty((2, fleet.shapes.x.shape[1]))
    turn, heavy, light, work = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    load = np.empty(9)
    for i in range(n):
        h = duration / counts[i]
        for s in range(counts[i]):
            set_turn(fleet.rotation, i, turn)
            drift(fleet, i, h / 2.0, turn, light, work)
            set_load(fleet, water, i, (s + 0.5) * h, laws.gravity, turn, depth, load)
            kick(fleet, water, laws, i, h, turn, load, heavy, light, work)
            drift(fleet, i, h / 2.0, turn, light, work)


@kernel
def felt_gravity(water, i, gravity):
    """g + a [m/s2] that a particle riding the surface feels; a surface in free fall presses on nothing."""
    return max(gravity + water.acceleration[i], 0.0)


@kernel
def set_load(fleet, water, i, t, gravity, turn, depth, load):
    """load (9,): force [N] and moment [N m] of the pressure, wet skin times density [kg/m], in body axes.

    t [s] is the time since the frame began: the surface rises meanwhile as the fluid does.
    """
    shapes, q = fleet.shapes, fleet.hull[i]
    first, last = shapes.vertex_start[q], shapes.vertex_start[q + 1]
    load[:] = 0.0
    dx, dy = fleet.position[i, 0] - water.at[i, 0], fleet.position[i, 1] - water.at[i, 1]
    sx, sy = water.slope[i, 0], water.slope[i, 1]
    # kinematic condition at the surface: d eta/dt = w - u . slope
    rise = water.velocity[i, 2] - water.velocity[i, 0] * sx - water.velocity[i, 1] * sy
    top = water.height[i] + sx * dx + sy * dy + rise * t - fleet.position[i, 2]
    flat = water.relief.size == 0 and water.interface_relief.size == 0
    if flat and top < -shapes.radius[q] * np.sqrt(1.0 + sx * sx + sy * sy):
        return  # in the air
    set_depth(shapes.x, first, last, turn, top, sx, sy, depth[0])
    start = fleet.vertex_start[i] - first
    if water.relief.size > 0:
        for v in range(first, last):
            depth[0, v] += water.relief[start + v]
    g = felt_gravity(water, i, gravity)
    add_pressure(shapes.x, shapes.faces, shapes.area, shapes.face_start[q], shapes.face_start[q + 1], depth[0],
                 water.upper, load)  # fmt: skip
    if water.lower > water.upper:
        sx, sy = water.interface_slope[i, 0], water.interface_slope[i, 1]
        top = water.interface[i] + sx * dx + sy * dy + water.interface_rise[i] * t - fleet.position[i, 2]
        set_depth(shapes.x, first, last, turn, top, sx, sy, depth[1])
        if water.interface_relief.size > 0:
            for v in range(first, last):
                depth[1, v] += water.interface_relief[start + v]
        for v in range(first, last):  # an interface above the surface is no thicker than the water there
            depth[1, v] = min(depth[1, v], depth[0, v])
        add_pressure(shapes.x, shapes.faces, shapes.area, shapes.face_start[q], shapes.face_start[q + 1], depth[1],
                     water.lower - water.upper, load)  # fmt: skip
    for c in range(6):
        load[c] *= -g


@kernel(noalias=True)
def set_depth(x, first, last, turn, top, sx, sy, depth):
    """depth of vertices first to last below the plane of slope (sx, sy) that is `top` above the body's centre."""
    # eta - z = top + (sx, sy, -1) . R x
    gx = sx * turn[0, 0] + sy * turn[1, 0] - turn[2, 0]
    gy = sx * turn[0, 1] + sy * turn[1, 1] - turn[2, 1]
    gz = sx * turn[0, 2] + sy * turn[1, 2] - turn[2, 2]
    for v in range(first, last):
        depth[v] = top + gx * x[0, v] + gy * x[1, v] + gz * x[2, v]


@kernel
def kick(fleet, water, laws, i, h, turn, load, heavy, light, work):
    """Change velocity and spin of body i by the forces of one substep. heavy, light, work (3, 3) are scratch."""
    shapes, q, m = fleet.shapes, fleet.hull[i], fleet.mass[i]
    g = felt_gravity(water, i, laws.gravity)
    ax, ay, az = -g * water.slope[i, 0], -g * water.slope[i, 1], water.acceleration[i]
    u0, u1, u2 = water.velocity[i, 0], water.velocity[i, 1], water.velocity[i, 2]
    v0, v1, v2 = fleet.velocity[i, 0], fleet.velocity[i, 1], fleet.velocity[i, 2]
    w0, w1, w2 = fleet.spin[i, 0], fleet.spin[i, 1], fleet.spin[i, 2]
    fleet.buoyancy[i] = turn[2, 0] * load[0] + turn[2, 1] * load[1] + turn[2, 2] * load[2]
    v, w, mass = work[0], work[1], work[2]
    for c in range(3):
        carried = laws.added_mass * shapes.along[q, c] / shapes.skin[q, c]
        mass[c] = m + carried * load[6 + c]
        kept = (m + carried * fleet.wet[i, c]) / mass[c] if 0.0 <= fleet.wet[i, c] < load[6 + c] else 1.0
        fleet.wet[i, c] = load[6 + c]
        fluid = turn[0, c] * ax + turn[1, c] * ay + turn[2, c] * az
        force = load[c] - m * laws.gravity * turn[2, c] + (mass[c] - m) * fluid
        flow = turn[0, c] * u0 + turn[1, c] * u1 + turn[2, c] * u2
        past = kept * (turn[0, c] * v0 + turn[1, c] * v1 + turn[2, c] * v2 - flow) + h * force / mass[c]
        drag = load[6 + c] / 2.0 / mass[c]
        v[c] = flow + slowed(past, laws.linear_drag * drag, laws.quadratic_drag / 2.0 * drag, h)
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        wet = (load[6 + a] / shapes.skin[q, a] + load[6 + b] / shapes.skin[q, b]) / 2.0
        for d in range(3):
            heavy[c, d] = fleet.density[i] * shapes.inertia[q, c, d]
        heavy[c, c] += laws.added_mass * shapes.about[q, c] * wet
    set_inverse(heavy, light)
    for c in range(3):
        a, b = (c + 1) % 3, (c + 2) % 3
        past = turn[0, c] * w0 + turn[1, c] * w1 + turn[2, c] * w2
        past += h * (light[c, 0] * load[3] + light[c, 1] * load[4] + light[c, 2] * load[5])
        # a face wet over S turns about an axis at arm r: drag S r^2 w, S r^3 |w| w
        ra, rb = shapes.arm[q, a], shapes.arm[q, b]
        linear = (load[6 + a] * rb * rb + load[6 + b] * ra * ra) / 2.0 / heavy[c, c]
        quadratic = (load[6 + a] * rb**3 + load[6 + b] * ra**3) / 2.0 / heavy[c, c]
        w[c] = slowed(past, laws.linear_drag * linear, laws.quadratic_drag / 2.0 * quadratic, h)
    if fleet.pull_limit[i] > 0.0:
        add_pull(fleet, i, h, laws.pull_rate, turn, mass, light, v, w)
    for c in range(3):
        fleet.velocity[i, c] = turn[c, 0] * v[0] + turn[c, 1] * v[1] + turn[c, 2] * v[2]
        fleet.spin[i, c] = turn[c, 0] * w[0] + turn[c, 1] * w[1] + turn[c, 2] * w[2]
