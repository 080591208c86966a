"""Damping alone, exact for each link and particle, for integrators that split it from the elastic forces.

Velocities under v' = -D v for a time s, positions held: each link's relative velocity decays exactly by
exp(-b (w1 + w2) s), link after link, each particle's drag by exp(-c w s). No such step can overshoot, and each
shrinks the kinetic energy. Applied for h/2 before and, in reverse order, for h/2 after an undamped kick-drift-kick step
it makes a symmetric composition: second order (Strang 1968), and, as kick-drift-kick keeps
v^T M v + x^T (K - h^2/4 K M^-1 K) x and damping only lowers its first term, stable for h omega < 2 at any damping.

Taking even links before odd ones leaves an error of the shortest wave that a net can carry, its sign that of the order.
It is small, but it seeds the folds of whatever is pressed; so the order alternates from step to step.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.forces import FORCES, each
from sim.springs.forces.links import lengthening
from sim.springs.laws import by_damping, lost_share
from sim.springs.points.arrays import by_net, span
from sim.springs.points.each_link import TINY, each_link, stretch
from sim.springs.points.line_points import set_inverse_masses
from sim.springs.points.order import in_turn


@kernel(noalias=True, inline=True)
def damp_pairs(v, w, ia, ib, stride, count, o, share):
    """One component of links (ia, ib), (ia + stride, ib + stride), ...: no particle twice, so that they vectorise.

    share: (1 - exp(-b (w1 + w2) s)) / (w1 + w2) of the link that begins at each particle.
    """
    for j in range(count):
        a, b = ia + stride * j, ib + stride * j
        d = share[a] * (v[o + b] - v[o + a])
        v[o + a] += w[a] * d
        v[o + b] -= w[b] * d


@kernel(noalias=True, inline=True)
def damp_pairs_along(x, v, w, ia, ib, stride, count, n, share):
    """The same for the part of the relative velocity along each link, all components at once."""
    for j in range(count):
        a, b = ia + stride * j, ib + stride * j
        rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[n + n + b] - x[n + n + a]
        closing = (v[b] - v[a]) * rx + (v[n + b] - v[n + a]) * ry + (v[n + n + b] - v[n + n + a]) * rz
        d = share[a] * closing / (rx * rx + ry * ry + rz * rz + TINY)
        v[a] += w[a] * d * rx
        v[n + a] += w[a] * d * ry
        v[n + n + a] += w[a] * d * rz
        v[b] -= w[b] * d * rx
        v[n + b] -= w[b] * d * ry
        v[n + n + b] -= w[b] * d * rz


@kernel(noalias=True, allocates=False)
def damp_set(x, v, w, ia, ib, stride, count, n, share, axial):
    """A set of links without a particle in common."""
    if axial:
        damp_pairs_along(x, v, w, ia, ib, stride, count, n, share)
    else:
        for e in range(3):
            damp_pairs(v, w, ia, ib, stride, count, np.uint64(e) * n, share)


@kernel(noalias=True, inline=True)
def damp_next(v, w, first, count, o, share):
    """`damp_pairs` for links (first, first + 1), (first + 2, first + 3), ...: a 2 in LLVM's sight vectorises."""
    for j in range(count):
        a = first + np.uint64(2) * j
        b = a + np.uint64(1)
        d = share[a] * (v[o + b] - v[o + a])
        v[o + a] += w[a] * d
        v[o + b] -= w[b] * d


@kernel(noalias=True, allocates=False)
def damp_row(x, v, w, start, cols, dj, colour, n, share, axial):
    """Links (j, j + dj) within one row, those that start in an even block of dj points (colour 0) or an odd one (1)."""
    for j0 in range(colour * dj, colour * dj + dj):
        count = (cols - dj - j0 + 2 * dj - 1) // (2 * dj)
        if count > 0:
            a = np.uint64(start + j0)
            if dj == 1 and not axial:
                for e in range(3):
                    damp_next(v, w, a, np.uint64(count), np.uint64(e) * n, share)
            else:
                damp_set(x, v, w, a, a + np.uint64(dj), np.uint64(2 * dj), np.uint64(count), n, share, axial)


