"""Advances a cloth with a student's functions, in the process that runs them; see `rope_march.py`.

The student's `cloth_links` joins points, and `cloth_forces` computes the forces of the links. Air, floor, sphere and
the pull of the mouse are the program's laws; points do not collide with each other.
"""

import functools
from collections.abc import Callable, Collection, Mapping
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from app.lab.course.tasks.springs.cloth_forces import cloth_forces
from app.lab.course.tasks.springs.cloth_links import cloth_links
from app.lab.course.tasks.springs.step_euler import step_euler
from app.lab.course.tasks.springs.step_rk4 import step_rk4
from app.lab.process.rope_march import ClothData, Functions, Unfit, fitting, not_a_number

FILE = "cloth.py"  # where the tasks have these functions
# Fractions of a step at which each method evaluates the acceleration.
MOMENTS = {"step_euler": (0.0,), "step_symplectic": (0.0,), "step_rk4": (0.0, 0.5, 0.5, 1.0)}


def step_symplectic(x: Any, v: Any, h: float, acceleration: Callable[..., Any]) -> tuple[Any, Any]:
    """One step of symplectic Euler: one acceleration a step, stable at the longest steps."""
    v = v + h * acceleration(x, v)
    return x + h * v, v


class ClothFunctions(Functions):
    """The functions that advance a cloth."""

    reference: Mapping[str, Callable[..., Any]] = MappingProxyType({
        "cloth_links": cloth_links, "cloth_forces": cloth_forces, "step_euler": step_euler, "step_rk4": step_rk4,
        "step_symplectic": step_symplectic,
    })  # fmt: skip
    roots = 0

    def __init__(self, module: ModuleType, own: Collection[str], step: str, sheet: ClothData) -> None:
        """own, step: as of `Functions`. Raises Unfit for links impossible in a cloth of this size."""
        super().__init__(module, own, step, {})
        self.sheet, self.pins = sheet, np.array(sheet.pins, int)
        links = checked_links(self.get("cloth_links"), sheet.rows, sheet.cols)
        across, down = np.ones(sheet.cols), np.ones(sheet.rows)
        across[[0, -1]] = down[[0, -1]] = 0.5
        self.cells = np.outer(down, across).ravel()  # (n,) cells of each point: 1, 1/2 or 1/4
        (i, j), (k, m) = (np.divmod(links[:, end], sheet.cols) for end in (0, 1))
        down, along = np.abs(k - i), np.abs(m - j)
        self.rest = np.hypot(along * sheet.spacing[0], down * sheet.spacing[1])
        self.links, self.kind = links, np.where(down * along > 0, 1, np.where(down + along > 1, 2, 0))
        side = ((down == 0) & np.isin(i, (0, sheet.rows - 1))) | ((along == 0) & np.isin(j, (0, sheet.cols - 1)))
        self.strip = np.where(side, 0.5, 1.0)  # of cloth for each link

    def mass_of(self, i: int | np.intp) -> float:
        """The mass of point i [kg]: of a cell, of half of one on an edge, of a quarter at a corner."""
        return self.forces.mass * self.cells[i]

    def shape_of(self, x: np.ndarray) -> tuple[int, int]:
        """Rows and columns of the points."""
        return self.sheet.rows, self.sheet.cols

    def inner(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Links, air and gravity."""
        f, sheet = self.forces, self.sheet
        total = -f.drag * v
        for kind, stiffness in enumerate((f.stiffness, sheet.shear, sheet.bend)):
            for strip in (0.5, 1.0):
                chosen = (self.kind == kind) & (self.strip == strip)
                if chosen.any():
                    total += self.link_forces(x, v, chosen, strip * stiffness, strip * f.damping)
        total += self.wind(x, v)
        a = total / (f.mass * self.cells[:, None])
        a[:, 2] -= f.gravity
        return a

    def start_clock(self, x: np.ndarray, v: np.ndarray) -> None:
        """Start a step. The steps of a cloth are the program's, with known times of the accelerations."""
        self.moments = iter(MOMENTS[self.step])

    def time_in_step(self, x: np.ndarray) -> float:
        """Time [s] since the start of the step."""
        return next(self.moments) * self.segment.h

    def acceleration(self, x: Any, v: Any) -> np.ndarray:
        """The accelerations [m/s2], shape (n, 3), for a step."""
        a = super().acceleration(x, v)
        a[self.pins] = 0.0
        return a

    def link_forces(
        self, x: np.ndarray, v: np.ndarray, chosen: np.ndarray, stiffness: float, damping: float
    ) -> np.ndarray:
        """The forces [N], shape (n, 3), of some links. The student's function may change its arguments."""
        arrays = x.copy(), v.copy(), self.links[chosen], self.rest[chosen]
        value = self.get("cloth_forces")(*arrays, stiffness, damping)
        return self.fit("cloth_forces", value, x.shape)

    def wind(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """The force [N], shape (n, 3), of the air (`sim/springs/forces/air.py`)."""
        f, shape = self.forces, (self.sheet.rows, self.sheet.cols, 3)
        force = np.zeros(shape)
        if f.air_drag == f.air_lift == 0.0:
            return force.reshape(x.shape)
        a, b, c, d = corners(x.reshape(shape))
        area = 0.5 * np.cross(d - a, c - b)
        u = np.array((f.wind_x, f.wind_y, f.wind_z)) - 0.25 * sum(corners(v.reshape(shape)))
        flow = (u * area).sum(axis=-1, keepdims=True)
        size, speed = (np.maximum(np.linalg.norm(y, axis=-1, keepdims=True), 1e-150) for y in (area, u))
        along = np.abs(flow) * (f.air_drag - f.air_lift * np.abs(flow) / size / speed)
        quarter = 0.25 * (along * u + flow / size * f.air_lift * speed * area)
        for corner in corners(force):
            corner += quarter
        return force.reshape(x.shape)

    def name_nan(self, x: np.ndarray, v: np.ndarray) -> None:
        """Raises Unfit for cloth_forces, if that returns NaN at this state."""
        f = self.forces
        if (
            "cloth_forces" in self.own
            and np.isnan(self.link_forces(x, v, self.kind >= 0, f.stiffness, f.damping)).any()
        ):
            raise not_a_number("cloth_forces", self.own["cloth_forces"])


def corners(of: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The four corners of every cell, (rows - 1, cols - 1, 3) each, as views."""
    return of[:-1, :-1], of[:-1, 1:], of[1:, :-1], of[1:, 1:]


@functools.lru_cache(maxsize=4)
def checked_links(function: Callable[..., Any], rows: int, cols: int) -> np.ndarray:
    """(links, 2) whole numbers of points. Raises Unfit for anything else."""
    value = function(rows, cols)
    count = len(value) if isinstance(value, list | tuple | np.ndarray) else 0
    links = fitting("cloth_links", value, (count, 2), function)
    if not ((links >= 0) & (links < rows * cols) & (links == np.floor(links))).all():
        last = rows * cols - 1
        text = f"cloth_links returns a point that does not exist: a cloth of {rows} x {cols} has the points 0 to {last}"
        raise Unfit("out of range", text, function)
    if (links[:, 0] == links[:, 1]).any():
        raise Unfit("out of range", "cloth_links joins a point to itself", function)
    return links.astype(int)
