"""Smooth pursuit of a target that jumps: a browser sends drags some twenty times a second."""

import math

from sim.springs.net import PinPath, Vector

RATE = 25.0  # [1/s]: what follows has done nine tenths of a jump after 0.16 s


class CriticallyDampedTracker:
    """A critically damped pursuit, y'' = r^2 (target - y) - 2 r y', exact over any time.

    top: largest speed along an axis [m/s]. A target further than 2 top/r is pursued as if it were that far: from rest,
    or from any slower motion, the pursuit of a point ahead by d is never faster than r d/2.
    """

    def __init__(self, position: Vector, top: float = math.inf) -> None:
        self.top = top
        self.position: Vector = position
        self.velocity: Vector = (0.0, 0.0, 0.0)
        self.target: Vector = position

    @property
    def at_rest(self) -> bool:
        return self.velocity == (0.0, 0.0, 0.0) and self.position == self.target

    def advance(self, start: float, duration: float) -> PinPath | None:
        """Follow for `duration` [s] from time `start`; the cubic between the two ends, or None at rest."""
        if self.at_rest:
            return None
        x0, v0 = self.position, self.velocity
        decay = math.exp(-RATE * duration)
        x1, v1 = [], []
        reach = 2.0 * self.top / RATE
        ahead = tuple(x + min(max(target - x, -reach), reach) for x, target in zip(x0, self.target, strict=True))
        for x, v, target in zip(x0, v0, ahead, strict=True):
            # y - target = (a + b t) exp(-r t) with a = y0 - target, b = v0 + r a
            a = x - target
            b = v + RATE * a
            x1.append(target + (a + b * duration) * decay)
            v1.append((b - RATE * (a + b * duration)) * decay)
        if max(abs(x - t) for x, t in zip(x1, self.target, strict=True)) < 1e-7 and max(map(abs, v1)) < 1e-6:
            x1, v1 = list(self.target), [0.0, 0.0, 0.0]
        self.position, self.velocity = tuple(x1), tuple(v1)  # type: ignore[assignment]
        c2, c3 = [], []
        for p0, p1, s0, s1 in zip(x0, x1, v0, v1, strict=True):
            # Cubic Hermite: position and velocity at both ends.
            c2.append((3 * (p1 - p0) / duration - 2 * s0 - s1) / duration)
            c3.append((2 * (p0 - p1) / duration + s0 + s1) / duration**2)
        return PinPath(start, (x0, v0, tuple(c2), tuple(c3)))  # type: ignore[arg-type]

    def place_at(self, position: Vector) -> None:
        """Be at rest there at once."""
        self.__init__(position, self.top)
