"""One Gauss-Seidel sweep over all links, contacts and pulls as compliant constraints (Macklin et al. 2016).

A constraint C with stiffness k gets the multiplier -C / (w1 + w2 + 1/(k h^2)), its exact linear implicit Euler answer
if nothing else pulled, and its particles move along the gradient at once, so that the next constraint sees it (eq. 18).
Constraints one after another within a family share no particle.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.forces.contact import touches, touching
from sim.springs.forces.links import TINY
from sim.springs.forces.self_contact import refresh_pairs
from sim.springs.net import by_net


@kernel(noalias=True, inline=True)
def project_links(x, w, ia, ib, stride, count, n, rest, give):
    """Links (ia, ib), (ia + stride, ib + stride), ... towards their rest length; give = 1/(k h^2) [1/kg]."""
    for j in range(count):
        a, b = ia + stride * j, ib + stride * j
        rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[n + n + b] - x[n + n + a]
        length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
        s = (length - rest) / ((w[a] + w[b] + give) * length)
        sa, sb = w[a] * s, w[b] * s
        x[a] += sa * rx
        x[n + a] += sa * ry
        x[n + n + a] += sa * rz
        x[b] -= sb * rx
        x[n + b] -= sb * ry
        x[n + n + b] -= sb * rz


@kernel(allocates=False)
def sweep_links(x, h, p):
    """Every family, its rows in order; within a row those links that start in an even block of dj points first."""
    n, one = np.uint64(p.rows * p.cols), np.uint64(1)
    for q in range(p.offsets.shape[0]):
        di, dj, rest, k = p.offsets[q, 0], p.offsets[q, 1], p.links[q, 0], p.links[q, 1]
        if k == 0.0:
            continue
        give = 1.0 / (k * h * h)
        first, count = max(0, -dj), max(0, p.cols - abs(dj))
        for i in range(p.rows - di):
            if di > 0:
                a, b = np.uint64(i * p.cols + first), np.uint64((i + di) * p.cols + first + dj)
                project_links(x, p.inverse_masses, a, b, one, np.uint64(count), n, rest, give)
                continue
            for lane in range(2 * dj):
                # Lanes 0 to dj - 1 are the even blocks, the others the odd ones.
                some = (p.cols - dj - lane + 2 * dj - 1) // (2 * dj)
                if some > 0:
                    a = np.uint64(i * p.cols + lane)
                    project_links(
                        x, p.inverse_masses, a, a + np.uint64(dj), np.uint64(2 * dj), np.uint64(some), n, rest, give
                    )  # fmt: skip


@kernel(allocates=False)
def sweep_surface(x, t, h, p, on_sphere):
    """Points out of floor or sphere, as far as its stiffness holds."""
    if p.contact_k == 0.0 or not touches(x, t, p, on_sphere):
        return
    n = p.rows * p.cols
    give = 1.0 / (p.contact_k * h * h)
    for j in range(n):
        depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
        w = p.inverse_masses[j]
        if depth > 0.0 and w > 0.0:
            s = w * depth / (w + give)
            x[j] += s * nx
            x[n + j] += s * ny
            x[2 * n + j] += s * nz


@kernel(allocates=False)
def sweep_pairs(x, h, p):
    """Particles of the net nearer to each other than its thickness."""
    if p.contact_k == 0.0 or p.thickness == 0.0:
        return
    n = p.rows * p.cols
    give = 1.0 / (p.contact_k * h * h)
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        r = math.sqrt(dx * dx + dy * dy + dz * dz)
        wi, wj = p.inverse_masses[i], p.inverse_masses[j]
        if r >= p.thickness or r == 0.0 or wi + wj == 0.0:
            continue
        push = (p.thickness - r) / ((wi + wj + give) * r)
        x[i] -= wi * push * dx
        x[n + i] -= wi * push * dy
        x[2 * n + i] -= wi * push * dz
        x[j] += wj * push * dx
        x[n + j] += wj * push * dy
        x[2 * n + j] += wj * push * dz


@kernel(allocates=False)
def sweep_grab(x, h, p):
    """The grabbed particle towards its target, with at most grab_max."""
    n, j = p.rows * p.cols, p.grabbed
    w = p.inverse_masses[j]
    if p.grab_k == 0.0 or w == 0.0:
        return
    dx, dy, dz = p.grab_x - x[j], p.grab_y - x[n + j], p.grab_z - x[2 * n + j]
    r = math.sqrt(dx * dx + dy * dy + dz * dz + TINY)
    s = w * min(r / (w + 1.0 / (p.grab_k * h * h)), p.grab_max * h * h) / r
    x[j] += s * dx
    x[n + j] += s * dy
    x[2 * n + j] += s * dz


@kernel(inline=True)
def sweep_no_pairs(x, h, p):
    """A rope does not push itself."""


sweep_own_contacts = by_net(rope=sweep_no_pairs, grid=sweep_pairs)


@kernel(allocates=False)
def sweep(x, t, h, p):
    """Move x (3 rows cols,), predicted for time t without them, by every elastic constraint once."""
    sweep_links(x, h, p)
    sweep_own_contacts(x, h, p)
    if p.has_floor:
        sweep_surface(x, t, h, p, False)
    if p.has_sphere:
        sweep_surface(x, t, h, p, True)
    if p.grabbed >= 0:
        sweep_grab(x, h, p)
