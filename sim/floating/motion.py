"""Six degrees of freedom for many bodies: pressure of two fluids, waves, radiation, drag, pulls and collisions.

Of body i, in level axes that turn with its heading:

  (M + A) dV/dt = F_p + m g + F_e - F_r - drag(V - U) + pull,    V = (v, w)

F_p are the exact integrals of the hydrostatic pressure over the wet hull (hydrostatics.py) under the surface of
`FluidState`: in any wave, upwards, the weight of what is displaced. A (6, 6) is the added mass at infinite frequency,
F_r the memory of the waves that the body made (Cummins; hydrodynamics.py), F_e the wave force beyond F_p
(excitation.py). If the sea is no sum of waves, F_e is the added mass plus the mass displaced at rest, times the
fluid's acceleration at the surface, and F_r follows from the velocity against the fluid: so a small hull that
displaces its weight moves with the fluid in long waves. Small motions are those of linear theory. The drag is along
and about the body's own axes, rho S/2 (b v + C |v| v/2) with S the wetted area.

**Means.** A, F_r and F_e are linear and have no mean. Second-order terms must not leave a spurious mean force. Three
would: A dV/dt in axes that lean with the body (A differs along them, and lean and acceleration are correlated), an
acceleration times the momentary displacement, and a wave force taken at a place that moves with the wave. So the axes
are level, the displaced mass is that at rest, and the upward F_e is a change of impulse. A body then floats in waves
where Archimedes says, apart from the mean of the drag. Mean forces of second order, which would need the potential of
that order (Pinkster 1980), are left out.

A hull that comes out of the water loses A, F_r and F_e with what of it is wet, below half of that at rest. With
A = L L^T the part that it carries is L diag(c) L^T, c the wet share of each of the six motions: a sum of positive parts
that grow with c, whatever A couples. Where a share grows, body and fluid share their momentum and their moment of
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

from sim.floating.body import Fleet, check_fleet
from sim.floating.body_collisions import collide
from sim.floating.fluid_state import FluidState
from sim.floating.hydrostatics import add_pressure
from sim.floating.rigid import (
    add_pull,
    after_drag,
    drift,
    factorise,
    heading_of,
    make_scratch,
    set_rotation,
    solve_factorised,
)
from sim.jit import kernel
from sim.validation import argument_error, check_kind, check_positive, check_within, is_whole_number

# The kernels of one substep are inlined: a real call copies about a hundred fields of the records, which took more than
# half of the time.
MAX_PHASE = 0.4  # of omega h in a substep: periods are within 0.7 %, and waves may add to gravity
ENTRY_SHARE = 0.5  # of the area wet at rest, up to which a hull that gets wetter counts as entering the water
MAX_SUBSTEPS = 512  # of a body in one call of `step`


class MotionCoefficients(NamedTuple):
    """The coefficients of motion, one set for all bodies."""

    gravity: float = 9.81  # [m/s2]
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
        check_within(name, getattr(coefficients, name), low, high, unit)
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
        raise argument_error("substeps", substeps, "a whole number from 1")
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


@kernel
def advance(fleet, water, coefficients, counts, duration):
    """Advance every body by `duration` [s] on its own, each in as many substeps as counts (n,) says."""
    depth = np.empty((2, fleet.hulls.x.shape[1]))
    scratch = make_scratch(fleet.linear.poles.shape[0], fleet.memory.shape[1])
    for i in range(fleet.mass.size):
        h = duration / counts[i]
        set_memory_step(fleet, i, h, coefficients.gravity, scratch)
        fleet.lift[i] = 0.0
        for s in range(counts[i]):
            set_rotation(fleet.rotation, i, scratch.R)
            drift(fleet, i, h / 2.0, scratch)
            set_axes(fleet, i, scratch)
            set_load(fleet, water, i, (s + 0.5) * h, coefficients.gravity, depth, scratch)
            kick(fleet, water, coefficients, i, h, 1.0 / counts[i], scratch)
            set_rotation(fleet.rotation, i, scratch.R)
            drift(fleet, i, h / 2.0, scratch)


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
def set_axes(fleet, i, scratch):
    """Set the axes of body i: R from its own to the world, T from its own to its heading's, H from those to the world.

    A sphere has the axes of the world.
    """
    R, T, H, p = scratch.R, scratch.T, scratch.H, fleet.pull_point[i]
    for c in range(3):
        scratch.pull_point[c] = R[c, 0] * p[0] + R[c, 1] * p[1] + R[c, 2] * p[2]
    cosine, sine = 1.0, 0.0
    if fleet.hulls.is_round[fleet.hull[i]]:
        for c in range(3):
            for d in range(3):
                R[c, d] = 1.0 if c == d else 0.0
    else:
        cosine, sine = heading_of(fleet.rotation, i)
    for c in range(3):
        T[0, c] = cosine * R[0, c] + sine * R[1, c]
        T[1, c] = cosine * R[1, c] - sine * R[0, c]
        T[2, c] = R[2, c]
        for d in range(3):
            H[c, d] = 0.0
    H[0, 0], H[0, 1], H[1, 0], H[1, 1], H[2, 2] = cosine, -sine, sine, cosine, 1.0
    x, y = scratch.pull_point[0], scratch.pull_point[1]
    scratch.pull_point[0], scratch.pull_point[1] = cosine * x + sine * y, cosine * y - sine * x


@kernel(inline=True)
def set_load(fleet, water, i, t, gravity, depth, scratch):
    """Set force and moment (3,) of the fluids' pressure on body i, in the axes of its heading, and wetted (3,).

    t [s] is the time since the step began: the surface rises meanwhile as the fluid does. depth (2, n) is scratch.
    """
    hulls, q, R, pressure = fleet.hulls, fleet.hull[i], scratch.R, scratch.pressure
    first, last = hulls.vertex_start[q], hulls.vertex_start[q + 1]
    first_face, last_face = hulls.face_start[q], hulls.face_start[q + 1]
    for e in range(3):
        scratch.force[e] = scratch.moment[e] = scratch.wetted[e] = 0.0
    for e in range(pressure.shape[0]):
        pressure[e] = 0.0
    fleet.wet_volume[i] = 0.0
    dx, dy = fleet.position[i, 0] - water.at[i, 0], fleet.position[i, 1] - water.at[i, 1]
    sx, sy = water.slope[i, 0], water.slope[i, 1]
    # kinematic condition at the surface: d eta/dt = w - u . slope
    rise = water.velocity[i, 2] - water.velocity[i, 0] * sx - water.velocity[i, 1] * sy
    top = water.height[i] + sx * dx + sy * dy + rise * (t - water.lead) - fleet.position[i, 2]
    set_share(fleet, i, top, scratch)
    level = water.relief.size == 0 and water.interface_relief.size == 0
    if level and top < -hulls.radius[q] * np.sqrt(1.0 + sx * sx + sy * sy):
        return  # the body is in the air
    set_depth(hulls.x, first, last, R, top, sx, sy, depth[0])
    start = fleet.vertex_start[i] - first
    if water.relief.size > 0:
        for v in range(first, last):
            depth[0, v] += water.relief[start + v]
    add_pressure(hulls.x, hulls.faces, hulls.area, first_face, last_face, depth[0], water.upper, pressure)
    # int d n_z dA over the wet surface is the volume below the surface, with the sign of the outward normal
    upper = -(R[2, 0] * pressure[0] + R[2, 1] * pressure[1] + R[2, 2] * pressure[2])
    fleet.wet_volume[i, 0] = upper / water.upper
    if water.lower > water.upper:
        sx, sy = water.interface_slope[i, 0], water.interface_slope[i, 1]
        top = water.interface[i] + sx * dx + sy * dy + water.interface_rise[i] * (t - water.lead) - fleet.position[i, 2]
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
    T = scratch.T
    for c in range(3):
        scratch.force[c] = -gravity * (T[c, 0] * pressure[0] + T[c, 1] * pressure[1] + T[c, 2] * pressure[2])
        scratch.moment[c] = -gravity * (T[c, 0] * pressure[3] + T[c, 1] * pressure[4] + T[c, 2] * pressure[5])
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


@kernel(inline=True)
def set_share(fleet, i, top, scratch):
    """Set share (6,) of body i below a surface `top` [m] above its centre, as far as depth reduces it."""
    depth = top - fleet.hulls.half[fleet.hull[i], 2]  # [m] of water over the body
    share = math.exp(-max(depth, 0.0) / fleet.linear.decay_length[fleet.linear_hull[i]])
    for c in range(6):
        scratch.share[c] = share


@kernel(inline=True)
def kick(fleet, water, coefficients, i, h, share_of_step, scratch):
    """Change velocity and spin of body i by the forces of one substep of h [s], that share of the whole step."""
    H, v, w, load = scratch.H, scratch.v, scratch.w, scratch.load
    before, mass = fleet.velocity[i, 2], fleet.mass[i]
    buoyancy, density = scratch.force[2], fluid_density(fleet, water, i)
    set_mass(fleet, water, coefficients, i, density, scratch)
    factorise(scratch.mass, scratch.factor)
    set_velocities(fleet, water, i, scratch)
    share_momentum(fleet, coefficients, i, density, scratch)
    update_memory(fleet, water, i, scratch)
    waves = set_forces(fleet, water, coefficients, i, density, scratch)
    solve_factorised(scratch.factor, load)
    for c in range(3):
        v[c] += h * load[c]
        w[c] += h * load[3 + c]
    drag = apply_drag(fleet, water, coefficients, i, h, scratch)
    if fleet.pull_limit[i] > 0.0:
        add_pull(fleet, i, h, coefficients.pull_rate, scratch)
    for c in range(3):
        fleet.velocity[i, c] = H[c, 0] * v[0] + H[c, 1] * v[1] + H[c, 2] * v[2]
        fleet.spin[i, c] = H[c, 0] * w[0] + H[c, 1] * w[1] + H[c, 2] * w[2]
    change = mass * ((fleet.velocity[i, 2] - before) / h + coefficients.gravity)
    fleet.buoyancy[i] = buoyancy
    fleet.lift[i, 0] += share_of_step * buoyancy
    fleet.lift[i, 1] += share_of_step * waves
    fleet.lift[i, 2] += share_of_step * drag
    fleet.lift[i, 3] += share_of_step * (change - buoyancy - waves - drag)


@kernel(inline=True)
def set_mass(fleet, water, coefficients, i, density, scratch):
    """Set mass (6, 6), wet (6,) and share (6,) of body i.

    wet: for each motion the wet area over half of that at rest, at most 1; share: its root.

    The coefficients are those at rest while at least half of that is wet: a scale that followed each small motion
    would push the body up or down on average, which linear theory does not know.
    """
    s, wet = fleet.linear_hull[i], scratch.wet
    T, own, inertia = scratch.T, scratch.inertia, fleet.hulls.inertia[fleet.hull[i]]
    for c in range(3):
        wet[c] = 0.0
        for d in range(3):
            full = ENTRY_SHARE * density * fleet.linear.wet_area[s, d]
            wet[c] += T[c, d] * T[c, d] * (min(scratch.wetted[d] / full, 1.0) if full > 0.0 else 0.0)
    for c in range(3):
        wet[3 + c] = (wet[(c + 1) % 3] + wet[(c + 2) % 3]) / 2.0
    L = fleet.linear.added_factor
    for c in range(6):
        scratch.share[c] *= np.sqrt(wet[c])
        for d in range(c + 1):
            added = 0.0
            for k in range(d + 1):
                added += L[s, c, k] * wet[k] * L[s, d, k]
            scratch.mass[c, d] = scratch.mass[d, c] = coefficients.added_mass * density * added
    for c in range(3):
        scratch.mass[c, c] += fleet.mass[i]
        for d in range(3):
            own[c, d] = inertia[c, 0] * T[d, 0] + inertia[c, 1] * T[d, 1] + inertia[c, 2] * T[d, 2]
    for c in range(3):
        for d in range(3):
            turned = T[c, 0] * own[0, d] + T[c, 1] * own[1, d] + T[c, 2] * own[2, d]
            scratch.mass[3 + c, 3 + d] += fleet.density[i] * turned


@kernel(inline=True)
def fluid_density(fleet, water, i):
    """Mean density [kg/m3] of the fluids that body i displaces; 0 in the air."""
    upper, lower = fleet.wet_volume[i, 0], fleet.wet_volume[i, 1]
    return (water.upper * upper + water.lower * lower) / (upper + lower) if upper + lower > 0.0 else 0.0


@kernel(inline=True)
def set_velocities(fleet, water, i, scratch):
    """Set v and w (3,) of body i, and the flow (3,), in the axes of its heading."""
    H, v, w, flow = scratch.H, scratch.v, scratch.w, scratch.flow
    for c in range(3):
        flow[c] = v[c] = w[c] = 0.0
        for d in range(3):
            flow[c] += H[d, c] * water.velocity[i, d]
            v[c] += H[d, c] * fleet.velocity[i, d]
            w[c] += H[d, c] * fleet.spin[i, d]


@kernel(inline=True)
def share_momentum(fleet, coefficients, i, density, scratch):
    """Let body i share its momentum with the fluid that it begins to carry.

    (M + A)(V - U) stays while c grows in A = L diag(c) L^T: V changes by -(M + A)^-1 L diag(dc) L^T (V - U), with the A
    of the greater c.
    """
    v, w, flow, change, L = scratch.v, scratch.w, scratch.flow, scratch.load, fleet.linear.added_factor
    s = fleet.linear_hull[i]
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
            momentum += L[s, c, k] * (v[c] - flow[c] if c < 3 else w[c - 3])
        for c in range(k, 6):
            change[c] -= coefficients.added_mass * (now - before) * L[s, c, k] * momentum
    if enters:
        solve_factorised(scratch.factor, change)
        for c in range(3):
            v[c] += change[c]
            w[c] += change[3 + c]


@kernel(inline=True)
def update_memory(fleet, water, i, scratch):
    """Take the velocities of body i into its memory: s' = p s + v over a substep.

    They are those against the fluid where no excitation is given, which would hold the fluid's part.
    """
    s = fleet.linear_hull[i]
    for c in range(6):
        speed = scratch.v[c] if c < 3 else scratch.w[c - 3]
        if c < 3 and water.excitation.shape[0] == 0:
            speed -= scratch.flow[c]
        speed *= scratch.share[c]
        for p in range(fleet.memory.shape[1]):
            fleet.memory[i, p, c] = scratch.decay[s, p] * fleet.memory[i, p, c] + scratch.gain[s, p] * speed


@kernel(inline=True)
def set_forces(fleet, water, coefficients, i, density, scratch):
    """Set load (6,): all forces and moments on body i but the drag and the pull.

    Returns the upward force [N] of the waves.
    """
    H, load, share = scratch.H, scratch.load, scratch.share
    s, m = fleet.linear_hull[i], fleet.mass[i]
    a, sx, sy = max(water.acceleration[i], -coefficients.gravity), water.slope[i, 0], water.slope[i, 1]
    for c in range(6):
        load[c] = 0.0
    # Of the volume at rest: the change by a wave is of second order, and would lift the body on average.
    carried = min(m, density * m / fleet.density[i]) * share[2] * share[2]
    for c in range(2):
        load[c] = -carried * a * (H[0, c] * sx + H[1, c] * sy)
    if water.excitation.shape[0] > 0:
        given = water.excitation[i]
        for c in range(6):
            first = 3 * (c // 3)
            along = H[0, c - first] * given[first] + H[1, c - first] * given[first + 1]
            along += H[2, c - first] * given[first + 2]
            load[c] += density * share[c] * share[c] * along
    else:
        load[2] = carried * a
        g = coefficients.gravity + a
        for d in range(3):
            along = H[2, d] * a - g * (H[0, d] * sx + H[1, d] * sy)
            for c in range(6):
                load[c] += scratch.mass[c, d] * along
            load[d] -= m * along
    waves = load[2]
    for c in range(3):
        load[c] += scratch.force[c] - m * coefficients.gravity * H[2, c]
        load[3 + c] += scratch.moment[c]
        for d in range(3):
            load[c] += H[d, c] * fleet.mooring[i, d]
            load[3 + c] += H[d, c] * fleet.mooring[i, 3 + d]
    scale = 2.0 * density * coefficients.gravity * coefficients.radiation
    for n in range(fleet.linear.coupled_count[s]):
        c, d = fleet.linear.coupled[s, n, 0], fleet.linear.coupled[s, n, 1]
        total = 0.0
        for p in range(fleet.memory.shape[1]):
            residue, state = fleet.linear.residues[s, n, p], fleet.memory[i, p, d]
            total += residue.real * state.real - residue.imag * state.imag
        load[c] -= scale * share[c] * total
    return waves


@kernel(inline=True)
def apply_drag(fleet, water, coefficients, i, h, scratch):
    """Let drag slow v and w (3,) of body i for h [s], each of its own axes alone and exactly.

    Returns the upward force [N] of that.
    """
    T, v, w, flow, wetted, mass = scratch.T, scratch.v, scratch.w, scratch.flow, scratch.wetted, scratch.mass
    q, b, C = fleet.hull[i], coefficients.linear_drag, coefficients.quadratic_drag / 2.0
    lift = 0.0
    for c in range(3):
        inertia, turning = along_axis(mass, 0, T, c), along_axis(mass, 3, T, c)
        drag = wetted[c] / 2.0 / inertia
        speed = T[0, c] * (v[0] - flow[0]) + T[1, c] * (v[1] - flow[1]) + T[2, c] * (v[2] - flow[2])
        change = after_drag(speed, b * drag, C * drag, h) - speed
        lift += T[2, c] * inertia * change / h
        # a face wet over S that rotates about an axis at radius r: drag S r^2 w, S r^3 |w| w
        d, e = (c + 1) % 3, (c + 2) % 3
        rd, re = fleet.hulls.radius_of_gyration[q, d], fleet.hulls.radius_of_gyration[q, e]
        linear = (wetted[d] * re * re + wetted[e] * rd * rd) / 2.0 / turning
        quadratic = (wetted[d] * re**3 + wetted[e] * rd**3) / 2.0 / turning
        spin = T[0, c] * w[0] + T[1, c] * w[1] + T[2, c] * w[2]
        spin_change = after_drag(spin, b * linear, C * quadratic, h) - spin
        for a in range(3):
            v[a] += T[a, c] * change
            w[a] += T[a, c] * spin_change
    return lift


@kernel(inline=True)
def along_axis(mass, first, T, c):
    """The inertia along column c of T (3, 3), of the three rows and columns of mass (6, 6) from `first`."""
    total = 0.0
    for a in range(3):
        for b in range(3):
            total += T[a, c] * mass[first + a, first + b] * T[b, c]
    return total
