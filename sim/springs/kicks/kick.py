"""`kick`: half a step's change of velocities, by the forces of position and all damping.

Damping is taken apart from the other forces only where h times its rate is small, see WEAK: link by link by the exact
decay of each, which is quick. A splitting is right only there. Where a part is stiff its steady state is wrong by
1 + y^2/12, with y its rate times h (Speth, Green, MacNamara & Strang 2013). Elsewhere the forces act inside the damping:
links and drag in one system (`sim.springs.kicks.formula`), and drag alone exactly.
Which of these it is depends on the net and the step alone, so that it is the same in every call.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.energy import account_size, close_damping, kinetic_energy, open_damping
from sim.springs.damping import damp, damp_others, other_acts
from sim.springs.kicks.chain import kick_chain, make_chain_room
from sim.springs.points.arrays import by_net, mass_at
from sim.springs.points.vector_ops import add_scaled

# Largest h times the damping rate of links and air at which they are taken apart: by `strongest_rate`, so that steady
# speeds of the fastest mode are right to WEAK^2 / 12 or 2 %, and those of slow modes, which carry the motion, far nearer.
WEAK = 0.5
FREE = 0  # no link is damped: drag is exact
SPLIT = 1  # damping is weak
WHOLE = 2  # links and drag in one system


@kernel
def rope_rate(p):
    most = 0.0
    for j in range(p.cols):
        links = (j > 0) + (j + 1 < p.cols)
        rate = max(2.0 * links * p.families[0, 2] + p.drag, 2.0 * p.drag) * p.inverse_masses[j]
        most = max(most, rate)
    return most


# Bound of the damping rate of links and air [1/s], by Gershgorin's discs; at least twice that of drag alone.
never_whole = kernel(lambda p: 0.0)
strongest_rate = by_net(rope=rope_rate, grid=never_whole, lines=never_whole)


@kernel
def net_kind(p, h):
    """FREE, SPLIT or WHOLE, of a net and steps of h [s]."""
    if not p.damped:
        return FREE
    return SPLIT if h * strongest_rate(p) <= WEAK else WHOLE


split_kind = kernel(lambda p, h: SPLIT)
kind_of = by_net(rope=net_kind, grid=net_kind, lines=split_kind)


class KickRoom(NamedTuple):
    """How the kicks of a call are taken, and their scratch."""

    kind: int
    share: NDArray[np.float64]  # (points,) time for which the acceleration acts where drag is exact [s]
    mean_share: NDArray[np.float64]  # (points,) the same of the mean velocity
    mean: NDArray[np.float64]  # (3 points,) mean velocities of a kick, where needed [m/s]
    before: NDArray[np.float64]  # (3 points,) of an account: velocities before damping [m/s]
    system: Any  # `ChainRoom` of a rope


@kernel(inline=True)
def shares(rate, s):
    """Times [s] by which w = a - rate v changes v in a time s [s], and by which the mean of v differs from v.

    s phi1(-y) and s phi2(-y), y = rate s, of exponential integrators (Hochbruck & Ostermann 2010, eq. 2.10).
    """
    y = rate * s
    if y < 1e-3:
        return s * (1.0 - y / 2.0 + y * y / 6.0 - y**3 / 24.0), s * (0.5 - y / 6.0 + y * y / 24.0 - y**3 / 120.0)
    first = -math.expm1(-y) / y
    return s * first, s * (1.0 - first) / y


@kernel
def make_net_room(x, p, s, kind, with_account):
    n = p.rows * p.cols if kind == FREE and p.drag > 0.0 else 0
    share, mean_share = np.empty(n), np.empty(n)
    for j in range(n):
        share[j], mean_share[j] = shares(p.drag * p.inverse_masses[j], s)
    mean = np.empty(x.shape[0] if with_account or kind == WHOLE else 0)
    before = np.empty(account_size(x, with_account))
    return KickRoom(kind, share, mean_share, mean, before, make_system(p, s, kind, mean))


@kernel
def make_lines_room(x, p, s, kind, with_account):
    none = np.empty(0)
    return KickRoom(kind, none, none, none, np.empty(account_size(x, with_account)), make_system(p, s, kind, none))


make_chain = kernel(lambda p, s, kind, mean: make_chain_room(p, s, kind == WHOLE, mean))
no_system = kernel(lambda p, s, kind, mean: 0, inline=True)
make_system = by_net(rope=make_chain, grid=no_system, lines=no_system)
make_room = by_net(rope=make_net_room, grid=make_net_room, lines=make_lines_room)


@kernel
def make_kick_room(x, p, h, with_account):
    """`KickRoom` of half-step kicks in steps of h [s]."""
    return make_room(x, p, 0.5 * h, kind_of(p, h), with_account)


@kernel(noalias=True, inline=True)
def kick_by_drag(v, a, w, c, share, o, n):
    """v += share (a - w c v), one component."""
    for j in range(n):
        v[o + j] += share[j] * (a[o + j] - w[j] * c * v[o + j])


@kernel(noalias=True, allocates=False)
def set_drag_mean(v, a, p, share, mean):
    n = p.rows * p.cols
    for e in range(3):
        for j in range(n):
            i = e * n + j
            mean[i] = v[i] + share[j] * (a[i] - p.inverse_masses[j] * p.drag * v[i])


@kernel(allocates=False)
def close_kick(v, a, s, p, kinetic, put_in, mean, ledger):
    """Book what damping took in a kick for a time s [s] from the kinetic energy `kinetic` [J].

    The forces of position do the work of the path, whose mean velocities are `mean`; what is not kinetic energy after
    it has been dissipated. What moving pins put in through the dampers, `put_in` [J], is dissipated, too.
    """
    n, work = p.rows * p.cols, 0.0
    for e in range(3):
        for j in range(n):
            if p.inverse_masses[j] > 0.0:
                work += mass_at(p, j) * a[e * n + j] * mean[e * n + j]
    ledger[0] += kinetic + s * work - kinetic_energy(v, p) + put_in
    ledger[1] += put_in


@kernel(inline=True)
def kick_inside_net(x, v, a, s, closing, room, p, with_account, ledger):
    """The forces of position, and the damping that is inside of their kick."""
    n = np.uint64(p.rows * p.cols)
    kinetic = 0.0
    if room.kind == WHOLE:
        if with_account:
            kinetic = kinetic_energy(v, p)
        put_in = kick_whole(x, v, a, s, closing, room.system, p)
        if with_account:
            close_kick(v, a, s, p, kinetic, put_in, room.mean, ledger)
    elif room.kind == FREE and p.drag > 0.0:
        if with_account:
            kinetic = kinetic_energy(v, p)
            set_drag_mean(v, a, p, room.mean_share, room.mean)
        for e in range(3):
            kick_by_drag(v, a, p.inverse_masses, p.drag, room.share, np.uint64(e) * n, n)
        if with_account:
            close_kick(v, a, s, p, kinetic, 0.0, room.mean, ledger)
    else:
        add_scaled(v, s, a)


kick_inside_lines = kernel(lambda x, v, a, s, closing, room, p, with_account, ledger: add_scaled(v, s, a), inline=True)
kick_inside = by_net(rope=kick_inside_net, grid=kick_inside_net, lines=kick_inside_lines)


not_whole = kernel(lambda x, v, a, s, closing, room, p: 0.0, inline=True)
kick_whole = by_net(rope=kick_chain, grid=not_whole)


@kernel(inline=True)
def damp_outside_net(x, v, t, s, decay, kind, p, reverse):
    if kind == SPLIT:
        return damp(x, v, t, s, decay, p, reverse)
    return damp_others(x, v, t, s, p, reverse) if other_acts(p) else 0.0


damp_outside_lines = kernel(lambda x, v, t, s, decay, kind, p, reverse: damp(x, v, t, s, decay, p, reverse))
# The damping that is taken apart; returns the work [J] that a moving sphere did.
damp_outside = by_net(rope=damp_outside_net, grid=damp_outside_net, lines=damp_outside_lines)


@kernel(inline=True)
def kick(x, v, a, t, s, decay, room, p, reverse, closing, with_account, ledger):
    """Change v by all forces in a time s [s], half a step, at positions x and the accelerations a of `accelerate`.

    closing: the kick that ends a step; the one that begins it goes through its parts in the reverse order. reverse: of
    the links and of other damping. decay: make_decay(p, s).
    """
    for turn in range(2):
        if (turn == 0) == closing:
            kick_inside(x, v, a, s, closing, room, p, with_account, ledger)
        else:
            kinetic = open_damping(v, p, room.before) if with_account else 0.0
            by_sphere = damp_outside(x, v, t, s, decay, room.kind, p, reverse)
            if with_account:
                close_damping(x, v, p, s, kinetic, by_sphere, room.before, ledger)
