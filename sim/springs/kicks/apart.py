"""`keep_apart`: in no step does a strand of a chain that touches itself pass another, nor a cloth pass itself.

A force that pushes things apart holds neither a pull that is strong enough nor a step that is longer than they are
thick. So the straight motion of each step is followed: two links of a chain, two edges of a cloth, or a point and a
face of it, come no nearer to each other than LEAST of the thickness, of a cloth at most of its spacing, or MOST_CLOSING
of their distance at its start. Pairs within NEAREST of LEAST come no nearer at all. Conservative advancement finds the
first time at which they do, by steps as long as the least time in which they could (Mirtich 1996, Impulse-based dynamic
simulation of rigid body systems). There the pair gets the impulses, of positions and of velocities, that end its
approach: equal and opposite, at its places of contact.
Pairs follow each other until none comes too near (Harmon, Vouga, Tamstorf & Grinspun 2008, Robust treatment of
simultaneous collisions). If that takes more than SWEEPS, no point moves further than a bound that its distances allow.

The energy that all this takes counts as dissipated. The motion of pins is not changed: one that moves further in a step
than a strand or a face is away from it may pass that.
"""

import math
from typing import Any

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.analysis.energy import kinetic_energy, stored_energies
from sim.springs.near.near_cells import (
    closing_since_list,
    find_near,
    find_neighbours,
    four_in_list,
    has_far,
    has_neighbours,
    note_left_out,
    set_closing,
    start_motion,
    stays_clear,
)
from sim.springs.near.near_pairs import (
    farthest,
    find_pairs_within,
    mean_shift,
    reach_of,
    refresh_pairs,
    spacing_of,
)
from sim.springs.points.arrays import by_net
from sim.springs.points.places import (
    Four,
    NearestPlaces,
    closing_bound,
    kick_between,
    mobility_between,
    places_at,
    point_of,
    rate_between,
)

LEAST = 0.25  # of the thickness
MOST_CLOSING = 0.9  # of the distance at the start of a step, of pairs that are nearer than LEAST
NEAREST = 0.4  # of LEAST, at which a pair comes no nearer at all: distances that shrink step by step end in round-off
SWEEPS = 30  # over the pairs
TRIES = 60  # steps of conservative advancement
NEARLY = 1.01  # of the least distance, at which a pair has met
HOLDS = 10  # times that points are held back after the sweeps, as those that are not may come near to those that are
BOUND = 0.45  # part of a pair's way to its least distance that each of its points may move, if the sweeps do not end
NEVER = 2.0  # steps: after the end of the present one


@kernel(noalias=True, inline=True)
def remember(x, p):
    for j in range(x.shape[0]):
        p.last[j] = x[j]


@kernel(noalias=True, allocates=False)
def remember_chain(x, p, follows):
    remember(x, p)


@kernel(allocates=False)
def remember_cloth(x, p, follows):
    if p.thickness > 0.0:
        start_motion(x, p, follows)
        remember(x, p)


def by_touch(chain: Any, cloth: Any) -> Any:
    """A kernel for chains, and for cloths."""
    return by_net(rope=chain, grid=cloth, strand=chain)


@kernel(inline=True)
def links_of_pair(p, q):
    a, b = p.pairs[q, 0], p.pairs[q, 1]
    return Four(False, a, a + 1, b, b + 1)


# The `Four` of row q of the list of pairs, and the distance [m] that a pair which is not nearer has to keep.
four_at = by_touch(chain=links_of_pair, cloth=four_in_list)
least_distance = by_touch(
    chain=kernel(lambda p: LEAST * p.thickness, inline=True),
    cloth=kernel(lambda p: LEAST * min(p.thickness, spacing_of(p)), inline=True),
)


@kernel(inline=True)
def least_after(p, distance):
    """Distance [m] that a pair has to keep in a step that begins at this distance."""
    least = least_distance(p)
    return min(least, max(MOST_CLOSING * distance, min(distance, NEAREST * least)))


@kernel(allocates=False)
def places_during(x, p, four, time):
    """The `NearestPlaces` at a part of the step."""
    n = p.rows * p.cols
    for e in range(4):
        j = point_of(four, e)
        for i in range(3):
            before = p.last[i * n + j]
            p.between[4 * i + e] = before + time * (x[i * n + j] - before)
    f, now = four, places_at(p.between, 4, Four(four.is_face, 0, 1, 2, 3))
    return NearestPlaces(f.a, f.b, f.c, f.d, now.wa, now.wb, now.wc, now.wd, now.distance, now.nx, now.ny, now.nz)


