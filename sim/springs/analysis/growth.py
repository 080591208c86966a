"""Measured stability: growth of a disturbance in a run of an integrator's kernel.

Beside theory (`sim.springs.stability`), which it does not use: the oscillator is a spring of no rest length, so that
a net of two points is exactly linear, and the rope is the real one.
"""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from sim.numerics.root import narrowed
from sim.springs.integrators import Integrator
from sim.springs.net import Family, Net
from sim.springs.rope import rope
from sim.springs.state import State, advance, energy

FIRST = 16  # steps of the first look; each look doubles them
FAR, NEAR = 1e3, 1e-60  # sizes at which a run from 1 has grown, or decayed
TALL, LOW = 30.0, 0.1  # the same of a run that was cut short: a leapfrog that holds may reach 30
STIR = 1e-9  # energy of a disturbance, in parts of what is large for its net
GROWN = 1e4  # times its energy at which a disturbance has grown: still far too small for the rope not to be linear
LOWEST, RESOLUTION = 0.1, 1e-3  # of a limit: fraction of the first step below which it counts as 0, and relative error
MUCH = 100.0  # parts of what is large, from which no link returns
PUSH = 1e-5  # of a link, in the differences of `step_growth`: their error is its square
STABLE, BOUNDED_GROWTH, EXPLODING = range(3)


