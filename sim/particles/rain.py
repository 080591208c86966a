"""Rain: drop sizes of Marshall and Palmer, fall speeds of Atlas, drops that drift with the wind and hit a moving sea.

A tile of 64 m at 25 mm/h receives 2e7 drops a second: a sample is drawn, and `weight` says how many each stands for.
Sources: Marshall and Palmer (1948, J. Meteor. 5:165); Atlas, Srivastava, Sekhon (1973, Rev. Geophys. 11:1), checked
against Gunn and Kinzer (1949, J. Meteor. 6:243). Diameters are in metres here; the papers' millimetres in the formulas.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.jit import kernel
from sim.validation import argument_error, as_array, check_number, check_positive, check_vector, is_whole_number
from sim.water import EARTH_GRAVITY, FRESH_DENSITY

SMALLEST, LARGEST = 0.5e-3, 6.0e-3  # [m] drops outside are not counted: mist below, broken up above
FASTEST = 9.17  # [m/s] where Gunn and Kinzer's table ends: large drops flatten and gain no more


def slope_parameter(rate: float) -> float:
    """Lambda [1/m] = 4.1 R^-0.21 per mm, R the rate [mm/h]."""
    return 4.1e3 * rate**-0.21


def terminal_speed(diameter: ArrayLike, gravity: float = EARTH_GRAVITY) -> Any:
    """Fall speed [m/s] of drops of diameter [m], array or number: v = 9.65 - 10.3 exp(-0.6 D/mm), ~ sqrt(gravity).

    Raises ValueError for a negative or non-finite diameter, or gravity not above 0.

    >>> round(float(terminal_speed(2e-3)), 2)  # [m/s] of a drop of 2 mm
    6.55
    """
    check_positive("gravity", gravity, "m/s2")
    allowed = "0 or above, finite m"
    D = as_array("diameter", diameter, allowed)
    bad = ~((D >= 0.0) & np.isfinite(D))
    if bad.any():
        raise argument_error("diameter", float(D[bad].flat[0]), allowed)
    atlas = 9.65 - 10.3 * np.exp(-600.0 * D)
    return (np.clip(atlas, 0.0, FASTEST) * math.sqrt(gravity / EARTH_GRAVITY))[()]


class Rainfall(NamedTuple):
    """Rain of a given rate: integrals over all drops between SMALLEST and LARGEST."""

    concentration: float  # [1/m3] drops in the air
    flux: float  # [1/(m2 s)] drops that arrive
    water: float  # [kg/m3] in the air
    rate: float  # [mm/h] carried by the drops: the rate given
    energy: float  # [W/m2] kinetic energy that arrives
    extinction: float  # [1/m] of light: large drops take away twice what they cover (van de Hulst 1957, 8.22)


def rainfall(rate: float, gravity: float = EARTH_GRAVITY) -> Rainfall:
    """Rain of Marshall and Palmer's drops at `rate` [mm/h]. Raises ValueError unless rate and gravity are above 0."""
    check_positive("rate", rate, "mm/h")
    D, N, step = drop_sizes(rate, gravity)
    v = terminal_speed(D, gravity)
    mass = FRESH_DENSITY * math.pi / 6.0 * D**3
    return Rainfall(
        float((N * step).sum()),
        float((N * v * step).sum()),
        float((N * mass * step).sum()),
        float((N * mass * v * step).sum() * 3600.0),
        float((0.5 * N * mass * v**3 * step).sum()),
        float((2.0 * N * math.pi / 4.0 * D**2 * step).sum()),
    )


class Hits(NamedTuple):
    """Drops that met the surface in one step, m of them."""

    position: np.ndarray  # (m, 3) [m] on the drawn surface
    label: np.ndarray  # (m, 2) [m] of the surface point that was hit: where a ring begins
    diameter: np.ndarray  # (m,) [m]
    speed: np.ndarray  # (m,) [m/s] downward


