"""The steps of `WIDTH` ropes side by side, by four of the methods in `sim.springs.integrators`.

Forces, damping and energy account are those of a rope in `sim.springs.forces` and `sim.springs.analysis.energy`, with
other numbers in every lane. Each loop runs over all points and lanes, so that it is long enough to vectorise.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.forces.links import TINY
from sim.springs.many.lanes import WIDTH

LANES = np.uint64(WIDTH)


@kernel(noalias=True, inline=True)
def widen_box(x, low, high, count):
    """Remember the smallest and the largest coordinate of each point."""
    for j in range(count):
        low[j] = x[j] if x[j] < low[j] else low[j]  # `min` of numba does not vectorise
        high[j] = x[j] if x[j] > high[j] else high[j]


@kernel(noalias=True, inline=True)
def set_damped_links(x, v, k, tension, b, f, h, part, dissipated, n, m, nf):
    """`link_forces` with isotropic damping; adds what the damping takes in a time part h to `dissipated`."""
    for j in range(m):
        q = j + LANES
        rx, ry, rz = x[q] - x[j], x[n + q] - x[n + j], x[n + n + q] - x[n + n + j]
        dx, dy, dz = v[q] - v[j], v[n + q] - v[n + j], v[n + n + q] - v[n + n + j]
        s = k[j] - tension[j] / math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
        f[q] = s * rx + b[j] * dx
        f[nf + q] = s * ry + b[j] * dy
        f[nf + nf + q] = s * rz + b[j] * dz
        dissipated[j] += part * h[j] * b[j] * (dx * dx + dy * dy + dz * dz)


@kernel(noalias=True, inline=True)
def set_elastic_links(x, k, tension, f, n, m, nf):
    """`link_forces` without damping."""
    for j in range(m):
        q = j + LANES
        rx, ry, rz = x[q] - x[j], x[n + q] - x[n + j], x[n + n + q] - x[n + n + j]
        s = k[j] - tension[j] / math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
        f[q] = s * rx
        f[nf + q] = s * ry
        f[nf + nf + q] = s * rz


@kernel(noalias=True, inline=True)
def add_drag_loss(v, c, h, part, dissipated, n):
    """What drag takes in a time part h."""
    for j in range(n):
        square = v[j] * v[j] + v[n + j] * v[n + j] + v[n + n + j] * v[n + n + j]
        dissipated[j] += part * h[j] * c[j] * square


@kernel(noalias=True, inline=True)
def set_from_links(f, v, w, g, c, a, o, of, n):
    """One component of a_j = w_j (f_j - f_{j-1} - c_j v_j) + g_j."""
    for j in range(n):
        a[o + j] = w[j] * (f[of + j + LANES] - f[of + j] - c[j] * v[o + j]) + g[o + j]


@kernel(noalias=True, inline=True)
def set_from_elastic_links(f, w, g, a, o, of, n):
    """The same without drag."""
    for j in range(n):
        a[o + j] = w[j] * (f[of + j + LANES] - f[of + j]) + g[o + j]


@kernel(noalias=True, inline=True)
def accelerate_all(x, v, p, s, part, a):
    """Accelerations a (3 n,) by every force, and the account of a time part h."""
    n, m = np.uint64(p.points) * LANES, np.uint64(p.points - 1) * LANES
    nf = n + LANES
    widen_box(x, s.low, s.high, n + n + n)
    set_damped_links(x, v, p.stiffness, p.tension_at_rest, p.damping, s.f, p.h, part, s.dissipated, n, m, nf)
    add_drag_loss(v, p.drag, p.h, part, s.dissipated, n)
    for e in range(3):
        o, of = np.uint64(e) * n, np.uint64(e) * nf
        set_from_links(s.f, v, p.inverse_masses, p.weight, p.drag, a, o, of, n)


@kernel(noalias=True, inline=True)
def accelerate_undamped(x, p, s, a):
    """Accelerations a (3 n,) by the forces of position alone."""
    n, m = np.uint64(p.points) * LANES, np.uint64(p.points - 1) * LANES
    nf = n + LANES
    widen_box(x, s.low, s.high, n + n + n)
    set_elastic_links(x, p.stiffness, p.tension_at_rest, s.f, n, m, nf)
    for e in range(3):
        o, of = np.uint64(e) * n, np.uint64(e) * nf
        set_from_elastic_links(s.f, p.inverse_masses, p.weight, a, o, of, n)


@kernel(noalias=True, inline=True)
def add_step(y, h, part, x, o, n):
    """One component of y += part h x."""
    for j in range(n):
        y[o + j] += part * h[j] * x[o + j]


@kernel(noalias=True, inline=True)
def set_step(out, y, h, part, x, o, n):
    """One component of out = y + part h x."""
    for j in range(n):
        out[o + j] = y[o + j] + part * h[j] * x[o + j]


@kernel(noalias=True, inline=True)
def add_steps(y, h, part, x, n):
    for e in range(3):
        add_step(y, h, part, x, np.uint64(e) * n, n)


@kernel(noalias=True, inline=True)
def set_steps(out, y, h, part, x, n):
    for e in range(3):
        set_step(out, y, h, part, x, np.uint64(e) * n, n)


@kernel(noalias=True)
def take_explicit_euler_steps(p, s, first, steps):
    """`sim.springs.integrators.explicit_euler`."""
    n, a = np.uint64(p.points) * LANES, s.a[0]
    for _ in range(steps):
        accelerate_all(s.x, s.v, p, s, 1.0, a)
        add_steps(s.x, p.h, 1.0, s.v, n)
        add_steps(s.v, p.h, 1.0, a, n)


@kernel(noalias=True)
def take_symplectic_euler_steps(p, s, first, steps):
    """`sim.springs.integrators.symplectic_euler`."""
    n, a = np.uint64(p.points) * LANES, s.a[0]
    for _ in range(steps):
        accelerate_all(s.x, s.v, p, s, 1.0, a)
        add_steps(s.v, p.h, 1.0, a, n)
        add_steps(s.x, p.h, 1.0, s.v, n)


@kernel(noalias=True, inline=True)
def add_kinetic(v, masses, sign, total, n):
    """Add each point's kinetic energy, or take it away."""
    for j in range(n):
        square = v[j] * v[j] + v[n + j] * v[n + j] + v[n + n + j] * v[n + n + j]
        total[j] += sign * 0.5 * masses[j] * square


