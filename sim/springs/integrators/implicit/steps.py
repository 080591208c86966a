"""The steps of the implicit methods: implicit Euler, the midpoint and TR-BDF2, in one kernel.

Nearly all of the kernel is Newton's method, the same for all three, so it is compiled once for each kind of net instead
of once for each method. Stages are solved at one place in the loop, so that the solver is inlined there: a call would
copy hundreds of numbers, a tenth of the time of a rope of ten points.

A step that Newton's method cannot solve is split into halves, quarters, ..., and into longer parts again after an
easy one.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.friction import FIXED, NOTED
from sim.springs.integrators.implicit.newton import (
    Exactness,
    forget_factors,
    make_work,
    mended_speed,
    most_of,
    scale_speeds,
    solve_stage,
)
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.arrays import by_net

EULER, MIDPOINT, TR_BDF2 = 0, 1, 2

FINEST = 16  # parts of a step, taken even if unsettled
FINEST_MIDPOINT = 64
# Of the solver. Implicit Euler damps the rest of an error most, TR-BDF2 less; halves of a midpoint are quicker than
# more corrections.
OF_EULER = Exactness(share=2e-3, usable=1.0, most=24, most_of_rope=25)
OF_TR_BDF2 = Exactness(share=5e-4, usable=1e-3, most=60, most_of_rope=25)
# Midpoints keep errors; those of energy, which would feed the motion without bound, are mended. Where the energy or the
# angular momentum is kept exactly, it shows every error.
OF_MIDPOINT = Exactness(share=2e-3, usable=1.0, most=36, most_of_rope=12)
OF_CONSERVING_MIDPOINT = Exactness(share=0.0, usable=0.0, most=60, most_of_rope=12)
is_conserving = by_net(rope=kernel(lambda p: True, inline=True), grid=kernel(lambda p: p.is_conserving, inline=True))
GAMMA = 2.0 - math.sqrt(2.0)  # fraction of a step of TR-BDF2 in its first stage
W = math.sqrt(2.0) / 4.0  # weights of the quadrature of TR-BDF2: W, W, GAMMA/2


@kernel(allocates=False)
def note_net_load(x, v, t, p, f, a):
    if p.held.shape[0] > 0:
        p.load_is[0] = NOTED
        accelerate(x, v, t, p, True, f, a)
        p.load_is[0] = FIXED


no_load = kernel(lambda x, v, t, p, f, a: None, inline=True)
# Note what friction holds against in the step that begins here.
note_load = by_net(rope=note_net_load, grid=note_net_load, lines=no_load)


@kernel
def advance_implicit(method, x, v, ledger, t, h, steps, p, with_account):
    """`advance` of an integrator, by the method EULER, MIDPOINT or TR_BDF2.

    ledger[2] counts the steps with a part that was taken before its corrections had settled.
    """
    finest = FINEST_MIDPOINT if method == MIDPOINT else FINEST
    exactness = OF_EULER if method == EULER else OF_TR_BDF2
    if method == MIDPOINT:
        exactness = OF_CONSERVING_MIDPOINT if is_conserving(p) else OF_MIDPOINT
    most = most_of(p, exactness)
    work = make_work(p, method == MIDPOINT)
    f = make_scratch(p)
    a = np.empty_like(x)
    x0, v0, x1, v1 = np.empty_like(x), np.empty_like(x), np.empty_like(x), np.empty_like(x)
    xs, vs = np.empty_like(x), np.empty_like(x)
    # y2 = y1/(gamma (2 - gamma)) - y (1 - gamma)^2/(gamma (2 - gamma)) + g f2
    c1 = 1.0 / (GAMMA * (2.0 - GAMMA))
    c0 = 1.0 - c1
    evals = 0
    for s in range(steps):
        done, size, all_settled = 0, finest, True
        forget_factors(work.solver, p)
        while done < finest:
            if is_stopped(p.stop):
                return evals
            part = h * size / finest
            now = t + (s + done / finest) * h
            after = t + (s + (done + size) / finest) * h
            set_pins(x, v, now, p)
            note_load(x, v, now, p, f, a)
            # Each stage solves vs = v0 + g a(x0 + g vs, vs, then).
            g, then = part, after
            if method == MIDPOINT:
                g, then = 0.5 * part, now + 0.5 * part
            elif method == TR_BDF2:
                # y1 = y + g (f + f1)
                g, then = 0.5 * GAMMA * part, now + GAMMA * part
                accelerate(x, v, now, p, True, f, a)
                evals += 1
            for j in range(x.shape[0]):
                x0[j], v0[j], vs[j] = x[j], v[j], v[j]
            if method == TR_BDF2:
                for j in range(x.shape[0]):
                    x0[j] += g * v[j]
                    v0[j] += g * a[j]
            hardest, stage, last, part_settled, speed = 0, 0, 1 if method == TR_BDF2 else 0, True, 1.0
            while True:
                taken, asked, settled, usable = solve_stage(x0, v0, g, then, exactness, p, xs, vs, work)
                evals += asked
                hardest = max(hardest, taken)
                part_settled = part_settled and settled
                if method == MIDPOINT and exactness.share > 0.0:
                    speed = mended_speed(vs, v, p, work)
                is_taken = size == 1 or (usable and speed > 0.0)
                if stage == last or not is_taken:
                    break
                stage, then = 1, after
                for j in range(x.shape[0]):
                    x1[j], v1[j] = xs[j], vs[j]
                    x0[j] = c1 * x1[j] + c0 * x[j]
                    v0[j] = c1 * v1[j] + c0 * v[j]
            if not is_taken:
                size //= 2
                continue
            if with_account:
                if method == TR_BDF2:
                    add_power(x, v, now, p, True, W * part, ledger)
                    add_power(x1, v1, now + GAMMA * part, p, True, W * part, ledger)
                add_power(xs, vs, then, p, True, g if method == TR_BDF2 else part, ledger)
            for j in range(x.shape[0]):
                x[j], v[j] = (x[j] + part * vs[j], 2.0 * vs[j] - v[j]) if method == MIDPOINT else (xs[j], vs[j])
            if speed != 1.0:
                scale_speeds(speed, v, p)
            done += size
            all_settled = all_settled and part_settled
            if hardest <= most // 2 and done % (2 * size) == 0:
                size *= 2
        if not all_settled:
            ledger[2] += 1.0
    set_pins(x, v, t + steps * h, p)
    return evals
