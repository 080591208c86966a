"""The damped kick of a net of several rows, by conjugate gradients.

The equations for the complex velocities V of `sim.springs.kicks.formula`, times the masses, are
    (M + alpha s (B + c)) V = M v + alpha s F,
complex and symmetric: conjugate gradients with the bilinear product r^T z for r^H z (van der Vorst & Melissen 1990),
each point's own equation as preconditioner. The numbers of iterations grow as the root of s b/m, up to the number of
points that a disturbance has to cross. What is left of the residual r changes a velocity by r/m: it does not grow
with the damping, as the new velocities are those by the impulses of the dampers, and a free net keeps its momentum.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.kicks.dampers import turning_time
from sim.springs.points.arrays import add_pair
from sim.springs.points.each_link import each_link

SETTLED = 1e-10  # residual over that of the velocities at the start
ROUND_OFF = 4e-15  # residual over the size of the terms that it is the difference of
MOST_ITERATIONS = 5000  # too few only for the stiffest axial damping: 100 by 100 particles, s b / m of 2e7


class SheetSystem(NamedTuple):
    """Scratch for n points; of complex numbers all three real components, then all three imaginary ones."""

    diagonal: NDArray[np.float64]  # (3 n,) of B + c [N s/m]
    change: NDArray[np.float64]  # (6 n,) V - v [m/s]
    residual: NDArray[np.float64]  # (6 n,) [kg m/s]
    eased: NDArray[np.float64]  # (6 n,) the residual by the preconditioner [m/s]
    direction: NDArray[np.float64]  # (6 n,) [m/s]
    product: NDArray[np.float64]  # (6 n,) the matrix times the direction [kg m/s]
    row: NDArray[np.float64]  # (cols,) forces of the dampers of a row of links [N]


@kernel
def make_sheet(p, wanted):
    """Scratch for a net; not wanted: for no points."""
    n = p.rows * p.cols if wanted else 0
    return SheetSystem(
        np.zeros(3 * n), np.zeros(6 * n), np.zeros(6 * n), np.zeros(6 * n), np.zeros(6 * n), np.zeros(6 * n),
        np.zeros(p.cols if wanted else 0),
    )  # fmt: skip


@kernel(noalias=True, inline=True)
def set_pulls(u, b, o, first, second, at, count, row):
    """Forces b (u_second - u_first) of a row of isotropic dampers, one component."""
    for j in range(count):
        row[j] = b[at + j] * (u[o + second + j] - u[o + first + j])


@kernel(noalias=True, inline=True)
def set_pulls_along(u, b, along, o, n, links, first, second, at, count, row):
    """Forces b n.(u_second - u_first) of a row of axial dampers, all components."""
    for j in range(count):
        i, a, c = at + j, o + first + j, o + second + j
        speed = along[i] * (u[c] - u[a]) + along[links + i] * (u[c + n] - u[a + n])
        row[j] = b[i] * (speed + along[links + links + i] * (u[c + n + n] - u[a + n + n]))


@kernel(noalias=True, inline=True)
def add_pulls(row, count, sign, out, o):
    for j in range(count):
        out[o + j] += sign * row[j]


@kernel(noalias=True, inline=True)
def add_pulls_along(row, along, at, count, sign, out, o):
    for j in range(count):
        out[o + j] += sign * along[at + j] * row[j]


@kernel(noalias=True, allocates=False)
def subtract_damping(u, parts, p, dampers, row, out):
    """out -= B u of linear dampers; `parts` 1 of real vectors (3 n,), 2 of complex ones (6 n,)."""
    n, links, start = np.uint64(p.rows * p.cols), np.uint64(dampers.acting.shape[0]), np.uint64(0)
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        begin, count = max(0, -dj), np.uint64(max(0, p.cols - abs(dj)))
        for i in range(p.rows - di):
            first, second = np.uint64(i * p.cols + begin), np.uint64((i + di) * p.cols + begin + dj)
            if p.families[q, 2] > 0.0:
                for part in range(parts):
                    o = np.uint64(3 * part) * n
                    if p.axial:
                        set_pulls_along(u, dampers.acting, dampers.along, o, n, links, first, second, start, count, row)
                    for e in range(3):
                        oe, at = o + np.uint64(e) * n, start + np.uint64(e) * links
                        if p.axial:
                            add_pulls_along(row, dampers.along, at, count, 1.0, out, oe + first)
                            add_pulls_along(row, dampers.along, at, count, -1.0, out, oe + second)
                        else:
                            set_pulls(u, dampers.acting, oe, first, second, start, count, row)
                            add_pulls(row, count, 1.0, out, oe + first)
                            add_pulls(row, count, -1.0, out, oe + second)
            start += count


@each_link(noalias=True)
def add_diagonal(link, p, dampers, out):
    """Add the diagonal of B to out (3 n,)."""
    n, links, b = p.rows * p.cols, dampers.acting.shape[0], dampers.acting[link.number]
    for e in range(3):
        part = b * dampers.along[e * links + link.number] ** 2 if p.axial else b
        out[e * n + link.a] += part
        out[e * n + link.b] += part


@each_link(noalias=True)
def add_turning(link, p, dampers, time, out, start):
    """Add the forces of axial dampers for having turned for a time [s] to out from `start`."""
    links, q = dampers.acting.shape[0], link.number
    pull = dampers.acting[q] * dampers.turning[q] * time
    fx, fy, fz = dampers.along[q], dampers.along[links + q], dampers.along[2 * links + q]
    add_pair(out, p.rows * p.cols, start + link.a, start + link.b, pull * fx, pull * fy, pull * fz)


@kernel(noalias=True, inline=True)
def turn_by_alpha(y, n, s):
    """y *= alpha s, complex (2 n,)."""
    for j in range(n):
        re, im = y[j], y[n + j]
        y[j], y[n + j] = 0.5 * s * (re - im), 0.5 * s * (re + im)


@kernel(noalias=True, inline=True)
def bilinear(y, z, n):
    """y^T z of complex vectors (2 n,), without conjugation."""
    re = im = 0.0
    for j in range(n):
        re += y[j] * z[j] - y[n + j] * z[n + j]
        im += y[j] * z[n + j] + y[n + j] * z[j]
    return complex(re, im)


@kernel(noalias=True, inline=True)
def add_complex(y, q, z, n):
    """y += q z."""
    re, im = q.real, q.imag
    for j in range(n):
        y[j] += re * z[j] - im * z[n + j]
        y[n + j] += re * z[n + j] + im * z[j]


@kernel(noalias=True, inline=True)
def set_complex(y, q, z, n):
    """y = q y + z."""
    re, im = q.real, q.imag
    for j in range(n):
        a, b = y[j], y[n + j]
        y[j], y[n + j] = re * a - im * b + z[j], re * b + im * a + z[n + j]


@kernel(noalias=True, inline=True)
def size_of(y, w, n):
    """Root of the sum of w |y|^2 of complex forces y (6 n,): an impulse over the root of the masses."""
    total = 0.0
    for e in range(6):
        o = np.uint64(e) * n
        for j in range(n):
            total += w[j] * y[o + j] * y[o + j]
    return math.sqrt(total)


@kernel(noalias=True, inline=True)
def multiply_by_matrix(u, out, s, p, dampers, sheet):
    """out = (M + alpha s (B + c)) u, 0 where pinned."""
    n = np.uint64(p.rows * p.cols)
    for e in range(6):
        o = np.uint64(e) * n
        for j in range(n):
            out[o + j] = -p.drag * u[o + j]
    subtract_damping(u, 2, p, dampers, sheet.row, out)
    turn_by_alpha(out, np.uint64(3) * n, -s)
    for e in range(6):
        o = np.uint64(e) * n
        for j in range(n):
            out[o + j] = p.mass[j] * u[o + j] + out[o + j] if p.inverse_masses[j] > 0.0 else 0.0


@kernel(noalias=True, inline=True)
def ease(r, z, s, p, diagonal):
    """z = r over each point's own complex coefficient, 0 where pinned."""
    n = np.uint64(p.rows * p.cols)
    for e in range(3):
        o, i = np.uint64(e) * n, np.uint64(e + 3) * n
        for j in range(n):
            im = 0.5 * s * diagonal[o + j]
            re = p.mass[j] + im
            over = 1.0 / (re * re + im * im)
            z[o + j], z[i + j] = over * (re * r[o + j] + im * r[i + j]), over * (re * r[i + j] - im * r[o + j])


