"""Fire and its smoke: parcels of hot gas that go the way of a plume (`sim/particles/plume.py`), each beside its middle.

A parcel's place is a function of its age, so that any step will do. It keeps its own share of the plume's radius and
turns about the middle; puffs, of the frequency 1.5/sqrt(D) of pool fires (Cetegen and Ahmed 1993, Combust. Flame
93:157) and slower ones, move parcels that started together to the same side.
Limits: no gas dynamics between parcels.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.particles.plume import DRAG_TIME, flame_height, track
from sim.particles.random import uniform
from sim.validation import argument_error, check_number, check_positive, check_vector, is_whole_number

LEAST_LIFE, LIFE_RANGE = 0.12, 2.64  # of the mean life: most parcels are flame, few are old smoke
LONGEST_LIFE = LEAST_LIFE + LIFE_RANGE  # of the mean life
MEANDER = 0.5  # of the plume's widening, by which puffs move parcels


class Parcels(NamedTuple):
    """The arrays of a fire that a step changes: see `Fire`."""

    position: NDArray[np.float32]
    age: NDArray[np.float32]
    life: NDArray[np.float32]
    heat: NDArray[np.float32]
    spread: NDArray[np.float32]
    turn: NDArray[np.uint32]


class Flame(NamedTuple):
    """The numbers of a fire, in single precision where the parcels are."""

    x: np.float32  # [m] of its middle
    y: np.float32
    z: np.float32
    radius: np.float32  # [m]
    wind_x: np.float32  # [m/s]
    wind_y: np.float32
    mean_life: np.float32  # [s]
    eddies: np.float32
    puffs: float  # [1/s]


class Fire:
    """Parcels of one fire. `position` (3, n), `age`, `life` [s], `heat` 1 to 0, `spread` [m] (n,), all float32."""

    def __init__(
        self,
        position: tuple[float, float, float],
        power: float = 100e6,
        diameter: float = 4.0,
        count: int = 4000,
        life: float = 9.0,
        wind: tuple[float, float] = (0.0, 0.0),
        eddies: float = 1.0,
    ) -> None:
        """position [m] of the fire's middle; power [W]; life [s] of a parcel on average; wind (x, y) [m/s]; eddies:
        how much parcels turn and meander, 0 for not at all.

        Parcels start spread over their lives, as if the fire had burnt for long. Raises ValueError for a value that is
        not allowed.
        """
        power, diameter = check_positive("power", power, "W"), check_positive("diameter", diameter, "m")
        life = check_positive("life", life, "s")
        if not is_whole_number(count) or count < 1:
            raise argument_error("count", count, "a whole number of at least 1")
        self.place, self.wind = check_vector("position", position, "m"), check_vector("wind", wind, "m/s", 2)
        self.diameter, self.eddies = diameter, check_number("eddies", eddies, "", 0.0)
        self.height = flame_height(power, diameter)
        self.longest_life = LONGEST_LIFE * life  # [s]
        self.track = track(power, diameter, math.hypot(*self.wind), self.longest_life)
        self.puffs = 1.5 / math.sqrt(diameter)  # [1/s]
        self.time = 0.0  # [s]
        self.position = np.zeros((3, count), np.float32)
        self.life = np.zeros(count, np.float32)
        self.heat = np.zeros(count, np.float32)
        self.spread = np.zeros(count, np.float32)  # radius of the plume where a parcel is
        self.turn = np.zeros(count, np.uint32)  # number of starts of each parcel
        # Before the first start a parcel waits its share of a life: `age` counts up from it.
        self.age = (-(np.arange(count) + 0.5) / count * life).astype(np.float32)
        self.mean_life = life
        self.started = 0

    def step(self, dt: float) -> None:
        """Let dt [s] pass. Raises ValueError for a negative or infinite one."""
        dt = check_number("dt", dt, "s", 0.0)
        self.time += dt
        numbers = (*self.place, 0.5 * self.diameter, *self.wind, self.mean_life, self.eddies)
        flame = Flame(*map(np.float32, numbers), puffs=self.puffs)
        parcels = Parcels(self.position, self.age, self.life, self.heat, self.spread, self.turn)
        self.started += burn(parcels, self.track, flame, np.float32(dt), self.time)

    @property
    def burning(self) -> np.ndarray:
        """Parcels that have started, (n,) bool."""
        return self.age >= 0.0


def share_left(along: NDArray[np.float32]) -> NDArray[np.float32]:
    """Fraction of the parcels that live longer than this fraction of the longest life, (n,)."""
    late = np.clip((LONGEST_LIFE * along - LEAST_LIFE) / LIFE_RANGE, 0.0, 1.0)
    return (1.0 - np.sqrt(late)).astype(np.float32)


@kernel(noalias=True)
def burn(parcels, track, flame, dt, now):
    """One step of all parcels, along the plume's track, to the time `now`; returns how many started again."""
    position, age, life, heat, spread, turn = parcels
    x, y, z, radius, wind_x, wind_y, mean_life, eddies, puffs = flame
    step, heights, radii, heats = np.float32(track.step), track.height, track.radius, track.heat
    tau, one, half = np.float32(DRAG_TIME), np.float32(1.0), np.float32(0.5)
    circle, last = np.float32(2.0 * math.pi), heights.size - 2
    started = 0
    for i in range(age.size):
        age[i] += dt
        if age[i] < np.float32(0.0):
            continue
        if turn[i] == 0 or age[i] >= life[i]:
            turn[i] += np.uint32(1)
            age[i] = np.float32(0.0)
            share = uniform(i, turn[i], 3)
            life[i] = mean_life * (np.float32(LEAST_LIFE) + np.float32(LIFE_RANGE) * share * share)
            started += 1
        place = age[i] / step
        k = min(int(place), last)
        part = place - np.float32(k)
        height = heights[k] + part * (heights[k + 1] - heights[k])
        width = radii[k] + part * (radii[k + 1] - radii[k])
        heat[i] = heats[k] + part * (heats[k + 1] - heats[k])
        spread[i] = width
        # Along the wind by its closed form of drag: t - tau (1 - e^(-t/tau)).
        drift = age[i] - tau * (one - np.exp(-age[i] / tau))
        angle = circle * uniform(i, turn[i], 2)
        angle += eddies * (uniform(i, turn[i], 4) - half) * np.float32(4.0) * np.log(one + age[i])
        r = np.sqrt(uniform(i, turn[i], 1)) * width
        begun = now - age[i]
        sway = eddies * np.float32(MEANDER) * (width - radius)
        beat = 2.0 * math.pi * puffs * begun
        sway_x = sway * np.float32(0.5 * math.sin(beat) + 0.5 * math.sin(0.231 * beat + 1.0))
        sway_y = sway * np.float32(0.5 * math.sin(0.83 * beat + 2.0) + 0.5 * math.sin(0.147 * beat))
        position[0, i] = x + wind_x * drift + r * np.cos(angle) + sway_x
        position[1, i] = y + wind_y * drift + r * np.sin(angle) + sway_y
        position[2, i] = z + height + (uniform(i, turn[i], 5) - half) * (width - radius)
    return started
