"""Cloths whose layers are thrown through each other, and a slow look at what passes what in a step."""

import dataclasses
import functools

import numpy as np

from sim.springs import Contact, cloth
from sim.springs.points.cells import faces

REAL = 1e-9  # imaginary part of a root that counts as real, and distance [m] of places that coincide


@functools.lru_cache(maxsize=4)
def elements(rows, cols):
    """Pairs without a common point of a cloth's drawn triangles: (of edges (n, 4), of points and faces (n, 4))."""
    triangles = faces(rows, cols).astype(int)
    edges = np.unique(np.sort(np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1), axis=0)
    i, j = np.triu_indices(len(edges), 1)
    edges = np.concatenate([edges[i], edges[j]], axis=1)
    points = np.arange(rows * cols)
    on_faces = np.column_stack([np.repeat(points, len(triangles)), np.tile(triangles, (len(points), 1))])
    return tuple(one[[len(set(row)) == 4 for row in one.tolist()]] for one in (edges, on_faces))


def volumes(a, b, c):
    return np.einsum("ij,ij->i", a, np.cross(b, c))


def crossings(before, after, pairs, parts):
    """Pairs (n, 4) that cross in a straight motion (points, 3); the first `parts` points of each are its first thing.

    The four points are in one plane where the volume between them, a cubic in time, vanishes.
    """
    low, high = np.minimum(before, after), np.maximum(before, after)
    first, second = pairs[:, :parts], pairs[:, parts:]
    overlap = (low[first].min(1) <= high[second].max(1)) & (low[second].min(1) <= high[first].max(1))
    pairs = pairs[overlap.all(1)]
    starts, ways = before[pairs], after[pairs] - before[pairs]
    a, b = (np.moveaxis(each[:, 1:] - each[:, :1], 1, 0) for each in (starts, ways))
    cubics = np.column_stack([
        volumes(*b),
        volumes(a[0], b[1], b[2]) + volumes(b[0], a[1], b[2]) + volumes(b[0], b[1], a[2]),
        volumes(b[0], a[1], a[2]) + volumes(a[0], b[1], a[2]) + volumes(a[0], a[1], b[2]),
        volumes(*a),
    ])  # fmt: skip
    found = []
    for pair, cubic, start, way in zip(pairs, cubics, starts, ways, strict=True):
        for time in np.roots(cubic):
            if abs(time.imag) > REAL or not 0.0 <= time.real <= 1.0:
                continue
            p, q, r, s = start + time.real * way
            # Of a point p = q + u (r - q) + w (s - q); of edges p + u (q - p) = r + w (s - r).
            sides, to = ((r - q, s - q), p - q) if parts == 1 else ((q - p, r - s), r - p)
            sides = np.column_stack(sides)
            u, w = parts_of = np.linalg.lstsq(sides, to)[0]
            if np.linalg.norm(sides @ parts_of - to) > REAL:
                continue  # parallel edges in one plane
            if u >= 0.0 and w >= 0.0 and (u + w <= 1.0 if parts == 1 else max(u, w) <= 1.0):
                found.append((tuple(pair.tolist()), time.real))
    return found


def all_crossings(before, after, rows, cols):
    """All pairs of a cloth that cross in a straight motion between positions (3, rows, cols)."""
    before, after = (each.reshape(3, -1).T for each in (before, after))
    edges, on_faces = elements(rows, cols)
    return crossings(before, after, edges, 2) + crossings(before, after, on_faces, 1)


def turned(rng, most):
    """A rotation by at most `most` [rad] about each axis in turn."""
    turn = np.eye(3)
    for axis, angle in enumerate(rng.uniform(-most, most, 3)):
        one, c, s = np.eye(3), np.cos(angle), np.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        one[i, i], one[i, j], one[j, i], one[j, j] = c, -s, s, c
        turn = turn @ one
    return turn


def thrown_layers(seed, ratio, speed, size=6, damping=0.1):
    """A soft cloth that is folded in two layers, and the velocities that throw one through the other.

    ratio: thickness over spacing. The upper layer is tilted and aside at random. Cells of 0.1 m.
    """
    rng, rows = np.random.default_rng(seed), 2 * size
    net = cloth(
        rows, size, 0.1 * (size - 1), 0.1 * (rows - 1), 0.3, 20.0, 5.0, 0.1, 0.02 * damping, gravity=0.0,
        pinned="free", contact=Contact(50.0, damping), thickness=0.1 * ratio,
    )  # fmt: skip
    x = net.x0.copy()
    upper = x[:, :size, :].copy()
    upper[2] = 0.0
    middle = upper.mean(axis=(1, 2))[:, None, None]
    upper = np.einsum("ij,jkl->ikl", turned(rng, 0.3), upper - middle) + middle
    upper[:2] += rng.uniform(-0.05, 0.05, 2)[:, None, None]
    upper[2] += 0.12 - upper[2].min()
    x[:, size:] = upper[:, ::-1]
    v = np.zeros_like(x)
    v[:, size:] = turned(rng, 0.3)[:, 2][:, None, None] * -speed
    v += 0.02 * speed * rng.standard_normal(v.shape)
    return dataclasses.replace(net, x0=x), v
