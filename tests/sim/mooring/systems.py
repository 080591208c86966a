"""Moorings that several tests use: the reference tasks of MoorDyn, and plain lines."""

import math

import numpy as np

from sim.mooring import Line, LineType, MooredBody, Point, System
from sim.water import Water

CHAIN = LineType("chain", 0.09, 80.0, 5e7, -0.8, 1.0, 1.6, 0.0, 0.1)
TAUT = LineType("taut", 0.04, 1.1, 1.5e6, 3e4, 1.0, 1.2, 0.0, 0.05)


def chain_on_bed(segments: int) -> System:
    """Task A."""
    points = (Point(1, "fixed", (-140.0, 0.0, -40.0)), Point(2, "coupled", (0.0, 0.0, 0.0)))
    return System((Line(1, CHAIN, 1, 2, 160.0, segments),), points, Water(40.0))


def taut_rope(segments: int) -> System:
    """Task B."""
    points = (Point(1, "fixed", (-20.0, 0.0, -50.0)), Point(2, "coupled", (0.0, 0.0, -1.0)))
    return System((Line(1, TAUT, 1, 2, 52.0, segments),), points, Water(50.0))


class Shaking:
    """A sine along an axis that fades in over 10 s, with its velocity."""

    def __init__(self, place: tuple[float, float, float], axis: int, amplitude: float, period: float) -> None:
        self.place, self.axis, self.amplitude, self.rate = np.array(place), axis, amplitude, 2.0 * math.pi / period

    def __call__(self, t: float) -> np.ndarray:
        found = self.place.copy()
        found[self.axis] += self.amplitude * math.sin(self.rate * t) * min(1.0, max(t, 0.0) / 10.0)
        return found

    def velocity(self, t: float) -> np.ndarray:
        found = np.zeros(3)
        wave = self.rate * math.cos(self.rate * t) * min(1.0, t / 10.0)
        found[self.axis] = self.amplitude * (wave + (math.sin(self.rate * t) / 10.0 if t < 10.0 else 0.0))
        return found


def in_vacuum(kind: LineType) -> LineType:
    """The type without internal damping, for systems with no water."""
    return kind._replace(damping=0.0)


def floating_body(surge_stiffness: float = 0.0) -> MooredBody:
    """A body of 20 t with springs of heave, roll, pitch and yaw, at the surface."""
    mass = np.diag([2e4, 2e4, 3e4, 8e4, 8e4, 9e4])
    mass[0, 4] = mass[4, 0] = -1e4
    mass[1, 3] = mass[3, 1] = 1e4
    return MooredBody(1, (0.0, 0.0, 0.0), mass, np.diag([surge_stiffness, surge_stiffness, 2e5, 5e5, 5e5, 1e4]))
