"""One moment of a sea: fields on the grid, each computed when first read, by the transforms it needs."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from sim.interruption import raise_if_stopped
from sim.ocean.tile.evolve import set_imaginary_multiple, set_real_multiple
from sim.ocean.tile.tile_waves import TileWaves
from sim.ocean.tile.transforms import Transforms


class SurfaceSource(Protocol):
    """The part of `TileHeights` that a surface reads."""

    waves: TileWaves
    transforms: Transforms

    def spectrum(self, t: float) -> np.ndarray: ...
    def quadrature(self, t: float) -> np.ndarray: ...
    def set_input(self, t: float, choppiness: float) -> None: ...
    def mean_height(self, t: float, choppiness: float) -> float: ...


class Multiple(Protocol):
    """A kernel that writes a multiple of the height's spectrum."""

    def __call__(
        self, h: np.ndarray, row: np.ndarray, column: np.ndarray, radial: np.ndarray, out: np.ndarray
    ) -> None: ...


def field(make: Callable[[Any], np.ndarray]) -> property:
    """A property computed when first read and kept with the other fields of its moment."""

    def read(surface: Any) -> np.ndarray:
        if make.__name__ not in surface.fields:
            raise_if_stopped()
            surface.fields[make.__name__] = make(surface)
        return surface.fields[make.__name__]

    return property(read, doc=make.__doc__)


class Surface:
    """The sea at `t` [s]. Read a field before the sea is changed; one read later is that of the changed sea.

    Two-component fields are views of two planes: field[..., 0] is contiguous.
    """

    def __init__(self, heights: SurfaceSource, t: float, choppiness: float, fields: dict[str, np.ndarray]) -> None:
        """fields: those already computed; `heights` keeps the same dict, but no Surface: a cycle would hold memory."""
        self.heights, self.t, self.choppiness, self.fields = heights, t, choppiness, fields
        self.numbers, self.transforms = heights.waves.numbers, heights.transforms

    @field
    def height(self) -> np.ndarray:
        """Height (size, size) [m] of the displaced point labelled x, y, with `mean_height`. One transform."""
        self.heights.set_input(self.t, self.choppiness)
        grid = self.transforms.grids.take(1)[0]
        self.transforms.set_grid(grid)
        return grid

    @property
    def mean_height(self) -> float:
        """Mean [m] of `height` over the labels without rings, choppiness sum k |h(k)|^2: the mean level in place is 0.

        Displaced points gather at the crests, so that a place sees the mean of h J, J the Jacobian. That of the waves
        alone is lower by this sum, to third order in steepness; their spectrum has no mean. A particle's mean level is
        higher than that of the water by the same sum (Longuet-Higgins 1986, J. Fluid Mech. 173:683, for one deep wave
        k a^2/2). It is that of the displacement as drawn: of the waves that the tile has, at any choppiness and depth.
        """
        return self.heights.mean_height(self.t, self.choppiness)

    @field
    def displacement(self) -> np.ndarray:
        """Horizontal displacement (size, size, 2) [m] as drawn. Two transforms; none at choppiness 0.

        D(k) = i choppiness (k/|k|) h(k): Tessendorf (2001), eq. 44, with the sign that he leaves to the factor. Water
        of a deep wave a cos(kx - omega t) moves by -a sin(kx - omega t) along it (Lamb, Art. 229): to the crests.
        """
        out = self._two_planes()
        if self.choppiness > 0.0:
            rows = self.numbers.rows
            chop = rows["k"] * rows["k"].dtype.type(self.choppiness)
            self._set_gradient(chop, self.numbers.radial["1/k"], self.heights.spectrum(self.t), out)
        else:
            out[...] = 0.0
        return out

    @field
    def slope(self) -> np.ndarray:
        """Slope (size, size, 2) of the height along x and y, by label. Two transforms."""
        out = self._two_planes()
        self._set_gradient(self.numbers.rows["k"], self.numbers.radial["1"], self.heights.spectrum(self.t), out)
        return out

    @field
    def flow(self) -> np.ndarray:
        """Horizontal velocity (size, size, 2) [m/s] of the water by label, whatever the choppiness. Two transforms.

        u(k) = i (k/|k|) coth(kh) omega q(k), at z = 0 (Lamb, Art. 229), q the quadrature of the heights.
        """
        out = self._two_planes()
        self._set_gradient(self.numbers.rows["k"], self.heights.waves.flow, self.heights.quadrature(self.t), out)
        return out

    @field
    def rise(self) -> np.ndarray:
        """Upward velocity (size, size) [m/s] of the water by label: omega q(k). One transform."""
        return self._multiple(self.heights.waves.rise, self.heights.quadrature(self.t))

    @field
    def lift(self) -> np.ndarray:
        """Upward acceleration (size, size) [m/s2] of the water by label: -omega^2 h(k). One transform."""
        return self._multiple(self.heights.waves.lift, self.heights.spectrum(self.t))

    @field
    def strain(self) -> np.ndarray:
        """(Dxx, Dyy, Dxy), shape (3, size, size): how the displacement stretches the grid. Three transforms."""
        rows, out = self.numbers.rows, self.transforms.grids.take(3)
        out[...] = 0.0
        if self.choppiness > 0.0:
            chop, inverse = -rows["1"].dtype.type(self.choppiness), self.numbers.radial["1/k"]
            h = self.heights.spectrum(self.t)
            for i, (row, column) in enumerate((("k2", "1"), ("1", "k2"), ("k", "k"))):
                self._set_field(set_real_multiple, chop * rows[row], rows[column], inverse, h, out[i])
        return out

    @field
    def jacobian(self) -> np.ndarray:
        """J (size, size) = (1 + Dxx)(1 + Dyy) - Dxy^2 of the displacement: below 0 the surface folds."""
        Dxx, Dyy, Dxy = self.strain
        return (1.0 + Dxx) * (1.0 + Dyy) - Dxy * Dxy

    def _two_planes(self) -> np.ndarray:
        return np.moveaxis(self.transforms.grids.take(2), 0, -1)

    def _multiple(self, radial: np.ndarray, h: np.ndarray) -> np.ndarray:
        """The field (size, size) of a spectrum times a factor of |k|."""
        one, out = self.numbers.rows["1"], self.transforms.grids.take(1)[0]
        self._set_field(set_real_multiple, one, one, radial, h, out)
        return out

    def _set_gradient(self, row: np.ndarray, radial: np.ndarray, h: np.ndarray, out: np.ndarray) -> None:
        """Set out (size, size, 2) to the fields of i row(kx) and i row(ky) times radial(|k|) h(k)."""
        one = self.numbers.rows["1"]
        self._set_field(set_imaginary_multiple, row, one, radial, h, out[..., 0])
        self._set_field(set_imaginary_multiple, one, row, radial, h, out[..., 1])

    def _set_field(
        self, multiple: Multiple, row: np.ndarray, column: np.ndarray, radial: np.ndarray, h: np.ndarray,
        out: np.ndarray,
    ) -> None:  # fmt: skip
        multiple(h, row, column, radial, self.transforms.spectrum.view(row.dtype))
        self.transforms.set_grid(out)