@kernel(noalias=True, allocates=False)
def open_sheet(v, load, s, closing, p, dampers, sheet):
    """Set diagonal and residual of V = v; returns the size of the terms of the residual."""
    n, three = np.uint64(p.rows * p.cols), np.uint64(3 * p.rows * p.cols)
    time, r = turning_time(s, closing), sheet.residual
    for j in range(three):
        sheet.diagonal[j], sheet.change[j], sheet.change[three + j] = p.drag, 0.0, 0.0
        sheet.product[j], sheet.product[three + j] = 0.0, 0.0
    add_diagonal(p, dampers, sheet.diagonal)
    for e in range(3):
        o = np.uint64(e) * n
        for j in range(n):
            sheet.product[o + j] = p.mass[j] * load[o + j] - p.drag * v[o + j]
    subtract_damping(v, 1, p, dampers, sheet.row, sheet.product)
    if p.axial:
        add_turning(p, dampers, time.real, sheet.product, 0)
        add_turning(p, dampers, time.imag, sheet.product, 3 * p.rows * p.cols)
    turn_by_alpha(sheet.product, three, s)
    size = 0.0
    for e in range(6):
        o, i = np.uint64(e) * n, np.uint64(e % 3) * n
        for j in range(n):
            w = p.inverse_masses[j]
            r[o + j] = sheet.product[o + j] if w > 0.0 else 0.0
            size += w * ((p.mass[j] + s * sheet.diagonal[i + j]) * v[i + j]) ** 2
    return math.sqrt(size)


