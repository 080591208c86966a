"""The steps of the implicit methods: implicit Euler, the midpoint rule and TR-BDF2, in one kernel.

Each stage solves v = v0 + g a(x0 + g v, v, t): g = h of implicit Euler, h/2 of the midpoint rule, (1 - 1/sqrt 2) h of
TR-BDF2. The residual r = M (v0 + g a - v) decides. A correction u takes it away as far as forces are linear
(`sim.springs.integrators.implicit.correction`): what u amounts to is the error of v that r stands for.

A chain takes corrections by its own matrix until they are round-off. A net has settled if the error that its residual
stands for is below `tolerance`, a fraction of the method's own error in this step. A step that has not settled after a
number of corrections is split into halves, quarters, ..., unless its error is small or its parts are the finest;
ledger[2] counts the steps with a part that was taken so. Each part ends with `sim.springs.kicks.apart`, as the steps of
other methods do, so that it does not lead through a strand or a fold.

The solver is the same for all methods, so it is compiled once for each kind of net. It is called at one place of the
loop, so that it is inlined: a call would copy hundreds of numbers, a tenth of the time of a rope of ten points.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import is_stopped, kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.friction import FIXED, NOTED
from sim.springs.integrators.implicit.blocks import set_link_blocks, set_pair_blocks, set_point_blocks
from sim.springs.integrators.implicit.conservation import (
    change_norm,
    conserve_momentum,
    energy_correction,
    norm,
    scale_motion,
    total_mass,
)
from sim.springs.integrators.implicit.correction import correct_net, correct_rope, forget_factors, make_solver
from sim.springs.integrators.implicit.mean_length import add_mean_lengths, set_mean_blocks
from sim.springs.integrators.implicit.quasi_newton import remember
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.arrays import by_net, mass_at
from sim.springs.points.vector_ops import add_scaled, set_sum

EULER, MIDPOINT, TR_BDF2 = 0, 1, 2

GAMMA = 2.0 - math.sqrt(2.0)  # fraction of a step of TR-BDF2 in its first stage
W = math.sqrt(2.0) / 4.0  # weights of the quadrature of TR-BDF2: W, W, GAMMA/2
# y2 = y1/(gamma (2 - gamma)) - y (1 - gamma)^2/(gamma (2 - gamma)) + g f2
C1 = 1.0 / (GAMMA * (2.0 - GAMMA))
C0 = 1.0 - C1

# Error of the solver over the method's own in a step: so small that their sums over many steps stay below a third.
SOLVER_SHARE = 0.05
COARSE = 1e-4  # and over the change of velocity, where the step is too long for an estimate of the method's own
SETTLED = 1e-11  # error relative to the velocities below which nothing more is asked
ROUND_OFF = 4e-15  # and relative to the farthest position over g, below which corrections are noise
# A net's correction is cut or prolonged until less than this part of the forces along it is left, in at most TRIES
# tries, to at most this multiple of its length.
NEARLY, TRIES, FARTHEST = 0.7, 6, 3.0
FEW = 12  # corrections of a net, after which new factors are quicker than more of them


class StageLimits(NamedTuple):
    """Limits of a method's stages."""

    order: int
    error: float  # of one step, see `local_error`
    usable: float  # error of a net over velocity and its change, of a stage that may be taken unsettled
    usable_of_rope: float  # the last correction of a chain over its fastest velocity, of such a stage
    most: int  # corrections of a net
    most_of_rope: int
    finest: int  # parts of a step


# Implicit Euler damps errors most, TR-BDF2 less, the midpoint rule none: a part of its step that has not settled after
# FEW corrections is split. Of stiff curtains that took half the force evaluations of further corrections.
OF_EULER = StageLimits(1, 1 / 2, 1.0, 1e-3, 24, 25, 16)
OF_MIDPOINT = StageLimits(2, 1 / 6, 0.0, 0.0, 60, 12, 64)
OF_TR_BDF2 = StageLimits(2, 1 / 7, 1e-3, 1e-3, 60, 25, 16)


