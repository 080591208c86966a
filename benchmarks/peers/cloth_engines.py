"""The cloth in physics engines: the same particles, springs and pins, and each engine's own method.

Most engines damp along the springs only, or not at all. The damping of this task is so small that it hardly changes the
error.
"""

import functools
import math
import os
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.peers.cloth import MAX_ROWS
from benchmarks.peers.record import Peer, Run
from sim.springs import Net


def particles(net: Net) -> Iterator[tuple[tuple[float, float, float], float]]:
    """Position [m] and mass [kg] of each particle, row by row; the mass of a pinned one is 0."""
    for place, weight in zip(net.x0.reshape(3, -1).T, net.inverse_masses(), strict=True):
        yield (float(place[0]), float(place[1]), float(place[2])), net.mass if weight else 0.0


def springs(net: Net) -> Iterator[tuple[int, int, float, float, float]]:
    """Each link: its two particles, rest length [m], stiffness [N/m], damping [N s/m]."""
    rows, cols = net.shape
    for di, dj, rest, k, b in net.families:
        for i in range(rows - di):
            for j in range(max(0, -dj), cols - max(0, dj)):
                yield i * cols + j, (i + di) * cols + j + dj, rest, k, b


def newton_springs(solver: str, **options: Any) -> Callable[[Net, float], Run]:
    """Newton's particles and springs, in single precision, on the processor."""

    def make(net, h):
        import newton  # type: ignore[import-not-found]
        import warp as wp  # type: ignore[import-not-found]

        wp.config.quiet = True
        builder = newton.ModelBuilder(gravity=tuple(map(float, net.gravity)))
        for place, mass in particles(net):
            builder.add_particle(place, (0.0, 0.0, 0.0), mass, radius=0.0)
        for i, j, _, k, b in springs(net):
            builder.add_spring(i, j, k, b, 0.0)  # rest length: the distance at the start, as ours
        builder.color()
        model = builder.finalize(device="cpu")
        model.particle_grid = None  # particles do not touch each other
        control = model.control()
        engine = getattr(newton.solvers, solver)(model, **options)

        def run(seconds):
            steps = math.ceil(seconds / h * (1 - 1e-9))
            now, then = model.state(), model.state()
            for _ in range(steps):
                now.clear_forces()
                engine.step(now, then, control, None, seconds / steps)
                now, then = then, now
            return now.particle_q.numpy().T.reshape(net.x0.shape).astype(np.float64)

        return run

    return make


def pypbd_springs(net: Net, h: float) -> Run:
    """PositionBasedDynamics: extended position-based distance constraints, each step in five parts; undamped.

    On one thread. Two threads wait for each other after every colour of links: that is twice as slow at best, and
    hundreds of times slower while another program uses a core.
    """
    os.environ["OMP_NUM_THREADS"] = "1"  # pypbd reads it when it is loaded
    import pypbd  # type: ignore[import-not-found]

    simulation = pypbd.Simulation.getCurrent()
    simulation.initDefault()
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # gravity is 9.81 m/s^2 along -y there

    def run(seconds):
        model = pypbd.SimulationModel()
        model.init()
        simulation.setModel(model)
        points = model.getParticles()
        for index, (place, mass) in enumerate(particles(net)):
            points.addVertex(turn @ place)
            points.setMass(index, mass)
        for i, j, _, k, _ in springs(net):
            model.addDistanceConstraint_XPBD(i, j, k)
        steps = math.ceil(seconds / h * (1 - 1e-9))
        controller = simulation.getTimeStep()
        controller.setValueUInt(pypbd.TimeStepController.NUM_SUB_STEPS, 5)
        pypbd.TimeManager.getCurrent().setTimeStepSize(seconds / steps)
        for _ in range(steps):
            controller.step(model)
        return (turn.T @ np.array(points.getVertices()).reshape(-1, 3).T).reshape(net.x0.shape)

    return run


def mujoco_tendons(integrator: str, net: Net, h: float) -> Run:
    """Point masses on three sliders each, joined by spatial tendons.

    integrator: "Euler", explicit in the positions, or "discrete", implicit in positions and velocities.
    """
    import mujoco  # type: ignore[import-not-found]

    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    bodies = ""
    for index, ((x, y, z), mass) in enumerate(particles(net)):
        site, place = f'<site name="p{index}"', f'pos="{x!r} {y!r} {z!r}"'
        inside = f'{slides}<inertial pos="0 0 0" mass="{mass!r}" diaginertia="1e-9 1e-9 1e-9"/>{site}/>'
        bodies += f"<body {place}>{inside}</body>" if mass else f"{site} {place}/>"
    tendons = "".join(
        f'<spatial stiffness="{k!r}" damping="{b!r}" springlength="{rest!r}">'
        f'<site site="p{i}"/><site site="p{j}"/></spatial>'
        for i, j, rest, k, b in springs(net)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option integrator="{integrator}" jacobian="sparse" gravity="0 0 {net.gravity[2]}">'
        f'<flag contact="disable" eulerdamp="disable"/></option><worldbody>{bodies}</worldbody>'
        f"<tendon>{tendons}</tendon></mujoco>"
    )
    moves = net.inverse_masses() > 0.0

    def run(seconds):
        steps = math.ceil(seconds / h * (1 - 1e-9))
        model.opt.timestep = seconds / steps
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, steps)
        x = net.x0.reshape(3, -1).copy()
        x[:, moves] += data.qpos.reshape(-1, 3).T
        return x.reshape(net.x0.shape)

    return run


ENGINE_STEP = 1 / 600  # [s] of engines with no stability limit of the step

ENGINES = (
    Peer("newton SemiImplicit", "newton", newton_springs("SolverSemiImplicit"), "axial", MAX_ROWS),
    Peer(
        "newton VBD, 10 iterations",
        "newton",
        newton_springs("SolverVBD", iterations=10),
        "axial",
        MAX_ROWS,
        ENGINE_STEP,
    ),
    Peer(
        "newton XPBD, 10 iterations",
        "newton",
        newton_springs("SolverXPBD", iterations=10),
        "axial",
        MAX_ROWS,
        ENGINE_STEP,
    ),
    Peer("pypbd XPBD, one thread", "pypbd", pypbd_springs, "isotropic", MAX_ROWS, ENGINE_STEP),
    Peer("mujoco Euler, tendons", "mujoco", functools.partial(mujoco_tendons, "Euler"), "axial", 64),
    Peer(
        "mujoco discrete, tendons",
        "mujoco",
        functools.partial(mujoco_tendons, "discrete"),
        "axial",
        64,
        ENGINE_STEP,
    ),
)

# Programs that cannot be given this task, and why.
OTHER_TASKS = {"mujoco 2-D flex": "its sheets are elastic triangles or edges of fixed length, not springs"}
