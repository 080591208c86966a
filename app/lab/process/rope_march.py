"""Advances a rope with a student's functions, in the process that runs them.

Reference solutions stand in for missing functions. Floor, friction and the pull of the mouse, which are no task, are
the program's laws (`sim/point_laws.py`). The forces that the net declares are the program's kernels. A parameter that
acts otherwise than on the program's rope is named in the panel (`unlike` in `student_rope.py` and
`student_cloth.py`). numba is not imported here, so that the process starts fast.
"""

import time
from collections.abc import Callable, Collection, Mapping
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from app.lab.course.tasks.springs.rope_acceleration import rope_acceleration
from app.lab.course.tasks.springs.sphere_force import sphere_force
from app.lab.course.tasks.springs.spring_force import spring_force
from app.lab.course.tasks.springs.step_euler import step_euler
from app.lab.course.tasks.springs.step_leapfrog import step_leapfrog
from app.lab.course.tasks.springs.step_rk4 import step_rk4
from sim.point_laws import contact_force, secant, stopping, touching

FILE = "rope.py"  # where the tasks have these functions
REFERENCE: dict[str, Callable[..., Any]] = {
    "spring_force": spring_force, "rope_acceleration": rope_acceleration, "sphere_force": sphere_force,
    "step_euler": step_euler, "step_rk4": step_rk4, "step_leapfrog": step_leapfrog,
}  # fmt: skip
LINKS = "links"  # among the compiled functions, the loop over the links of a rope, which is ours
MAX_COORDINATE = 1e6  # [m], [m/s] beyond which a rope is not advanced


class Forces(NamedTuple):
    """Material and surroundings of a rope, per point and link."""

    mass: float  # [kg]
    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    drag: float  # [N s/m]
    rest_length: float  # [m]
    gravity: float  # [m/s2], downwards
    # From here on with the names of the kernels' record, at times t [s] of the segment.
    floor: float = -np.inf  # [m] where points meet it; -inf: none
    sr: float = 0.0  # radius [m] at which points meet the sphere; 0: none
    sx: float = 0.0  # [m] centre of the sphere at `epoch`
    sy: float = 0.0
    sz: float = 0.0
    svx: float = 0.0  # [m/s] its velocity
    svy: float = 0.0
    svz: float = 0.0
    epoch: float = 0.0
    contact_k: float = 800.0  # [N/m]
    contact_b: float = 5.0  # [N s/m]
    friction: float = 0.0  # Coulomb coefficient
    lab_contact: bool = False  # the lab's contact law instead of the clipped one
    grabbed: int = -1  # point that the mouse pulls, -1: none
    grab_x: float = 0.0  # [m] place of the mouse
    grab_y: float = 0.0
    grab_z: float = 0.0
    grab_k: float = 0.0  # [N/m]
    grab_b: float = 0.0  # [N s/m]
    grab_max: float = 1.0  # [N]
    wind_x: float = 0.0  # [m/s] at a cloth
    wind_y: float = 0.0
    wind_z: float = 0.0
    air_drag: float = 0.0  # [kg/m3] half the density of the air times the coefficient of drag
    air_lift: float = 0.0  # [kg/m3] the same of lift
    declared: tuple[tuple[str, tuple[float, ...]], ...] = ()  # name and numbers of each force of `Net.forces`
    began: float = 0.0  # [s] time of the net at time 0 of the segment


class ClothData(NamedTuple):
    """Data of a cloth in addition to `Forces`, which has the mass of a cell and the stiffness along rows and columns.

    Point (i, j) has the number i cols + j.
    """

    rows: int
    cols: int
    spacing: tuple[float, float]  # [m] at rest, along a row and along a column
    shear: float  # [N/m] of the links across a cell
    bend: float  # [N/m] of the links to the next point but one
    pins: tuple[int, ...]  # numbers of the points that are held; the path of a segment gives their places


class Segment(NamedTuple):
    """Some steps during which the forces stay the same; its last two fields are for the calling scene."""

    steps: int
    h: float  # [s]
    forces: Forces
    # (p, 4, 3) cubic path c0 + c1 t + c2 t^2 + c3 t^3 [m] of each of the p points that are held; (0, 4, 3) where they
    # rest. A rope has one, its root.
    path: np.ndarray
    since: float = 0.0  # time t [s] of the first step, for the path and the sphere
    sheet: ClothData | None = None  # data of a cloth; None for a rope
    end: float = 0.0  # time [s] of the scene at its end
    x: np.ndarray | None = None  # (n, 3) [m] the program's net at its end; None within a segment that was divided


