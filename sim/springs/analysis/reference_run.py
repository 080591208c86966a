"""The reference of a race: the same rope by an adaptive method, and how far it can be trusted.

Two runs of Dormand-Prince 5(4): the reference at a relative tolerance of 1e-10, and one at a tenth of that which
starts 1e-10 m away. Their separation holds what the reference's own steps err by and what the motion makes of a
disturbance, so an error is worth reading only well above it; once it is a visible part of the rope, chaos has taken
the reference.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.springs import INTEGRATORS, Net
from sim.springs.simulate import FRICTION_STEP
from sim.springs.stability import gershgorin
from sim.springs.state import DIVERGENCE_BOUND

RTOL = 1e-10
ATOL = 1e-13  # [m], [m/s]
PERTURBATION = 1e-10  # [m] between the two at the start
TRUST_FACTOR = 10.0  # separations above which an error is the racing method's own
HORIZON_SEPARATION = 1e-2  # of the rope's length: a separation at which there is nothing left to compare with
MAX_EVALUATION_RATE = 5e7  # evaluations of a point that a second of all references may take, some half a second
METHOD = INTEGRATORS["dopri5"]


def nudged(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Flat positions (3 n,) with every point but the root moved by PERTURBATION, each another way."""
    away = np.random.default_rng(0).standard_normal((3, x.size // 3))
    away *= PERTURBATION / np.linalg.norm(away, axis=0)
    away[:, 0] = 0.0
    return x + away.ravel()


class ReferenceRun:
    """The reference motion of one net."""

    def __init__(self, net: Net, length: float, count: int = 1) -> None:
        """length: [m] of the rope, scale of a lost reference. count: of references in the race."""
        x = net.x0.reshape(-1)
        self.length = length
        self.runs = [[x.copy(), np.zeros(x.size)], [nudged(x), np.zeros(x.size)]]
        self.separation = PERTURBATION  # [m]
        self.horizon: float | None = None  # [s] when chaos took it
        self.count = count
        self.failure = ""  # reason why the reference is missing, or ""
        self.update(net)

    @property
    def is_available(self) -> bool:
        return not self.failure

    @property
    def x(self) -> NDArray[np.float64]:
        """(3, points) [m]."""
        return self.runs[0][0].reshape(3, -1)

    @property
    def v(self) -> NDArray[np.float64]:
        """(3, points) [m/s]."""
        return self.runs[0][1].reshape(3, -1)

    def update(self, net: Net) -> None:
        """Other parameters, which may be too expensive to follow."""
        self.failure = self.failure or too_costly(net, self.count)

    def advance(self, net: Net, t: float, duration: float) -> None:
        """Follow the motion for `duration` [s] from time t [s]."""
        if not self.is_available:
            return
        p = net.kernel_view(FRICTION_STEP)
        times = np.array([t, t + duration])
        for run, finer in zip(self.runs, (1.0, 0.1), strict=True):
            xs, vs, ledgers = np.empty((2, run[0].size)), np.empty((2, run[0].size)), np.zeros((2, 3))
            assert METHOD.march is not None
            _, _, filled, _ = METHOD.march(*run, times, finer * RTOL, finer * ATOL, p, False, xs, vs, ledgers)
            raise_if_stopped()
            if filled < 2 or not np.abs(xs[1]).max() < DIVERGENCE_BOUND:
                self.failure = f"it found no step short enough at t = {t:.2f} s"
                return
            run[:] = xs[1], vs[1]
        apart = (self.runs[0][0] - self.runs[1][0]).reshape(3, -1)
        # Where a rope comes to rest the two meet again; below the nudge they say nothing new.
        self.separation = max(PERTURBATION, float(np.linalg.norm(apart, axis=0).max()))
        if self.horizon is None and self.separation > HORIZON_SEPARATION * self.length:
            self.horizon = t + duration

    def pin(self, position: tuple[float, float, float]) -> None:
        """Put the root to rest at a place [m]."""
        for x, v in self.runs:
            x.reshape(3, -1)[:, 0] = position
            v.reshape(3, -1)[:, 0] = 0.0

    def distance(self, x: NDArray[np.float64]) -> float:
        """Largest distance [m] of a point of x (3, 1, points) from the reference's; NaN without a reference."""
        if not self.is_available:
            return math.nan
        return float(np.linalg.norm(x[:, 0] - self.x, axis=0).max())


def too_costly(net: Net, count: int) -> str:
    """Reason why `count` references of about this net cannot be followed in real time, or ""."""
    # The shortest steps are about 0.7/omega, and stay below 3.3/rate where damping is strong; six evaluations each, in
    # two runs.
    omega, rate = gershgorin(net)
    steps = max(omega / 0.7, rate / 3.3)
    if count * 12.0 * steps * net.x0[0].size <= MAX_EVALUATION_RATE:
        return ""
    return f"it would take {steps:.2g} steps a second, too many for ropes of {net.x0[0].size} points"
