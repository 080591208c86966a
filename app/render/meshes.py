"""Meshes that are computed: a ball, and a tube of fixed topology around a moving line.

trimesh has both, but takes half a second to import, as long as all the rest of the rope scene.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel

SIDES = 10  # of a tube


def ball(rows: int = 16) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """Vertices (n, 3) and triangles (m, 3) of a unit sphere with `rows` rows of quads from pole to pole."""
    sides = 2 * rows
    theta = np.pi * np.arange(1, rows) / rows
    phi = 2 * np.pi * np.arange(sides) / sides
    belts = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), phi * 0 + 1),
        ],
        axis=-1,
    )
    vertices = np.concatenate([belts.reshape(-1, 3), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    top, bottom = len(vertices) - 2, len(vertices) - 1
    triangles = []
    for s in range(sides):
        t = (s + 1) % sides
        triangles += [(top, s, t), (bottom, (rows - 2) * sides + t, (rows - 2) * sides + s)]
        for r in range(rows - 2):
            a, b, c, d = r * sides + s, r * sides + t, (r + 1) * sides + s, (r + 1) * sides + t
            triangles += [(a, c, b), (b, c, d)]
    return vertices, np.array(triangles, dtype=np.uint32)


def tube_faces(rings: int, sides: int = SIDES) -> NDArray[np.uint32]:
    """Triangles (2 sides rings, 3) of a tube of `rings` rings, closed by a fan at each end's centre."""
    quads = []
    for r in range(rings - 1):
        for s in range(sides):
            a, b = r * sides + s, r * sides + (s + 1) % sides
            quads += [(a, b, a + sides), (b, b + sides, a + sides)]
    first, last = rings * sides, rings * sides + 1
    end = (rings - 1) * sides
    for s in range(sides):
        quads += [((s + 1) % sides, s, first), (end + s, end + (s + 1) % sides, last)]
    return np.array(quads, dtype=np.uint32)


def rod(ends: NDArray[np.float64], radius: float, sides: int = SIDES) -> NDArray[np.float32]:
    """Vertices (2 sides + 2, 3) of a rod between two ends (2, 3) [m] apart, for `tube_faces(2, sides)`."""
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    angle = 2 * np.pi * np.arange(sides)[:, None] / sides
    ring = radius * (np.cos(angle) * across + np.sin(angle) * np.cross(along, across))
    return np.concatenate([ends[0] + ring, ends[1] + ring, ends]).astype(np.float32)


@kernel
def smooth_line(points, samples, line):
    """Set line ((n - 1) samples + 1, 3) to the Catmull-Rom curve through points (n, 3), `samples` to a link."""
    n = points.shape[0]
    for i in range(n - 1):
        before, after = max(i - 1, 0), min(i + 2, n - 1)
        for s in range(samples):
            t = s / samples
            for e in range(3):
                p0, p1, p2, p3 = points[before, e], points[i, e], points[i + 1, e], points[after, e]
                line[i * samples + s, e] = 0.5 * (
                    2.0 * p1
                    + t * (p2 - p0 + t * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + t * (3.0 * (p1 - p2) + p3 - p0)))
                )
    for e in range(3):
        line[(n - 1) * samples, e] = points[n - 1, e]


@kernel
def sweep(line, radius, sides, vertices):
    """Set vertices (rings sides + 2, 3) (float32) to rings around line (rings, 3), then the centres of the two ends.

    radius [m]. The double reflection method (Wang et al. 2008, ACM TOG 27(1):2, table 1) moves the frame from ring to
    ring, so that the tube does not twist.
    """
    rings = line.shape[0]
    around = np.empty((sides, 2))
    for s in range(sides):
        angle = 2.0 * math.pi * s / sides
        around[s, 0], around[s, 1] = radius * math.cos(angle), radius * math.sin(angle)
    tx, ty, tz = 1.0, 0.0, 0.0
    rx, ry, rz = 0.0, 1.0, 0.0
    for i in range(rings):
        a, b = max(i - 1, 0), min(i + 1, rings - 1)
        ux, uy, uz = line[b, 0] - line[a, 0], line[b, 1] - line[a, 1], line[b, 2] - line[a, 2]
        length = math.sqrt(ux * ux + uy * uy + uz * uz)
        if length > 1e-12:
            ux, uy, uz = ux / length, uy / length, uz / length
        else:
            ux, uy, uz = tx, ty, tz
        if i == 0:
            # Any direction that is not along the first tangent.
            rx, ry, rz = (0.0, 0.0, 1.0) if abs(uz) < 0.9 else (1.0, 0.0, 0.0)
        else:
            vx, vy, vz = line[i, 0] - line[i - 1, 0], line[i, 1] - line[i - 1, 1], line[i, 2] - line[i - 1, 2]
            c = vx * vx + vy * vy + vz * vz
            if c > 1e-24:
                d, e = 2.0 * (vx * rx + vy * ry + vz * rz) / c, 2.0 * (vx * tx + vy * ty + vz * tz) / c
                rx, ry, rz = rx - d * vx, ry - d * vy, rz - d * vz
                tx, ty, tz = tx - e * vx, ty - e * vy, tz - e * vz
                wx, wy, wz = ux - tx, uy - ty, uz - tz
                c = wx * wx + wy * wy + wz * wz
                if c > 1e-24:
                    d = 2.0 * (wx * rx + wy * ry + wz * rz) / c
                    rx, ry, rz = rx - d * wx, ry - d * wy, rz - d * wz
        dot = rx * ux + ry * uy + rz * uz
        rx, ry, rz = rx - dot * ux, ry - dot * uy, rz - dot * uz
        norm = math.sqrt(rx * rx + ry * ry + rz * rz)
        if norm < 1e-12:
            rx, ry, rz, norm = (0.0, 0.0, 1.0, 1.0) if abs(uz) < 0.9 else (1.0, 0.0, 0.0, 1.0)
        rx, ry, rz = rx / norm, ry / norm, rz / norm
        tx, ty, tz = ux, uy, uz
        sx, sy, sz = uy * rz - uz * ry, uz * rx - ux * rz, ux * ry - uy * rx
        for s in range(sides):
            c, d = around[s, 0], around[s, 1]
            v = i * sides + s
            vertices[v, 0] = line[i, 0] + c * rx + d * sx
            vertices[v, 1] = line[i, 1] + c * ry + d * sy
            vertices[v, 2] = line[i, 2] + c * rz + d * sz
    for e in range(3):
        vertices[rings * sides, e] = line[0, e]
        vertices[rings * sides + 1, e] = line[rings - 1, e]
