"""`accelerate`: springs, gravity, air drag, pull, floor and sphere of a whole net.

Kernels take positions and velocities flat, (3 rows cols,): all x, then all y, then all z. Flat arrays with unsigned
indices cost nothing beside the arithmetic, where views and signed indices cost several times it (numba checks each for
a negative). Two passes over a rope, link forces and then their differences, vectorise where one pass with a carried
force does not.
"""

import numpy as np

from sim.jit import kernel
from sim.springs.forces import OWN, each
from sim.springs.forces.air import wind_scratch_size
from sim.springs.forces.cloth_forces import accelerate_cloth, cloth_scratch_size
from sim.springs.forces.links import link_forces, scale_ends
from sim.springs.pins import set_paths
from sim.springs.points.arrays import by_net
from sim.springs.points.line_points import accelerate_masses, set_inverse_masses, set_line_pins


@kernel(noalias=True, inline=True)
def set_from_differences(f, v, w, a, of, ov, ow, oa, n, g, c):
    """a = w (f_j+1 - f_j - c v) + g of n points, 0 where pinned; each array from its own offset on."""
    for j in range(n):
        free = g if w[ow + j] > 0.0 else 0.0
        a[oa + j] = w[ow + j] * (f[of + j + np.uint64(1)] - f[of + j] - c * v[ov + j]) + free


@kernel(noalias=True, inline=True)
def accelerate_rope(x, v, p, b, c, f, a):
    """One row of links: forces into f (3 (cols + 1),) with ends that stay zero, then differences into a."""
    zero, one = np.uint64(0), np.uint64(1)
    n = np.uint64(p.cols)
    m = n + one
    link_forces(
        x, v, f, zero, one, one, n - one, n, m,
        p.law, p.families[0, 1], b * p.families[0, 2], p.families[0, 0], p.axial and b > 0,
    )  # fmt: skip
    set_from_differences(f, v, p.inverse_masses, a, zero, zero, zero, zero, n, p.gx, c)
    set_from_differences(f, v, p.inverse_masses, a, m, n, zero, n, n, p.gy, c)
    set_from_differences(f, v, p.inverse_masses, a, m + m, n + n, zero, n + n, n, p.gz, c)


@kernel(noalias=True, inline=True)
def set_load(v, a, o, m, n, g, c):
    for j in range(n):
        a[o + j] = m[j] * g - c * v[o + j]


@kernel(noalias=True, inline=True)
def add_row(f, of, n, sign, a, o):
    for j in range(n):
        a[o + j] += sign * f[of + j]


@kernel(noalias=True, inline=True)
def scale_rows(w, n, a, o):
    for j in range(n):
        a[o + j] *= w[j]


@kernel(noalias=True, allocates=False)
def accelerate_grid(x, v, p, b, c, f, a):
    """Any families of links, row pair by row pair."""
    n = np.uint64(p.rows * p.cols)
    m = np.uint64(p.cols + 1)
    set_load(v, a, np.uint64(0), p.mass, n, p.gx, c)
    set_load(v, a, n, p.mass, n, p.gy, c)
    set_load(v, a, n + n, p.mass, n, p.gz, c)
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        first = max(0, -dj)
        count = np.uint64(max(0, p.cols - abs(dj)))
        for i in range(p.rows - di):
            ia = np.uint64(i * p.cols + first)
            ib = np.uint64((i + di) * p.cols + first + dj)
            ratio = p.side if di == 0 and (i == 0 or i == p.rows - 1) else 1.0
            link_forces(
                x, v, f, ia, ib, np.uint64(0), count, n, m,
                p.law, ratio * p.families[q, 1], ratio * b * p.families[q, 2], p.families[q, 0], p.axial and b > 0,
            )  # fmt: skip
            if dj == 0 and p.side != 1.0:
                scale_ends(f, np.uint64(0), count, m, p.side)
            for e in range(3):
                of, o = np.uint64(e) * m, np.uint64(e) * n
                add_row(f, of, count, 1.0, a, o + ia)
                add_row(f, of, count, -1.0, a, o + ib)
    scale_rows(p.inverse_masses, n, a, np.uint64(0))
    scale_rows(p.inverse_masses, n, a, n)
    scale_rows(p.inverse_masses, n, a, n + n)


