"""The waves that bodies make: a square of rings about the origin, laid over the radial mesh."""

import numpy as np

from sim.jit import kernel
from sim.ocean import Sea
from sim.ocean.tile.query import bicubic

SIZE, LENGTH = 96, 57.6  # cells and side [m] of the square
WIDEST = 0.42  # fraction of the side within which rings are drawn whole; they fade to its edge
LEAK = 0.08  # [1/s] stands for what leaves the square and would come back in on its other side


class RadiatedWaves:
    """Rings made by bodies that press on the water."""

    def __init__(self) -> None:
        self.sea = Sea(size=SIZE, length=LENGTH, wind_speed=0.0, choppiness=0.0)
        self.sea.ripples.leak = LEAK

    def press(self, t: float, points: np.ndarray, widths: np.ndarray, impulses: np.ndarray, density: float) -> None:
        """At time t [s], bodies at points (n, 2) [m] of widths (n,) [m] have pressed with impulses (n,) [N s].

        density [kg/m3]: of the fluid that they pressed on.
        """
        inside = np.abs(points).max(axis=1) < WIDEST * LENGTH
        if not inside.any():
            return
        cell = LENGTH / SIZE
        spread = np.maximum(0.5 * widths[inside], 1.6 * cell)
        self.sea.ripples.add(
            t, points[inside] + 0.5 * LENGTH, spread, impulse=impulses[inside] * self.sea.conditions.density / density
        )

    def lay(self, t: float, vertices: np.ndarray, slopes: np.ndarray, count: int) -> None:
        """Add the rings at time t [s] to the first `count` vertices (m, 3) [m] and slopes (m, 2)."""
        if self.sea.ripples.alive:
            add_square(self.sea.surface(t).height, LENGTH, WIDEST * LENGTH, vertices[:count], slopes[:count])


@kernel
def add_square(height, length, inner, vertices, slopes):
    """Add a square field centred on the origin, whole within `inner` of it and fading to its edge."""
    cell = length / height.shape[0]
    outer = 0.5 * length
    for i in range(vertices.shape[0]):
        x, y = vertices[i, 0], vertices[i, 1]
        r = max(abs(x), abs(y))
        if r >= outer:
            continue
        fade = min((outer - r) / (outer - inner), 1.0)
        z, by_u, by_v = bicubic(height, (x + outer) / cell, (y + outer) / cell)
        vertices[i, 2] += fade * z
        slopes[i, 0] += fade * by_u / cell
        slopes[i, 1] += fade * by_v / cell
