"""The cloth as a user of another program would write it.

All take symplectic Euler steps h [s], except a peer that has its own method and step.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.record import Peer, Run
from sim.springs import Net

MAX_ROWS = 128  # a run with more takes minutes


def ends(di: int, dj: int) -> tuple[Any, Any]:
    """Slices of a (3, rows, cols) array: the first and the second ends of a family's links."""
    rows = slice(None, -di or None), slice(di, None)
    cols = (slice(None, -dj or None), slice(dj, None)) if dj >= 0 else (slice(-dj, None), slice(None, dj))
    return (slice(None), rows[0], cols[0]), (slice(None), rows[1], cols[1])


def numpy_slices(net: Net, h: float) -> Run:
    """Whole-array arithmetic on (3, rows, cols)."""
    w = net.inverse_masses().reshape(net.shape)
    load = net.mass * np.array(net.gravity)[:, None, None]

    def acceleration(x, v):
        f = np.empty_like(x)
        f[:] = load
        for di, dj, rest, k, b in net.families:
            first, second = ends(di, dj)
            r = x[second] - x[first]
            pull = (k - k * rest / np.sqrt((r * r).sum(axis=0))) * r + b * (v[second] - v[first])
            f[first] += pull
            f[second] -= pull
        return f * w

    def run(seconds):
        steps = math.ceil(seconds / h * (1 - 1e-9))
        x, v = net.x0.copy(), np.zeros_like(net.x0)
        for _ in range(steps):
            v += seconds / steps * acceleration(x, v)
            x += seconds / steps * v
        return x

    return run


def jax_slices(net: Net, h: float) -> Run:
    """The same in one compiled loop, in double precision."""
    import jax  # type: ignore[import-not-found]

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp  # type: ignore[import-not-found]

    w = jnp.asarray(net.inverse_masses().reshape(net.shape))
    load = jnp.asarray(net.mass * np.array(net.gravity)[:, None, None] * np.ones_like(net.x0))

    def step(_, state):
        x, v, dt = state
        f = load
        for di, dj, rest, k, b in net.families:
            first, second = ends(di, dj)
            r = x[second] - x[first]
            pull = (k - k * rest / jnp.sqrt((r * r).sum(axis=0))) * r + b * (v[second] - v[first])
            f = f.at[first].add(pull).at[second].add(-pull)
        v = v + dt * w * f
        return x + dt * v, v, dt

    @jax.jit
    def advance(x, v, steps, dt):
        return jax.lax.fori_loop(0, steps, step, (x, v, dt))[0]

    def run(seconds):
        steps = math.ceil(seconds / h * (1 - 1e-9))
        x0 = jnp.asarray(net.x0)
        return np.asarray(advance(x0, jnp.zeros_like(x0), steps, seconds / steps))

    return run


def neighbours(net: Net) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The links of each particle for a kernel that gathers: offsets (12, 2), and (12, 3) of rest length, k, b."""
    both = [(di, dj, rest, k, b) for di, dj, rest, k, b in net.families]
    both += [(-di, -dj, rest, k, b) for di, dj, rest, k, b in net.families]
    return np.array([q[:2] for q in both], np.int32), np.array([q[2:] for q in both])


def taichi_gather(net: Net, h: float) -> Run:
    """Each particle gathers its twelve links, in parallel loops over two cores."""
    import taichi as ti  # type: ignore[import-not-found]

    ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=2, log_level=ti.ERROR)
    rows, cols = net.shape
    offsets, links = neighbours(net)
    x, v = ti.Vector.field(3, ti.f64, (rows, cols)), ti.Vector.field(3, ti.f64, (rows, cols))
    w, g = ti.field(ti.f64, (rows, cols)), ti.Vector(list(net.gravity))
    w.from_numpy(net.inverse_masses().reshape(rows, cols))
    mass = net.mass
    fixed = [(int(di), int(dj), *map(float, link)) for (di, dj), link in zip(offsets, links, strict=True)]

    @ti.kernel
    def kick(dt: ti.f64):
        for i, j in x:
            f = mass * g
            for q in ti.static(range(12)):
                di, dj, rest, k, b = ti.static(*fixed[q])
                a, c = i + di, j + dj
                if 0 <= a < rows and 0 <= c < cols:
                    r = x[a, c] - x[i, j]
                    f += (k - k * rest / r.norm()) * r + b * (old[a, c] - old[i, j])
            v[i, j] = old[i, j] + dt * w[i, j] * f

    old = ti.Vector.field(3, ti.f64, (rows, cols))

    @ti.kernel
    def drift(dt: ti.f64):
        for i, j in x:
            x[i, j] += dt * v[i, j]
            old[i, j] = v[i, j]

    def run(seconds):
        steps = math.ceil(seconds / h * (1 - 1e-9))
        x.from_numpy(np.ascontiguousarray(np.moveaxis(net.x0, 0, -1)))
        old.fill(0.0)
        for _ in range(steps):
            kick(seconds / steps)
            drift(seconds / steps)
        return np.moveaxis(x.to_numpy(), -1, 0)

    return run


def warp_gather(net: Net, h: float) -> Run:
    """Each particle gathers its links and steps itself, from one buffer into another: one launch a step."""
    import warp as wp  # type: ignore[import-not-found]

    from benchmarks.peers.cloth_warp import make_step

    rows, cols = net.shape
    offsets, links = neighbours(net)
    step = make_step(wp)
    where, what = wp.array(offsets, dtype=wp.vec2i, device="cpu"), wp.array(links, dtype=wp.vec3d, device="cpu")
    w = wp.array(net.inverse_masses(), dtype=wp.float64, device="cpu")
    start = np.ascontiguousarray(net.x0.reshape(3, -1).T)

    def run(seconds):
        steps = math.ceil(seconds / h * (1 - 1e-9))
        x, v = (wp.array(q, dtype=wp.vec3d, device="cpu") for q in (start, np.zeros_like(start)))
        xn, vn = wp.empty_like(x), wp.empty_like(v)
        for _ in range(steps):
            wp.launch(
                step, rows * cols, device="cpu",
                inputs=[x, v, w, where, what, rows, cols, wp.vec3d(*net.gravity), net.mass, seconds / steps],
                outputs=[xn, vn],
            )  # fmt: skip
            x, v, xn, vn = xn, vn, x, v
        return x.numpy().T.reshape(net.x0.shape)

    return run


SCRIPTS = (
    Peer("numpy slices", "numpy", numpy_slices, max_size=MAX_ROWS),
    Peer("jax slices, one loop", "jax", jax_slices, max_size=MAX_ROWS),
    Peer("taichi gather, two threads", "taichi", taichi_gather, max_size=MAX_ROWS),
    Peer("warp gather, one launch a step", "warp", warp_gather, max_size=MAX_ROWS),
)
