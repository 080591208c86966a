"""From frame to frame with steps that keep an estimated error within a tolerance.

The step's error is measured per position [m] and velocity [m/s] against atol + rtol |value|, root mean square
(Solving ODEs I, II.4.11). Order 5 steps freely past the frames and fills them by a quintic from positions, velocities
and accelerations at both ends, of the order of the method; higher orders, or a ledger, let the steps end on the frames.

While errors are small and steady, and nothing but smooth forces acts, every second step has no estimate of its own. It
is as long as the one before, holds no frame, and stands only if the next one keeps the tolerance: else both are undone.
"""

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.analysis.extremes import DIVERGENCE_BOUND
from sim.springs.integrators.embedded.errors import error_of
from sim.springs.integrators.embedded.stages import end_step, is_smooth, make_stages, take_step
from sim.springs.points.acceleration import accelerate, set_pins

SAFETY = 0.9
NOW, BEFORE = 0.7, 0.4  # exponents of this step's error and the last one's (Gustafsson's PI), over the order
SHRINK, GROW = 0.2, 6.0  # least and largest factor between two steps
TRIES_UNASKED = 16  # steps between two looks at whether the march is to end
CALM, RISE = 0.3, 2.0  # errors below which, and growing by less than which, the next step needs no estimate
SMALLEST = 1e-14  # step over the whole time, below which the search is given up


@kernel(noalias=True, allocates=False)
def fill_frame(x, v, a, xn, vn, an, h, s, x_out, v_out):
    """State at part s of a step of h: the quintic through both ends' positions, velocities and accelerations."""
    for j in range(x.shape[0]):
        d0 = xn[j] - x[j] - h * v[j] - 0.5 * h * h * a[j]
        d1 = h * (vn[j] - v[j]) - h * h * a[j]
        d2 = h * h * (an[j] - a[j])
        c3, c4, c5 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2, 7.0 * d1 - 15.0 * d0 - d2, 6.0 * d0 - 3.0 * d1 + 0.5 * d2
        x_out[j] = x[j] + s * (h * v[j] + s * (0.5 * h * h * a[j] + s * (c3 + s * (c4 + s * c5))))
        v_out[j] = v[j] + s * (h * a[j] + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)) / h)


@kernel(noalias=True, inline=True)
def set_to(y, x):
    for j in range(x.shape[0]):
        y[j] = x[j]


@kernel(allocates=False)
def first_step(x, v, a, rtol, atol):
    """A hundredth of the time in which the state changes by its own size, in units of the tolerance."""
    size = change = 0.0
    for j in range(x.shape[0]):
        wx, wv = 1.0 / (atol + rtol * abs(x[j])), 1.0 / (atol + rtol * abs(v[j]))
        size += (wx * x[j]) ** 2 + (wv * v[j]) ** 2
        change += (wx * v[j]) ** 2 + (wv * a[j]) ** 2
    return 0.01 * np.sqrt(size / change) if size > 0.0 and change > 0.0 else 1e-6


@kernel(allocates=False)
def is_bounded(x):
    sane = True
    for j in range(x.shape[0]):
        # A NaN fails the comparison too.
        sane &= abs(x[j]) < DIVERGENCE_BOUND
    return sane


@kernel
def march(method, x, v, times, rtol, atol, p, with_account, xs, vs, ledgers):
    """Fill xs, vs (frames, 3 rows cols) and ledgers (frames, 3) at `times`, starting from x, v at the first.

    x, v are scratch afterwards. Returns force evaluations, steps taken, frames filled, and the time reached [s]; fewer
    frames than there are where no step was short enough, the state left any sane bound, or p.stop asked for an end.
    """
    stages = make_stages(method, x, p)
    size = x.shape[0]
    a, an = stages.k[:size], stages.k[method.stages * stages.stride :][:size]
    xn, vn = np.empty_like(x), np.empty_like(x)
    x_kept, v_kept, a_kept = np.empty_like(x), np.empty_like(x), np.empty_like(x)
    spent, ledger, ledger_kept = np.zeros(4), np.zeros(3), np.zeros(3)
    t, last = times[0], times[-1]
    set_pins(x, v, t, p)
    accelerate(x, v, t, p, True, stages.f, stages.a)
    for j in range(size):
        a[j], xs[0, j], vs[0, j] = stages.a[j], x[j], v[j]
    evals, steps, frame = 1, 0, 1
    lands = method.error_order > 5 or with_account
    h = first_step(x, v, a, rtol, atol)
    power, before = -1.0 / method.error_order, 1.0
    grow = GROW
    tries = 0
    smooth = is_smooth(p)
    calm = unsure = False  # the next step needs no estimate; the last one had none
    frame_kept, t_kept = frame, t
    while frame < len(times):
        if tries % TRIES_UNASKED == 0 and is_stopped(p.stop):
            break
        tries += 1
        goal = times[frame] if lands else last
        landing = t + 1.01 * h >= goal
        blind = calm and not landing
        step = goal - t if landing else h
        spent[0] = spent[1] = spent[3] = 0.0
        take_step(method, x, v, t, step, p, stages, xn, vn, spent, with_account)
        evals += method.stages
        error = before if blind else error_of(method, x, v, step, stages, xn, vn, rtol, atol)
        if not error <= 1.0:
            if unsure:
                x, x_kept, v, v_kept, t, frame = x_kept, x, v_kept, v, t_kept, frame_kept
                set_to(a, a_kept)
                set_to(ledger, ledger_kept)
                steps -= 1
            # Written so that a NaN shrinks the step as well.
            h = step * max(SHRINK, SAFETY * error**power) if error < 1e9 else SHRINK * step
            grow = 1.0
            calm = unsure = False
            # Written so that a NaN ends it too.
            if not h >= SMALLEST * last:
                break
            continue
        if blind:
            set_to(a_kept, a)
            set_to(ledger_kept, ledger)
            t_kept, frame_kept = t, frame
        after = goal if landing else t + step
        evals += end_step(method, x, after, p, stages, xn, vn, with_account, spent)
        ledger[0] += spent[0]
        ledger[1] += spent[1]
        ledger[2] += spent[3]
        while frame < len(times) and times[frame] <= after:
            if times[frame] == after:
                for j in range(size):
                    xs[frame, j], vs[frame, j] = xn[j], vn[j]
            else:
                fill_frame(x, v, a, xn, vn, an, step, (times[frame] - t) / step, xs[frame], vs[frame])
                set_pins(xs[frame], vs[frame], times[frame], p)
            ledgers[frame, 0], ledgers[frame, 1], ledgers[frame, 2] = ledger[0], ledger[1], ledger[2]
            frame += 1
        # The old state's arrays become room for the next one or, before a step without an estimate, are kept.
        if blind:
            x, xn, x_kept, v, vn, v_kept = xn, x_kept, x, vn, v_kept, v
        else:
            x, xn, v, vn = xn, x, vn, v
        set_to(a, an)
        t = after
        steps += 1
        unsure = blind
        if blind:
            calm = False
            continue
        if not is_bounded(x):
            break
        factor = grow
        calm = smooth and error < CALM and before < CALM and error < RISE * before
        if error > 0.0:
            factor = min(grow, SAFETY * error ** (NOW * power) / before ** (BEFORE * power))
            before = max(error, 1e-4)
        # A step cut short to land says little about the next.
        h = max(h, step * factor) if landing else step * max(SHRINK, factor)
        grow = GROW
    if unsure:
        frame, t = frame_kept, t_kept
    return evals, steps, frame, t
