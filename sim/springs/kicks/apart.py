"""`keep_apart`: in no step does a strand of a chain that touches itself pass another.

A force that pushes strands apart holds neither a pull that is strong enough nor a step that is longer than the rope is
thick. So the straight motion of each step is followed: two links come no nearer to each other than LEAST of the
thickness, or MOST_CLOSING of their distance at its start. Conservative advancement finds the first time at which they
do, by steps as long as the least time in which they could (Mirtich 1996, Impulse-based dynamic simulation of rigid body
systems). There the pair gets the impulses, of positions and of velocities, that end its approach: equal and opposite,
at its places of contact. Pairs follow each other until none comes too near (Harmon, Vouga, Tamstorf & Grinspun 2008,
Robust treatment of simultaneous collisions). If that takes more than SWEEPS, no point moves further than a bound that
its distances allow.

The energy that all this takes counts as dissipated. The motion of pins is not changed: one that moves further in a step
than a strand is away from it may pass the strand.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.analysis.energy import kinetic_energy, stored_energies
from sim.springs.forces.strand_contact import add_kick, pair_mobility
from sim.springs.points.arrays import by_net
from sim.springs.points.link_pairs import LinkPair, pair_at, rate_of
from sim.springs.points.near_pairs import farthest, find_pairs_within, mean_shift, reach_of, refresh_pairs

LEAST = 0.25  # of the thickness
MOST_CLOSING = 0.9  # of the distance at the start of a step, of pairs that are nearer than LEAST
SWEEPS = 30  # over the pairs
TRIES = 60  # steps of conservative advancement
NEARLY = 1.01  # of the least distance, at which two links have met
BOUND = 0.45  # part of a pair's way to its least distance that each of its points may move, if the sweeps do not end
NEVER = 2.0  # steps: after the end of the present one


@kernel(noalias=True, allocates=False)
def remember_chain(x, p):
    for j in range(x.shape[0]):
        p.last[j] = x[j]


@kernel(inline=True)
def shift_of(x, p, j):
    """Displacement of point j since the start of the step."""
    n = p.cols
    return x[j] - p.last[j], x[n + j] - p.last[n + j], x[2 * n + j] - p.last[2 * n + j]


@kernel(inline=True)
def end_of(pair, e):
    """Point e, from 0 to 3, of a pair."""
    return pair.a + e if e < 2 else pair.b + e - 2


@kernel(inline=True)
def least_of(p, pair):
    """Least distance [m] that a pair may have at the end of a step."""
    return min(LEAST * p.thickness, MOST_CLOSING * pair.distance)


@kernel(allocates=False)
def closing_bound(x, p, pair):
    """Largest change of the distance of two links [m] in the step: twice the motion of any end about their mean."""
    mx = my = mz = most = 0.0
    for e in range(4):
        dx, dy, dz = shift_of(x, p, end_of(pair, e))
        mx, my, mz = mx + 0.25 * dx, my + 0.25 * dy, mz + 0.25 * dz
    for e in range(4):
        dx, dy, dz = shift_of(x, p, end_of(pair, e))
        most = max(most, (dx - mx) ** 2 + (dy - my) ** 2 + (dz - mz) ** 2)
    return 2.0 * math.sqrt(most)


@kernel(allocates=False)
def pair_during(x, p, pair, time):
    """The `LinkPair` at a part of the step."""
    n = p.cols
    for e in range(4):
        j = end_of(pair, e)
        for i in range(3):
            before = p.last[i * n + j]
            p.between[4 * i + e] = before + time * (x[i * n + j] - before)
    now = pair_at(p.between, 4, 0, 2)
    return LinkPair(pair.a, pair.b, now.s, now.t, now.distance, now.nx, now.ny, now.nz)


@kernel(allocates=False)
def meeting(x, p, a, b):
    """(part of the step, pair, least distance [m]) of the first time at which two links are too near and still approach
    each other; NEVER if they never are."""
    pair = pair_at(p.last, p.cols, a, b)
    least, most, time = least_of(p, pair), closing_bound(x, p, pair), 0.0
    if pair.distance - least >= most or pair.distance == 0.0:
        return NEVER, pair, least
    for _ in range(TRIES):
        time += (pair.distance - least) / most
        if time >= 1.0:
            return NEVER, pair, least
        pair = pair_during(x, p, pair, time)
        if pair.distance <= NEARLY * least:
            if pair.distance == 0.0 or rate_of(x, p.cols, pair) < least:
                break
            least *= 0.5  # these places part again; others of the two links may not
    return time, pair, least


@kernel(allocates=False)
def part_pair(x, v, p, pair, least):
    """End the approach of a pair at its places of contact."""
    w = pair_mobility(p, pair)
    if w > 0.0:
        missing = NEARLY * NEARLY * least - rate_of(x, p.cols, pair)
        add_kick(x, p, pair, max(missing, 0.0) / w)
        add_kick(v, p, pair, max(-rate_of(v, p.cols, pair), 0.0) / w)


@kernel
def pairs_of_step(x, p):
    """Number of pairs in the list of those that may meet in the step."""
    reach = 2.0 * math.sqrt(farthest(x, p.last, np.uint64(p.cols))) + LEAST * p.thickness
    if reach <= p.thickness:
        return refresh_pairs(p.last, p)
    if not reach < math.inf:
        return 0
    find_pairs_within(p.last, p, max(reach, reach_of(p)))
    return p.pairs[p.pairs.shape[0] - 1, 0]


@kernel
def hold_back(x, v, p):
    """Shorten the motion of each point, without pins about the mean, to a bound by the distances of its links."""
    n = np.uint64(p.cols)
    part = np.ones(p.cols)
    mx = my = mz = 0.0
    if p.inverse_masses.min() > 0.0:
        mx, my = mean_shift(x, p.last, np.uint64(0), n), mean_shift(x, p.last, n, n)
        mz = mean_shift(x, p.last, n + n, n)
    for q in range(pairs_of_step(x, p)):
        pair = pair_at(p.last, p.cols, p.pairs[q, 0], p.pairs[q, 1])
        for e in range(4):
            j = end_of(pair, e)
            dx, dy, dz = shift_of(x, p, j)
            way = math.sqrt((dx - mx) ** 2 + (dy - my) ** 2 + (dz - mz) ** 2)
            most = BOUND * (pair.distance - least_of(p, pair))
            if way > most and p.inverse_masses[j] > 0.0:
                part[j] = min(part[j], most / way)
    for e in range(3):
        shift = mx if e == 0 else my if e == 1 else mz
        for j in range(p.cols):
            i = e * p.cols + j
            if part[j] < 1.0:
                x[i] = p.last[i] + shift + part[j] * (x[i] - p.last[i] - shift)
                v[i] *= part[j]


@kernel(noalias=True, inline=True)
def farthest_in_step(x, last, seen, n):
    """Largest squared displacement of a point since the list was made, at the start or at the end of the step."""
    most = 0.0
    for j in range(n):
        dx, dy, dz = x[j] - seen[j], x[n + j] - seen[n + j], x[n + n + j] - seen[n + n + j]
        ex, ey, ez = last[j] - seen[j], last[n + j] - seen[n + j], last[n + n + j] - seen[n + n + j]
        most = max(most, dx * dx + dy * dy + dz * dz, ex * ex + ey * ey + ez * ez)
    return most


@kernel(allocates=False)
def may_meet(x, p):
    """False if no pair can come too near, by its distance when the list was made and the motion since."""
    n = np.uint64(p.cols)
    if 2.0 * math.sqrt(farthest_in_step(x, p.last, p.seen, n)) < p.nearest[0] - LEAST * p.thickness:
        return False
    # Of a rope that flies the motion about the mean decides.
    since, now = math.sqrt(farthest(p.last, p.seen, n)), math.sqrt(farthest(x, p.last, n))
    return not 2.0 * (since + now) < p.nearest[0] - LEAST * p.thickness


@kernel
def part_pairs(x, v, t, p, with_account, ledger):
    """`keep_apart` of a step in which pairs may meet."""
    kept, before = False, 0.0
    for sweep in range(SWEEPS + 1):
        met = False
        for q in range(pairs_of_step(x, p)):
            time, pair, least = meeting(x, p, p.pairs[q, 0], p.pairs[q, 1])
            if time == NEVER:
                continue
            if not kept and with_account:
                elastic, gravity, contact = stored_energies(x, t, p)
                before = kinetic_energy(v, p) + elastic + gravity + contact
            met = kept = True
            if sweep == SWEEPS:
                break
            part_pair(x, v, p, pair, least)
        if not met:
            break
        if sweep == SWEEPS:
            hold_back(x, v, p)
            ledger[2] += 1.0
    if kept and with_account:
        elastic, gravity, contact = stored_energies(x, t, p)
        ledger[0] += before - kinetic_energy(v, p) - elastic - gravity - contact
    return kept


@kernel(allocates=False)
def keep_chain_apart(x, v, t, p, with_account, ledger):
    return may_meet(x, p) and part_pairs(x, v, t, p, with_account, ledger)


nothing = kernel(lambda x, p: None, inline=True)
never = kernel(lambda x, v, t, p, with_account, ledger: False, inline=True)
# Remember the positions at the start of a step, for `keep_apart`.
remember_places = by_net(rope=nothing, grid=nothing, lines=nothing, strand=remember_chain)
# End a step to x [m], v [m/s] at time t [s] before a strand passes another. Returns True if x or v were changed.
keep_apart = by_net(rope=never, grid=never, lines=never, strand=keep_chain_apart)
