"""Coulomb's law between the strands of a chain that touches itself, solved in each step.

Two places that touch get the tangential forces that stop them along each other against the sum of all other forces, at
most mu N, as points do on a surface (`sim.springs.forces.friction`). A link may touch several others, so that all are
solved together, pair by pair in sweeps to and fro (M. Jean 1999, The non-smooth contact dynamics method, section 5),
until no force changes by more than SETTLED of the largest mu N, or after SWEEPS. A kick begins with the forces of the
one before, which a state keeps (`State.rubs`), so that MORE_SWEEPS are enough, even in a tight knot.

Implicit methods find by such sweeps the forces that hold a chain at rest at the start of a step. In the step each pair
gets its force and what stops its places in the step, at most mu N: friction depends on velocities alone, as that of
points does there.

A chain has no torsion: the forces act at the nearest places of the links' axes, and the moment of their distance, which
would twist the strands, is left out.
"""

import math

from sim import point_laws
from sim.jit import kernel
from sim.springs.forces.friction import FIXED, NOTED
from sim.springs.forces.matrices import add_block
from sim.springs.forces.record import Force
from sim.springs.forces.strand_contact import (
    MOBILITY,
    add_opposite,
    depth_of,
    pinned_velocity,
    push_of,
    touching_at_hand,
    touching_pair,
)
from sim.springs.points.arrays import StrandArrays
from sim.springs.points.link_pairs import opening_of
from sim.springs.points.order import in_turn

SWEEPS = 50
MORE_SWEEPS = 2
SETTLED = 1e-6
HELD = 1e-9  # the same of forces that hold through a step of an implicit method, where their error makes creep
# Further columns of p.rubs: mu N [N] of a touching pair, the force on its second link [N], and the impulse [N s].
MOST, FORCE_AT, IMPULSE_AT = 7, 8, 11

stopping = kernel(inline=True)(point_laws.stopping)


@kernel(allocates=False)
def note(x, v, p):
    """Note the force mu N of each touching pair; returns their number, and the largest mu N [N]."""
    count, largest = touching_at_hand(x, p), 0.0
    for i in range(count):
        pair = touching_pair(p, i)
        p.rubs[i, MOST] = p.friction * push_of(v, p, pair, depth_of(p, pair), True)
        largest = max(largest, p.rubs[i, MOST])
    return count, largest


@kernel(inline=True)
def along_surface(pair, u, v, w):
    """The part of a vector across the normal of a pair."""
    normal = u * pair.nx + v * pair.ny + w * pair.nz
    return u - normal * pair.nx, v - normal * pair.ny, w - normal * pair.nz


@kernel(inline=True)
def change(out, p, i, pair, column, fx, fy, fz):
    """Set the force, or impulse, on the second link of a pair, and add its change to `out`; returns that, squared."""
    row = p.rubs[i]
    dx, dy, dz = fx - row[column], fy - row[column + 1], fz - row[column + 2]
    row[column], row[column + 1], row[column + 2] = fx, fy, fz
    add_opposite(out, p, pair, 1.0, dx, dy, dz)
    return dx * dx + dy * dy + dz * dz


@kernel(inline=True)
def clear(p, count, column):
    for i in range(count):
        for k in range(column, column + 3):
            p.rubs[i, k] = 0.0


@kernel(allocates=False)
def sweep_forces(v, stop_rate, p, count, reverse, a):
    """One sweep of `accelerate`; returns the largest change of a force, squared."""
    n, largest = p.cols, 0.0
    for turn in range(count):
        i = in_turn(turn, count, reverse)
        pair, w = touching_pair(p, i), p.rubs[i, MOBILITY]
        most = p.rubs[i, MOST]
        if most == 0.0 or w == 0.0:
            continue
        u, q, r = opening_of(v, n, pair)
        ax, ay, az = opening_of(a, n, pair)
        fx, fy, fz = w * p.rubs[i, FORCE_AT], w * p.rubs[i, FORCE_AT + 1], w * p.rubs[i, FORCE_AT + 2]
        sx, sy, sz, part = stopping(pair.nx, pair.ny, pair.nz, u, q, r, ax - fx, ay - fy, az - fz, most * w, stop_rate)
        share = -part / w
        largest = max(largest, change(a, p, i, pair, FORCE_AT, share * sx, share * sy, share * sz))
    return largest


@kernel(inline=True)
def number_of_last(p):
    """Number of pairs that `keep` has last kept."""
    return max(0, p.touching[p.touching.shape[0] - 1, 1])