def oscillator(zeta: float) -> Net:
    """x'' + 2 zeta x' + x = 0 in each component: a free point on a spring to a pinned one."""
    net = rope(2, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    return dataclasses.replace(net, families=(Family(0, 1, 0.0, 1.0, 2.0 * zeta),))


def step_changes(integrator: Integrator, zeta: float, z: float) -> NDArray[np.complex128]:
    """Eigenvalues (2,) of A - I, measured: A is the matrix of one step of the oscillator, omega = 1 and h = z."""
    p = oscillator(zeta).kernel_view(z)
    columns = []
    for start in ((1.0, 0.0), (0.0, 1.0)):
        x, v = np.zeros(6), np.zeros(6)
        x[1], v[1] = start
        integrator.advance(x, v, np.zeros(4), 0.0, z, 1, p, False)
        columns.append((x[1] - start[0], v[1] - start[1]))
    return np.linalg.eigvals(np.array(columns).T).astype(np.complex128)


def growth(integrator: Integrator, zeta: float, z: float, most: int = 1 << 17) -> float:
    """Logarithm per step of an oscillator's amplitude, omega = 1 and h = z, measured over up to `most` steps.

    Two starts that no step matrix can both hide from, (x, v) = (1, 0) and (0, 1), go side by side until together they
    are FAR or NEAR, or for `most` steps; the rate is that of the second half, 0 where they did neither.
    """
    net = oscillator(zeta)
    p = net.kernel_view(z)
    x, v, ledger = np.zeros(6), np.zeros(6), np.zeros(4)
    x[1], v[3] = 1.0, 1.0
    steps, before, rate = 0, math.sqrt(2.0), 0.0
    while steps < most:
        more = max(steps, FIRST)
        integrator.advance(x, v, ledger, steps * z, z, more, p, False)
        steps += more
        size = math.sqrt(float(x @ x + v @ v))
        if not NEAR < size < FAR:  # a NaN as well
            if not size < 1e300:
                return math.inf
            return math.log(max(size, 1e-300) / before) / more
        rate, before = math.log(size / before) / more, size
    return rate if before < LOW or (before > TALL and rate > 0.0) else 0.0


def measured_limit(
    integrator: Integrator, zeta: float, steps: NDArray[np.float64], rates: NDArray[np.float64], most: int = 1 << 21
) -> float:
    """The h omega at which a row of the map, growth rates (n,) at ascending `steps` (n,), first begins to grow.

    Sought between the last that holds and the first that grows, to 0.1 %; inf where none grows, 0 where all do. most:
    steps spent on one value; near its limit explicit Euler grows by (h omega)^2/100 a step.
    """
    grows = np.flatnonzero(rates > 0.0)
    if not len(grows):
        return math.inf
    first = int(grows[0])
    low = float(steps[first - 1]) if first else LOWEST * float(steps[0])
    if not first and growth(integrator, zeta, low, most) > 0.0:
        return 0.0
    high = float(steps[first])
    # Only the sign of a growth rate counts: below the limit it is 0, or that of a decay.
    ends = narrowed(lambda z: 1.0 if growth(integrator, zeta, z, most) > 0.0 else -1.0, low, high, RESOLUTION * high)
    return 0.5 * float(sum(ends))


def energy_scale(net: Net, x: NDArray[np.float64]) -> float:
    """An energy [J] that is large for a net at rest at x (3, rows, cols): a fall by its own length, or a stretch."""
    span = float(np.ptp(x.reshape(3, -1), axis=1).max())
    free = net.inverse_masses().reshape(net.shape) > 0.0
    fall = float(net.masses[free].sum()) * math.hypot(*net.gravity) * span
    stretch = max((f.stiffness * f.rest**2 for f in net.families), default=0.0)
    return max(fall, 1e-3 * stretch, 1e-12)


def stir(net: Net, state: State, joule: float) -> None:
    """Give the free points random velocities that carry `joule` [J]: something of every mode."""
    free = net.inverse_masses().reshape(net.shape) > 0.0
    kick = np.random.default_rng(0).standard_normal(state.v.shape) * free
    square = 0.5 * float((net.masses * kick * kick).sum())
    if square > 0.0:
        state.v += kick * math.sqrt(joule / square)


def outcome(integrator: Integrator, net: Net, h: float, rest: NDArray[np.float64], most: int = 1 << 14) -> int:
    """Growth of a small disturbance of `net` at rest at `rest` (3, rows, cols) [m] in steps of h [s].

    STABLE: it decayed, or did not grow within `most` steps. BOUNDED_GROWTH: its amplitude grew a hundredfold, and then
    the nonlinear links bounded it. EXPLODING: nothing bounds it. The size of a disturbance is its energy above the
    energy at rest, which is the minimum.
    """
    state = State.at_rest(net)
    state.x[:] = rest
    scale, least = energy_scale(net, rest), energy(net, state).total
    stir(net, state, STIR * scale)
    done = grown_at = 0
    while done < (2 * grown_at or most):
        more = max(done, FIRST)
        advance(net, state, integrator, h, more)
        done += more
        if not state.is_bounded:
            return EXPLODING
        above = energy(net, state).total - least
        if not above < MUCH * scale:
            return EXPLODING
        if not grown_at and above > GROWN * STIR * scale:
            grown_at = done
        if above < STIR * scale / GROWN:
            break
    return BOUNDED_GROWTH if grown_at else STABLE


def step_growth(integrator: Integrator, net: Net, h: float, rest: NDArray[np.float64]) -> float:
    """Logarithm per step of the fastest growing small disturbance of `net` at rest at `rest` (3, rows, cols) [m].

    The largest eigenvalue of the matrix of two steps of h [s], as some methods alternate. Its columns are central
    differences of runs of the kernel; only for nets of a few points. inf if a run leaves the finite numbers.
    """
    p = net.kernel_view(h)
    free = np.flatnonzero(np.tile(net.inverse_masses() > 0.0, 3))
    size = PUSH * max((f.rest for f in net.families), default=1.0)
    start = np.concatenate([np.ascontiguousarray(rest).reshape(-1), np.zeros(rest.size)])
    columns = []
    for pushed, by in [(i, size) for i in free] + [(rest.size + i, size / h) for i in free]:
        ends = []
        for sign in (1.0, -1.0):
            state = start.copy()
            state[pushed] += sign * by
            x, v = state[: rest.size], state[rest.size :]
            integrator.advance(x, v, np.zeros(4), 0.0, h, 2, p, False)
            ends.append(np.concatenate([x[free], h * v[free]]))
        columns.append((ends[0] - ends[1]) / (2.0 * size))
    matrix = np.array(columns)
    if not np.isfinite(matrix).all():
        return math.inf
    return 0.5 * math.log(max(float(np.abs(np.linalg.eigvals(matrix)).max()), 1e-300))


def energy_course(
    integrator: Integrator, net: Net, h: float, steps: int, samples: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (samples + 1,) [s] and total energies [J] of `net` from its start, in steps of h [s]; NaN once diverged."""
    state = State.at_rest(net)
    t = np.arange(samples + 1, dtype=np.float64) * (h * steps / samples)
    total = np.full(samples + 1, math.nan)
    total[0] = energy(net, state).total
    for i in range(1, samples + 1):
        advance(net, state, integrator, h, steps // samples)
        if not state.is_bounded:
            break
        total[i] = energy(net, state).total
    return t, total
