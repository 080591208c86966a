"""The rope as a user of another program would write it: with a fixed step h [s], or for a relative tolerance rtol."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.record import Peer, Run
from sim.springs import Net

TOLERANCES = (1e-3, 1e-5, 1e-6, 1e-7, 1e-9)


def numbers(net: Net) -> tuple[float, float, float, float, float, float]:
    """k [N/m], rest length [m], b [N s/m], drag c [N s/m], m [kg] and g [m/s^2] of a rope."""
    family = net.families[0]
    return family.stiffness, family.rest, family.damping, net.drag, net.mass, -net.gravity[2]


def numpy_acceleration(net: Net) -> Callable[[Any, Any], NDArray[np.float64]]:
    """Slices and whole-array arithmetic on (3, points)."""
    k, rest, b, c, m, g = numbers(net)

    def acceleration(x, v):
        r = x[:, 1:] - x[:, :-1]
        f = k * (1.0 - rest / np.sqrt((r * r).sum(axis=0))) * r + b * (v[:, 1:] - v[:, :-1])
        a = -c / m * v
        a[2] -= g
        a[:, :-1] += f / m
        a[:, 1:] -= f / m
        a[:, 0] = 0.0
        return a

    return acceleration


def numpy_leapfrog(net: Net, h: float) -> Run:
    acceleration = numpy_acceleration(net)

    def run(seconds):
        steps = math.ceil(seconds / h)
        dt = seconds / steps
        x, v = net.x0[:, 0].copy(), np.zeros_like(net.x0[:, 0])
        a = acceleration(x, v)
        for _ in range(steps):
            v += 0.5 * dt * a
            x += dt * v
            a = acceleration(x, v)
            v += 0.5 * dt * a
        return x[:, None]

    return run


def numpy_rk4(net: Net, h: float) -> Run:
    acceleration = numpy_acceleration(net)

    def run(seconds):
        steps = math.ceil(seconds / h)
        dt = seconds / steps
        x, v = net.x0[:, 0].copy(), np.zeros_like(net.x0[:, 0])
        for _ in range(steps):
            a1 = acceleration(x, v)
            v2 = v + 0.5 * dt * a1
            a2 = acceleration(x + 0.5 * dt * v, v2)
            v3 = v + 0.5 * dt * a2
            a3 = acceleration(x + 0.5 * dt * v2, v3)
            v4 = v + dt * a3
            a4 = acceleration(x + dt * v3, v4)
            x += dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
            v += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        return x[:, None]

    return run


def scipy_method(name: str) -> Callable[[Net, float], Run]:
    def make(net, rtol):
        from scipy.integrate import solve_ivp  # type: ignore[import-not-found]

        acceleration = numpy_acceleration(net)
        shape = net.x0[:, 0].shape
        size = net.x0.size

        def slope(_, y):
            x, v = y[:size].reshape(shape), y[size:].reshape(shape)
            return np.concatenate([y[size:], acceleration(x, v).ravel()])

        y0 = np.concatenate([net.x0.ravel(), np.zeros(size)])

        def run(seconds):
            solution = solve_ivp(slope, (0.0, seconds), y0, name, t_eval=[seconds], rtol=rtol, atol=1e-2 * rtol)
            return solution.y[:size, -1].reshape(net.x0.shape)

        return run

    return make


def jax_acceleration(net: Net):
    import jax  # type: ignore[import-not-found]

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp  # type: ignore[import-not-found]

    k, rest, b, c, m, g = numbers(net)
    free = jnp.ones(net.shape[1]).at[0].set(0.0) / m
    load = jnp.array([[0.0], [0.0], [-m * g]])

    def acceleration(x, v):
        r = x[:, 1:] - x[:, :-1]
        f = k * (1.0 - rest / jnp.sqrt((r * r).sum(axis=0))) * r + b * (v[:, 1:] - v[:, :-1])
        return free * (jnp.diff(jnp.pad(f, ((0, 0), (1, 1))), axis=1) + load - c * v)

    return jax, jnp, acceleration


def jax_leapfrog(net: Net, h: float) -> Run:
    jax, jnp, acceleration = jax_acceleration(net)

    def step(_, state):
        x, v, a, dt = state
        v = v + 0.5 * dt * a
        x = x + dt * v
        a = acceleration(x, v)
        return x, v + 0.5 * dt * a, a, dt

    @jax.jit
    def advance(x, v, steps, dt):
        return jax.lax.fori_loop(0, steps, step, (x, v, acceleration(x, v), dt))[0]

    def run(seconds):
        steps = math.ceil(seconds / h)
        x0 = jnp.asarray(net.x0[:, 0])
        return np.asarray(advance(x0, jnp.zeros_like(x0), steps, seconds / steps))[:, None]

    return run


def diffrax_method(name: str) -> Callable[[Net, float], Run]:
    def make(net, rtol):
        import diffrax  # type: ignore[import-not-found]

        jax, jnp, acceleration = jax_acceleration(net)
        term = diffrax.ODETerm(lambda t, y, args: jnp.stack([y[1], acceleration(y[0], y[1])]))
        solver = getattr(diffrax, name)()
        controller = diffrax.PIDController(rtol=rtol, atol=1e-2 * rtol)

        @jax.jit
        def solve(seconds, y0):
            return diffrax.diffeqsolve(
                term, solver, 0.0, seconds, None, y0, stepsize_controller=controller, max_steps=10_000_000,
                saveat=diffrax.SaveAt(t1=True), adjoint=diffrax.ForwardMode(),
            ).ys[0, 0]  # fmt: skip

        def run(seconds):
            x0 = jnp.asarray(net.x0[:, 0])
            return np.asarray(solve(seconds, jnp.stack([x0, jnp.zeros_like(x0)])))[:, None]

        return run

    return make


def taichi_leapfrog(net: Net, h: float) -> Run:
    """All steps in one serial kernel: the quickest way of this library with so few points."""
    import taichi as ti  # type: ignore[import-not-found]

    ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=1, log_level=ti.ERROR)
    k, rest, b, c, m, g = numbers(net)
    points = net.shape[1]
    x, v, f = (ti.Vector.field(3, ti.f64, points + 1) for _ in range(3))
    start = np.zeros((points + 1, 3))
    start[:points] = net.x0[:, 0].T
    load = ti.Vector([0.0, 0.0, -m * g])

    @ti.func
    def kick(s):
        for j in range(points - 1):
            r = x[j + 1] - x[j]
            f[j + 1] = k * (1.0 - rest / r.norm()) * r + b * (v[j + 1] - v[j])
        for j in range(1, points - 1):
            v[j] += s / m * (f[j + 1] - f[j] + load - c * v[j])
        v[points - 1] += s / m * (load - f[points - 1] - c * v[points - 1])

    @ti.kernel
    def advance(steps: ti.i32, dt: ti.f64):
        ti.loop_config(serialize=True)
        for s in range(steps):
            kick(dt if s > 0 else 0.5 * dt)
            for j in range(points):
                x[j] += dt * v[j]

    def run(seconds):
        steps = math.ceil(seconds / h)
        x.from_numpy(start)
        v.fill(0.0)
        advance(steps, seconds / steps)
        return x.to_numpy()[:points].T[:, None]

    return run


def pymunk_springs(net: Net, h: float) -> Run:
    """Two dimensions, in which this rope stays; the springs damp along themselves."""
    import pymunk  # type: ignore[import-not-found]

    k, rest, b, c, m, g = numbers(net)

    def run(seconds):
        steps = math.ceil(seconds / h)
        space = pymunk.Space()
        space.gravity = (0.0, -g)
        space.damping = math.exp(-c / m)
        bodies = [space.static_body]
        space.static_body.position = (float(net.x0[0, 0, 0]), float(net.x0[2, 0, 0]))
        for j in range(1, net.shape[1]):
            body = pymunk.Body(m, 1.0)
            body.position = (float(net.x0[0, 0, j]), float(net.x0[2, 0, j]))
            space.add(body, pymunk.DampedSpring(bodies[-1], body, (0, 0), (0, 0), rest, k, b))
            bodies.append(body)
        for _ in range(steps):
            space.step(seconds / steps)
        xz = np.array([body.position for body in bodies]).T
        return np.stack([xz[0], np.zeros(len(bodies)), xz[1]])[:, None]

    return run


def mujoco_tendons(integrator: str) -> Callable[[Net, float], Run]:
    """Point masses on three sliders each, joined by spatial tendons."""

    def make(net, h):
        import mujoco  # type: ignore[import-not-found]

        k, rest, b, c, m, g = numbers(net)
        points = net.shape[1]
        bodies = "".join(
            f'<body pos="{net.x0[0, 0, j]} {net.x0[1, 0, j]} {net.x0[2, 0, j]}">'
            + "".join(f'<joint type="slide" axis="{axis}" damping="{c}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
            + f'<inertial pos="0 0 0" mass="{m}" diaginertia="1e-9 1e-9 1e-9"/><site name="p{j}"/></body>'
            for j in range(1, points)
        )
        tendons = "".join(
            f'<spatial stiffness="{k}" damping="{b}" springlength="{rest}">'
            f'<site site="p{j}"/><site site="p{j + 1}"/></spatial>'
            for j in range(points - 1)
        )
        x, y, z = net.x0[:, 0, 0]
        xml = (
            f'<mujoco><option integrator="{integrator}" timestep="{{}}" gravity="0 0 {-g}"><flag contact="disable"/>'
            f'</option><worldbody><site name="p0" pos="{x} {y} {z}"/>{bodies}</worldbody>'
            f"<tendon>{tendons}</tendon></mujoco>"
        )
        models: dict[float, Any] = {}

        def run(seconds):
            steps = math.ceil(seconds / h)
            if seconds not in models:
                models[seconds] = mujoco.MjModel.from_xml_string(xml.format(seconds / steps))
            data = mujoco.MjData(models[seconds])
            mujoco.mj_step(models[seconds], data, steps)
            moved = data.qpos.reshape(-1, 3).T
            return np.concatenate([net.x0[:, 0, :1], net.x0[:, 0, 1:] + moved], axis=1)[:, None]

        return run

    return make


PEERS = (
    Peer("numpy leapfrog", "numpy", numpy_leapfrog),
    Peer("numpy RK4", "numpy", numpy_rk4),
    Peer("scipy RK45", "scipy", scipy_method("RK45"), tolerances=TOLERANCES),
    Peer("scipy DOP853", "scipy", scipy_method("DOP853"), tolerances=TOLERANCES),
    Peer("jax fori_loop leapfrog", "jax", jax_leapfrog),
    Peer("diffrax Tsit5", "diffrax", diffrax_method("Tsit5"), tolerances=TOLERANCES),
    Peer("diffrax Dopri8", "diffrax", diffrax_method("Dopri8"), tolerances=TOLERANCES),
    Peer("taichi leapfrog, one kernel", "taichi", taichi_leapfrog),
    Peer("pymunk DampedSpring", "pymunk", pymunk_springs, "axial"),
    Peer("mujoco Euler, tendons", "mujoco", mujoco_tendons("Euler"), "axial", 128),
    Peer("mujoco RK4, tendons", "mujoco", mujoco_tendons("RK4"), "axial", 128),
)