class Rain:
    """A sample of the drops above one periodic tile. Arrays: `position` (3, n) [m], `diameter`, `speed` (n,)."""

    def __init__(
        self,
        rate: float,
        length: float,
        ceiling: float,
        count: int = 2000,
        wind: tuple[float, float] = (0.0, 0.0),
        gravity: float = EARTH_GRAVITY,
        seed: int = 0,
    ) -> None:
        """rate [mm/h]; length [m] of the tile; ceiling [m]: height drops start from; count: most drops to draw;
        wind (x, y) [m/s]: the speed drops drift with. Raises ValueError for a value that is not allowed.
        """
        self.rate, self.length = check_positive("rate", rate, "mm/h"), check_positive("length", length, "m")
        self.ceiling, self.gravity = check_positive("ceiling", ceiling, "m"), check_positive("gravity", gravity, "m/s2")
        if not is_whole_number(count) or count < 1:
            raise argument_error("count", count, "a whole number of at least 1")
        if not is_whole_number(seed):
            raise argument_error("seed", seed, "a whole number")
        self.wind = check_vector("wind", wind, "m/s", 2)
        self.rainfall = rainfall(rate, gravity)
        in_the_air = self.rainfall.concentration * length**2 * ceiling
        drawn = max(min(int(count), round(in_the_air)), 1)
        self.weight = in_the_air / drawn  # fallen drops that each drawn one stands for
        self.hits = 0  # drawn drops that have hit
        self._random = np.random.default_rng(seed)
        D, N, _ = drop_sizes(rate, gravity)
        self._sizes = D
        self._by_volume = _cumulative(N)
        self._by_flux = _cumulative(N * terminal_speed(D, gravity))
        # In the air sizes are as N(D); those that arrive, and so those that start again, as N(D) v(D).
        self.position = self._random.uniform(0.0, [[length], [length], [ceiling]], (3, drawn))
        self.diameter = self._draw(self._by_volume, drawn)
        self.speed = terminal_speed(self.diameter, gravity)
        self._gap = np.full(drawn, np.nan)  # [m] height above the surface at the end of the last step
        self._rows = np.empty((drawn, 6))

    @property
    def fallen(self) -> float:
        """Drops that have fallen on the tile so far: `hits` times `weight`."""
        return self.hits * self.weight

    def step(self, dt: float, height: np.ndarray, displacement: np.ndarray | None = None) -> Hits:
        """Let the drops fall for dt [s] onto the surface as it is at the end of the step.

        height (m, m) [m]; displacement (m, m, 2) [m] or None: of the mesh as drawn. Drops that hit start again on top.
        Raises ValueError for a dt that is negative or not finite.
        """
        dt = check_number("dt", dt, "s", 0.0)
        if displacement is None:
            displacement = np.zeros((1, 1, 2), height.dtype)
        moved = fall(
            self.position, self.speed, self._gap, self.wind, float(dt), self.length, self.ceiling,
            float(height.max()), height, displacement[..., 0], displacement[..., 1], self._rows,
        )  # fmt: skip
        rows = self._rows[:moved].copy()
        which = rows[:, 0].astype(np.int64)
        hits = Hits(rows[:, 1:4], rows[:, 4:6], self.diameter[which], self.speed[which])
        self.hits += moved
        self.diameter[which] = self._draw(self._by_flux, moved)
        self.speed[which] = terminal_speed(self.diameter[which], self.gravity)
        self.position[:2, which] = self._random.uniform(0.0, self.length, (2, moved))
        # Not all at the ceiling at once: each as far below it as it fell since its start within the step.
        self.position[2, which] = self.ceiling - self._random.uniform(0.0, 1.0, moved) * self.speed[which] * dt
        self._gap[which] = np.nan
        return hits

    def _draw(self, cumulative: np.ndarray, count: int) -> np.ndarray:
        return np.interp(self._random.uniform(size=count), cumulative, self._sizes)


def drop_sizes(rate: float, gravity: float = EARTH_GRAVITY) -> tuple[np.ndarray, np.ndarray, float]:
    """Diameters [m], N(D) = N0 exp(-Lambda D) [1/m4] there, and their spacing [m] (midpoints).

    N0 is such that the drops carry `rate` [mm/h]. Marshall and Palmer's 8e6 /m4 is for drops of all sizes at speeds of
    their time: with these speeds and sizes it would carry 1.11, 28.0 and 102 mm/h for 1, 25 and 100.
    """
    edges = np.linspace(SMALLEST, LARGEST, 2001)
    D = 0.5 * (edges[1:] + edges[:-1])
    step = float(edges[1] - edges[0])
    shape = np.exp(-slope_parameter(rate) * D)
    volume = float((math.pi / 6.0 * D**3 * shape * terminal_speed(D, gravity)).sum()) * step  # [m5/s] over N0
    return D, rate / 3.6e6 / volume * shape, step


def _cumulative(density: np.ndarray) -> np.ndarray:
    total = np.cumsum(density) - 0.5 * density
    return total / (total[-1] + 0.5 * density[-1])


@kernel
def bilinear(field, u, v):
    """A periodic field at u, v in cells."""
    n = field.shape[0]
    i, j = int(np.floor(u)), int(np.floor(v))
    fu, fv = u - i, v - j
    i, j = i % n, j % n
    k, m = (i + 1) % n, (j + 1) % n
    return (1.0 - fu) * ((1.0 - fv) * field[i, j] + fv * field[i, m]) + fu * (
        (1.0 - fv) * field[k, j] + fv * field[k, m]
    )


@kernel
def fall(x, speed, gap, wind, dt, length, ceiling, crest, h, dx, dy, rows):
    """Move all drops by dt; write (index, x, y, z, label x, label y) of each that met the surface; return how many.

    crest: highest point of h; a drop that cannot reach it within the next step is not compared with the surface.
    gap: height above the surface at the last end of a step, nan for a new drop.
    """
    cells, coarse = h.shape[0] / length, dx.shape[0] / length
    count = 0
    for d in range(x.shape[1]):
        for axis in range(2):
            x[axis, d] += wind[axis] * dt
            if not 0.0 <= x[axis, d] < length:
                x[axis, d] %= length
        x[2, d] -= speed[d] * dt
        if x[2, d] > crest + 2.0 * speed[d] * dt:
            gap[d] = x[2, d] - crest
            continue
        # The label under the drop, one fixed-point step: l = X - D(X).
        a = x[0, d] - bilinear(dx, x[0, d] * coarse, x[1, d] * coarse)
        b = x[1, d] - bilinear(dy, x[0, d] * coarse, x[1, d] * coarse)
        below = x[2, d] - bilinear(h, a * cells, b * cells)
        if below > 0.0 or np.isnan(below):
            gap[d] = below
            continue
        if np.isnan(gap[d]):  # begun under a wave: it has not fallen on it
            x[2, d] += ceiling
            continue
        # Relative height falls evenly from gap to below: it was 0 the share `back` of the step ago.
        back = -below / (gap[d] - below)
        rows[count, 0] = d
        rows[count, 1] = x[0, d] - back * wind[0] * dt
        rows[count, 2] = x[1, d] - back * wind[1] * dt
        rows[count, 3] = x[2, d] - below
        rows[count, 4], rows[count, 5] = a, b
        count += 1
    return count
