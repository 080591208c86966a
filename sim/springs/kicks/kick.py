"""`kick`: half a step's change of velocities, by the forces of position and all damping.

Damping is taken apart from the other forces only where h times its rate is small, see WEAK: link by link by the exact
decay of each, which is quick. A splitting is right only there. With y the rate of a stiff part times h, its steady
speed is wrong by y^2/12 (Speth, Green, MacNamara & Strang 2013). Elsewhere the forces act inside the damping: links and
drag in one system (`sim.springs.kicks.formula`), drag alone exactly. Which of these it is depends on the net and the
step alone, so that it is the same in every call. The normal damping of points and links on floor and sphere, and of a
rope's contact with itself, is inside the kick of each point, link or pair; it is taken apart only where links and drag
are one system. That of a cloth's faces and of its contact with itself is always taken apart.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.energy import account_size, close_damping, kinetic_energy, open_damping
from sim.springs.damping import damp_beside, damp_lines, damp_motion, damp_others, foresee_all, hold_all, other_acts
from sim.springs.forces.contact import kick_touching
from sim.springs.forces.link_contact import damp_kicked
from sim.springs.forces.strand_contact import damp_strands_kicked
from sim.springs.kicks.chain import factor_chain, make_chain, solve_chain
from sim.springs.kicks.dampers import (
    MOST_CHANGES,
    Dampers,
    add_limited,
    limit_anew,
    make_dampers,
    may_be_limited,
    set_directions,
    set_whole,
)
from sim.springs.kicks.formula import shares
from sim.springs.kicks.lines import kick_lines, kick_lines_with_account, make_lines_system
from sim.springs.kicks.sheet import make_sheet, solve_sheet
from sim.springs.points.arrays import by_net, mass_at
from sim.springs.points.each_contact import touches
from sim.springs.points.each_link import each_link
from sim.springs.points.order import in_turn
from sim.springs.points.vector_ops import add_scaled, set_sum

# Largest h times `strongest_rate` at which damping is taken apart: steady speeds of the fastest mode are then right to
# WEAK^2 / 12, or 2 %, and those of slow modes, which carry the motion, far nearer.
WEAK = 0.5
FREE = 0  # no link is damped: drag is exact
SPLIT = 1  # damping is weak
WHOLE = 2  # links and drag in one system


@each_link()
def add_rates(link, p, rates):
    """Add the bounds of a link's damping rate to those of its ends [1/s], by Gershgorin's discs."""
    rates[link.a] += 2.0 * link.damping * p.inverse_masses[link.a]
    rates[link.b] += 2.0 * link.damping * p.inverse_masses[link.b]


@kernel
def strongest_rate(p):
    """Bound of the damping rate of links and air [1/s], and at least twice the rate of the air."""
    rates, strongest = np.zeros(p.rows * p.cols), 0.0
    add_rates(p, rates)
    for j in range(rates.shape[0]):
        drag = p.drag * p.inverse_masses[j]
        strongest = max(strongest, drag + max(drag, rates[j]))
    return strongest


@kernel
def net_kind(p, h):
    """FREE, SPLIT or WHOLE, of a net and steps of h [s]."""
    if not p.damped:
        return FREE
    return SPLIT if h * strongest_rate(p) <= WEAK else WHOLE


split_kind = kernel(lambda p, h: SPLIT)
kind_of = by_net(rope=net_kind, grid=net_kind, lines=split_kind)


class KickRoom(NamedTuple):
    """The way in which the kicks of a call are taken, and their scratch."""

    kind: int
    share: NDArray[np.float64]  # (points,) time for which w = a - c v / m changes v, where drag is exact [s]
    mean_share: NDArray[np.float64]  # (points,) the same of the mean of v
    mean: NDArray[np.float64]  # (3 points,) mean velocities of a kick, where needed [m/s]
    before: NDArray[np.float64]  # (3 points,) of an account: velocities before damping [m/s]
    load: NDArray[np.float64]  # (3 points,) accelerations by all but linear dampers [m/s2]
    force: NDArray[np.float64]  # (3 points,) mean forces of dampers [N]
    dampers: Dampers
    system: Any  # `ChainSystem` of a rope, `SheetSystem` of another net, `LinesRoom` of lines


make_system = by_net(rope=make_chain, grid=kernel(lambda p, s, wanted: make_sheet(p, wanted)), strand=make_chain)
keep_factors = kernel(lambda system, dampers, p: None, inline=True)
factor = by_net(rope=factor_chain, grid=keep_factors, strand=factor_chain)
solve = by_net(rope=solve_chain, grid=solve_sheet, strand=solve_chain)


@kernel
def make_net_room(x, p, s, kind, with_account):
    whole, by_drag = kind == WHOLE, kind == FREE and p.drag > 0.0
    share, mean_share = np.empty(p.rows * p.cols if by_drag else 0), np.empty(p.rows * p.cols if by_drag else 0)
    for j in range(share.shape[0]):
        share[j], mean_share[j] = shares(p.drag * p.inverse_masses[j], s)
    mean = np.empty(x.shape[0] if with_account or whole else 0)
    load = np.empty(x.shape[0] if whole else 0)
    before = np.empty(account_size(x, with_account))
    dampers, system = make_dampers(p, whole), make_system(p, s, whole)
    if whole:
        factor(system, dampers, p)
    return KickRoom(kind, share, mean_share, mean, before, load, np.empty_like(load), dampers, system)


@kernel
def make_lines_room(x, p, s, kind, with_account):
    none = np.empty(0)
    before = np.empty(account_size(x, with_account))
    return KickRoom(kind, none, none, none, before, none, none, make_dampers(p, False), make_lines_system(p))


make_room = by_net(rope=make_net_room, grid=make_net_room, lines=make_lines_room)


@kernel
def make_kick_room(x, p, h, with_account):
    """`KickRoom` of half-step kicks in steps of h [s]."""
    return make_room(x, p, 0.5 * h, kind_of(p, h), with_account)


@kernel(noalias=True, allocates=False)
def kick_whole(x, v, a, s, closing, room, p, ledger):
    """Kick with links and drag in one system; room.mean is left with the mean velocities.

    Returns the work [J] that moving pins did through the dampers. A solve that has not settled counts in ledger[2].
    """
    n, work, settled, limited = p.rows * p.cols, 0.0, True, may_be_limited(p.law)
    if p.axial:
        set_directions(x, v, p, room.dampers)
    if limited:
        set_whole(p, room.dampers)
        factor(room.system, room.dampers, p)
    for _ in range(MOST_CHANGES):
        for j in range(3 * n):
            room.force[j] = 0.0
        if limited:
            add_limited(p, room.dampers, room.force)
        for e in range(3):
            for j in range(n):
                room.load[e * n + j] = a[e * n + j] + p.inverse_masses[j] * room.force[e * n + j]
        settled = solve(v, room.load, s, closing, room.system, room.dampers, p, room.mean, room.force)
        if not limited or limit_anew(x, room.mean, s, closing, p, room.dampers) == 0.0:
            break
        factor(room.system, room.dampers, p)
    for e in range(3):
        for j in range(n):
            i, w = e * n + j, p.inverse_masses[j]
            if w == 0.0:
                work -= s * room.force[i] * v[i]
            else:
                v[i] += s * (a[i] + w * (room.force[i] - p.drag * room.mean[i]))
    ledger[2] += 0.0 if settled else 1.0
    return work


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
    """Book the loss to damping in a kick for a time s [s] that began with the kinetic energy `kinetic` [J].

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
def kick_alone(x, v, a, t, s, room, p, with_account):
    """`kick_points` without the damping of links that touch the sphere or each other."""
    n, drag = np.uint64(p.rows * p.cols), p.drag if room.kind == FREE else 0.0
    if touches(x, t, p, False) or touches(x, t, p, True):
        return kick_touching(x, v, a, drag, t, s, p, room.mean)
    if drag == 0.0:
        if with_account:
            set_sum(room.mean, v, 0.5 * s, a)
        add_scaled(v, s, a)
        return 0.0
    if with_account:
        set_drag_mean(v, a, p, room.mean_share, room.mean)
    for e in range(3):
        kick_by_drag(v, a, p.inverse_masses, drag, room.share, np.uint64(e) * n, n)
    return 0.0


