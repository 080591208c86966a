"""Strain of a net's links."""

import numpy as np
from numpy.typing import NDArray

from sim.springs.net import Net


def strain_range(net: Net, x: NDArray[np.float64]) -> tuple[float, float]:
    """Least and largest length / rest length - 1, and 0, of all links with a rest length at x (3, rows, cols) [m]."""
    rows, cols = net.shape
    least = largest = 0.0
    for f in net.families:
        first, last = max(0, -f.dj), max(0, cols - max(0, f.dj))
        near, far = x[:, : max(0, rows - f.di), first:last], x[:, f.di :, first + f.dj : last + f.dj]
        if f.rest > 0.0 and near.size:
            strain = np.linalg.norm(far - near, axis=0) / f.rest - 1.0
            least, largest = min(least, float(strain.min())), max(largest, float(strain.max()))
    return least, largest


def structural_strain(net: Net, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """(rows, cols) largest |length / rest length - 1| of the links to the nearest neighbours of each particle.

    net: a cloth. Its first two families are the links along a row and along a column. x: (3, rows, cols) [m].
    """
    strain = np.zeros(net.shape)
    along_row, along_column = net.families[:2]
    every, first, last = slice(None), slice(None, -1), slice(1, None)
    for axis, family, start, end in (
        (2, along_row, (every, first), (every, last)),
        (1, along_column, (first, every), (last, every)),
    ):
        r = np.diff(x, axis=axis)
        of_link = np.abs(np.sqrt(np.einsum("eij,eij->ij", r, r)) / family.rest - 1.0)
        strain[start] = np.maximum(strain[start], of_link)
        strain[end] = np.maximum(strain[end], of_link)
    return strain
