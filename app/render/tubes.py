"""Tubes through the points of ropes."""

import numpy as np
from numpy.typing import NDArray

from app.render.colormap import SCALE, set_tube_colours
from app.render.meshes import SIDES, smooth_line, sweep, tube_faces


class Tube:
    """The mesh of a tube through the points of a rope."""

    def __init__(self, points: int, rings: int, sides: int = SIDES) -> None:
        """points: of the rope. rings: of the tube, about. sides: of a ring."""
        self.samples = max(1, rings // (points - 1))  # rings a link
        self.line = np.zeros(((points - 1) * self.samples + 1, 3))
        self.sides, self.faces = sides, tube_faces(len(self.line), sides)

    @property
    def shape(self) -> tuple[int, int]:
        """Shape (rings sides + 2, 3) of the vertices and of their colours."""
        return len(self.line) * self.sides + 2, 3

    def vertices(self, points: NDArray[np.float32], radius: float) -> NDArray[np.float32]:
        """Vertices [m] of a tube with this radius [m] through points (n, 3) [m]."""
        vertices = np.empty(self.shape, np.float32)
        smooth_line(points, self.samples, self.line)
        sweep(self.line, radius, self.sides, vertices)
        return vertices

    def colours(self, tension: NDArray[np.float32], full_scale: float) -> NDArray[np.float32]:
        """Colours, sRGB in 0..1, of the tension (n - 1,) [N] of links. full_scale: [N] at the end of the scale."""
        colours = np.empty(self.shape, np.float32)
        set_tube_colours(tension, self.samples, full_scale, SCALE, self.sides, colours)
        return colours


def compile_tube() -> None:
    """Call the kernels that draw a coloured tube."""
    tube = Tube(2, 2)
    tube.vertices(np.zeros((2, 3), np.float32), 1.0)
    tube.colours(np.ones(1, np.float32), 1.0)