@kernel(noalias=True, allocates=False)
def damp_two_rows(ax, ay, az, bx, by, bz, wa, wb, share):
    """Links (j, j) from one row of particles to another: velocities a and b, inverse masses wa and wb, (count,) each.

    As arrays of their own they vectorise: LLVM does not look whether rows of one array overlap.
    """
    for j in range(np.uint64(ax.shape[0])):
        ca, cb = share[j] * wa[j], share[j] * wb[j]
        dx, dy, dz = bx[j] - ax[j], by[j] - ay[j], bz[j] - az[j]
        ax[j] += ca * dx
        ay[j] += ca * dy
        az[j] += ca * dz
        bx[j] -= cb * dx
        by[j] -= cb * dy
        bz[j] -= cb * dz


@kernel(allocates=False)
def damp_links(x, v, decay, p, reverse):
    """Every link of every family, in order or in the reverse order."""
    w, n = p.inverse_masses, p.rows * p.cols
    families = p.offsets.shape[0]
    for step in range(families):
        q = in_turn(step, families, reverse)
        di, dj, b = p.offsets[q, 0], p.offsets[q, 1], p.families[q, 2]
        if b == 0.0:
            continue
        share = decay[q]
        first = max(0, -dj)
        count = max(0, p.cols - abs(dj))
        for line in range(p.rows - di):
            i = in_turn(line, p.rows - di, reverse)
            if di == 0:
                for turn in range(2):
                    colour = in_turn(turn, 2, reverse)
                    damp_row(x, v, w, i * p.cols, p.cols, dj, colour, np.uint64(n), share, p.axial)
                continue
            a, c = i * p.cols + first, (i + di) * p.cols + first + dj
            if p.axial:
                damp_set(x, v, w, np.uint64(a), np.uint64(c), np.uint64(1), np.uint64(count), np.uint64(n), share, True)
            else:
                damp_two_rows(
                    v[a : a + count], v[n + a : n + a + count], v[2 * n + a : 2 * n + a + count],
                    v[c : c + count], v[n + c : n + c + count], v[2 * n + c : 2 * n + c + count],
                    w[a : a + count], w[c : c + count], share[a : a + count],
                )  # fmt: skip


@kernel(noalias=True, inline=True)
def scale(v, keep, o, n):
    for j in range(n):
        v[o + j] *= keep[j]


@each_link()
def set_link_shares(link, latest, s, p, decay):
    """Set the shares of the links. latest: inverse masses, damping and share of the last link that was another."""
    both = p.inverse_masses[link.a] + p.inverse_masses[link.b]
    if both != latest[0] or link.damping != latest[1]:  # nearly all links are equal
        latest[0], latest[1] = both, link.damping
        latest[2] = -math.expm1(-link.damping * both * s) / both if both > 0.0 else 0.0
    decay[link.family, link.a] = latest[2]


@kernel
def make_net_decay(p, s):
    """Array (families + 1, rows cols): the share of each family's link that begins at a point; last the fraction of
    a point's velocity that drag leaves, 1 for pins.
    """
    families, n, w = p.offsets.shape[0], p.rows * p.cols, p.inverse_masses
    decay = np.zeros((families + 1, n))
    set_link_shares(np.zeros(3), s, p, decay)
    last, keep = 0.0, 1.0
    for j in range(n):
        if w[j] != last:
            last, keep = w[j], math.exp(-p.drag * w[j] * s)
        decay[families, j] = keep
    return decay


make_no_decay = kernel(lambda p, s: np.empty((0, 0)))
# Factors of `damp` for a time s [s]. Of lines nothing is known: masses in water change with the tangents.
make_decay = by_net(rope=make_net_decay, grid=make_net_decay, lines=make_no_decay)


@kernel(noalias=True, inline=True)
def damp_rope(v, decay, p, reverse):
    """`damp_links` of a rope with isotropic damping: its even links, then its odd ones, or in reverse."""
    n = np.uint64(p.cols)
    one = np.uint64(1)
    for e in range(3):
        o = np.uint64(e) * n
        if reverse:
            damp_next(v, p.inverse_masses, one, (n - one) >> one, o, decay[0])
        damp_next(v, p.inverse_masses, np.uint64(0), n >> one, o, decay[0])
        if not reverse:
            damp_next(v, p.inverse_masses, one, (n - one) >> one, o, decay[0])


