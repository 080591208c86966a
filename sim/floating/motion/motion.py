"""Six degrees of freedom for many bodies: pressure of two fluids, waves, radiation, drag, pulls and collisions.

Of body i, in level axes that turn with its heading:

  (M + A) dV/dt = F_p + m g + F_e - F_r - drag(V - U) + pull,    V = (v, w)

F_p are the exact integrals of the hydrostatic pressure over the wet hull (hydrostatics.py) under the surface of
`FluidState`: in any wave, upwards, the weight of what is displaced. A (6, 6) is the added mass at infinite frequency,
F_r the memory of the waves that the body made (Cummins; hydrodynamics.py), F_e the wave force beyond F_p
(excitation.py). If the sea is no sum of waves, F_e is the added mass plus the mass displaced at rest, times the
fluid's acceleration at the surface, with the yaw moment of the surface's twist, and F_r follows from the velocity
against the fluid: so a small hull that displaces its weight moves with the fluid in long waves. Small motions are
those of linear theory. The drag is along and about the body's own axes, rho S/2 (b v + C |v| v/2) with S the wetted
area.

**Means.** A, F_r and F_e are linear and have no mean. Second-order terms must not leave a spurious mean force. Three
would: A dV/dt in axes that lean with the body (A differs along them, and lean and acceleration are correlated), an
acceleration times the momentary displacement, and a wave force taken at a place that moves with the wave. So the axes
are level, the displaced mass is that at rest, and the upward F_e is a change of impulse. A body then floats in waves
where Archimedes says, apart from the mean of the drag. Mean forces of second order, which would need the potential of
that order (Pinkster 1980), are left out.

A hull that comes out of the water loses A, F_r and F_e with what of it is wet, below half of that at rest. With
A = L L^T the part that it carries is L diag(c) L^T, c the wet fraction of each of the six motions: a sum of positive
parts that grow with c, whatever A couples. Where a share grows, body and fluid share their momentum and their moment of
momentum, (M + A)(V - U) = const for the six motions at once (von Karman 1929, NACA TN 321, for the vertical one). Where
a share shrinks, the velocities stay, and the fluid that is left behind keeps its energy. So neither change of A gives
energy: p^T (M + A)^-1 p falls as A grows at constant p, V^T (M + A) V falls as A shrinks at constant V.

**Step.** Leapfrog, half a drift, the kick, half a drift: forces at the middle of the substep change the velocity.
Buoyancy alone is explicit; drag is solved exactly over the step and the pull implicitly, so neither limits it. The
limit is omega h < 2 with omega the fastest heave or roll, the period is short by (omega h)^2/24, and the energy
error stays bounded. Since F_p and A decrease together as a hull leaves the water, omega is bounded whatever the density
(`frequency_bound`), and `step` divides the frame until omega h <= MAX_PHASE, for each body on its own. Rotation sets
no limit: each drift keeps the angular momentum of the solid, so that spin stays bounded.

Not modelled: waves from one body to another, coefficients that change with pose and draft, the moment of added mass at
steady speed (Munk), air. A sphere has the axes of the world: its mesh has a pose, the sphere has none.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.floating.motion.body import Fleet, check_fleet
from sim.floating.motion.body_collisions import collide
from sim.floating.motion.fluid_state import FluidState
from sim.floating.motion.rigid import (
    add_pull,
    angular_part,
    drift,
    factorise,
    linear_part,
    set_six,
    solve_factorised,
)
from sim.floating.motion.rotation import (
    columns,
    dot,
    from_heading,
    heading_of,
    plus,
    scaled,
    set_three,
    squares,
    three,
    to_heading,
    turn,
    turn_back,
    turn_matrix,
)
from sim.floating.statics.hydrostatics import add_pressure
from sim.jit import kernel
from sim.validation import argument_error, check_kind, check_number, check_positive, is_whole_number
from sim.water import EARTH_GRAVITY

# The kernels of one substep are inlined: a real call copies about a hundred fields of the records, which took more than
# half of the time.
MAX_PHASE = 0.4  # of omega h in a substep: periods are within 0.7 %, and waves may add to gravity
ENTRY_SHARE = 0.5  # of the area wet at rest, up to which a hull that gets wetter counts as entering the water
MAX_SUBSTEPS = 512  # of a body in one call of `step`
WORLD = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))  # its axes


class MotionCoefficients(NamedTuple):
    """The coefficients of motion, one set for all bodies."""

    gravity: float = EARTH_GRAVITY  # [m/s2]
    linear_drag: float = 0.0  # b [m/s]
    quadratic_drag: float = 1.0  # C, of a bluff body
    added_mass: float = 1.0  # factor on that at infinite frequency
    radiation: float = 1.0  # factor on the memory of the waves that the body made
    restitution: float = 0.3  # of collisions
    pull_rate: float = 12.0  # [rad/s] of the critically damped pull


STANDARD = MotionCoefficients()
LIMITS = {
    "gravity": (1e-3, 1e4, "m/s2"), "linear_drag": (0.0, 1e6, "m/s"), "quadratic_drag": (0.0, 1e6, ""),
    "added_mass": (0.0, 100.0, ""), "radiation": (0.0, 100.0, ""),
    "restitution": (0.0, 1.0, ""), "pull_rate": (0.0, 1e4, "rad/s"),
}  # fmt: skip


def frequency_bound(fleet: Fleet, density: float, coefficients: MotionCoefficients) -> np.ndarray:
    """Upper bound (n,) [rad/s] of the frequencies of each body in fluid of at most `density` [kg/m3].

    In any pose the force changes with depth by at most rho g times the smaller of |S|/2, with S_i the wetted area
    across each axis of the whole hull, and the wet area. The added mass is proportional to the wet area up to half of
    that at rest: omega^2 <= rho g |S|/2 / (m + rho a). About each axis the same holds with the bound of the restoring
    moment, where the mean of two shares may be half the greater one. The sum bounds any coupling of the two.
    """
    hulls, q, s = fleet.hulls, fleet.hull, fleet.linear_hull
    added = (coefficients.added_mass * density) * fleet.linear.added_bound
    weight = density * coefficients.gravity
    heave = weight * hulls.waterplane_bound[q] / (fleet.mass + added[s, 2])
    roll_added = (np.minimum(added[:, 3], added[:, 4]) / 2)[s]
    roll = np.zeros(len(q))
    for axis in range(3):
        inertia = fleet.density * hulls.inertia[q, axis, axis] + roll_added
        np.maximum(roll, weight * hulls.restoring_bound[q, axis] / inertia, out=roll)
    return np.sqrt(heave + roll)


def step(
    fleet: Fleet,
    water: FluidState,
    duration: float,
    coefficients: MotionCoefficients = STANDARD,
    substeps: int | None = None,
) -> int:
    """Advance all bodies by `duration` [s] in place; returns how many pairs touched.

    substeps: the same number for each body, or None for as many as each needs. Raises ValueError for bad arguments
    and FloatingPointError, naming the body, where a state is no longer finite; the fleet is then as it was.

    >>> from sim.floating import Body, Hull, make_fleet, still_water
    >>> fleet = make_fleet([Body(Hull.box(1.0, 1.0, 1.0), density=500.0)])
    >>> for _ in range(60):
    ...     touching = step(fleet, still_water(fleet), 1 / 60)
    >>> fleet.position.shape, touching
    ((1, 3), 0)
    """
    check_kind("coefficients", coefficients, MotionCoefficients, "MotionCoefficients")
    for name, (low, high, unit) in LIMITS.items():
        check_number(name, getattr(coefficients, name), unit, low, high)
    duration = check_positive("duration", duration, "s")
    check_fleet(fleet)
    check_kind("water", water, FluidState, "a FluidState, as `make_water` makes it")
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
    elif is_whole_number(substeps) and substeps >= 1:
        counts = np.full(len(fleet.mass), int(substeps), dtype=np.int64)
    else:
        raise argument_error("substeps", substeps, "a whole number of at least 1")
    state = fleet[:9]
    before = [array.copy() for array in state]
    advance(fleet, water, MotionCoefficients(*(float(value) for value in coefficients)), counts, float(duration))
    # Checked here and not in the kernel: its compiler may take x - x for 0, and with that a NaN for finite.
    finite = np.isfinite(np.column_stack(state[:8])).all(axis=1)
    if not finite.all():
        failed = int(np.argmin(finite))
        place = before[0][failed].tolist()
        for array, old in zip(state, before, strict=True):
            array[:] = old
        raise FloatingPointError(f"body {failed}: its state is no longer finite; it was at {place} m")
    return collide(fleet, float(coefficients.restitution))


class Scratch(NamedTuple):
    """Arrays that the kernels of one body write before they read them; allocated once for all bodies."""

    mass: np.ndarray  # (6, 6) [kg, kg m, kg m2] of the solid with added mass, in the axes of the heading
    factor: np.ndarray  # (6, 6) lower Cholesky factor of it
    wet: np.ndarray  # (6,) wet fraction of the body for each motion: 1 as at rest, 0 in air
    felt: np.ndarray  # (6,) factor on the force of waves: `wet`, less if the body is below the surface
    made: np.ndarray  # (6,) its root: factor on the velocity that makes waves, and on their force on the body
    V: np.ndarray  # (6,) [m/s, rad/s] velocities, in the axes of the heading
    U: np.ndarray  # (6,) [m/s, rad/s] those of the fluid, which does not rotate
    load: np.ndarray  # (6,) [N, N m] of all forces, and what they change
    substep: np.ndarray  # (s,) [s] for which decay and gain hold, of each linear hull
    decay: np.ndarray  # (s, p) complex: what a substep leaves of the memory
    gain: np.ndarray  # (s, p) [s] complex: what a substep adds of a unit velocity
    pressure: np.ndarray  # (9,) [kg, kg m, kg/m] sums of `add_pressure`, along the axes of the body
    depth: np.ndarray  # (2, v) [m] of the vertices of all hulls below the surface and below the interface


@kernel
def make_scratch(hulls, poles, vertices):
    """Arrays for the kernels of one body: numbers of linear hulls and of their poles; all but substep uninitialised."""
    return Scratch(
        np.empty((6, 6)), np.empty((6, 6)), np.empty(6), np.empty(6), np.empty(6), np.empty(6), np.empty(6),
        np.empty(6), np.zeros(hulls), np.empty((hulls, poles), np.complex128), np.empty((hulls, poles), np.complex128),
        np.empty(9), np.empty((2, vertices)),
    )  # fmt: skip


class Pose(NamedTuple):
    """The axes in which the forces on a body are; a sphere has those of the world."""

    axes: tuple  # of the body, in the world
    heading: tuple  # its cosine and sine
    own: tuple  # the axes of the body, in those of the heading
    pulled: tuple  # (3) [m] the pulled point, in the axes of the heading


@kernel
def advance(fleet, water, coefficients, counts, duration):
    """Advance every body by `duration` [s] on its own, each in as many substeps as counts (n,) says."""
    scratch = make_scratch(fleet.linear.poles.shape[0], fleet.memory.shape[1], fleet.hulls.x.shape[1])
    for i in range(fleet.mass.size):
        h = duration / counts[i]
        set_memory_step(fleet, i, h, coefficients.gravity, scratch)
        fleet.lift[i] = 0.0
        for s in range(counts[i]):
            pose = pose_of(fleet, i, drift(fleet, i, h / 2.0))
            top = set_pressure(fleet, water, i, pose.axes, (s + 0.5) * h, scratch)
            kick(fleet, water, coefficients, i, pose, top, h, 1.0 / counts[i], scratch)
            drift(fleet, i, h / 2.0)


@kernel(inline=True)
def set_memory_step(fleet, i, h, gravity, scratch):
    """Set decay and gain of the memory of body i for a substep of h [s], unless they are set already."""
    s = fleet.linear_hull[i]
    if scratch.substep[s] == h:
        return
    scratch.substep[s] = h
    for p in range(fleet.memory.shape[1]):
        pole = fleet.linear.poles[s, p] * np.sqrt(gravity)
        scratch.decay[s, p] = np.exp(pole * h)
        scratch.gain[s, p] = (scratch.decay[s, p] - 1.0) / pole


@kernel(inline=True)
def pose_of(fleet, i, axes):
    """The pose of body i with these axes."""
    pulled = turn(axes, three(fleet.pull_point, i))
    heading = (1.0, 0.0)
    if fleet.hulls.is_round[fleet.hull[i]]:
        axes = WORLD
    else:
        heading = heading_of(axes)
    a, b, c = axes
    own = to_heading(heading, a), to_heading(heading, b), to_heading(heading, c)
    return Pose(axes, heading, own, to_heading(heading, pulled))


@kernel(inline=True)
def set_pressure(fleet, water, i, axes, t, scratch):
    """Set the integrals of `add_pressure` over the wet hull of body i, times density.

    t [s] is the time since the step began: the surface rises meanwhile as the fluid does. Returns the height [m] of the
    surface above the body's centre.
    """
    hulls, q, pressure, depth = fleet.hulls, fleet.hull[i], scratch.pressure, scratch.depth
    first, last = hulls.vertex_start[q], hulls.vertex_start[q + 1]
    first_face, last_face = hulls.face_start[q], hulls.face_start[q + 1]
    for e in range(pressure.shape[0]):
        pressure[e] = 0.0
    fleet.wet_volume[i] = 0.0
    dx, dy = fleet.position[i, 0] - water.at[i, 0], fleet.position[i, 1] - water.at[i, 1]
    sx, sy = water.slope[i, 0], water.slope[i, 1]
    # kinematic condition at the surface: d eta/dt = w - u . slope
    rise = water.velocity[i, 2] - water.velocity[i, 0] * sx - water.velocity[i, 1] * sy
    surface = water.height[i] + sx * dx + sy * dy + rise * (t - water.lead) - fleet.position[i, 2]
    level = water.relief.size == 0 and water.interface_relief.size == 0
    if level and surface < -hulls.radius[q] * np.sqrt(1.0 + sx * sx + sy * sy):
        return surface  # the body is in the air
    set_depth(hulls.x, first, last, axes, surface, sx, sy, depth[0])
    start = fleet.vertex_start[i] - first
    if water.relief.size > 0:
        for v in range(first, last):
            depth[0, v] += water.relief[start + v]
    add_pressure(hulls.x, hulls.faces, hulls.area, first_face, last_face, depth[0], water.upper, pressure)
    # int d n_z dA over the wet surface is the volume below the surface, with the sign of the outward normal
    upper = -turn(axes, linear_part(pressure))[2]
    fleet.wet_volume[i, 0] = upper / water.upper
    if water.lower > water.upper:
        sx, sy = water.interface_slope[i, 0], water.interface_slope[i, 1]
        top = water.interface[i] + sx * dx + sy * dy + water.interface_rise[i] * (t - water.lead) - fleet.position[i, 2]
        set_depth(hulls.x, first, last, axes, top, sx, sy, depth[1])
        if water.interface_relief.size > 0:
            for v in range(first, last):
                depth[1, v] += water.interface_relief[start + v]
        for v in range(first, last):  # where the interface is above the surface there is no upper fluid
            depth[1, v] = min(depth[1, v], depth[0, v])
        difference = water.lower - water.upper
        add_pressure(hulls.x, hulls.faces, hulls.area, first_face, last_face, depth[1], difference, pressure)
        both = -turn(axes, linear_part(pressure))[2]
        fleet.wet_volume[i, 1] = (both - upper) / difference
        fleet.wet_volume[i, 0] -= fleet.wet_volume[i, 1]
    return surface


@kernel(noalias=True)
def set_depth(x, first, last, axes, top, sx, sy, depth):
    """Set depth (n,) [m] of vertices first to last of x (3, n), in a body's axes, below a plane.

    The plane has slope (sx, sy) and is `top` [m] above the body's centre.
    """
    # eta - z = top + (sx, sy, -1) . R x
    gx, gy, gz = turn_back(axes, (sx, sy, -1.0))
    for v in range(first, last):
        depth[v] = top + gx * x[0, v] + gy * x[1, v] + gz * x[2, v]


@kernel(inline=True)
def kick(fleet, water, coefficients, i, pose, top, h, share_of_step, scratch):
    """Change velocity and spin of body i by the forces of one substep of h [s], that share of the whole step.

    top [m]: height of the surface above the body's centre.
    """
    V, U, load, heading = scratch.V, scratch.U, scratch.load, pose.heading
    before, mass, density = fleet.velocity[i, 2], fleet.mass[i], fluid_density(fleet, water, i)
    set_six(V, to_heading(heading, three(fleet.velocity, i)), to_heading(heading, three(fleet.spin, i)))
    set_six(U, to_heading(heading, three(water.velocity, i)), (0.0, 0.0, 0.0))
    set_wet(fleet, i, density, pose.own, top, scratch)
    set_mass(fleet, coefficients, i, density, pose.own, scratch)
    factorise(scratch.mass, scratch.factor)
    share_momentum(fleet, coefficients, i, density, scratch)
    update_memory(fleet, water, i, scratch)
    buoyancy, waves = set_forces(fleet, water, coefficients, i, density, pose, scratch)
    solve_factorised(scratch.factor, load)
    for c in range(6):
        V[c] += h * load[c]
    drag = apply_drag(fleet, coefficients, i, pose.own, h, scratch)
    if fleet.pull_limit[i] > 0.0:
        add_pull(fleet, i, h, coefficients.pull_rate, scratch.factor, heading, pose.pulled, load, V)
    set_three(fleet.velocity, i, from_heading(heading, linear_part(V)))
    set_three(fleet.spin, i, from_heading(heading, angular_part(V)))
    change = mass * ((fleet.velocity[i, 2] - before) / h + coefficients.gravity)
    fleet.buoyancy[i] = buoyancy
    fleet.lift[i, 0] += share_of_step * buoyancy
    fleet.lift[i, 1] += share_of_step * waves
    fleet.lift[i, 2] += share_of_step * drag
    fleet.lift[i, 3] += share_of_step * (change - buoyancy - waves - drag)


@kernel(inline=True)
def fluid_density(fleet, water, i):
    """Mean density [kg/m3] of the fluids that body i displaces; 0 in the air."""
    upper, lower = fleet.wet_volume[i, 0], fleet.wet_volume[i, 1]
    return (water.upper * upper + water.lower * lower) / (upper + lower) if upper + lower > 0.0 else 0.0


@kernel(inline=True)
def wet_across(wetted, at_rest):
    """Wetted area over half of that at rest, at most 1."""
    return min(wetted / (ENTRY_SHARE * at_rest), 1.0) if at_rest > 0.0 else 0.0


@kernel(inline=True)
def set_wet(fleet, i, density, own, top, scratch):
    """Set wet, felt and made (6,) of body i with these axes, under a surface `top` [m] above its centre.

    The coefficients are those at rest while at least half of that is wet: a scale that followed each small motion
    would push the body up or down on average, which linear theory does not know.
    """
    s, wet, pressure, (a, b, c) = fleet.linear_hull[i], scratch.wet, scratch.pressure, own
    x, y, z = scaled(density, three(fleet.linear.wet_area, s))
    across = wet_across(pressure[6], x), wet_across(pressure[7], y), wet_across(pressure[8], z)
    x, y, z = turn((squares(a), squares(b), squares(c)), across)
    set_six(wet, (x, y, z), ((y + z) / 2.0, (z + x) / 2.0, (x + y) / 2.0))
    depth = top - fleet.hulls.half[fleet.hull[i], 2]  # [m] of water over the body
    reduction = math.exp(-max(depth, 0.0) / fleet.linear.decay_length[s])
    for e in range(6):
        scratch.made[e] = reduction * np.sqrt(wet[e])
        scratch.felt[e] = scratch.made[e] * scratch.made[e]


@kernel(inline=True)
def set_mass(fleet, coefficients, i, density, own, scratch):
    """Set mass (6, 6) of body i, with the added mass of its wet part."""
    s, L, wet, mass = fleet.linear_hull[i], fleet.linear.added_factor, scratch.wet, scratch.mass
    for c in range(6):
        for d in range(c + 1):
            added = 0.0
            for k in range(d + 1):
                added += L[s, c, k] * wet[k] * L[s, d, k]
            mass[c, d] = mass[d, c] = coefficients.added_mass * density * added
    solid = turn_matrix(own, columns(fleet.hulls.inertia, fleet.hull[i]))
    for c in range(3):
        mass[c, c] += fleet.mass[i]
        x, y, z = scaled(fleet.density[i], solid[c])
        mass[3, 3 + c] += x
        mass[4, 3 + c] += y
        mass[5, 3 + c] += z


@kernel(inline=True)
def share_momentum(fleet, coefficients, i, density, scratch):
    """Let body i share its momentum with the fluid that it begins to carry.

    (M + A)(V - U) stays while c grows in A = L diag(c) L^T: V changes by -(M + A)^-1 L diag(dc) L^T (V - U), with the A
    of the greater c.
    """
    V, U, change, L, s = scratch.V, scratch.U, scratch.load, fleet.linear.added_factor, fleet.linear_hull[i]
    enters = False
    for c in range(6):
        change[c] = 0.0
    for k in range(6):
        before, now = fleet.carried[i, k], density * scratch.wet[k]
        fleet.carried[i, k] = now
        if not 0.0 <= before < now:
            continue
        enters = True
        momentum = 0.0
        for c in range(k, 6):
            momentum += L[s, c, k] * (V[c] - U[c])
        for c in range(k, 6):
            change[c] -= coefficients.added_mass * (now - before) * L[s, c, k] * momentum
    if enters:
        solve_factorised(scratch.factor, change)
        for c in range(6):
            V[c] += change[c]


@kernel(inline=True)
def update_memory(fleet, water, i, scratch):
    """Take the velocities of body i into its memory: s' = p s + v over a substep.

    They are those against the fluid where no excitation is given, which would hold the fluid's part.
    """
    s, flows = fleet.linear_hull[i], 1.0 if water.excitation.shape[0] == 0 else 0.0
    for c in range(6):
        speed = scratch.made[c] * (scratch.V[c] - flows * scratch.U[c])
        for p in range(fleet.memory.shape[1]):
            fleet.memory[i, p, c] = scratch.decay[s, p] * fleet.memory[i, p, c] + scratch.gain[s, p] * speed


@kernel(inline=True)
def set_forces(fleet, water, coefficients, i, density, pose, scratch):
    """Set load (6,): all forces and moments on body i but the drag and the pull.

    Returns the upward forces [N] of the pressure and of the waves.
    """
    load, heading, s, m = scratch.load, pose.heading, fleet.linear_hull[i], fleet.mass[i]
    a = max(water.acceleration[i], -coefficients.gravity)
    sx, sy, _ = to_heading(heading, (water.slope[i, 0], water.slope[i, 1], 0.0))
    # Of the volume at rest: the change by a wave is of second order, and would lift the body on average.
    carried = min(m, density * m / fleet.density[i]) * scratch.felt[2]
    if water.excitation.shape[0] > 0:
        excitation = water.excitation[i]
        set_six(load, to_heading(heading, linear_part(excitation)), to_heading(heading, angular_part(excitation)))
        for c in range(6):
            load[c] *= density * scratch.felt[c]
    else:
        ax, ay, az = -(coefficients.gravity + a) * sx, -(coefficients.gravity + a) * sy, a
        for c in range(6):  # of what the fluid's acceleration does to the added mass
            load[c] = scratch.mass[c, 0] * ax + scratch.mass[c, 1] * ay + scratch.mass[c, 2] * az
        set_six(load, plus(linear_part(load), -m, (ax, ay, az)), angular_part(load))
        load[2] += carried * a
        load[5] += density * scratch.felt[5] * water.yaw[i]
    load[0] -= carried * a * sx
    load[1] -= carried * a * sy
    waves, g = load[2], coefficients.gravity
    force, moment = turn(pose.own, linear_part(scratch.pressure)), turn(pose.own, angular_part(scratch.pressure))
    lines = to_heading(heading, linear_part(fleet.mooring[i])), to_heading(heading, angular_part(fleet.mooring[i]))
    set_six(
        load,
        plus(plus(linear_part(load), -g, force), 1.0, lines[0]),
        plus(plus(angular_part(load), -g, moment), 1.0, lines[1]),
    )
    load[2] -= m * g
    scale = 2.0 * density * g * coefficients.radiation
    for n in range(fleet.linear.coupled_count[s]):
        c, d = fleet.linear.coupled[s, n, 0], fleet.linear.coupled[s, n, 1]
        total = 0.0
        for p in range(fleet.memory.shape[1]):
            residue, state = fleet.linear.residues[s, n, p], fleet.memory[i, p, d]
            total += residue.real * state.real - residue.imag * state.imag
        load[c] -= scale * scratch.made[c] * total
    return -g * force[2], waves


@kernel
def after_drag(v, linear, quadratic, h):
    """v after h [s] of dv/dt = -linear v - quadratic |v| v, exactly: e v/(1 + quadratic |v| (1 - e)/linear).

    With e = exp(-linear h). v is a number; linear [1/s], quadratic [1/m].
    """
    if linear <= 0.0:
        return v / (1.0 + quadratic * abs(v) * h)
    decay = math.exp(-linear * h)
    integral = -math.expm1(-linear * h) / linear if linear * h > 1e-9 else h
    return v * decay / (1.0 + quadratic * abs(v) * integral)


@kernel(inline=True)
def apply_drag(fleet, coefficients, i, own, h, scratch):
    """Let drag slow body i for h [s], each of its own axes alone and exactly.

    Returns the upward force [N] of that.
    """
    V, pressure, mass = scratch.V, scratch.pressure, scratch.mass
    q, b, C, flow = fleet.hull[i], coefficients.linear_drag, coefficients.quadratic_drag / 2.0, linear_part(scratch.U)
    lift = 0.0
    for c in range(3):
        axis, v, w = own[c], linear_part(V), angular_part(V)
        inertia, turning = along_axis(mass, 0, axis), along_axis(mass, 3, axis)
        drag = pressure[6 + c] / 2.0 / inertia
        speed = dot(axis, plus(v, -1.0, flow))
        change = after_drag(speed, b * drag, C * drag, h) - speed
        lift += axis[2] * inertia * change / h
        # a face wet over S that rotates about an axis at radius r: drag S r^2 w, S r^3 |w| w
        d, e = (c + 1) % 3, (c + 2) % 3
        rd, re = fleet.hulls.radius_of_gyration[q, d], fleet.hulls.radius_of_gyration[q, e]
        linear = (pressure[6 + d] * re * re + pressure[6 + e] * rd * rd) / 2.0 / turning
        quadratic = (pressure[6 + d] * re**3 + pressure[6 + e] * rd**3) / 2.0 / turning
        spin = dot(axis, w)
        spin_change = after_drag(spin, b * linear, C * quadratic, h) - spin
        set_six(V, plus(v, change, axis), plus(w, spin_change, axis))
    return lift


@kernel(inline=True)
def along_axis(mass, k, axis):
    """The inertia along an axis, of the three rows and columns of mass (6, 6) from k; its other half is not read."""
    x, y, z = axis
    return (
        mass[k, k] * x * x + mass[k + 1, k + 1] * y * y + mass[k + 2, k + 2] * z * z
        + 2.0 * (mass[k + 1, k] * x * y + mass[k + 2, k] * x * z + mass[k + 2, k + 1] * y * z)
    )  # fmt: skip
