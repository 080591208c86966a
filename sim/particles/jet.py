"""A jet of oil: parcels on ballistic paths that fall on a moving surface and feed a spill.

Between nozzle and sea a parcel moves as dv/dt = -g z - (v - wind)/tau, exactly, with tau infinite by default. Volume is
conserved: `ejected` = `in_flight` + `fed` to rounding.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.jit import kernel
from sim.particles.rain import bilinear
from sim.particles.random import uniform
from sim.validation import argument_error, check_number, check_positive, check_vector, is_whole_number
from sim.water import EARTH_GRAVITY


class Landed(NamedTuple):
    """Parcels that met the surface in one step, m of them."""

    position: np.ndarray  # (m, 3) [m] where they met it
    velocity: np.ndarray  # (m, 3) [m/s] with which
    volume: np.ndarray  # (m,) [m3]


class Jet:
    """Parcels of one jet: `position`, `velocity` (3, n) float64; `flying` (n,) bool; `volume` (n,) [m3]."""

    def __init__(
        self,
        nozzle: tuple[float, float, float],
        velocity: tuple[float, float, float],
        flow: float = 0.5,
        spread: float = 0.06,
        count: int = 4000,
        gravity: float = EARTH_GRAVITY,
        drag_time: float = math.inf,
        wind: tuple[float, float] = (0.0, 0.0),
        flight: float = 8.0,
    ) -> None:
        """nozzle [m]; velocity [m/s] of the jet's axis; flow [m3/s]; spread: rms deviation over the speed; count:
        most parcels in the air, which, spread over `flight` [s], sets how many leave a second; drag_time [s] or inf.
        Raises ValueError for a value that is not allowed.
        """
        if not is_whole_number(count) or count < 1:
            raise argument_error("count", count, "a whole number of at least 1")
        self.nozzle, self.axis = check_vector("nozzle", nozzle, "m"), check_vector("velocity", velocity, "m/s")
        self.flow, self.spread = check_positive("flow", flow, "m3/s"), check_number("spread", spread, "", 0.0)
        self.gravity, self.wind = check_positive("gravity", gravity, "m/s2"), check_vector("wind", wind, "m/s", 2)
        self.drag_time = check_positive("drag_time", drag_time, "s", allow_infinite=True)
        flight = check_positive("flight", flight, "s")
        self.rate = count / flight  # [1/s] parcels
        self.position = np.zeros((3, count))
        self.velocity = np.zeros((3, count))
        self.flying = np.zeros(count, np.bool_)
        self.volume = np.zeros(count)
        self.serial = 0  # parcels that have left
        self.hits = 0
        self.ejected = self.fed = 0.0  # [m3]
        self._due = self._waiting = 0.0
        self._rows = np.empty((count, 7))

    @property
    def in_flight(self) -> float:
        """Volume [m3] between the nozzle and the sea, with the volume that waits for a free parcel."""
        return float(self.volume[self.flying].sum()) + self._waiting

    def step(self, dt: float, height: np.ndarray, origin: tuple[float, float], cell: float) -> Landed:
        """Let dt [s] pass over a surface given as it is at the end: height (m, m) [m] at origin + cell (i, j) [m].

        Beyond that patch the surface counts as it is at its edge. Raises ValueError for a bad dt.
        """
        dt = check_number("dt", dt, "s", 0.0)
        fly(self.position, self.velocity, self.flying, dt, self.gravity, self.drag_time, *self.wind)
        self._emit(dt)
        m = height.shape[0]
        count = land(self.position, self.velocity, self.flying, self.volume, dt, np.asarray(height, np.float64),
                     float(origin[0]), float(origin[1]), float(cell), float(m - 1), self._rows)  # fmt: skip
        rows = self._rows[:count]
        self.hits += count
        self.fed += float(rows[:, 6].sum())
        return Landed(rows[:, :3].copy(), rows[:, 3:6].copy(), rows[:, 6].copy())

    def _emit(self, dt: float) -> None:
        volume = self.flow * dt
        self.ejected += volume
        self._waiting += volume
        self._due += self.rate * dt
        n = int(self._due)
        free = np.flatnonzero(~self.flying)[:n]
        self._due -= n
        if len(free) == 0:
            return
        self.volume[free] = self._waiting / len(free)
        self._waiting = 0.0
        nozzle, axis = np.array(self.nozzle, float), np.array(self.axis, float)
        emit(self.position, self.velocity, self.flying, free, self.serial, dt, self.gravity, self.drag_time,
             self.spread, *self.wind, nozzle, axis)  # fmt: skip
        self.serial += len(free)


@kernel
def path(v, wind, pull, tau, t):
    """(way, speed) after t [s] of dv/dt = pull - (v - wind)/tau from speed v."""
    if math.isinf(tau):
        return v * t + 0.5 * pull * t * t, v + pull * t
    end = wind + pull * tau  # the terminal speed
    gone = -math.expm1(-t / tau)
    return end * t + (v - end) * tau * gone, v + (end - v) * gone


@kernel
def fly(position, velocity, flying, dt, gravity, tau, wind_x, wind_y):
    """Move the parcels in the air by dt."""
    for i in range(flying.size):
        if flying[i]:
            way, velocity[0, i] = path(velocity[0, i], wind_x, 0.0, tau, dt)
            position[0, i] += way
            way, velocity[1, i] = path(velocity[1, i], wind_y, 0.0, tau, dt)
            position[1, i] += way
            way, velocity[2, i] = path(velocity[2, i], 0.0, -gravity, tau, dt)
            position[2, i] += way


@kernel
def emit(position, velocity, flying, free, serial, dt, gravity, tau, spread, wind_x, wind_y, nozzle, axis):
    """Start parcels `free` evenly over the last dt, each already under way since."""
    speed = np.sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2])
    for j in range(free.size):
        i = free[j]
        t = dt * (j + 0.5) / free.size
        for c in range(3):
            # Three uniform numbers: near enough to a normal one, of variance 1 with the factor 2.
            off = uniform(serial + j, 0, 3 * c) + uniform(serial + j, 0, 3 * c + 1) + uniform(serial + j, 0, 3 * c + 2)
            v = axis[c] + speed * spread * 2.0 * (off - 1.5)
            wind = wind_x if c == 0 else wind_y if c == 1 else 0.0
            way, velocity[c, i] = path(v, wind, -gravity if c == 2 else 0.0, tau, t)
            position[c, i] = nozzle[c] + way
        flying[i] = True


@kernel
def land(position, velocity, flying, volume, dt, height, x0, y0, cell, last, rows):
    """Land parcels under the surface: set rows[m] to place, velocity and volume at the hit; return their number m."""
    count = 0
    for i in range(flying.size):
        if not flying[i]:
            continue
        u = min(max((position[0, i] - x0) / cell, 0.0), last - 1e-9)
        v = min(max((position[1, i] - y0) / cell, 0.0), last - 1e-9)
        below = position[2, i] - bilinear(height, u, v)
        if not below < 0.0:
            continue
        # Back along the path, straight over so short a time, to where it crossed.
        fall = max(-velocity[2, i], 1e-6)
        back = min(-below / fall, dt)
        for c in range(3):
            rows[count, c] = position[c, i] - back * velocity[c, i]
            rows[count, 3 + c] = velocity[c, i]
        rows[count, 6] = volume[i]
        flying[i] = False
        count += 1
    return count