@kernel(inline=True)
def first_in_last(p, i, first):
    """Number, from `first` on, of the first pair kept whose first point is not before that of touching pair i.

    The pairs of both lists are in the order of their first points.
    """
    number = number_of_last(p)
    while first < number and p.last_rubs[first, 0] < p.touching[i, 0]:
        first += 1
    return first


@kernel(inline=True)
def number_in_last(p, i, first):
    """Number of touching pair i among those kept, from `first_in_last` on; their count if it is not among them."""
    a, b, last, count = p.touching[i, 0], p.touching[i, 1], p.last_rubs, number_of_last(p)
    while first < count and last[first, 0] == a:
        if last[first, 1] == b:
            return first
        first += 1
    return count


@kernel(allocates=False)
def keep(p, count, column, scale):
    """Keep `scale` times the numbers of a column as forces, for the next kick or the stages of an implicit step."""
    for i in range(count):
        row, last = p.rubs[i], p.last_rubs[i]
        last[0], last[1] = p.touching[i, 0], p.touching[i, 1]
        last[2], last[3], last[4] = scale * row[column], scale * row[column + 1], scale * row[column + 2]
    p.touching[p.touching.shape[0] - 1, 1] = count


@kernel(inline=True)
def stopping_with_noted(v, p, i, pair, first):
    """`stopping` of touching pair i by the velocities v and the force that was kept for it."""
    u, q, r = opening_of(v, p.cols, pair)
    k, w = number_in_last(p, i, first), p.rubs[i, MOBILITY]
    ax = ay = az = 0.0
    if k < number_of_last(p):
        last = p.last_rubs[k]
        ax, ay, az = -w * last[2], -w * last[3], -w * last[4]
    return stopping(pair.nx, pair.ny, pair.nz, u, q, r, ax, ay, az, p.rubs[i, MOST] * w, p.stop_rate)


@kernel(allocates=False)
def add_fixed(v, p, count, a):
    """Add the friction of a stage of an implicit step: that against the forces which were kept, and the velocities."""
    first = 0
    for i in range(count):
        w = p.rubs[i, MOBILITY]
        if w == 0.0:
            continue
        pair = touching_pair(p, i)
        first = first_in_last(p, i, first)
        sx, sy, sz, part = stopping_with_noted(v, p, i, pair, first)
        share = -part / w
        change(a, p, i, pair, FORCE_AT, share * sx, share * sy, share * sz)


@kernel(allocates=False)
def settle_forces(v, stop_rate, p, count, tolerance, a):
    """Sweep until no force changes by more than this [N], or SWEEPS times."""
    for sweep in range(SWEEPS):
        if sweep_forces(v, stop_rate, p, count, sweep % 2 == 1, a) <= tolerance * tolerance:
            break


