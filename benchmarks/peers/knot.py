"""A knot that is pulled tight, as a user of another program would write it.

Programs take the net: a rope with one end held. `pull` is the force on its other end. A run gives the frames of the
rope until the end, or until it diverges.
"""

import functools
import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.record import Peer
from sim.springs import Net

FORCE, RISE, STAGE = 50.0, 3.0, 0.1  # [N] a tenth of the rope's EA; [s] in which it rises; [s] of each stage of it
DURATION, FRAMES_PER_STAGE = 5.0, 3
FRAMES_PER_SECOND = round(FRAMES_PER_STAGE / STAGE)
FREE_OF_CONTACT = 2  # links apart, up to which they are no contact: they bend about a common link

KnotRun = Callable[[], NDArray[np.float64]]  # -> frames (frames, points, 3) [m]


class Setting(NamedTuple):
    """Steps a second, a multiple of the frames; and the numbers of contact, as each program means them."""

    rate: int
    contact: Any

    @property
    def label(self) -> str:
        """The words of a table."""
        contact = (
            self.contact if isinstance(self.contact, str) else " ".join(f"{one:g}" for one in np.ravel(self.contact))
        )
        return f"step 1/{self.rate} s, contact {contact}"


def pull(stage: int) -> float:
    """Force [N] on the free end along -x in a stage, from 0 on."""
    return FORCE * min(1.0, (stage + 1) * STAGE / RISE)


def stages() -> range:
    """Numbers of all stages."""
    return range(round(DURATION / STAGE))


def steps_of_frame(setting: Setting) -> int:
    """Steps from frame to frame."""
    steps, rest = divmod(setting.rate, FRAMES_PER_SECOND)
    assert rest == 0
    return steps


def framed(advance: Callable[[float, int], NDArray[np.float64] | None], setting: Setting) -> NDArray[np.float64]:
    """Frames of a run.

    advance: takes the force on the free end [N] and a number of steps; returns the points (n, 3), None if it diverged.
    """
    frames: list[NDArray[np.float64]] = []
    for stage in stages():
        for _ in range(FRAMES_PER_STAGE):
            points = advance(pull(stage), steps_of_frame(setting))
            if points is None or not np.isfinite(points).all():
                return np.array(frames)
            frames.append(points)
    return np.array(frames)


def numbers(net: Net) -> tuple[NDArray[np.float64], float, float, float, float, float]:
    """Points (n, 3) [m], rest length [m], k [N/m], b [N s/m], drag of a point [N s/m] and radius [m] of the rope."""
    family = net.families[0]
    return net.x0[:, 0].T, family.rest, family.stiffness, family.damping, net.drag, net.radius


def written(values: Any) -> str:
    """Numbers as XML has them."""
    return " ".join(f"{value!r}" for value in np.ravel(values).tolist())


MUJOCO = """<mujoco><option timestep="{h!r}" integrator="{integrator}" gravity="0 0 0" jacobian="sparse"
viscosity="{viscosity!r}"/><size memory="200M"/>{rest}</mujoco>"""


def mujoco_model(xml: str) -> Any:
    """A model; warnings are counted, and no file is written about them."""
    import mujoco  # type: ignore[import-not-found]

    mujoco.set_mju_user_warning(lambda text: None)
    return mujoco.MjModel.from_xml_string(xml)


def has_warned(data: Any) -> bool:
    """True if MuJoCo has warned; of what diverges it begins the run anew."""
    return any(warning.number for warning in data.warning)


