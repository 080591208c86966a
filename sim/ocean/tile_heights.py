"""The heights h(k, t) of a tile with its rings, as the transforms take them: for the last time that was asked for."""

from typing import Any

import numpy as np

from sim.ocean.evolve import set_heights, weighted_energy
from sim.ocean.ripples import Ripples
from sim.ocean.transforms import Transforms
from sim.ocean.wave_sizes import WaveSizes


class TileHeights:
    """Evolves the waves of one tile. Not for two threads at once."""

    def __init__(self, transforms: Transforms, radial: dict[str, np.ndarray], real: Any) -> None:
        """radial: "1" and "k" of the quarter plane, in the type `real`."""
        self.transforms, self.radial, self.real = transforms, radial, real
        size = 2 * len(radial["1"])
        self.scratch = np.empty(size, real), np.empty(size, real)
        self.heights: np.ndarray | None = None  # made on first use
        self.evolved: tuple | None = None  # key of time and state
        self.mean: tuple[tuple | None, float] = None, 0.0  # the same, and the mean [m]

    def spectrum(self, t: float, version: object, waves: WaveSizes, ripples: Ripples | None) -> np.ndarray:
        """h(k, t) with rings on the half plane ky >= 0, as its real view (N, N + 2).

        version: differs where the waves have changed.
        """
        if self.heights is None:
            size = len(self.scratch[0])
            self.heights = np.zeros((size, size + 2), self.real)
        if self.evolved != key_of(t, version, ripples):
            even, odd = waves.planes_at(t)
            fade = self.radial["1"]
            if waves.decays:
                fade = np.exp(waves.fall * self.real(t - waves.base))
            copy = self.transforms.spectrum.view(self.real)
            set_heights(even, odd, waves.rate, fade, t - waves.base, *self.scratch, self.heights, copy)
            if ripples is not None:
                ripples.add_to(self.heights, t)
            self.evolved = key_of(t, version, ripples)
        return self.heights

    def mean_height(self, t: float, version: object, waves: WaveSizes, ripples: Ripples | None) -> float:
        """Mean height [m] of the displaced points, over the choppiness: see `Surface.mean_height`."""
        key = key_of(t, version, ripples)
        if self.mean[0] != key:
            self.mean = key, float(weighted_energy(self.spectrum(t, version, waves, ripples), self.radial["k"]))
        return self.mean[1]

    def set_input(
        self, t: float, version: object, waves: WaveSizes, ripples: Ripples | None, choppiness: float
    ) -> None:
        """The transform's input: `spectrum` and the mean height. Without rings evolving has left a copy there."""
        before = self.evolved
        heights, there = self.spectrum(t, version, waves, ripples), self.transforms.spectrum.view(self.real)
        if self.evolved is before or ripples is not None:
            there[...] = heights
        mean = choppiness * self.mean_height(t, version, waves, ripples) if choppiness else 0.0
        there[0, 0] = heights[0, 0] + mean  # that of rings is the water they brought


def key_of(t: float, version: object, ripples: Ripples | None) -> tuple:
    """A key of time, waves and rings."""
    return t, version, -1 if ripples is None else ripples.version