@kernel(noalias=True, allocates=False)
def solve_sheet(v, load, s, closing, sheet, dampers, p, mean, force):
    """Set the mean velocities (3 n,) [m/s] of a kick, and add the mean forces of linear dampers to force (3 n,) [N].

    Returns False if the iterations have not settled.
    """
    n, three = np.uint64(p.rows * p.cols), np.uint64(3 * p.rows * p.cols)
    r, z, d, y = sheet.residual, sheet.eased, sheet.direction, sheet.product
    rounding = ROUND_OFF * open_sheet(v, load, s, closing, p, dampers, sheet)
    left, count, last = size_of(r, p.inverse_masses, n), 0, 1.0 + 0.0j
    enough = max(SETTLED * left, rounding)
    while left > enough and count < MOST_ITERATIONS:
        ease(r, z, s, p, sheet.diagonal)
        product = bilinear(r, z, three)
        if count == 0:
            for j in range(np.uint64(2) * three):
                d[j] = z[j]
        else:
            set_complex(d, product / last, z, three)
        multiply_by_matrix(d, y, s, p, dampers, sheet)
        length = product / bilinear(d, y, three)
        add_complex(sheet.change, length, d, three)
        add_complex(r, -length, y, three)
        last, count = product, count + 1
        left = size_of(r, p.inverse_masses, n)
    for j in range(three):
        mean[j] = v[j] + sheet.change[j]
    subtract_damping(mean, 1, p, dampers, sheet.row, force)
    if p.axial:
        add_turning(p, dampers, turning_time(s, closing).real, force, 0)
    return not left > enough