class MarchResult(NamedTuple):
    """Result of advancing."""

    x: np.ndarray  # (segments, n, 3) [m] at the end of each segment that was finished
    v: np.ndarray  # (n, 3) [m/s] at the end of the last of these
    steps: int  # taken in all
    seconds: float  # that they took
    effort: float  # [s] of processor time that they took
    left: bool  # the rope left all bounds; the remaining segments were not taken

    @property
    def step_time(self) -> float:
        """Time [s] that one step took."""
        return self.seconds / max(self.steps, 1)


class Unfit(Exception):  # noqa: N818 - a judgement on a result, not an error of the program
    """Unusable result of a student's function.

    kind: "wrong shape", "wrong type", "NaN", "returns nothing" or "out of range".

    function: the one that did.
    """

    def __init__(self, kind: str, text: str, function: Callable[..., Any]) -> None:
        super().__init__(text)
        self.kind = kind
        self.text = text
        code = getattr(function, "__code__", None)
        self.line = None if code is None else int(code.co_firstlineno)


def entries(count: int) -> str:
    """A number of entries, in words."""
    return "1 entry" if count == 1 else f"{count} entries"


def not_a_number(name: str, function: Callable[..., Any]) -> Unfit:
    """The judgement on a function of this name that returns NaN."""
    text = f"{name} returns NaN (not a number): look for a division by 0 or the root of a negative number"
    return Unfit("NaN", text, function)


def fitting(name: str, value: Any, shape: tuple[int, ...], function: Callable[..., Any]) -> np.ndarray:
    """Result of the function of this name as an array of this shape; one entry is a number too. Raises Unfit."""
    expected = f"expected an array of shape {shape}" if shape else "expected a number"
    if value is None:
        raise Unfit("returns nothing", f"{name} returns nothing: the last line must be return ...", function)
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "biuf":
        text = f"{name} returns a value of type {type(value).__name__}; {expected}"
        raise Unfit("wrong type", text, function)
    if shape == () and array.size == 1:
        array = array.reshape(())
    if array.shape != shape:
        form = f"an array of shape {array.shape}" if array.shape else "a number"
        raise Unfit("wrong shape", f"{name} returns {form}; {expected}", function)
    return array.astype(np.float64)