@kernel(allocates=False)
def meeting(x, p, four):
    """(part of the step, places, least distance [m]) of the first time at which two things are too near and still
    approach each other; NEVER if they never are."""
    n = p.rows * p.cols
    places = places_at(p.last, n, four)
    least, most = least_after(p, places.distance), closing_bound(x, p.last, n, four)
    time = 0.0
    if places.distance - least >= most or places.distance == 0.0:
        return NEVER, places, least
    for _ in range(TRIES):
        time += (places.distance - least) / most
        if time >= 1.0:
            return NEVER, places, least
        places = places_during(x, p, four, time)
        if places.distance <= NEARLY * least:
            if places.distance == 0.0 or rate_between(x, n, places) < least:
                break
            least *= 0.5  # these places part again; others of the two may not
    return time, places, least


@kernel(allocates=False)
def part_pair(x, v, p, places, least):
    """End the approach of a pair at its places of contact."""
    n, w = p.rows * p.cols, mobility_between(p, places)
    if w > 0.0:
        missing = NEARLY * NEARLY * least - rate_between(x, n, places)
        kick_between(x, p, places, max(missing, 0.0) / w)
        kick_between(v, p, places, max(-rate_between(v, n, places), 0.0) / w)


@kernel
def pairs_of_chain(x, p):
    reach = 2.0 * math.sqrt(farthest(x, p.last, np.uint64(p.cols))) + least_distance(p)
    if reach <= p.thickness:
        return refresh_pairs(p.last, p), True
    if not reach < math.inf:
        return 0, True
    find_pairs_within(p.last, p, max(reach, reach_of(p)))
    return p.pairs[p.pairs.shape[0] - 1, 0], True


@kernel
def pairs_of_cloth(x, p):
    last, least = p.near.shape[0] - 1, least_distance(p)
    has_list = p.near[last, 0] >= 0 and has_far(p, least)
    if has_list and has_neighbours(p, least):
        return p.near[last, 0], True
    if not math.sqrt(farthest(x, p.last, np.uint64(p.rows * p.cols))) < math.inf:
        return 0, True
    if not (has_list and find_neighbours(p.last, x, p)) and not find_near(p.last, x, p, least):
        if find_near(p.last, p.last, p, least):
            return 0, False
        note_left_out(p)
    set_closing(x, p)
    return p.near[last, 0], True


@kernel(inline=True)
def is_near_enough(x, p, q):
    """False of a pair that cannot come too near, by its distance when the list was made and the motion since: that of
    all parts, or its own at the start and at the end of the step."""
    kind, left = p.near[q, 2], p.near_gaps[q] - least_distance(p)
    return p.closing[kind] > left and closing_since_list(x, p, four_in_list(p, q), kind) > left


# `note_end` notes the positions x at the end of the step. `pairs_of_step` returns the number of listed pairs, which may
# meet in it, and False if the step is too long for the list. `is_worth_a_look` is False if a pair cannot meet in it.
note_end = by_touch(chain=kernel(lambda x, p: None, inline=True), cloth=set_closing)
pairs_of_step = by_touch(chain=pairs_of_chain, cloth=pairs_of_cloth)
is_worth_a_look = by_touch(chain=kernel(lambda x, p, q: True, inline=True), cloth=is_near_enough)


@kernel
def shared_shift(x, p):
    """Mean displacement in the step, (x, y, z) [m]; 0 if there are pins."""
    n = np.uint64(p.rows * p.cols)
    if p.inverse_masses.min() == 0.0:
        return 0.0, 0.0, 0.0
    return mean_shift(x, p.last, np.uint64(0), n), mean_shift(x, p.last, n, n), mean_shift(x, p.last, n + n, n)


@kernel
def shorten(x, v, p, part):
    """Shorten the motion of each free point about the mean to a part of it, `part` (points,)."""
    n = p.rows * p.cols
    mx, my, mz = shared_shift(x, p)
    for e in range(3):
        shift = mx if e == 0 else my if e == 1 else mz
        for j in range(n):
            i = e * n + j
            if part[j] < 1.0 and p.inverse_masses[j] > 0.0:
                x[i] = p.last[i] + shift + part[j] * (x[i] - p.last[i] - shift)
                v[i] *= part[j]