def mujoco_flex(inextensible: bool, net: Net, setting: Setting) -> KnotRun:
    """A one-dimensional flex: point masses on three sliders each, whose edges touch as capsules.

    inextensible: edges are constraints of fixed length; else springs with our stiffness and damping. Adjacent edges are
    no contact, those with one between them are. setting.contact: solref of contacts, and of fixed lengths.
    """
    import mujoco  # type: ignore[import-not-found]

    x, _, k, b, drag, radius = numbers(net)
    inertia = 1e-6  # [kg m^2] of each point, which does not turn; its viscous drag is that of a sphere of the same
    sliders = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    bodies = "".join(
        f'<body name="p{j}" pos="{written(place)}">{sliders if j else ""}'
        f'<inertial pos="0 0 0" mass="{mass!r}" diaginertia="{written([inertia] * 3)}"/></body>'
        for j, (place, mass) in enumerate(zip(x, net.masses.ravel().tolist(), strict=True))
    )
    names, ends = " ".join(f"p{j}" for j in range(len(x))), " ".join(f"{j} {j + 1}" for j in range(len(x) - 1))
    edge = "<edge/>" if inextensible else f'<edge stiffness="{k!r}" damping="{b!r}"/>'
    flex = (
        f'<deformable><flex name="rope" dim="1" radius="{radius!r}" body="{names}" element="{ends}">'
        f'<contact condim="1" selfcollide="sap" solref="{setting.contact}"/>{edge}</flex></deformable>'
    )
    fixed = f'<equality><flex flex="rope" solref="{setting.contact}"/></equality>' if inextensible else ""
    sphere = math.sqrt(1.5 * inertia / net.mass)  # [m] its radius as MuJoCo takes it, from the box of the same inertia
    model = mujoco_model(
        MUJOCO.format(
            h=1.0 / setting.rate, integrator="Euler", viscosity=drag / (6.0 * math.pi * sphere),
            rest=f"<worldbody>{bodies}</worldbody>{flex}{fixed}",
        )
    )  # fmt: skip

    def run():
        data = mujoco.MjData(model)

        def advance(force, steps):
            data.xfrc_applied[-1, 0] = -force
            mujoco.mj_step(model, data, steps)
            moved = np.vstack([np.zeros(3), data.qpos.reshape(-1, 3)])
            return None if has_warned(data) else x + moved

        return framed(advance, setting)

    return run


def mujoco_capsules(net: Net, setting: Setting) -> KnotRun:
    """A chain of rigid capsules in ball joints, which cannot stretch.

    setting.contact: armature [kg m^2] and damping [N m s] of the joints, without which it diverges sooner. The force
    acts on the middle of the last capsule.
    """
    import mujoco  # type: ignore[import-not-found]

    x, _, _, _, drag, radius = numbers(net)
    armature, damping = setting.contact
    ways = np.diff(x, axis=0)
    bodies = ""
    for j, way in enumerate(ways):
        place = x[0] if j == 0 else ways[j - 1]
        bodies += (
            f'<body name="b{j}" pos="{written(place)}"><joint type="ball" armature="{armature}" damping="{damping}"/>'
            f'<geom type="capsule" size="{radius!r}" fromto="0 0 0 {written(way)}" mass="{net.mass!r}" condim="1"'
            f' solref="{2.0 / setting.rate!r} 1"/>'
        )
    bodies += f'<site name="end" pos="{written(ways[-1])}"/>' + "</body>" * len(ways)
    near = [(i, i + gap) for gap in range(1, FREE_OF_CONTACT + 1) for i in range(len(ways) - gap)]
    excluded = "".join(f'<exclude body1="b{i}" body2="b{j}"/>' for i, j in near)
    model = mujoco_model(
        MUJOCO.format(
            h=1.0 / setting.rate, integrator="implicitfast", viscosity=0.0,
            rest=f"<worldbody>{bodies}</worldbody><contact>{excluded}</contact>",
        )
    )  # fmt: skip
    box = np.sqrt(1.5 * (model.body_inertia[-1].sum() - 2.0 * model.body_inertia[-1]) / model.body_mass[-1])
    model.opt.viscosity = drag / (6.0 * math.pi * box.mean())

    def run():
        data = mujoco.MjData(model)

        def advance(force, steps):
            data.xfrc_applied[-1, 0] = -force
            mujoco.mj_step(model, data, steps)
            return None if has_warned(data) else np.vstack([data.xpos[1:], data.site_xpos])

        return framed(advance, setting)

    return run