class Functions:
    """The functions that advance a rope: the student's, with reference solutions for missing ones."""

    reference: Mapping[str, Callable[..., Any]] = REFERENCE
    roots = 1  # points at the start that only their path moves

    def __init__(
        self, module: ModuleType, own: Collection[str], step: str, compiled: Mapping[str, Callable[..., Any]]
    ) -> None:
        """own: names of the functions that the student has begun. step: name of the method's function.

        compiled: functions to use instead (`compiled.py`).
        """
        functions = {name: compiled.get(name) or getattr(module, name, None) for name in own if name in self.reference}
        self.own = {name: function for name, function in functions.items() if callable(function)}
        self.links = compiled.get(LINKS)
        self.step = step
        self.pins = np.zeros(1, int)
        self.segment: Segment
        self.start = self.now = 0.0  # times t [s] of the segment: of the step's start, and of the acceleration

    def get(self, name: str) -> Callable[..., Any]:
        """The student's function, or the reference solution."""
        return self.own.get(name) or self.reference[name]

    def fit(self, name: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
        """A result as an array of this shape. Raises Unfit."""
        if type(value) is np.ndarray and value.dtype == np.float64 and value.shape == shape:
            return value
        return fitting(name, value, shape, self.get(name))

    def acceleration(self, x: Any, v: Any) -> np.ndarray:
        """The accelerations [m/s2], shape (n, 3), for a step."""
        x, v = np.asarray(x, np.float64), np.asarray(v, np.float64)
        if x.ndim != 2 or x.shape[1] != 3 or x.shape != v.shape:
            text = f"{self.step} calls acceleration(x, v) with shapes {x.shape} and {v.shape}; both must be (n, 3)"
            raise Unfit("wrong shape", text, self.get(self.step))
        self.now = self.start + self.time_in_step(x)
        if len(self.segment.path):
            x, v = self.held(x, v, self.now)
        a = self.inner(x, v)
        self.add_surroundings(x, v, a)
        if np.isnan(a.sum()) and np.isfinite(x).all() and np.isfinite(v).all() and np.isnan(a).any():
            self.name_nan(x, v)
        return a

    def time_in_step(self, x: np.ndarray) -> float:
        """Time [s] since the start of the step for which it needs the acceleration at x.

        A root that moves is the clock, see `advance`. Otherwise it is not known; then the sphere is taken at the start
        by Euler's method, and else in the middle.
        """
        if len(self.segment.path):
            return float(x[0, 0])
        return 0.0 if self.step == "step_euler" else 0.5 * self.segment.h

    def held(self, x: np.ndarray, v: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities with the points on their path at time t [s] of the segment."""
        c0, c1, c2, c3 = self.segment.path.transpose(1, 0, 2)
        x, v = x.copy(), v.copy()
        x[self.pins], v[self.pins] = c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + t * 3.0 * c3)
        return x, v

    @property
    def forces(self) -> Forces:
        """Material and surroundings."""
        return self.segment.forces

    def inner(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Springs, air and gravity: by `rope_acceleration`, or by `spring_force` at each link."""
        f = self.forces
        numbers = f.mass, f.stiffness, f.damping, f.drag, f.rest_length, f.gravity
        if "rope_acceleration" in self.own or "spring_force" not in self.own:
            value = self.get("rope_acceleration")(x.copy(), v.copy(), *numbers)
            a = self.fit("rope_acceleration", value, x.shape)
            return a.copy() if a is value else a
        if self.links is not None:
            return self.links(np.ascontiguousarray(x), np.ascontiguousarray(v), *numbers)
        a = -f.drag * v
        for i in range(len(x) - 1):
            pull = self.link(x, v, i)
            a[i] += pull
            a[i + 1] -= pull
        a /= f.mass
        a[:, 2] -= f.gravity
        a[0] = 0.0
        return a

    def link(self, x: np.ndarray, v: np.ndarray, i: int) -> np.ndarray:
        """The student's force [N], shape (3,), on the first point of link i. It may change its arguments."""
        f, j = self.forces, i + 1
        ends = x[i].copy(), x[j].copy(), v[i].copy(), v[j].copy()
        return self.fit("spring_force", self.own["spring_force"](*ends, f.stiffness, f.damping, f.rest_length), (3,))

    def add_surroundings(self, x: np.ndarray, v: np.ndarray, a: np.ndarray) -> None:
        """Add floor, sphere, the pull of the mouse and the forces that the net declares, on all points but the root."""
        f, first = self.forces, self.roots
        pressed: list[tuple[int | np.intp, np.ndarray, np.ndarray, bool]] = []  # points in contact
        for i in np.flatnonzero(x[first:, 2] < f.floor) + first if x[:, 2].min() < f.floor else ():
            force = self.contact(x[i], v[i], on_sphere=False)
            pressed.append((i, force, v[i], False))
            a[i] += force / self.mass_of(i)
        if f.sr > 0.0:
            centre, velocity = self.sphere_now()
            near = np.flatnonzero(np.linalg.norm(x[first:] - centre, axis=1) < f.sr) + first
            for i in range(first, len(x)) if "sphere_force" in self.own else near:
                force = self.sphere(x[i], v[i] - velocity)
                pressed.append((i, force, v[i] - velocity, True))
                a[i] += force / self.mass_of(i)
        if f.grabbed >= first:
            gap = np.array((f.grab_x, f.grab_y, f.grab_z)) - x[f.grabbed]
            pull = secant(*gap.tolist(), stiffness=f.grab_k, most=f.grab_max) * gap - f.grab_b * v[f.grabbed]
            a[f.grabbed] += pull / self.mass_of(f.grabbed)
        if f.declared:
            from app.lab.process.declared_forces import accelerations, record  # numba, which takes a second to import

            masses = tuple(float(self.mass_of(i)) for i in range(len(x)))
            p = record(f.declared, self.shape_of(x), masses, tuple(self.pins.tolist()), self.segment.h)
            a += accelerations(x, v, f.began + self.now, p)
        if f.friction > 0.0 and not f.lab_contact:
            for i, force, slip, on_sphere in pressed:
                self.add_friction(x[i], slip, a[i], force / self.mass_of(i), on_sphere=on_sphere)

    def add_friction(self, x: np.ndarray, v: np.ndarray, a: np.ndarray, push: np.ndarray, *, on_sphere: bool) -> None:
        """Add the program's friction to the acceleration a (3,) of a point at x, at v against its surface.

        push: acceleration (3,) by the surface, which a student's function may have given.
        """
        _, *normal = touching(*x.tolist(), t=self.now, p=self.forces, on_sphere=on_sphere)
        grip = self.forces.friction * max(0.0, float(push @ normal))
        *needed, part = stopping(*normal, *v.tolist(), *a.tolist(), grip=grip, stop_rate=1.0 / self.segment.h)
        a -= np.multiply(part, needed)

    def shape_of(self, x: np.ndarray) -> tuple[int, int]:
        """Rows and columns of the points."""
        return 1, len(x)

    def mass_of(self, i: int | np.intp) -> float:
        """The mass of point i [kg]."""
        return self.forces.mass

    def sphere_now(self) -> tuple[np.ndarray, np.ndarray]:
        """Centre [m] and velocity [m/s] of the sphere."""
        f = self.forces
        velocity = np.array((f.svx, f.svy, f.svz))
        return np.array((f.sx, f.sy, f.sz)) + (self.now - f.epoch) * velocity, velocity

    def sphere(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """The force [N], shape (3,), of the sphere on a point at x, at v against it, without friction."""
        f = self.forces
        if "sphere_force" not in self.own:
            return self.contact(x, v, on_sphere=True)
        centre, _ = self.sphere_now()
        value = self.own["sphere_force"](x.copy(), v.copy(), centre, f.sr, f.contact_k, f.contact_b)
        return self.fit("sphere_force", value, (3,))

    def contact(self, x: np.ndarray, v: np.ndarray, *, on_sphere: bool) -> np.ndarray:
        """The program's force [N], shape (3,), of floor or sphere on a point at x, at v against it, but no friction."""
        at = touching(*x.tolist(), t=self.now, p=self.forces, on_sphere=on_sphere)
        return np.array(contact_force(*at, *v.tolist(), p=self.forces, on_sphere=on_sphere, with_damping=True))

    def name_nan(self, x: np.ndarray, v: np.ndarray) -> None:
        """Raises Unfit for the function that returns NaN at this state."""
        f = self.forces
        numbers = f.mass, f.stiffness, f.damping, f.drag, f.rest_length, f.gravity
        for name in ("rope_acceleration", "spring_force", "sphere_force"):
            if name not in self.own:
                continue
            if name == "rope_acceleration":
                values = [self.own[name](x.copy(), v.copy(), *numbers)]
            elif name == "spring_force":
                values = [self.link(x, v, i) for i in range(len(x) - 1)]
            else:
                _, velocity = self.sphere_now()
                values = [self.sphere(x[i], v[i] - velocity) for i in range(1, len(x))]
            if any(np.isnan(value).any() for value in values):
                raise not_a_number(name, self.own[name])

    def advance(self, x: np.ndarray, v: np.ndarray, start: float) -> tuple[np.ndarray, np.ndarray]:
        """One step from time `start` [s] of the segment. Raises Unfit.

        A step does not pass the time of an acceleration. A moving root shows it: the step gets the root as a clock, at
        x = 0 with 1 m/s, and the root is in its right place whenever a force is computed.
        """
        h = self.segment.h
        self.start = start
        x, v = x.copy(), v.copy()
        self.start_clock(x, v)
        value = self.get(self.step)(x, v, h, self.acceleration)
        if value is None:
            text = f"{self.step} returns nothing: the last line must be return ..."
            raise Unfit("returns nothing", text, self.get(self.step))
        size = len(value) if isinstance(value, tuple | list) or np.ndim(value) else 0
        if size != 2:
            form = entries(size) if size else f"a value of type {type(value).__name__}"
            text = f"{self.step} returns {form}; expected two arrays, the new positions and velocities"
            raise Unfit("wrong shape" if size else "wrong type", text, self.get(self.step))
        x_new, v_new = self.fit(self.step, value[0], x.shape), self.fit(self.step, value[1], x.shape)
        if np.isnan(x_new.sum() + v_new.sum()) and (np.isnan(x_new).any() or np.isnan(v_new).any()):
            raise not_a_number(self.step, self.get(self.step))
        return self.held(x_new, v_new, start + h) if len(self.segment.path) else (x_new, v_new)

    def start_clock(self, x: np.ndarray, v: np.ndarray) -> None:
        """Make the root of x and v the clock of a step."""
        if len(self.segment.path):
            x[0], v[0] = 0.0, (1.0, 0.0, 0.0)


def march(functions: Functions, x: np.ndarray, v: np.ndarray, segments: list[Segment]) -> MarchResult:
    """Advance a rope from positions x and velocities v, shape (n, 3), over some segments. Raises Unfit."""
    ends: list[np.ndarray] = []
    taken, last_v, left = 0, v, False
    began, effort = time.perf_counter(), time.thread_time()
    with np.errstate(all="ignore"):
        for segment in segments:
            functions.segment = segment
            for i in range(segment.steps):
                x, v = functions.advance(x, v, segment.since + i * segment.h)
                taken += 1
                left = not (np.abs(x).max() < MAX_COORDINATE and np.abs(v).max() < MAX_COORDINATE)
                if left:
                    break
            if left:
                break
            ends.append(x)
            last_v = v
    seconds, effort = time.perf_counter() - began, time.thread_time() - effort
    return MarchResult(np.array(ends).reshape(-1, *x.shape), last_v, taken, seconds, effort, left)


def packed(segment: Segment) -> list[Any]:
    """A segment in the form that crosses the pipe (`wire.py`)."""
    return [segment.steps, segment.h, [*segment.forces], segment.path, segment.since]


def unpacked(parts: Any) -> Segment:
    """The segment that `packed` made."""
    steps, h, forces, path, since = parts
    return Segment(int(steps), float(h), Forces(*forces), np.asarray(path, np.float64), float(since))