@kernel
def hold_back(x, v, p):
    """Shorten the motion of each point to a bound by the distances of its pairs."""
    n = p.rows * p.cols
    part = np.ones(n)
    mx, my, mz = shared_shift(x, p)
    count, _ = pairs_of_step(x, p)
    for q in range(count):
        if not is_worth_a_look(x, p, q):
            continue
        four = four_at(p, q)
        distance = places_at(p.last, n, four).distance
        most = BOUND * (distance - least_after(p, distance))
        for e in range(4):
            j = point_of(four, e)
            dx, dy, dz = x[j] - p.last[j] - mx, x[n + j] - p.last[n + j] - my, x[2 * n + j] - p.last[2 * n + j] - mz
            way = math.sqrt(dx * dx + dy * dy + dz * dz)
            if way > most:
                part[j] = min(part[j], most / way)
    shorten(x, v, p, part)


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
def may_links_meet(x, p):
    n, least = np.uint64(p.cols), least_distance(p)
    if 2.0 * math.sqrt(farthest_in_step(x, p.last, p.seen, n)) < p.nearest[0] - least:
        return False
    # Of a rope that flies the motion about the mean decides.
    since, now = math.sqrt(farthest(p.last, p.seen, n)), math.sqrt(farthest(x, p.last, n))
    return not 2.0 * (since + now) < p.nearest[0] - least


@kernel(allocates=False)
def may_cloth_meet(x, p):
    if p.thickness == 0.0:
        return False
    if p.near[p.near.shape[0] - 1, 0] < 0:
        return True
    set_closing(x, p)
    return not stays_clear(p, least_distance(p))


# False if no pair can come too near, by its distance when the list was made and the motion since.
may_meet = by_touch(chain=may_links_meet, cloth=may_cloth_meet)


@kernel(allocates=False)
def energy_of(x, v, t, p):
    elastic, gravity, contact = stored_energies(x, t, p)
    return kinetic_energy(v, p) + elastic + gravity + contact


@kernel
def part_pairs(x, v, t, p, with_account, ledger):
    """`keep_apart` of a step in which pairs may meet, as `may_meet` has noted its end."""
    kept, slowed, before = False, False, 0.0
    for sweep in range(SWEEPS + HOLDS + 1):
        if is_stopped(p.stop):
            break
        if sweep > 0:
            note_end(x, p)
        count, has_room = pairs_of_step(x, p)
        met = not has_room
        for q in range(count):
            if not is_worth_a_look(x, p, q):
                continue
            time, places, least = meeting(x, p, four_at(p, q))
            if time == NEVER:
                continue
            if not kept and with_account:
                before = energy_of(x, v, t, p)
            met = kept = True
            if sweep >= SWEEPS:
                break
            part_pair(x, v, p, places, least)
        if not met or sweep == SWEEPS + HOLDS:
            break
        if not has_room or sweep >= SWEEPS:
            if not kept and with_account:
                before = energy_of(x, v, t, p)
            kept = slowed = True
            if has_room:
                hold_back(x, v, p)
            else:
                shorten(x, v, p, np.full(p.rows * p.cols, 0.5))
    if slowed:
        ledger[3] += 1.0
    if kept and with_account:
        ledger[0] += before - energy_of(x, v, t, p)
    return kept


@kernel(allocates=False)
def keep_net_apart(x, v, t, p, with_account, ledger):
    return may_meet(x, p) and part_pairs(x, v, t, p, with_account, ledger)


nothing = kernel(lambda x, p, follows: None, inline=True)
never = kernel(lambda x, v, t, p, with_account, ledger: False, inline=True)
# Remember the positions at the start of a step, for `keep_apart`. follows: these are those at the end of the last step.
remember_places = by_net(rope=nothing, grid=nothing, cloth=remember_cloth, lines=nothing, strand=remember_chain)
# End a step to x [m], v [m/s] at time t [s] before a strand of a chain passes another, or a part of a cloth passes
# another. Returns True if x or v were changed.
keep_apart = by_net(rope=never, grid=never, cloth=keep_net_apart, lines=never, strand=keep_net_apart)