@kernel(allocates=False)
def damp_all_kicked(x, v, a, mean, t, s, p, reverse):
    work = 0.0
    for turn in range(2):
        if in_turn(turn, 2, reverse) == 0:
            work += damp_kicked(x, v, a, mean, t, s, p, reverse)
        else:
            damp_strands_kicked(x, v, a, mean, s, p, reverse)
    return work


# Normal damping of links that touch the sphere or each other, in the kick of their points.
damp_links_kicked = by_net(
    rope=damp_kicked,
    grid=kernel(lambda x, v, a, mean, t, s, p, reverse: 0.0, inline=True),
    strand=damp_all_kicked,
)
# True if links touch each other.
strands_touch = by_net(
    rope=kernel(lambda p: False, inline=True),
    grid=kernel(lambda p: False, inline=True),
    strand=kernel(lambda p: True, inline=True),
)


@kernel(allocates=False)
def kick_points(x, v, a, t, s, closing, room, p, with_account):
    """Kick each point by itself, with drag and the normal damping of contact inside.

    Returns the work [J] that a moving sphere did by its damping.
    """
    kicked = kick_alone(x, v, a, t, s, room, p, with_account)
    return kicked + damp_links_kicked(x, v, a, room.mean, t, s, p, closing)


@kernel(inline=True)
def kick_inside_net(x, v, a, t, s, closing, room, p, with_account, ledger):
    """The forces of position, and the damping that is inside of their kick."""
    touches_anything = p.has_floor or p.has_sphere or strands_touch(p)
    if room.kind != WHOLE and not (touches_anything or (room.kind == FREE and p.drag > 0.0)):
        add_scaled(v, s, a)
        return
    kinetic = kinetic_energy(v, p) if with_account else 0.0
    if room.kind == WHOLE:
        put_in = kick_whole(x, v, a, s, closing, room, p, ledger)
    else:
        put_in = kick_points(x, v, a, t, s, closing, room, p, with_account)
    if with_account:
        close_kick(v, a, s, p, kinetic, put_in, room.mean, ledger)