class SolverWork(NamedTuple):
    """Arrays of the solver."""

    mean: bool  # links take the tension of their mean length
    a: NDArray[np.float64]  # (3 rows cols,)
    f: NDArray[np.float64]  # scratch of `accelerate`
    points: NDArray[np.float64]  # (6 rows cols,) blocks of the particles
    links: NDArray[np.float64]  # (families numbers rows cols,) blocks of the links
    pairs: NDArray[np.float64]  # (6 rows cols,) further blocks of a rope's links, where these touch
    r: NDArray[np.float64]  # (3 rows cols,) the residual
    u: NDArray[np.float64]  # (3 rows cols,) its correction
    solver: Any


@kernel
def make_work(p, mean):
    size = p.rows * p.cols
    solver = make_solver(p, mean)
    return SolverWork(
        mean,
        np.zeros(3 * size),
        make_scratch(p),
        np.zeros(6 * size),
        np.zeros(solver.numbers * size * p.offsets.shape[0]),
        np.zeros(6 * size if p.links_touch else 0),
        np.zeros(3 * size),
        np.zeros(3 * size),
        solver,
    )


@kernel(inline=True)
def largest(u):
    """Largest magnitude, NaN if there is one."""
    most = 0.0
    for j in range(u.shape[0]):
        size = abs(u[j])
        if size > most or size != size:
            most = size
    return most


@kernel(inline=True)
def set_residual(x0, v0, g, t, p, x, v, work):
    """work.r = M (v0 + g a(x, v, t) - v), x = x0 + g v; 0 where pinned."""
    n = p.rows * p.cols
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    accelerate(x, v, t, p, True, work.f, work.a)
    if work.mean:
        add_mean_lengths(x0, x, p, work.a)
    for e in range(3):
        for j in range(n):
            i = e * n + j
            work.r[i] = mass_at(p, j) * (v0[i] + g * work.a[i] - v[i]) if p.inverse_masses[j] > 0.0 else 0.0


@kernel(inline=True)
def set_blocks(x0, g, t, p, x, v, work):
    """The blocks of the matrix about x, v."""
    set_point_blocks(x, v, t, g, p, work.points)
    set_pair_blocks(x, v, t, g, p, work.pairs)
    if work.mean:
        set_mean_blocks(x0, x, g, p, work.links)
    else:
        set_link_blocks(x, g, p, work.links)


@kernel
def solve_rope_stage(x0, v0, a0, g, t, limits, may_split, p, x, v, work):
    """`solve_stage` of a chain, to round-off, which costs one correction more than any other tolerance."""
    count, settled, size = 0, False, np.inf
    while count < limits.most_of_rope and not is_stopped(p.stop):
        set_residual(x0, v0, g, t, p, x, v, work)
        set_blocks(x0, g, t, p, x, v, work)
        correct_rope(p, work)
        add_scaled(v, 1.0, work.u)
        count += 1
        last, size = size, largest(work.u)
        # Corrections shrink at least by the same ratio again: they are those of the whole matrix, or nearly.
        error = size * size / (last - size) if size < last < np.inf else size
        noise = ROUND_OFF * largest(x) / g
        settled = error <= SETTLED * largest(v) + noise or size <= noise
        # A NaN ends the search too: it only spreads.
        if settled or not size <= np.inf:
            break
    return count, count, settled, settled or size <= limits.usable_of_rope * largest(v)


@kernel(inline=True)
def local_error(change, curvature, limits):
    """Error of the method in a stage, from the change g |a| of velocity and g |a - a0|, a0 at the step's start.

    Implicit Euler: h^2 |a'|/2. Of the others, h^3 |a''| times 1/24 or 0.040: a'' is taken as |a'|^2/|a|, as small as it
    can be where the motion is of many frequencies.
    """
    return limits.error * (curvature if limits.order == 1 else curvature * curvature / max(change, 1e-300))


@kernel(inline=True)
def tolerance(change, curvature, speed, noise, limits):
    """Largest error of a net's stage that counts as settled, in the norm of the energy."""
    share = min(SOLVER_SHARE * local_error(change, curvature, limits), COARSE * change)
    return max(share, SETTLED * speed + noise)


