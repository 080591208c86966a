"""Knots: curves of three of them, their determinant, and a rope that holds one while it is pulled at random."""

import dataclasses
import math

import numpy as np

from sim.springs import Contact, Grab, State, advance, rope

# Closed curves of t from 0 to 2 pi, farthest from the z axis at t = 0, by the numbers of their turns: (radius, about z,
# height). Their determinants are 3, 5 and 5.
TURNS = {"trefoil": (3, 2, 3), "figure eight": (2, 3, 4), "cinquefoil": (5, 2, 5)}
DETERMINANTS = {"trefoil": 3, "figure eight": 5, "cinquefoil": 5}
FAR = 1e3
STRAIGHT = 1e-9  # sine of the angle between two links, below which they are parallel


def closed_curve(name, t):
    """Points (n, 3) of a knot about 6 wide."""
    waves, turns, heights = TURNS[name]
    out = 2.0 + np.cos(waves * t)
    return np.column_stack([out * np.cos(turns * t), out * np.sin(turns * t), np.sin(heights * t)])


def open_curve(name, scale, tail):
    """A fine polygon (n, 3) of the knot, cut where it is outermost; both ends lead straight outwards for `tail`."""
    knot = scale * closed_curve(name, np.linspace(0.12, 2.0 * math.pi - 0.12, 4000))
    aside = np.array([0.0, 0.3, 0.0])
    first, last = (knot[end] / np.linalg.norm(knot[end]) + sign * aside for end, sign in ((0, 1.0), (-1, -1.0)))
    return np.vstack([knot[0] + tail * first, knot, knot[-1] + tail * last])


def spaced(polygon, count):
    """`count` points at equal distances along a polygon (n, 3), and its length."""
    along = np.concatenate([[0.0], np.linalg.norm(np.diff(polygon, axis=0), axis=1).cumsum()])
    places = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(places, along, axis) for axis in polygon.T]), along[-1]


def crossings_of(points):
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


def whole_determinant(rows):
    """Determinant of a matrix of whole numbers, without rounding (Bareiss 1968)."""
    rows, sign, before = [list(map(int, row)) for row in rows], 1, 1
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


def determinant(points):
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


def knotted_rope(name, radius=0.02, links_per_metre=30, tail=2.5, **more):
    """A rope tied in a loose knot in the air; its straight ends are held but for 0.3 m."""
    polygon = open_curve(name, 0.1, tail)
    points = round(links_per_metre * spaced(polygon, 2)[1])
    x, length = spaced(polygon, points)
    link = length / (points - 1)
    net = rope(
        points, length, 0.2 * link, 100.0 / link, 0.05 / link, 0.2 * link, 9.81, contact=Contact(1000.0, 1.0),
        radius=radius, self_contact=True,
    )  # fmt: skip
    held = round((tail - 0.3) / link)
    pinned = frozenset((0, j) for j in (*range(held), *range(points - held, points)))
    return dataclasses.replace(net, x0=np.ascontiguousarray(x.T[:, None]), pinned=pinned, **more)


def pulled(net, seed, seconds, step, integrator="leapfrog", speed=10.0, force=30.0):
    """Yield the state after each tenth of a second in which a hand pulls a random point at `speed` [m/s]."""
    rng, state, points = np.random.default_rng(seed), State.at_rest(net), net.shape[1]
    for _ in range(round(10.0 * seconds)):
        point, way = int(rng.choice([j for j in range(points) if (0, j) not in net.pinned])), rng.standard_normal(3)
        way *= speed / np.linalg.norm(way)
        place = state.x[:, 0, point].copy()
        for _ in range(5):
            place += 0.02 * way
            hand = Grab(0, point, tuple(place), 2000.0, 1.0, force)
            advance(dataclasses.replace(net, grab=hand), state, integrator, step, round(0.02 / step))
        yield state