def frames_along(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Directors (3, 3, links) along a polygon (n, 3), the last of each its way, moved without twist."""
    ways = np.diff(x, axis=0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    directors = np.empty((3, 3, len(ways)))
    side = np.cross(ways[0], np.eye(3)[np.abs(ways[0]).argmin()])
    for j, way in enumerate(ways):
        side = side - (side @ way) * way
        side /= np.linalg.norm(side)
        directors[:, :, j] = side, np.cross(way, side), way
    return directors


SOFT = 0.1  # of a round rod's stiffness in bending and twist; our rope has none


def pyelastica_rod(net: Net, setting: Setting) -> KnotRun:
    """A Cosserat rod with `RodSelfContact` and the EA of the rope, whose bending and twist are SOFT.

    Its damping is the rope's drag, and a filter of the first order of what alternates from link to link. Without that
    filter it was deeper or diverged. setting.contact: stiffness [N/m] and damping [N s/m] of contact.
    """
    import elastica as ea  # type: ignore[import-not-found]

    x, rest, k, _, drag, radius = numbers(net)
    links, area = len(x) - 1, math.pi * radius**2
    modulus = k * rest / area
    stiffness, damping = setting.contact

    class Simulation(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping, ea.Contact):
        pass

    class Held(ea.ConstraintBase):
        def constrain_values(self, system, time):
            system.position_collection[:, 0] = x[0]

        def constrain_rates(self, system, time):
            system.velocity_collection[:, 0] = 0.0

    class Pull(ea.NoForces):
        force = 0.0

        def apply_forces(self, system, time=0.0):
            system.external_forces[0, -1] -= Pull.force

    def run():
        simulation, directors = Simulation(), frames_along(x)
        rod = ea.CosseratRod.straight_rod(
            links, x[0], directors[2, :, 0], directors[0, :, 0], rest * links, radius, net.mass / (rest * area),
            youngs_modulus=modulus, shear_modulus=modulus / 3.0, position=x.T.copy(), directors=directors,
        )  # fmt: skip
        rod.bend_matrix[:] *= SOFT
        simulation.append(rod)
        simulation.constrain(rod).using(Held)
        simulation.add_forcing_to(rod).using(Pull)
        h = 1.0 / setting.rate
        simulation.dampen(rod).using(
            ea.AnalyticalLinearDamper, uniform_damping_constant=drag / net.mass, time_step=h
        )  # fmt: skip
        simulation.dampen(rod).using(ea.LaplaceDissipationFilter, filter_order=1)
        simulation.detect_contact_between(rod, rod).using(ea.RodSelfContact, k=stiffness, nu=damping)
        simulation.finalize()
        stepper, time = ea.PositionVerlet(), 0.0

        def advance(force, steps):
            nonlocal time
            Pull.force = force
            for _ in range(steps):
                time = stepper.step(simulation, time, h)
            return rod.position_collection.T.copy()

        return framed(advance, setting)

    return run


def newton_rod(iterations: int, net: Net, setting: Setting) -> KnotRun:
    """Newton's rod of capsules, by augmented vertex block descent in single precision, on the processor.

    Its stretch and shear are the rope's springs; it has no bending. The force acts on the middle of the last capsule.
    setting.contact: stiffness [N/m].
    """
    import newton  # type: ignore[import-not-found]
    import warp as wp  # type: ignore[import-not-found]

    wp.config.quiet = True
    x, rest, k, b, drag, radius = numbers(net)
    lengths = np.linalg.norm(np.diff(x, axis=0), axis=1)
    volume = math.pi * radius**2 * (rest + 4.0 / 3.0 * radius)
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    shape = newton.ModelBuilder.ShapeConfig(
        ke=setting.contact, kd=10.0, mu=0.0, gap=radius, density=net.mass / volume
    )  # fmt: skip
    bodies, joints = builder.add_rod(
        rod=newton.Rod([wp.vec3(*map(float, place)) for place in x], radius=radius), cfg=shape, stretch_stiffness=k,
        stretch_damping=b, bend_stiffness=0.0, bend_damping=1e-3, wrap_in_articulation=False,
    )  # fmt: skip
    shapes = [builder.body_shapes[body][0] for body in bodies]
    for i, one in enumerate(shapes):
        for other in shapes[i + 1 : i + 1 + FREE_OF_CONTACT]:
            builder.add_shape_collision_filter_pair(one, other)
    first, nothing = bodies[0], wp.mat33(0.0)
    builder.body_mass[first] = builder.body_inv_mass[first] = 0.0
    builder.body_inertia[first] = builder.body_inv_inertia[first] = nothing
    builder.add_articulation(joints)
    builder.color()
    model = builder.finalize(device="cpu")
    pipeline = newton.CollisionPipeline(model, contact_matching="latest")
    contacts = pipeline.contacts()
    solver = newton.solvers.SolverVBD(
        model, iterations=iterations, rigid_contact_history=True, rigid_body_contact_buffer_size=256
    )  # fmt: skip
    control = model.control()

    def run():
        now, then = model.state(), model.state()
        solver.reset(now)

        def advance(force, steps):
            nonlocal now, then
            for _ in range(steps):
                now.clear_forces()
                loads = now.body_f.numpy()  # shares its memory on the processor
                loads[:, :3] = -drag * now.body_qd.numpy()[:, :3]
                loads[-1, 0] -= force
                pipeline.collide(now, contacts)
                solver.set_rigid_history_update(True)
                solver.step(now, then, control, contacts, 1.0 / setting.rate)
                now, then = then, now
            return points_of(now.body_q.numpy().astype(np.float64), lengths)

        return framed(advance, setting)

    return run


def points_of(poses: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 3) of capsules along their z: poses (n - 1, 7), place and quaternion x, y, z, w of each middle."""
    i, j, k, w = poses[:, 3:].T
    along = np.column_stack([2.0 * (i * k + w * j), 2.0 * (j * k - w * i), 1.0 - 2.0 * (i * i + j * j)])
    half = 0.5 * lengths[:, None] * along
    starts, ends = poses[:, :3] - half, poses[:, :3] + half
    return np.vstack([starts[:1], 0.5 * (starts[1:] + ends[:-1]), ends[-1:]])


def ladder(*settings: tuple[int, Any]) -> tuple[tuple[str, Setting], ...]:
    """Rungs with their labels, from quick to slow."""
    return tuple((setting.label, setting) for setting in itertools.starmap(Setting, settings))


# The best settings that were found, for each number of steps.
PEERS = (
    Peer(
        "mujoco flex, springs", "mujoco", functools.partial(mujoco_flex, False), "axial",
        settings=ladder((840, "0.0025 1"), (1920, "0.00105 1"), (3840, "0.00053 1"), (7680, "0.0003 1")),
    ),
    Peer(
        "mujoco flex, fixed lengths", "mujoco", functools.partial(mujoco_flex, True), "axial",
        settings=ladder((120, "0.017 1"), (240, "0.0084 1"), (480, "0.0042 1"), (960, "0.0021 1")),
    ),
    Peer(
        "mujoco capsules, ball joints", "mujoco", mujoco_capsules, "axial",
        settings=ladder((960, (1e-3, 0.01)), (1920, (1e-3, 0.05))),
    ),
    Peer(
        "pyelastica RodSelfContact", "elastica", pyelastica_rod,
        settings=ladder((720, (2e4, 20.0)), (960, (2e4, 20.0)), (960, (1e5, 20.0)), (1920, (2e5, 60.0))),
    ),
    Peer(
        "newton VBD rod, 10 iterations", "newton", functools.partial(newton_rod, 10), "axial",
        settings=ladder((60, 1e4), (120, 1e4), (240, 1e5)),
    ),
)  # fmt: skip
