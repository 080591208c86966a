"""Knots: curves of three of them, and a rope that holds one while it is pulled at random."""

import dataclasses
import math

import numpy as np

from sim.springs import Contact, Grab, State, advance, rope

# Closed curves of t from 0 to 2 pi, farthest from the z axis at t = 0, by the numbers of their turns: (radius, about z,
# height). Their determinants are 3, 5 and 5.
TURNS = {"trefoil": (3, 2, 3), "figure eight": (2, 3, 4), "cinquefoil": (5, 2, 5)}
DETERMINANTS = {"trefoil": 3, "figure eight": 5, "cinquefoil": 5}


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