@kernel(inline=True)
def kick_inside_lines(x, v, a, t, s, closing, room, p, with_account, ledger):
    if with_account:
        kick_lines_with_account(x, v, a, t, s, p, not closing, room.system, room.before, ledger)
    else:
        kick_lines(x, v, a, t, s, p, not closing, room.system, ledger)


kick_inside = by_net(rope=kick_inside_net, grid=kick_inside_net, lines=kick_inside_lines)


@kernel(inline=True)
def damp_outside_net(x, v, t, s, decay, kind, p, reverse):
    work = 0.0
    for turn in range(2):
        if in_turn(turn, 2, reverse) == 0:
            if kind == SPLIT:
                damp_motion(x, v, s, decay, p, reverse)
        elif other_acts(p):
            if kind == WHOLE:
                work += damp_others(x, v, t, s, p, reverse)
            else:
                work += damp_beside(x, v, t, s, p, reverse)
    return work


damp_outside_lines = kernel(lambda x, v, t, s, decay, kind, p, reverse: damp_lines(x, v, t, s, p, reverse), inline=True)
# The damping that is taken apart; returns the work [J] that a moving sphere did.
damp_outside = by_net(rope=damp_outside_net, grid=damp_outside_net, lines=damp_outside_lines)


@kernel(inline=True)
def hold_net(x, v, t, s, room, p, foreseen, with_account, ledger):
    if p.held.shape[0] > 0:
        kinetic = open_damping(v, p, room.before) if with_account else 0.0
        by_sphere = hold_all(x, v, t, s, p, foreseen)
        if with_account:
            close_damping(x, v, t, p, 0.0, kinetic, by_sphere, False, room.before, ledger)


@kernel(inline=True)
def foresee_net(x, v, t, p):
    if p.held.shape[0] > 0:
        foresee_all(x, v, t, p)


hold_lines = kernel(lambda x, v, t, s, room, p, foreseen, with_account, ledger: None, inline=True)
foresee_lines = kernel(lambda x, v, t, p: None, inline=True)
# Friction is last in both kicks of a step: what can rest then does not move between them. Of what slides, the second
# kick takes the friction of its beginning, as the mirror image of the first one: the step is of second order.
hold = by_net(rope=hold_net, grid=hold_net, lines=hold_lines)
foresee = by_net(rope=foresee_net, grid=foresee_net, lines=foresee_lines)


@kernel(inline=True)
def kick(x, v, a, t, s, decay, room, p, reverse, closing, with_account, ledger):
    """Change v by all forces in a time s [s], half a step, at positions x and the accelerations a of `accelerate`.

    closing: the kick that ends a step; the one that begins it goes through its parts in the reverse order. reverse: of
    the links and of other damping. decay: make_decay(p, s).
    """
    if closing:
        foresee(x, v, t, p)
    for turn in range(2):
        if (turn == 0) == closing:
            kick_inside(x, v, a, t, s, closing, room, p, with_account, ledger)
        else:
            kinetic = open_damping(v, p, room.before) if with_account else 0.0
            by_sphere = damp_outside(x, v, t, s, decay, room.kind, p, reverse)
            if with_account:
                close_damping(x, v, t, p, s, kinetic, by_sphere, room.kind == SPLIT, room.before, ledger)
    hold(x, v, t, s, room, p, closing, with_account, ledger)
