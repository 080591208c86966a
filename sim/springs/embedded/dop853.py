"""Dormand and Prince's eighth-order method of Hairer's DOP853 in Nystroem form: twelve force evaluations a step.

Hairer, Norsett & Wanner (1993), Solving ODEs I, II.5 and II.10; the numbers are in dop853_tableau.py. With x' = v a
stage's velocity is v + h sum A_ij a_j and its position x + C_i h v + h^2 sum (A A)_ij a_j, so that only accelerations
are kept.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.embedded.dop853_tableau import BG, E3, E3G, E5, E5G, A, B, C, G
from sim.springs.energy import add_power
from sim.springs.forces import accelerate, make_scratch, set_pins


class Stages(NamedTuple):
    """Accelerations of the stages and of the new state, (3 rows cols,) each, and room for a stage."""

    a0: NDArray[np.float64]
    a1: NDArray[np.float64]
    a2: NDArray[np.float64]
    a3: NDArray[np.float64]
    a4: NDArray[np.float64]
    a5: NDArray[np.float64]
    a6: NDArray[np.float64]
    a7: NDArray[np.float64]
    a8: NDArray[np.float64]
    a9: NDArray[np.float64]
    a10: NDArray[np.float64]
    a11: NDArray[np.float64]
    a12: NDArray[np.float64]
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
        vs[j] = v[j] + h * (A[3][0] * a0[j] + A[3][2] * a2[j])


@kernel(noalias=True, inline=True)
def set_stage_4(x, v, h, a0, a1, a2, a3, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[4] * v[j] + h * (G[4][0] * a0[j] + G[4][1] * a1[j] + G[4][2] * a2[j]))
        vs[j] = v[j] + h * (A[4][0] * a0[j] + A[4][2] * a2[j] + A[4][3] * a3[j])


@kernel(noalias=True, inline=True)
def set_stage_5(x, v, h, a0, a2, a3, a4, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[5] * v[j] + h * (G[5][0] * a0[j] + G[5][2] * a2[j] + G[5][3] * a3[j]))
        vs[j] = v[j] + h * (A[5][0] * a0[j] + A[5][3] * a3[j] + A[5][4] * a4[j])


@kernel(noalias=True, inline=True)
def set_stage_6(x, v, h, a0, a2, a3, a4, a5, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (C[6] * v[j] + h * (G[6][0] * a0[j] + G[6][2] * a2[j] + G[6][3] * a3[j] + G[6][4] * a4[j]))
        vs[j] = v[j] + h * (A[6][0] * a0[j] + A[6][3] * a3[j] + A[6][4] * a4[j] + A[6][5] * a5[j])


@kernel(noalias=True, inline=True)
def set_stage_7(x, v, h, a0, a2, a3, a4, a5, a6, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (
            C[7] * v[j] + h * (G[7][0] * a0[j] + G[7][2] * a2[j] + G[7][3] * a3[j] + G[7][4] * a4[j] + G[7][5] * a5[j])
        )
        vs[j] = v[j] + h * (A[7][0] * a0[j] + A[7][3] * a3[j] + A[7][4] * a4[j] + A[7][5] * a5[j] + A[7][6] * a6[j])


@kernel(noalias=True, inline=True)
def set_stage_8(x, v, h, a0, a2, a3, a4, a5, a6, a7, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (
            C[8] * v[j]
            + h
            * (
                G[8][0] * a0[j]
                + G[8][2] * a2[j]
                + G[8][3] * a3[j]
                + G[8][4] * a4[j]
                + G[8][5] * a5[j]
                + G[8][6] * a6[j]
            )
        )
        vs[j] = v[j] + h * (
            A[8][0] * a0[j] + A[8][3] * a3[j] + A[8][4] * a4[j] + A[8][5] * a5[j] + A[8][6] * a6[j] + A[8][7] * a7[j]
        )


@kernel(noalias=True, inline=True)
def set_stage_9(x, v, h, a0, a2, a3, a4, a5, a6, a7, a8, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (
            C[9] * v[j]
            + h
            * (
                G[9][0] * a0[j]
                + G[9][2] * a2[j]
                + G[9][3] * a3[j]
                + G[9][4] * a4[j]
                + G[9][5] * a5[j]
                + G[9][6] * a6[j]
                + G[9][7] * a7[j]
            )
        )
        vs[j] = v[j] + h * (
            A[9][0] * a0[j]
            + A[9][3] * a3[j]
            + A[9][4] * a4[j]
            + A[9][5] * a5[j]
            + A[9][6] * a6[j]
            + A[9][7] * a7[j]
            + A[9][8] * a8[j]
        )


@kernel(noalias=True, inline=True)
def set_stage_10(x, v, h, a0, a2, a3, a4, a5, a6, a7, a8, a9, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (
            C[10] * v[j]
            + h
            * (
                G[10][0] * a0[j]
                + G[10][2] * a2[j]
                + G[10][3] * a3[j]
                + G[10][4] * a4[j]
                + G[10][5] * a5[j]
                + G[10][6] * a6[j]
                + G[10][7] * a7[j]
                + G[10][8] * a8[j]
            )
        )
        vs[j] = v[j] + h * (
            A[10][0] * a0[j]
            + A[10][3] * a3[j]
            + A[10][4] * a4[j]
            + A[10][5] * a5[j]
            + A[10][6] * a6[j]
            + A[10][7] * a7[j]
            + A[10][8] * a8[j]
            + A[10][9] * a9[j]
        )


@kernel(noalias=True, inline=True)
def set_stage_11(x, v, h, a0, a2, a3, a4, a5, a6, a7, a8, a9, a10, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (
            C[11] * v[j]
            + h
            * (
                G[11][0] * a0[j]
                + G[11][2] * a2[j]
                + G[11][3] * a3[j]
                + G[11][4] * a4[j]
                + G[11][5] * a5[j]
                + G[11][6] * a6[j]
                + G[11][7] * a7[j]
                + G[11][8] * a8[j]
                + G[11][9] * a9[j]
            )
        )
        vs[j] = v[j] + h * (
            A[11][0] * a0[j]
            + A[11][3] * a3[j]
            + A[11][4] * a4[j]
            + A[11][5] * a5[j]
            + A[11][6] * a6[j]
            + A[11][7] * a7[j]
            + A[11][8] * a8[j]
            + A[11][9] * a9[j]
            + A[11][10] * a10[j]
        )


@kernel(noalias=True, inline=True)
def finish(x, v, h, a0, a3, a4, a5, a6, a7, a8, a9, a10, a11, xs, vs):
    for j in range(x.shape[0]):
        xs[j] = x[j] + h * (
            v[j]
            + h
            * (
                BG[0] * a0[j]
                + BG[3] * a3[j]
                + BG[4] * a4[j]
                + BG[5] * a5[j]
                + BG[6] * a6[j]
                + BG[7] * a7[j]
                + BG[8] * a8[j]
                + BG[9] * a9[j]
                + BG[10] * a10[j]
            )
        )
        vs[j] = v[j] + h * (
            B[0] * a0[j]
            + B[5] * a5[j]
            + B[6] * a6[j]
            + B[7] * a7[j]
            + B[8] * a8[j]
            + B[9] * a9[j]
            + B[10] * a10[j]
            + B[11] * a11[j]
        )


@kernel(noalias=True, allocates=False)
def take_step(x, v, t, h, p, stages, xn, vn, ledger, with_ledger):
    """The state a step h after x, v at t into xn, vn, and its acceleration into the last of the stages.

    The first stage's acceleration is given. With `with_ledger`, ledger gets what was dissipated and put in [J].
    """
    a0, a1, a2, a3, a4, a5, a6 = stages.a0, stages.a1, stages.a2, stages.a3, stages.a4, stages.a5, stages.a6
    a7, a8, a9, a10, a11, a12 = stages.a7, stages.a8, stages.a9, stages.a10, stages.a11, stages.a12
    xs, vs, f = stages.xs, stages.vs, stages.f
    if with_ledger:
        add_power(x, v, t, p, True, B[0] * h, ledger)
    set_stage_1(x, v, h, a0, xs, vs)
    set_pins(xs, vs, t + C[1] * h, p)
    accelerate(xs, vs, t + C[1] * h, p, True, f, a1)
    set_stage_2(x, v, h, a0, a1, xs, vs)
    set_pins(xs, vs, t + C[2] * h, p)
    accelerate(xs, vs, t + C[2] * h, p, True, f, a2)
    set_stage_3(x, v, h, a0, a1, a2, xs, vs)
    set_pins(xs, vs, t + C[3] * h, p)
    accelerate(xs, vs, t + C[3] * h, p, True, f, a3)
    set_stage_4(x, v, h, a0, a1, a2, a3, xs, vs)
    set_pins(xs, vs, t + C[4] * h, p)
    accelerate(xs, vs, t + C[4] * h, p, True, f, a4)
    set_stage_5(x, v, h, a0, a2, a3, a4, xs, vs)
    set_pins(xs, vs, t + C[5] * h, p)
    accelerate(xs, vs, t + C[5] * h, p, True, f, a5)
    if with_ledger:
        add_power(xs, vs, t + C[5] * h, p, True, B[5] * h, ledger)
    set_stage_6(x, v, h, a0, a2, a3, a4, a5, xs, vs)
    set_pins(xs, vs, t + C[6] * h, p)
    accelerate(xs, vs, t + C[6] * h, p, True, f, a6)
    if with_ledger:
        add_power(xs, vs, t + C[6] * h, p, True, B[6] * h, ledger)
    set_stage_7(x, v, h, a0, a2, a3, a4, a5, a6, xs, vs)
    set_pins(xs, vs, t + C[7] * h, p)
    accelerate(xs, vs, t + C[7] * h, p, True, f, a7)
    if with_ledger:
        add_power(xs, vs, t + C[7] * h, p, True, B[7] * h, ledger)
    set_stage_8(x, v, h, a0, a2, a3, a4, a5, a6, a7, xs, vs)
    set_pins(xs, vs, t + C[8] * h, p)
    accelerate(xs, vs, t + C[8] * h, p, True, f, a8)
    if with_ledger:
        add_power(xs, vs, t + C[8] * h, p, True, B[8] * h, ledger)
    set_stage_9(x, v, h, a0, a2, a3, a4, a5, a6, a7, a8, xs, vs)
    set_pins(xs, vs, t + C[9] * h, p)
    accelerate(xs, vs, t + C[9] * h, p, True, f, a9)
    if with_ledger:
        add_power(xs, vs, t + C[9] * h, p, True, B[9] * h, ledger)
    set_stage_10(x, v, h, a0, a2, a3, a4, a5, a6, a7, a8, a9, xs, vs)
    set_pins(xs, vs, t + C[10] * h, p)
    accelerate(xs, vs, t + C[10] * h, p, True, f, a10)
    if with_ledger:
        add_power(xs, vs, t + C[10] * h, p, True, B[10] * h, ledger)
    set_stage_11(x, v, h, a0, a2, a3, a4, a5, a6, a7, a8, a9, a10, xs, vs)
    set_pins(xs, vs, t + C[11] * h, p)
    accelerate(xs, vs, t + C[11] * h, p, True, f, a11)
    if with_ledger:
        add_power(xs, vs, t + C[11] * h, p, True, B[11] * h, ledger)
    finish(x, v, h, a0, a3, a4, a5, a6, a7, a8, a9, a10, a11, xn, vn)
    set_pins(xn, vn, t + h, p)
    accelerate(xn, vn, t + h, p, True, f, a12)


@kernel(noalias=True, inline=True)
def add_errors(x, v, xn, vn, h, a0, a3, a4, a5, a6, a7, a8, a9, a10, a11, rtol, atol):
    """Sums of the squares of the scaled errors."""
    sum0 = 0.0
    sum1 = 0.0
    for j in range(x.shape[0]):
        wx = 1.0 / (atol + rtol * max(abs(x[j]), abs(xn[j])))
        wv = 1.0 / (atol + rtol * max(abs(v[j]), abs(vn[j])))
        ex = wx * (
            E5G[0] * a0[j]
            + E5G[3] * a3[j]
            + E5G[4] * a4[j]
            + E5G[5] * a5[j]
            + E5G[6] * a6[j]
            + E5G[7] * a7[j]
            + E5G[8] * a8[j]
            + E5G[9] * a9[j]
            + E5G[10] * a10[j]
        )
        ev = wv * (
            E5[0] * a0[j]
            + E5[5] * a5[j]
            + E5[6] * a6[j]
            + E5[7] * a7[j]
            + E5[8] * a8[j]
            + E5[9] * a9[j]
            + E5[10] * a10[j]
            + E5[11] * a11[j]
        )
        sum0 += h * h * ex * ex + ev * ev
        ex = wx * (
            E3G[0] * a0[j]
            + E3G[3] * a3[j]
            + E3G[4] * a4[j]
            + E3G[5] * a5[j]
            + E3G[6] * a6[j]
            + E3G[7] * a7[j]
            + E3G[8] * a8[j]
            + E3G[9] * a9[j]
            + E3G[10] * a10[j]
        )
        ev = wv * (
            E3[0] * a0[j]
            + E3[5] * a5[j]
            + E3[6] * a6[j]
            + E3[7] * a7[j]
            + E3[8] * a8[j]
            + E3[9] * a9[j]
            + E3[10] * a10[j]
            + E3[11] * a11[j]
        )
        sum1 += h * h * ex * ex + ev * ev
    return sum0, sum1


@kernel(noalias=True, allocates=False)
def error_of(x, v, h, p, stages, xn, vn, rtol, atol):
    """The step's error over what is allowed, root mean square over positions and velocities,
    with the third-order estimate in the denominator (Solving ODEs I, II.10.17)."""
    sum0, sum1 = add_errors(
        x, v, xn, vn, h, stages.a0, stages.a3, stages.a4, stages.a5, stages.a6, stages.a7, stages.a8, stages.a9,
        stages.a10, stages.a11, rtol, atol
    )  # fmt: skip
    both = sum0 + 0.01 * sum1
    return abs(h) * sum0 / math.sqrt(both * 2 * x.shape[0]) if both > 0.0 else 0.0
