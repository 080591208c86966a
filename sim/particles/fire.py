"""Fire and its smoke: parcels of hot gas that rise, cool, spread and drift with the wind.

A parcel of excess heat theta, 1 at the fire, cools as e^(-t/c) and is dragged to the speed of the wind within tau:

  dv/dt = b theta z - (v - wind)/tau,   theta = e^(-age/c)

integrated exactly, so that any step will do. b = 23.3 m/s2 is the rise of gas in a flame (McCaffrey 1979, NBSIR
79-1910: v = 6.83 sqrt(z), any fire), and c is the time it takes through the flame, which is as high as Heskestad says
(1983, Fire Saf. J. 5:103). Eddies are a swirl of its own for each parcel, that grows as the plume widens.
Limits: no gas dynamics between parcels; the plume does not entrain, it is only dragged.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.particles.random import uniform
from sim.validation import argument_error, check_positive

RISE = 23.3  # [m/s2] b
DRAG_TIME = 1.2  # [s] tau
EDDY = 0.22  # swirl speed over rise


def flame_height(power: float, diameter: float) -> float:
    """L [m] = 0.235 Q^(2/5) - 1.02 D, Q in kW; power [W], diameter [m] of the fire; at least its radius.

    Raises ValueError where either is not above 0.
    """
    check_positive("power", power, "W")
    check_positive("diameter", diameter, "m")
    return max(0.235 * (power / 1e3) ** 0.4 - 1.02 * diameter, 0.5 * diameter)


class Fire:
    """Parcels of one fire. `position`, `velocity` (3, n) float32; `age`, `life` (n,) [s]; `heat` (n,) 1 to 0."""

    def __init__(
        self,
        position: tuple[float, float, float],
        power: float = 100e6,
        diameter: float = 4.0,
        count: int = 4000,
        life: float = 9.0,
        wind: tuple[float, float] = (0.0, 0.0),
        eddies: float = 1.0,
        updraft: float = 0.0,
    ) -> None:
        """position [m] of the fire's middle; power [W]; life [s] of a parcel; wind (x, y) [m/s]; eddies: 0 for none;
        updraft [m/s]: of the air about the plume, which smoke rises with when it is cold.

        Parcels start spread over their lives, as if the fire had burnt for long. Raises ValueError for what is not
        allowed.
        """
        for name, value in (("power", power), ("diameter", diameter), ("life", life)):
            if not (math.isfinite(value) and value > 0.0):
                raise argument_error(name, value, "a finite number above 0")
        for name, values, length in (("position", position, 3), ("wind", wind, 2)):
            if len(values) != length or not all(math.isfinite(v) for v in values):
                raise argument_error(name, values, f"{length} finite numbers")
        if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
            raise argument_error("count", count, "a whole number from 1")
        if not (math.isfinite(eddies) and eddies >= 0.0):
            raise argument_error("eddies", eddies, "0 or above, finite")
        if not math.isfinite(updraft):
            raise argument_error("updraft", updraft, "a finite number")
        self.place, self.diameter, self.wind, self.eddies = position, diameter, wind, eddies
        self.updraft = float(updraft)
        self.height = flame_height(power, diameter)
        self.cooling = math.sqrt(2.0 * self.height / RISE)  # [s] c
        self.position = np.zeros((3, count), np.float32)
        self.velocity = np.zeros((3, count), np.float32)
        self.life = np.zeros(count, np.float32)
        self.age = np.zeros(count, np.float32)
        self.heat = np.zeros(count, np.float32)
        self.turn = np.zeros(count, np.uint32)  # how often each parcel has started
        # Before the first start a parcel waits its share of a life: `age` counts up from it.
        self.age[:] = -(np.arange(count) + 0.5) / count * life
        self.mean_life = float(life)
        self.life[:] = 0.0
        self.started = 0

    def step(self, dt: float) -> None:
        """Let dt [s] pass. Raises ValueError for a negative or infinite one."""
        if not 0.0 <= dt < math.inf:
            raise argument_error("dt", dt, "0 or above, finite s")
        x, y, z = self.place
        self.started += burn(
            self.position, self.velocity, self.age, self.life, self.heat, self.turn, np.float32(dt), np.float32(x),
            np.float32(y), np.float32(z), np.float32(0.5 * self.diameter), np.float32(self.wind[0]),
            np.float32(self.wind[1]), np.float32(self.cooling), np.float32(self.mean_life),
            np.float32(EDDY * self.eddies), np.float32(self.updraft),
        )  # fmt: skip

    @property
    def burning(self) -> np.ndarray:
        """Which parcels have started, (n,) bool."""
        return self.age >= 0.0


@kernel(noalias=True)
def burn(
    position, velocity, age, life, heat, turn, dt, x, y, z, radius, wind_x, wind_y, cooling, mean_life, eddy, updraft
):
    """One step of all parcels; returns how many started again."""
    tau, rise = np.float32(DRAG_TIME), np.float32(RISE)
    one, zero, tiny = np.float32(1.0), np.float32(0.0), np.float32(1e-6)
    keep = np.exp(-dt / tau)
    fade = np.exp(-dt / cooling)
    # v(dt) = wind + (v - wind) e^(-dt/tau) + b theta (e^(-dt/c) - e^(-dt/tau))/(1/tau - 1/c)
    rate = one / tau - one / cooling
    if abs(rate) < tiny:
        gain = rise * dt * keep
        way = rise * tau * (tau - (tau + dt) * keep)
    else:
        gain = rise * (fade - keep) / rate
        way = rise * (cooling * (one - fade) - tau * (one - keep)) / rate
    coast = tau * (one - keep)
    started = 0
    for i in range(age.size):
        age[i] += dt
        if age[i] < zero:
            continue
        if turn[i] == 0 or age[i] >= life[i]:
            turn[i] += np.uint32(1)
            r = radius * np.sqrt(uniform(i, turn[i], 1))
            angle = np.float32(2.0 * math.pi) * uniform(i, turn[i], 2)
            position[0, i], position[1, i] = x + r * np.cos(angle), y + r * np.sin(angle)
            position[2, i] = z
            velocity[0, i], velocity[1, i], velocity[2, i] = zero, zero, zero
            age[i] = zero
            life[i] = mean_life * (np.float32(0.6) + np.float32(0.8) * uniform(i, turn[i], 3))
            heat[i] = one
            started += 1
            continue
        theta = heat[i]
        vx, vy, vz = velocity[0, i] - wind_x, velocity[1, i] - wind_y, velocity[2, i] - updraft
        position[0, i] += wind_x * dt + vx * coast
        position[1, i] += wind_y * dt + vy * coast
        position[2, i] += updraft * dt + vz * coast + theta * way
        velocity[0, i] = wind_x + vx * keep
        velocity[1, i] = wind_y + vy * keep
        velocity[2, i] = updraft + vz * keep + theta * gain
        heat[i] = theta * fade
        if eddy > zero:
            # Swirl: a circle at a pace and a phase of its own, as fast as a share of the rise.
            pace = np.float32(1.0) + np.float32(2.5) * uniform(i, turn[i], 4)
            phase = np.float32(2.0 * math.pi) * uniform(i, turn[i], 5) + pace * age[i]
            speed = eddy * (velocity[2, i] + np.float32(1.5)) * np.float32(2.0) * uniform(i, turn[i], 6)
            position[0, i] += speed * np.cos(phase) * dt
            position[1, i] += speed * np.sin(phase) * dt
    return started
