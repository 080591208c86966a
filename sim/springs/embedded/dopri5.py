"""Dormand and Prince's pair of orders 5 and 4 in Nystroem form: six force evaluations a step, the last one shared.

Coefficients: Dormand & Prince (1980), J. Comp. Appl. Math. 6, table 2. With x' = v a stage's velocity is
v + h sum A_ij a_j and its position x + C_i h v + h^2 sum (A A)_ij a_j, so that only accelerations are kept.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.energy import add_power
from sim.springs.forces import accelerate, make_scratch, set_pins

C = (  # times of the stages
    0.0,
    0.2,
    0.3,
    0.8,
    0.8888888888888888,
    1.0,
)
A = (  # slopes of the stages
    (0.0,),
    (0.2,),
    (0.075, 0.225),
    (0.9777777777777777, -3.7333333333333334, 3.5555555555555554),
    (2.9525986892242035, -11.595793324188385, 9.822892851699436, -0.2908093278463649),
    (2.8462752525252526, -10.757575757575758, 8.906422717743473, 0.2784090909090909, -0.2735313036020583),
)
B = (  # weights
    0.09114583333333333,
    0.0,
    0.44923629829290207,
    0.6510416666666666,
    -0.322376179245283,
    0.13095238095238096,
)
E = (  # the fifth-order weights less the embedded fourth-order ones, the new state included
    0.0012326388888888888,
    0.0,
    -0.0042527702905061394,
    0.03697916666666667,
    -0.05086379716981132,
    0.0419047619047619,
    -0.025,
)


def squared(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    """A A: what a stage's position takes of the accelerations before it. Nothing but 0 where no path leads."""
    size = len(rows)
    full = np.array([(*row, *(0.0,) * (size - len(row))) for row in rows])
    return tuple(tuple(float(q) for q in row[: max(i, 1)]) for i, row in enumerate(full @ full))


def through(weights: tuple[float, ...], last: float = 0.0) -> tuple[float, ...]:
    """weights A; `last` is that of the new state, whose slopes are B."""
    row = last * np.array(B)
    for weight, slopes in zip(weights, A, strict=False):
        row[: len(slopes)] += weight * np.array(slopes)
    return tuple(float(q) for q in row)


G = squared(A)
BG = through(B)
EG = through(E[:-1], E[-1])
STAGES = len(B)


class Stages(NamedTuple):
    """Accelerations of the stages and of the new state, (3 rows cols,) each, and room for a stage."""

    a0: NDArray[np.float64]
    a1: NDArray[np.float64]
    a2: NDArray[np.float64]
    a3: NDArray[np.float64]
    a4: NDArray[np.float64]
    a5: NDArray[np.float64]
    a6: NDArray[np.float64]
    xs: NDArray[np.float64]
    vs: NDArray[np.float64]
    f: NDArray[np.float64]  # scratch of `accelerate`


@kernel
def make_stages(x, p):
    return Stages(
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        np.empty_like(x),
        make_scratch(p),
    )


