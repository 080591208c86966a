"""The heights h(k, t) of a tile with its rings, as the transforms take them, for the last requested time."""

import copy
from typing import Any

import numpy as np

from sim.ocean.tile.evolve import set_heights, weighted_energy
from sim.ocean.tile.ripples import Ripples
from sim.ocean.tile.surface import Surface
from sim.ocean.tile.tile_waves import TileWaves
from sim.ocean.tile.transforms import Transforms


class TileHeights:
    """Evolves the waves of one tile, and keeps the last surface. Not for two threads at once."""

    def __init__(self, waves: TileWaves, transforms: Transforms) -> None:
        self.waves, self.transforms = waves, transforms
        self.ripples: Ripples | None = None
        self.time = 0.0  # [s] of the last surface, or of the last change if that is later
        self.latest: tuple[tuple | None, dict[str, np.ndarray]] = None, {}  # key of the last surface, and its fields
        numbers = waves.numbers
        self.scratch = np.empty(numbers.size, numbers.real), np.empty(numbers.size, numbers.real)
        self.heights: np.ndarray | None = None  # made on first use
        self.evolved: tuple | None = None  # key of time and state
        self.later: tuple[tuple | None, np.ndarray | None] = None, None  # the same of `quadrature`, and its array
        self.mean: tuple[tuple | None, float] = None, 0.0  # the same, and the mean [m]

    def copied(self, waves: TileWaves, memo: dict[int, Any]) -> "TileHeights":
        """An independent copy with a copy of the waves, for the same thread: it shares the transforms."""
        other = TileHeights(waves, self.transforms)
        other.ripples, other.time = copy.deepcopy(self.ripples, memo), self.time
        return other

    def __getstate__(self) -> dict[str, Any]:
        """Pickle no results: saved fields would lie otherwise in memory, and their sums differ by the last digit."""
        results = {"latest": (None, {}), "heights": None, "evolved": None, "later": (None, None), "mean": (None, 0.0)}
        return self.__dict__ | results

    def key(self, t: float) -> tuple:
        """A key of time, waves and rings."""
        return t, self.waves.version, -1 if self.ripples is None else self.ripples.version

    def surface(self, t: float, choppiness: float) -> Surface:
        """The surface at time t [s]; it has the fields of the last one if that was the same."""
        key = choppiness, self.key(t)
        if self.latest[0] != key:
            self.latest = key, {}
        self.time = t
        return Surface(self, t, choppiness, self.latest[1])

    def spectrum(self, t: float) -> np.ndarray:
        """h(k, t) with rings on the half plane ky >= 0, as its real view (N, N + 2)."""
        waves, numbers = self.waves, self.waves.numbers
        if self.heights is None:
            self.heights = np.zeros((numbers.size, numbers.size + 2), numbers.real)
        if self.evolved != self.key(t):
            even, odd = waves.planes_at(t)
            copied = self.transforms.spectrum.view(numbers.real)
            set_heights(even, odd, waves.rate, self.fade(t), t - waves.base, *self.scratch, self.heights, copied)
            if self.ripples is not None:
                self.ripples.add_to(self.heights, t)
            self.evolved = self.key(t)
        return self.heights

    def fade(self, t: float) -> np.ndarray:
        """Fraction of each wave that its decay since the last change leaves at time t [s], a quarter plane."""
        waves, numbers = self.waves, self.waves.numbers
        return np.exp(waves.fall * numbers.real(t - waves.base)) if waves.decays else numbers.radial["1"]

    def quadrature(self, t: float) -> np.ndarray:
        """q(k, t) with rings, as `spectrum`: each wave a quarter of its period later, as high as at time t [s].

        The surface rises at omega q, apart from decay and growth.
        """
        waves, numbers = self.waves, self.waves.numbers
        key, out = self.later
        if out is None:
            out = np.zeros((numbers.size, numbers.size + 2), numbers.real)
        if key != self.key(t):
            even, odd = waves.planes_at(t)
            copied = self.transforms.spectrum.view(numbers.real)
            # odd cos(omega t) - even sin(omega t)
            set_heights(odd, even, waves.rate, self.fade(t), waves.base - t, *self.scratch, out, copied)
            if self.ripples is not None:
                self.ripples.add_quadrature(out, t)
            self.later = self.key(t), out
        return out

    def mean_height(self, t: float, choppiness: float) -> float:
        """Mean height [m] of the displaced points: see `Surface.mean_height`."""
        if choppiness == 0.0:
            return 0.0
        key = self.key(t)
        if self.mean[0] != key:
            self.mean = key, float(weighted_energy(self.spectrum(t), self.waves.numbers.radial["k"]))
        return choppiness * self.mean[1]

    def set_input(self, t: float, choppiness: float) -> None:
        """The transform's input: `spectrum` and the mean height. Without rings evolving has left a copy there."""
        before = self.evolved
        heights, there = self.spectrum(t), self.transforms.spectrum.view(self.waves.numbers.real)
        if self.evolved is before or self.ripples is not None:
            there[...] = heights
        there[0, 0] = heights[0, 0] + self.mean_height(t, choppiness)  # that of rings is the water they brought