@kernel(allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    if not with_damping:
        return
    count, most = note(x, v, p)
    clear(p, count, FORCE_AT)
    if p.load_is[0] == FIXED:
        add_fixed(v, p, count, a)
        return
    if p.load_is[0] == NOTED:
        settle_forces(v, 0.0, p, count, HELD * most, a)
        keep(p, count, FORCE_AT, 1.0)
    settle_forces(v, p.stop_rate, p, count, SETTLED * most, a)


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """The secant of the force over the sliding speed, of each pair, as against its noted force.

    Each place by itself, with the whole mass of the pair: the matrix resists no less than the forces do.
    """
    count, first = note(x, v, p)[0], 0
    for i in range(count):
        if p.rubs[i, MOBILITY] == 0.0:
            continue
        pair = touching_pair(p, i)
        first = first_in_last(p, i, first)
        _, _, _, part = stopping_with_noted(v, p, i, pair, first)
        across = g * p.stop_rate * part / p.rubs[i, MOBILITY]
        for e in range(2):
            a, s = (pair.a, pair.s) if e == 0 else (pair.b, pair.t)
            add_block(points, a, p.cols, 0.0, (1.0 - s) * across, pair.nx, pair.ny, pair.nz)
            add_block(points, a + 1, p.cols, 0.0, s * across, pair.nx, pair.ny, pair.nz)


@kernel(allocates=False)
def foresee(x, v, t, p):
    """Set the forces of pairs that slide at v, before a kick that `hold` ends."""
    for i in range(note(x, v, p)[0]):
        pair, most, w = touching_pair(p, i), p.rubs[i, MOST], p.rubs[i, MOBILITY]
        u, q, r = opening_of(v, p.cols, pair)
        tx, ty, tz = along_surface(pair, u, q, r)
        speed = math.sqrt(tx * tx + ty * ty + tz * tz)
        # Places that friction could stop in the kick may be at rest, where the direction of their motion is round-off.
        over = -most / speed if p.stop_rate * speed > 0.5 * most * w else 0.0
        p.rubs[i, FORCE_AT], p.rubs[i, FORCE_AT + 1], p.rubs[i, FORCE_AT + 2] = over * tx, over * ty, over * tz


@kernel(allocates=False)
def sweep_impulses(v, s, p, count, foreseen, reverse):
    """One sweep of `hold`; returns the largest change of an impulse, squared."""
    largest = 0.0
    for turn in range(count):
        i = in_turn(turn, count, reverse)
        pair, w, row = touching_pair(p, i), p.rubs[i, MOBILITY], p.rubs[i]
        limit = s * row[MOST]
        if limit == 0.0 or w == 0.0:
            continue
        u, q, r = opening_of(v, p.cols, pair)
        jx, jy, jz = row[IMPULSE_AT], row[IMPULSE_AT + 1], row[IMPULSE_AT + 2]
        tx, ty, tz = along_surface(pair, u - w * jx, q - w * jy, r - w * jz)
        speed, fx, fy, fz = math.sqrt(tx * tx + ty * ty + tz * tz), row[FORCE_AT], row[FORCE_AT + 1], row[FORCE_AT + 2]
        if speed > w * limit and foreseen and (fx != 0.0 or fy != 0.0 or fz != 0.0):
            jx, jy, jz = s * fx, s * fy, s * fz
        else:
            over = -min(1.0 / w, limit / speed) if speed > 0.0 else 0.0
            jx, jy, jz = over * tx, over * ty, over * tz
        largest = max(largest, change(v, p, i, pair, IMPULSE_AT, jx, jy, jz))
    return largest


@kernel(inline=True)
def pins_share(v, p, i, column):
    """Product of a force, or impulse, of a pair and the motion that pins give its places: work that they put in."""
    pair, row = touching_pair(p, i), p.rubs[i]
    ax, ay, az = pinned_velocity(v, p, pair.a, pair.s)
    bx, by, bz = pinned_velocity(v, p, pair.b, pair.t)
    return row[column] * (ax - bx) + row[column + 1] * (ay - by) + row[column + 2] * (az - bz)


@kernel(allocates=False)
def begin_with_last(v, s, p, count):
    """Begin with the forces of the last kick, each at most its pair's limit; returns False without such a kick."""
    number, first = number_of_last(p), 0
    for i in range(count):
        first = first_in_last(p, i, first)
        k = number_in_last(p, i, first)
        if k == number or p.rubs[i, MOBILITY] == 0.0:
            continue
        pair, last = touching_pair(p, i), p.last_rubs[k]
        jx, jy, jz = along_surface(pair, s * last[2], s * last[3], s * last[4])
        size, limit = math.sqrt(jx * jx + jy * jy + jz * jz), s * p.rubs[i, MOST]
        part = limit / size if size > limit else 1.0
        change(v, p, i, pair, IMPULSE_AT, part * jx, part * jy, part * jz)
    return number > 0


@kernel(allocates=False)
def hold(x, v, t, s, p, foreseen):
    """Friction for a time s, last in a kick, which stops places that it can stop. Returns the work of pins [J].

    foreseen: of other places, the friction that `foresee` has set, for a kick that mirrors one without.
    """
    count, most = note(x, v, p)
    clear(p, count, IMPULSE_AT)
    sweeps = MORE_SWEEPS if begin_with_last(v, s, p, count) else SWEEPS
    for sweep in range(sweeps):
        if sweep_impulses(v, s, p, count, foreseen, sweep % 2 == 1) <= (SETTLED * s * most) ** 2:
            break
    keep(p, count, IMPULSE_AT, 1.0 / s)
    work = 0.0
    if p.pins.shape[0] > 0:
        for i in range(count):
            work += pins_share(v, p, i, IMPULSE_AT)
    return work


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """(dissipated, put in by moving pins) [W] by the forces that `accelerate` has last noted."""
    dissipated = work = 0.0
    if with_damping:
        for i in range(touching_at_hand(x, p)):
            u, q, r = opening_of(v, p.cols, touching_pair(p, i))
            row = p.rubs[i]
            dissipated -= row[FORCE_AT] * u + row[FORCE_AT + 1] * q + row[FORCE_AT + 2] * r
            work += pins_share(v, p, i, FORCE_AT)
    return dissipated, work


FORCE = Force(
    "strand_friction", rank=990, nets=(StrandArrays,), acts="p.friction > 0.0 and not p.lab_contact",
    accelerate=accelerate, foresee=foresee, hold=hold, power=power, blocks=blocks,
)  # fmt: skip