accelerate_links = by_net(rope=accelerate_rope, grid=accelerate_grid, cloth=accelerate_cloth, strand=accelerate_rope)


add_others = each("accelerate", "x, v, t, p, with_damping, f, a", "none", noalias=True, inline=True)


@kernel(noalias=True, inline=True)
def accelerate_inline(x, v, t, p, with_damping, f, a):
    """`accelerate` of a rope, which is over so soon that a call would count."""
    b = 1.0 if with_damping else 0.0
    accelerate_links(x, v, p, b, b * p.drag, f, a)
    add_others(x, v, t, p, with_damping, f, a)


@kernel(noalias=True, allocates=False)
def accelerate_wide(x, v, t, p, with_damping, f, a):
    """`accelerate` of any other net, compiled once for all places of a kernel that call it."""
    accelerate_inline(x, v, t, p, with_damping, f, a)


@kernel(noalias=True, inline=True)
def set_forces(x, v, t, p, with_damping, f, a):
    """Set the forces a (3 n,) [N] on every node and body of lines, prescribed ones too."""
    for j in range(a.shape[0]):
        a[j] = 0.0
    add_others(x, v, t, p, with_damping, f, a)


@kernel(noalias=True, allocates=False)
def accelerate_lines(x, v, t, p, with_damping, f, a):
    set_inverse_masses(x, p)
    set_forces(x, v, t, p, with_damping, f, a)
    accelerate_masses(p, a)


# Acceleration a of every particle at time t, 0 where pinned. with_damping False leaves out every force that depends on
# v, for integrators that treat damping apart. f: scratch of `make_scratch`.
accelerate = by_net(rope=accelerate_inline, grid=accelerate_wide, lines=accelerate_lines)


chain_scratch_size = kernel(lambda p: 3 * (p.cols + 1), inline=True)
scratch_size = by_net(
    rope=chain_scratch_size,
    grid=kernel(lambda p: 3 * (p.cols + 1) + wind_scratch_size(p), inline=True),
    cloth=kernel(lambda p: p.bands * cloth_scratch_size(p.cols) + wind_scratch_size(p), inline=True),
    lines=kernel(lambda p: 0, inline=True),
    strand=chain_scratch_size,
)


@kernel
def make_scratch(p):
    return np.zeros(scratch_size(p))


# Put moved pins where their paths are at time t, with their paths' velocity, and what bodies carry.
set_pins = by_net(rope=set_paths, grid=set_paths, lines=set_line_pins)


@kernel(noalias=True)
def set_acceleration(x, v, t, p, a):
    """`accelerate` with every force, for callers outside the kernels."""
    accelerate(x, v, t, p, True, make_scratch(p), a)


add_declared = each("accelerate", "x, v, t, p, with_damping, f, a", "none", tuple(OWN.values()), noalias=True)


@kernel(noalias=True)
def set_declared(x, v, t, p, a):
    """Set the accelerations a [m/s^2] to those of the forces that the net declares (`Net.forces`), without others."""
    for j in range(a.shape[0]):
        a[j] = 0.0
    add_declared(x, v, t, p, True, make_scratch(p), a)


@kernel
def set_node_forces(x, v, t, p, out):
    """Set the forces (3 n,) [N] on every node and body of lines, prescribed ones too."""
    set_forces(x, v, t, p, True, make_scratch(p), out)


@kernel
def set_rest_forces(x, p, out):
    """Set the forces (3 n,) [N] on every node and body of lines that do not move, in still or steadily moving water."""
    set_forces(x, np.zeros(x.shape[0]), 0.0, p, True, make_scratch(p), out)