@kernel(noalias=True, inline=True)
def damp_link(v, w, share, j, o):
    """One component of one link in every lane; j: index of its first point in the first lane."""
    for lane in range(WIDTH):
        a = j + np.uint64(lane)
        b = a + LANES
        d = share[a] * (v[o + b] - v[o + a])
        v[o + a] += w[a] * d
        v[o + b] -= w[b] * d


@kernel(noalias=True, inline=True)
def damp_links(v, p, n, colour):
    """Every second link, from the first (colour 0) or the second (1) on."""
    for i in range(colour, p.points - 1, 2):
        j = np.uint64(i) * LANES
        for e in range(3):
            damp_link(v, p.inverse_masses, p.share, j, np.uint64(e) * n)


@kernel(noalias=True, inline=True)
def scale(v, keep, o, n):
    for j in range(n):
        v[o + j] *= keep[j]


@kernel(noalias=True, inline=True)
def damp_half_step(v, p, dissipated, reverse):
    """`sim.springs.forces.damping.damp` for half a step, and its account."""
    n = np.uint64(p.points) * LANES
    add_kinetic(v, p.masses, 1.0, dissipated, n)
    if reverse:
        for e in range(3):
            scale(v, p.keep, np.uint64(e) * n, n)
    damp_links(v, p, n, 1 if reverse else 0)
    damp_links(v, p, n, 0 if reverse else 1)
    if not reverse:
        for e in range(3):
            scale(v, p.keep, np.uint64(e) * n, n)
    add_kinetic(v, p.masses, -1.0, dissipated, n)


@kernel(noalias=True)
def take_leapfrog_steps(p, s, first, steps):
    """`sim.springs.integrators.leapfrog`. first: number of steps before these, which decides the order of the links."""
    n, a = np.uint64(p.points) * LANES, s.a[0]
    accelerate_undamped(s.x, p, s, a)
    for step in range(first, first + steps):
        is_odd = step % 2 == 1
        damp_half_step(s.v, p, s.dissipated, is_odd)
        add_steps(s.v, p.h, 0.5, a, n)
        add_steps(s.x, p.h, 1.0, s.v, n)
        accelerate_undamped(s.x, p, s, a)
        add_steps(s.v, p.h, 0.5, a, n)
        damp_half_step(s.v, p, s.dissipated, not is_odd)


@kernel(noalias=True, inline=True)
def finish_rk4_step(x, v, a1, a2, a3, a4, h, o, n):
    for j in range(n):
        i = o + j
        x[i] += h[j] * (v[i] + h[j] / 6.0 * (a1[i] + a2[i] + a3[i]))
        v[i] += h[j] / 6.0 * (a1[i] + a4[i] + 2.0 * (a2[i] + a3[i]))


@kernel(noalias=True)
def take_rk4_steps(p, s, first, steps):
    """`sim.springs.integrators.rk4`."""
    n = np.uint64(p.points) * LANES
    a1, a2, a3, a4 = s.a[0], s.a[1], s.a[2], s.a[3]
    xs, vs = s.stage[0], s.stage[1]
    for _ in range(steps):
        accelerate_all(s.x, s.v, p, s, 1.0 / 6.0, a1)
        set_steps(xs, s.x, p.h, 0.5, s.v, n)
        set_steps(vs, s.v, p.h, 0.5, a1, n)
        accelerate_all(xs, vs, p, s, 1.0 / 3.0, a2)
        set_steps(xs, s.x, p.h, 0.5, vs, n)
        set_steps(vs, s.v, p.h, 0.5, a2, n)
        accelerate_all(xs, vs, p, s, 1.0 / 3.0, a3)
        set_steps(xs, s.x, p.h, 1.0, vs, n)
        set_steps(vs, s.v, p.h, 1.0, a3, n)
        accelerate_all(xs, vs, p, s, 1.0 / 6.0, a4)
        for e in range(3):
            finish_rk4_step(s.x, s.v, a1, a2, a3, a4, p.h, np.uint64(e) * n, n)