@kernel
def advance_along(x0, v0, g, t, p, x, v, work):
    """Add a correction work.u to v so far that the forces along it nearly vanish: buckling is not linear.

    Returns its length, in units of u, and the force evaluations. work.r becomes the residual there.
    """
    slope = dot(work.r, work.u)
    low, low_slope, high, high_slope, length, tries = 0.0, slope, 0.0, 0.0, 1.0, 0
    add_scaled(v, 1.0, work.u)
    while True:
        set_residual(x0, v0, g, t, p, x, v, work)
        tries += 1
        after = dot(work.r, work.u)
        if abs(after) <= NEARLY * slope or tries == TRIES:
            return length, tries
        part = length
        if after > 0.0:
            low, low_slope = length, after
            part = min(slope / (slope - after), FARTHEST) if after < slope else FARTHEST
        else:
            high, high_slope = length, after
        if high > 0.0:
            part = low + (high - low) * min(0.9, max(0.1, low_slope / (low_slope - high_slope)))
        elif length >= FARTHEST:
            return length, tries
        add_scaled(v, part - length, work.u)
        length = part


@kernel
def solve_net_stage(x0, v0, a0, g, t, limits, may_split, p, x, v, work):
    """`solve_stage` of a net, by a quasi-Newton method, to `tolerance`.

    The factors are those of an earlier stage or of the first guess, until FEW corrections were not enough. A part that
    may be split ends there, if it is not going to be usable.
    """
    solver = work.solver
    count, evals, known, settled, usable = 0, 1, 0, False, False
    size, last, start, change, speed = np.inf, np.inf, np.inf, 0.0, 0.0
    set_residual(x0, v0, g, t, p, x, v, work)
    while not is_stopped(p.stop):
        if count > 0 and count % FEW == 0:
            # New factors make the error fall as the last ones did. Where that is not enough, halves are quicker.
            expected = size * (size / start) ** ((limits.most - count) / FEW)
            if may_split and min(size, expected) > limits.usable * (change + speed):
                break
            start = size
        if solver.factors_of[0] != g or (count > 0 and count % FEW == 0):
            set_blocks(x0, g, t, p, x, v, work)
            forget_factors(solver, p)
            known = 0
        known = correct_net(g, known, p, work)
        before, last, size = last, size, norm(work.u, p)
        if count == 0:
            start = size
        # The error that the residual stands for, if further corrections shrink as the slowest of the last two did.
        rate = max(size / last, math.sqrt(size / before)) if last < np.inf else 0.5
        error = size / (1.0 - rate) if rate < 1.0 else np.inf
        change, speed = change_norm(v, v0, a0, 0.0, p), norm(v, p)
        noise = ROUND_OFF * largest(x) / g * math.sqrt(total_mass(p))
        settled = error <= tolerance(change, change_norm(v, v0, a0, g, p), speed, noise, limits) or size <= noise
        usable = size <= limits.usable * (change + speed)
        # A NaN ends the search too: it only spreads.
        if settled or count == limits.most or not size <= np.inf:
            break
        for j in range(work.r.shape[0]):
            solver.before[j] = work.r[j]
        length, tries = advance_along(x0, v0, g, t, p, x, v, work)
        known = remember(solver.memory, known, work.u, length, solver.before, work.r)
        count, evals = count + 1, evals + tries
    return count, evals, settled, settled or usable


# Solve for v, from the guess in v, with x = x0 + g v. a0: the acceleration at the start of the step, of a net.
# may_split: the part of the step is not the finest.
#
# Returns the corrections, the force evaluations, whether they settled, and whether v may be used although they did not.
solve_stage = by_net(rope=solve_rope_stage, grid=solve_net_stage)
most_of = by_net(
    rope=kernel(lambda p, limits: limits.most_of_rope, inline=True),
    grid=kernel(lambda p, limits: limits.most, inline=True),
)
# True if `solve_stage` reads a0.
is_judged = by_net(rope=kernel(lambda p: False, inline=True), grid=kernel(lambda p: True, inline=True))


@kernel(noalias=True, inline=True)
def set_second_start(x, v, xs, vs, x1, v1, x0, v0):
    """Keep the first stage of TR-BDF2 as x1, v1, and set x0, v0 of the second."""
    for j in range(x.shape[0]):
        x1[j], v1[j] = xs[j], vs[j]
        x0[j] = C1 * xs[j] + C0 * x[j]
        v0[j] = C1 * vs[j] + C0 * v[j]


@kernel(noalias=True, inline=True)
def set_stage_start(x, v, a, g, x0, v0, vs):
    """x0 = x + g v, v0 = v + g a, and the guess vs = v."""
    for j in range(x.shape[0]):
        x0[j], v0[j], vs[j] = x[j] + g * v[j], v[j] + g * a[j], v[j]


