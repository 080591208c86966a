"""Ropes as open polygons: the determinant of their knot, and how near their links come to each other."""

import numpy as np
from numpy.typing import NDArray

FAR = 1e3
STRAIGHT = 1e-9  # sine of the angle between two links, below which they are parallel


def crossings_of(points: NDArray[np.float64]) -> list[tuple[float, float]]:
    """[(place on the upper strand, on the lower one)] of a closed polygon seen along z; a place is link + part."""
    ways = np.roll(points, -1, axis=0) - points
    i, j = np.triu_indices(len(points), 2)
    i, j = i[j - i < len(points) - 1], j[j - i < len(points) - 1]
    d, r, s = points[j] - points[i], ways[i], ways[j]
    across = r[:, 0] * s[:, 1] - r[:, 1] * s[:, 0]
    # Links of a straight part have no crossing: round-off would tell where.
    turned = np.abs(across) > STRAIGHT * np.linalg.norm(r, axis=1) * np.linalg.norm(s, axis=1)
    i, j, d, r, s, across = (each[turned] for each in (i, j, d, r, s, across))
    t, u = (d[:, 0] * s[:, 1] - d[:, 1] * s[:, 0]) / across, (d[:, 0] * r[:, 1] - d[:, 1] * r[:, 0]) / across
    above = t * r[:, 2] > d[:, 2] + u * s[:, 2]
    cross = (t >= 0.0) & (t < 1.0) & (u >= 0.0) & (u < 1.0)
    both = np.column_stack([i + t, j + u])
    both[~above] = both[~above, ::-1]
    return [tuple(pair) for pair in both[cross].tolist()]


def whole_determinant(matrix: NDArray[np.object_]) -> int:
    """Determinant of a matrix of whole numbers, without rounding (Bareiss 1968)."""
    rows, sign, before = [list(map(int, row)) for row in matrix], 1, 1
    for k in range(len(rows) - 1):
        swap = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if swap is None:
            return 0
        if swap != k:
            rows[k], rows[swap], sign = rows[swap], rows[k], -sign
        for i in range(k + 1, len(rows)):
            for j in range(k + 1, len(rows)):
                rows[i][j] = (rows[i][j] * rows[k][k] - rows[i][k] * rows[k][j]) // before
        before = rows[k][k]
    return sign * rows[-1][-1] if rows else 1


def determinant(points: NDArray[np.float64]) -> int:
    """Determinant of the knot of an open polygon (n, 3) whose ends are joined far away: 1 without a knot.

    Each crossing is a row with 2 for the arc above and -1 for both arcs below; arcs change where the curve is below.
    The first point's end and the last one's lead on straight, as their links do, and are joined far from the rest.
    """
    ends = [points[end] + FAR * (points[end] - points[beside]) for end, beside in ((-1, -2), (0, 1))]
    beyond = ends[0] + ends[1]
    apart = ends[0] - ends[1]
    if np.linalg.norm(beyond) < np.linalg.norm(apart):  # else the joint would lead back through the knot
        aside = np.eye(3)[np.abs(apart).argmin()]
        beyond = 0.5 * np.cross(apart, aside)
    closed = np.vstack([points, ends[0], beyond, ends[1]])
    turn = np.linalg.qr(np.random.default_rng(11).standard_normal((3, 3)))[0]  # a view in which nothing is in line
    crossings = crossings_of(closed @ turn)
    if len(crossings) < 3:
        return 1
    breaks = sorted(lower for _, lower in crossings)
    rows = np.zeros((len(crossings), len(crossings)), dtype=object)
    for row, (upper, lower) in zip(rows, crossings, strict=True):
        row[np.searchsorted(breaks, upper) % len(breaks)] += 2
        arc = breaks.index(lower)
        row[arc] -= 1
        row[(arc + 1) % len(breaks)] -= 1
    return abs(whole_determinant(rows[1:, 1:]))


def least_distance(points: NDArray[np.float64], apart: int) -> float:
    """Least distance [m] between links of a polygon (n, 3) whose numbers are at least `apart` apart.

    Ericson 2005, Real-Time Collision Detection, 5.1.9: the place on the first link is clamped, then that on the second.
    """
    ways = np.diff(points, axis=0)
    i, j = np.triu_indices(len(ways), apart)
    d, e, r = ways[i], ways[j], points[i] - points[j]
    dd, ee, de, dr, er = ((a * b).sum(axis=1) for a, b in ((d, d), (e, e), (d, e), (d, r), (e, r)))
    across = dd * ee - de * de
    s = np.clip((de * er - dr * ee) / np.where(across > 0.0, across, np.inf), 0.0, 1.0)
    t = np.clip((de * s + er) / ee, 0.0, 1.0)
    s = np.clip((de * t - dr) / dd, 0.0, 1.0)
    return float(np.linalg.norm(r + s[:, None] * d - t[:, None] * e, axis=1).min())