@kernel(noalias=True, inline=True)
def damp_rope_links(x, v, decay, p, reverse):
    """`damp_links` of a rope."""
    if p.axial:
        damp_links(x, v, decay, p, reverse)
    else:
        damp_rope(v, decay, p, reverse)


damp_rows = by_net(rope=damp_rope_links, grid=damp_links, strand=damp_rope_links)


@each_link()
def damp_limited(link, law, x, v, s, decay, p, reverse):
    """Links whose damping may be limited by their tension, one by one, as the limit depends on the velocities."""
    length, rate, acting = lengthening(x, v, p, link)
    if acting == 0.0:
        return
    rx, ry, rz, _ = stretch(x, p, link)
    n, a, b, share = p.rows * p.cols, link.a, link.b, decay[link.family, link.a]
    wa, wb = p.inverse_masses[a], p.inverse_masses[b]
    if acting != link.damping:
        share = lost_share(link.damping, acting, wa + wb, s)
    dx, dy, dz = span(v, n, a, b)
    if p.axial:
        dx, dy, dz = rate * rx / length, rate * ry / length, rate * rz / length
    v[a] += wa * share * dx
    v[n + a] += wa * share * dy
    v[2 * n + a] += wa * share * dz
    v[b] -= wb * share * dx
    v[n + b] -= wb * share * dy
    v[2 * n + b] -= wb * share * dz


@kernel(noalias=True, inline=True)
def damp_whole(law, x, v, s, decay, p, reverse):
    """Links whose damping always acts whole, many at once."""
    damp_rows(x, v, decay, p, reverse)


damp_all_links = by_damping(whole=damp_whole, limited=damp_limited)


@kernel(noalias=True, inline=True)
def damp_rope_motion(x, v, s, decay, p, reverse):
    """Link damping, then drag, or in reverse. Drag scales every free velocity; moving pins keep theirs."""
    n = np.uint64(p.rows * p.cols)
    keep = decay[p.offsets.shape[0]]
    for turn in range(2):
        if in_turn(turn, 2, reverse) == 0:
            if p.damped:
                damp_all_links(p.law, x, v, s, decay, p, reverse)
        elif p.drag > 0.0:
            scale(v, keep, np.uint64(0), n)
            scale(v, keep, n, n)
            scale(v, keep, n + n, n)


@kernel(noalias=True, allocates=False)
def damp_wide_motion(x, v, s, decay, p, reverse):
    """`damp_motion` of any other net, compiled once for all places of a kernel that call it."""
    damp_rope_motion(x, v, s, decay, p, reverse)


# Damping of links and drag for a time s [s], with decay = make_decay(p, s); `reverse` runs through it backwards. That
# of a rope is over so soon that a call would count.
damp_motion = by_net(rope=damp_rope_motion, grid=damp_wide_motion)

other_acts = each("acts", "p", "truth", having="accelerate", inline=True)
hold_all = each("hold", "x, v, t, s, p, foreseen", "sum", allocates=False)
foresee_all = each("foresee", "x, v, t, p", "none", allocates=False)
damp_others = each("damp", "x, v, t, s, p, reverse", "sum", turns=True, allocates=False)
# The same where the damping of contact is inside the kick of each point, link and pair of links.
beside = [force for force in FORCES if force.name not in ("contact", "link_contact", "strand_contact")]
damp_beside = each("damp", "x, v, t, s, p, reverse", "sum", beside, turns=True, allocates=False)


@kernel(inline=True)
def is_odd(t, h, s):
    """True if the step s steps after time t is of the odd ones, however steps are shared out among calls."""
    return (math.floor(t / h + 0.5) + s) % 2 == 1


@kernel(allocates=False)
def damp_lines(x, v, t, s, p, reverse):
    """Damping of lines that is not in their kick: friction of the bed, and that of declared forces."""
    set_inverse_masses(x, p)
    return damp_others(x, v, t, s, p, reverse)
