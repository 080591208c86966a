"""The places at which two links of a chain are nearest to each other."""

import math
from typing import NamedTuple

from sim.jit import kernel
from sim.springs.points.arrays import span
from sim.springs.points.each_link import TINY

PARALLEL = 1e-12  # squared sine of the angle between two links, below which they are parallel


class LinkPair(NamedTuple):
    """Two links of a chain, and their places that are nearest to each other."""

    a: int  # first point of one link; its second is the next one
    b: int  # and of the other
    s: float  # part of the link of a before its place, from 0 to 1
    t: float  # and of the link of b
    distance: float  # [m] between the places
    nx: float  # direction from the place on the link of a to that on the link of b
    ny: float
    nz: float


@kernel(inline=True)
def clamped(part):
    return min(1.0, max(0.0, part))


@kernel(inline=True)
def closest_parts(tt, uu, tu, tr, ur):
    """(s, t) of the nearest places of segments a + s T and b + t U, from products of T, U and R = a - b.

    Ericson, Real-Time Collision Detection, section 5.1.9. Of parallel segments that overlap it is the middle of the
    overlap.
    """
    both = tt * uu
    square = both - tu * tu  # |T x U|^2
    if square > PARALLEL * both:
        s = clamped((tu * ur - tr * uu) / square)
    else:
        first, second = clamped(-tr / (tt + TINY)), clamped((tu - tr) / (tt + TINY))  # where the ends of U are
        s = 0.5 * (first + second)
    t = (tu * s + ur) / (uu + TINY)
    if t < 0.0 or t > 1.0:
        t = clamped(t)
        s = clamped((tu * t - tr) / (tt + TINY))
    return s, t


@kernel(inline=True)
def pair_at(x, n, a, b):
    """The `LinkPair` of the links from points a and b of a chain of n points."""
    tx, ty, tz = span(x, n, a, a + 1)
    ux, uy, uz = span(x, n, b, b + 1)
    rx, ry, rz = span(x, n, b, a)
    s, t = closest_parts(
        tx * tx + ty * ty + tz * tz, ux * ux + uy * uy + uz * uz, tx * ux + ty * uy + tz * uz,
        tx * rx + ty * ry + tz * rz, ux * rx + uy * ry + uz * rz,
    )  # fmt: skip
    dx, dy, dz = t * ux - s * tx - rx, t * uy - s * ty - ry, t * uz - s * tz - rz
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    scale = 1.0 / distance if distance > 0.0 else 0.0
    return LinkPair(a, b, s, t, distance, scale * dx, scale * dy, scale * dz)


@kernel(inline=True)
def opening_of(v, n, pair):
    """Velocity, or another motion v, of the place on the second link relative to that on the first."""
    s, t = pair.s, pair.t
    ax, ay, az = span(v, n, pair.a, pair.b)
    bx, by, bz = span(v, n, pair.a + 1, pair.b)
    cx, cy, cz = span(v, n, pair.b, pair.b + 1)
    return (
        (1.0 - s) * ax + s * bx + t * cx,
        (1.0 - s) * ay + s * by + t * cy,
        (1.0 - s) * az + s * bz + t * cz,
    )


@kernel(inline=True)
def rate_of(v, n, pair):
    """The part of `opening_of` along the line between the places."""
    dx, dy, dz = opening_of(v, n, pair)
    return dx * pair.nx + dy * pair.ny + dz * pair.nz
