"""The links' laws for whole arrays: a constant EA, or a table of strain and tension."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sim.mooring.parts import LineType
from sim.springs.points.line_arrays import LineArrays

Array = NDArray[np.float64]


class Curves:
    """The tables of all line types, in one array for the kernels."""

    def __init__(self, types: Iterable[LineType]) -> None:
        self.first: dict[tuple[tuple[float, float], ...], int] = {}
        rows: list[tuple[float, float, float]] = []
        for curve in dict.fromkeys(kind.curve for kind in types):
            if curve:
                self.first[curve] = len(rows)
                strain, tension = np.array(curve).T
                energy = np.concatenate(([0.0], np.cumsum(0.5 * (tension[1:] + tension[:-1]) * np.diff(strain))))
                rows += zip(strain.tolist(), tension.tolist(), energy.tolist(), strict=True)
        self.table = np.array(rows, dtype=np.float64).reshape(-1, 3)

    def rows_of(self, kind: LineType) -> tuple[int, int]:
        """First row and number of rows of a type's table; 0, 0 of one with a constant stiffness."""
        return (self.first[kind.curve], len(kind.curve)) if kind.curve else (0, 0)


class Elastic:
    """Lengths and tensions of links that are taut; a shorter link pushes by the law of a small stretch."""

    def __init__(self, p: LineArrays) -> None:
        self.rest, self.stiffness = p.links[:, 0], p.links[:, 1]
        self.groups = []  # of the links with a table: places, strains, tensions
        for first, count in np.unique(p.links[p.links[:, 4] > 0.0, 3:], axis=0).astype(np.int64):
            at = np.flatnonzero((p.links[:, 3] == first) & (p.links[:, 4] == count))
            strain, tension, _ = p.curves[first : first + count].T
            self.groups.append((at, strain, tension))

    def tension(self, length: Array) -> tuple[Array, Array]:
        """Tensions (links,) [N] at lengths [m], and their derivatives [N/m]."""
        return self.on_pieces(length / self.rest - 1.0, self.stiffness * (length - self.rest), 0)

    def length(self, tension: Array) -> tuple[Array, Array]:
        """Lengths (links,) [m] at tensions [N], and the derivatives of the tensions [N/m] there."""
        length, slope = self.on_pieces(tension, self.rest + tension / self.stiffness, 1)
        return length, slope

    def on_pieces(self, value: Array, result: Array, column: int) -> tuple[Array, Array]:
        """`result` of links with a constant stiffness, with the table's numbers for `value` of all others.

        column: of the table, to which `value` belongs. The second array: derivatives [N/m] of the tensions.
        """
        slope = self.stiffness.copy()
        for at, *columns in self.groups:
            own, other = columns[column], columns[1 - column]
            i = np.clip(np.searchsorted(own, value[at], side="left") - 1, 0, len(own) - 2)
            rise = (other[i + 1] - other[i]) / (own[i + 1] - own[i])
            of_piece = other[i] + rise * (value[at] - own[i])
            result[at] = of_piece if column == 0 else self.rest[at] * (1.0 + of_piece)
            slope[at] = (rise if column == 0 else 1.0 / rise) / self.rest[at]
        return result, slope