@kernel(noalias=True, inline=True)
def set_stage_1(x, v, h, a0, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * C[1] * v[j]
        vs[j] = v[j] + h * (A[1][0] * a0[j])


@kernel(noalias=True, inline=True)
def set_stage_2(x, v, h, a0, a1, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[2] * v[j] + h * (G[2][0] * a0[j]))
        vs[j] = v[j] + h * (A[2][0] * a0[j] + A[2][1] * a1[j])


@kernel(noalias=True, inline=True)
def set_stage_3(x, v, h, a0, a1, a2, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[3] * v[j] + h * (G[3][0] * a0[j] + G[3][1] * a1[j]))
        vs[j] = v[j] + h * (A[3][0] * a0[j] + A[3][1] * a1[j] + A[3][2] * a2[j])


@kernel(noalias=True, inline=True)
def set_stage_4(x, v, h, a0, a1, a2, a3, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[4] * v[j] + h * (G[4][0] * a0[j] + G[4][1] * a1[j] + G[4][2] * a2[j]))
        vs[j] = v[j] + h * (A[4][0] * a0[j] + A[4][1] * a1[j] + A[4][2] * a2[j] + A[4][3] * a3[j])


@kernel(noalias=True, inline=True)
def set_stage_5(x, v, h, a0, a1, a2, a3, a4, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[5] * v[j] + h * (G[5][0] * a0[j] + G[5][1] * a1[j] + G[5][2] * a2[j] + G[5][3] * a3[j]))
        vs[j] = v[j] + h * (A[5][0] * a0[j] + A[5][1] * a1[j] + A[5][2] * a2[j] + A[5][3] * a3[j] + A[5][4] * a4[j])


@kernel(noalias=True, inline=True)
def finish(x, v, h, a0, a1, a2, a3, a4, a5, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (v[j] + h * (BG[0] * a0[j] + BG[1] * a1[j] + BG[2] * a2[j] + BG[3] * a3[j] + BG[4] * a4[j]))
        vs[j] = v[j] + h * (B[0] * a0[j] + B[2] * a2[j] + B[3] * a3[j] + B[4] * a4[j] + B[5] * a5[j])


@kernel(noalias=True, allocates=False)
def take_step(x, v, t, h, p, stages, xn, vn, ledger, with_ledger):
    """The state a step h after x, v at t into xn, vn, and its acceleration into the last of the stages.

    The first stage's acceleration is given. With `with_ledger`, ledger gets what was dissipated and put in [J].
    """
    a0, a1, a2, a3 = stages.a0, stages.a1, stages.a2, stages.a3
    a4, a5, a6 = stages.a4, stages.a5, stages.a6
    xs, vs, f = stages.xs, stages.vs, stages.f
    if with_ledger:
        add_power(x, v, t, p, True, B[0] * h, ledger)
    set_stage_1(x, v, h, a0, xs, vs)
    set_pins(xs, vs, t + C[1] * h, p)
    accelerate(xs, vs, t + C[1] * h, p, True, f, a1)
    set_stage_2(x, v, h, a0, a1, xs, vs)
    set_pins(xs, vs, t + C[2] * h, p)
    accelerate(xs, vs, t + C[2] * h, p, True, f, a2)
    if with_ledger:
        add_power(xs, vs, t + C[2] * h, p, True, B[2] * h, ledger)
    set_stage_3(x, v, h, a0, a1, a2, xs, vs)
    set_pins(xs, vs, t + C[3] * h, p)
    accelerate(xs, vs, t + C[3] * h, p, True, f, a3)
    if with_ledger:
        add_power(xs, vs, t + C[3] * h, p, True, B[3] * h, ledger)
    set_stage_4(x, v, h, a0, a1, a2, a3, xs, vs)
    set_pins(xs, vs, t + C[4] * h, p)
    accelerate(xs, vs, t + C[4] * h, p, True, f, a4)
    if with_ledger:
        add_power(xs, vs, t + C[4] * h, p, True, B[4] * h, ledger)
    set_stage_5(x, v, h, a0, a1, a2, a3, a4, xs, vs)
    set_pins(xs, vs, t + C[5] * h, p)
    accelerate(xs, vs, t + C[5] * h, p, True, f, a5)
    if with_ledger:
        add_power(xs, vs, t + C[5] * h, p, True, B[5] * h, ledger)
    finish(x, v, h, a0, a1, a2, a3, a4, a5, xn, vn)
    set_pins(xn, vn, t + h, p)
    accelerate(xn, vn, t + h, p, True, f, a6)


@kernel(noalias=True, inline=True)
def add_errors(x, v, xn, vn, h, a0, a1, a2, a3, a4, a5, a6, rtol, atol):
    """Sums of the squares of the scaled errors."""
    sum0 = 0.0
    for j in range(x.shape[0]):
        wx = 1.0 / (atol + rtol * max(abs(x[j]), abs(xn[j])))
        wv = 1.0 / (atol + rtol * max(abs(v[j]), abs(vn[j])))
        ex = wx * (EG[0] * a0[j] + EG[1] * a1[j] + EG[2] * a2[j] + EG[3] * a3[j] + EG[4] * a4[j] + EG[5] * a5[j])
        ev = wv * (E[0] * a0[j] + E[2] * a2[j] + E[3] * a3[j] + E[4] * a4[j] + E[5] * a5[j] + E[6] * a6[j])
        sum0 += h * h * ex * ex + ev * ev
    return sum0


@kernel(noalias=True, allocates=False)
def error_of(x, v, h, p, stages, xn, vn, rtol, atol):
    """The step's error over what is allowed, root mean square over positions and velocities."""
    sum0 = add_errors(
        x, v, xn, vn, h, stages.a0, stages.a1, stages.a2, stages.a3, stages.a4, stages.a5, stages.a6, rtol, atol
    )  # fmt: skip
    return abs(h) * math.sqrt(sum0 / (2 * x.shape[0]))
