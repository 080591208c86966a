"""The cloth as a sequence of OBJ files: the same quads and texture coordinates in each, other positions."""

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.stepping import steps_to
from app.study.export.sequence import file_name
from sim.validation import argument_error

FORMATS = ("obj",)
BYTES_PER_PARTICLE = 110  # of a file


class ClothMeshes:
    """One run of the cloth; see `app.study.export.sequence.Sequence`."""

    passes = 1

    def __init__(self, params: ClothParams, interval: float, form: str) -> None:
        """interval: [s] between two frames; steps are shortened equally where the step does not divide it.

        Raises ValueError for an integrator that cannot step this cloth.
        """
        self.interval = interval
        step = interval / math.ceil(interval / params.time_step * (1.0 - 1e-9))
        self.scene = ClothScene(dataclasses.replace(params, time_step=step))
        if self.scene.note:
            # A file would not show that another integrator ran than the requested one.
            raise argument_error(
                "integrator",
                params.integrator,
                "a method with damping: this net is damped by links, drag, air or contact",
            )
        self.bytes_per_frame = BYTES_PER_PARTICLE * params.rows * params.cols
        self.rest = rest_of_obj(params.rows, params.cols)

    def write(self, folder: Path, start: float, count: int) -> Iterator[float]:
        """Write the meshes."""
        scene = self.scene
        for number in range(1, count + 1):
            steps = steps_to(scene, start + (number - 1) * self.interval)
            if steps:
                scene.advance(steps)
            text = obj_of(np.moveaxis(scene.state.x, 0, -1), self.rest)
            (folder / file_name("cloth", number, "obj")).write_text(text, "ascii")
            yield scene.time

    def about(self) -> dict[str, Any]:
        """Units and axes."""
        return {
            "files": {"cloth.####.obj": {"unit": "m", "up": "z"}},
            "rows": self.scene.params.rows,
            "columns": self.scene.params.cols,
            "time_step": self.scene.step,
            "time_step_unit": "s",
        }


def rest_of_obj(rows: int, cols: int) -> str:
    """Common part of all files: texture coordinates, from (0, 0) at the last row to (1, 1), and quads."""
    lines = [f"vt {j / (cols - 1):.7g} {1.0 - i / (rows - 1):.7g}" for i in range(rows) for j in range(cols)]
    for i in range(rows - 1):
        for j in range(cols - 1):
            corner = i * cols + j + 1  # numbers of vertices begin at 1
            quad = corner, corner + cols, corner + cols + 1, corner + 1
            lines.append("f " + " ".join(f"{vertex}/{vertex}" for vertex in quad))
    return "\n".join(lines) + "\n"


def obj_of(points: NDArray[np.floating], rest: str) -> str:
    """The text of an OBJ file. points: (rows, cols, 3) [m]; written to the last bit of float32."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points.astype(np.float32).reshape(-1, 3).tolist()]
    return "# Springtide, metres, z up\no cloth\n" + "\n".join(lines) + "\n" + rest