@kernel(inline=True)
def end_part(x, v, xs, vs, t, p, with_account, ledger):
    """Go from x, v to xs, vs at time t [s], before a strand or a fold passes another."""
    remember_places(x, p, True)
    for j in range(x.shape[0]):
        x[j], v[j] = xs[j], vs[j]
    keep_apart(x, v, t, p, with_account, ledger)


@kernel
def advance_implicit(method, x, v, ledger, t, h, steps, p, with_account):
    """`advance` of an integrator, by the method EULER, MIDPOINT or TR_BDF2."""
    limits = OF_EULER if method == EULER else OF_MIDPOINT if method == MIDPOINT else OF_TR_BDF2
    finest, work, f, a = limits.finest, make_work(p, method == MIDPOINT), make_scratch(p), np.zeros_like(x)
    x0, v0, x1, v1 = np.empty_like(x), np.empty_like(x), np.empty_like(x), np.empty_like(x)
    xs, vs = np.empty_like(x), np.empty_like(x)
    evals = 0
    for s in range(steps):
        done, size, all_settled, slowed = 0, finest, True, ledger[3]
        # A step does not depend on earlier steps in the same call.
        forget_factors(work.solver, p)
        while done < finest:
            if is_stopped(p.stop):
                return evals
            part = h * size / finest
            now = t + (s + done / finest) * h
            after = t + (s + (done + size) / finest) * h
            set_pins(x, v, now, p)
            if method == TR_BDF2 or is_judged(p) or p.held.shape[0] > 0:
                p.load_is[0] = NOTED  # the forces of this step, which friction holds against
                accelerate(x, v, now, p, True, f, a)
                p.load_is[0] = FIXED
                evals += 1
            # Each stage solves vs = v0 + g a(x0 + g vs, vs, then).
            g, then = part, after
            if method == MIDPOINT:
                g, then = 0.5 * part, now + 0.5 * part
            elif method == TR_BDF2:
                # y1 = y + g (f + f1)
                g, then = 0.5 * GAMMA * part, now + GAMMA * part
            set_stage_start(x, v, a, g if method == TR_BDF2 else 0.0, x0, v0, vs)
            hardest, stage, last, part_settled = 0, 0, 1 if method == TR_BDF2 else 0, True
            while True:
                # A net that falls freely is solved by this first guess.
                if p.conserves_momentum:
                    conserve_momentum(x0, v0, g, p, xs, vs)
                count, asked, settled, usable = solve_stage(x0, v0, a, g, then, limits, size > 1, p, xs, vs, work)
                if p.conserves_momentum:
                    conserve_momentum(x0, v0, g, p, xs, vs)
                    if method == MIDPOINT and is_judged(p):
                        # The energy correction needs the residual of the velocities that are taken.
                        set_residual(x0, v0, g, then, p, xs, vs, work)
                        evals += 1
                set_sum(xs, x0, g, vs)
                set_pins(xs, vs, then, p)
                evals += asked
                hardest = max(hardest, count)
                part_settled = part_settled and settled
                if stage == last or not (usable or size == 1):
                    break
                stage, then = 1, after
                set_second_start(x, v, xs, vs, x1, v1, x0, v0)
            scale = 1.0
            if method == MIDPOINT:
                for j in range(x.shape[0]):
                    x1[j], v1[j] = x[j] + part * vs[j], 2.0 * vs[j] - v[j]
                scale = energy_correction(x1, v1, vs, p, work)
            if size > 1 and not (usable and scale > 0.0):
                size //= 2
                continue
            if with_account:
                if method == TR_BDF2:
                    add_power(x, v, now, p, True, W * part, ledger)
                    add_power(x1, v1, now + GAMMA * part, p, True, W * part, ledger)
                add_power(xs, vs, then, p, True, g if method == TR_BDF2 else part, ledger)
            if scale != 1.0:
                scale_motion(scale, x1, v1, p)
            end_part(
                x, v, x1 if method == MIDPOINT else xs, v1 if method == MIDPOINT else vs, after, p, with_account, ledger
            )
            done += size
            all_settled = all_settled and part_settled
            if hardest <= most_of(p, limits) // 2 and done % (2 * size) == 0:
                size *= 2
        if not all_settled:
            ledger[2] += 1.0
        ledger[3] = min(ledger[3], slowed + 1.0)
    set_pins(x, v, t + steps * h, p)
    return evals
