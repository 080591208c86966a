"""Collisions of bodies: an impulse along the line of their centres, equal and opposite.

Each hull is as wide as its collision form (box, cylinder or ellipsoid of its extents) is along the line to the other's
centre. This is simple on purpose: no friction, no rotation, and corners that pass beside the line of centres may
overlap. An impulse along that line keeps the momentum and the angular momentum of the pair exactly.
"""

import numpy as np

from sim.floating.shapes.record import COLLISION_FORMS
from sim.jit import kernel

BOX, CYLINDER = COLLISION_FORMS.index("box"), COLLISION_FORMS.index("cylinder")
SEPARATION_SHARE = 0.2  # part of an overlap that one frame removes: a few frames part two bodies, none throws them
OVERLAP_TOLERANCE = 1e-3  # part of the distance at touch that may overlap, so that bodies at rest do not chatter
MIN_BOUNCE_SPEED = 0.2  # [m/s] of approach, below which bodies do not bounce


@kernel
def reach(hulls, q, w, x, y, z, dx, dy, dz):
    """Half width [m] of hull q, rotated by the quaternion (w, x, y, z), along the world direction (dx, dy, dz)."""
    # into body axes: v - 2 w (u cross v) + 2 u cross (u cross v)
    cx, cy, cz = y * dz - z * dy, z * dx - x * dz, x * dy - y * dx
    bx = abs(dx - 2.0 * w * cx + 2.0 * (y * cz - z * cy))
    by = abs(dy - 2.0 * w * cy + 2.0 * (z * cx - x * cz))
    bz = abs(dz - 2.0 * w * cz + 2.0 * (x * cy - y * cx))
    hx, hy, hz = hulls.half[q, 0], hulls.half[q, 1], hulls.half[q, 2]
    if hulls.collision[q] == BOX:  # the ray leaves by one of its faces
        return 1.0 / max(bx / hx, by / hy, bz / hz)
    if hulls.collision[q] == CYLINDER:
        return 1.0 / max(np.hypot(bx / hx, by / hy), bz / hz)
    return 1.0 / np.sqrt((bx / hx) ** 2 + (by / hy) ** 2 + (bz / hz) ** 2)


@kernel
def collide(fleet, restitution):
    """Separate the bodies of a fleet that overlap and reverse those that approach; returns how many pairs touched.

    restitution: speed of separation over speed of approach, 0 to 1.
    """
    hulls, position, velocity, rotation = fleet.hulls, fleet.position, fleet.velocity, fleet.rotation
    touched = 0
    for i in range(fleet.mass.size):
        for j in range(i + 1, fleet.mass.size):
            dx = position[j, 0] - position[i, 0]
            dy = position[j, 1] - position[i, 1]
            dz = position[j, 2] - position[i, 2]
            near = hulls.radius[fleet.hull[i]] + hulls.radius[fleet.hull[j]]
            square = dx * dx + dy * dy + dz * dz
            if not square < near * near:
                continue
            distance = np.sqrt(square)
            if distance > 0.0:
                dx, dy, dz = dx / distance, dy / distance, dz / distance
            else:
                dx, dy, dz = 1.0, 0.0, 0.0
            a, b = rotation[i], rotation[j]
            width = reach(hulls, fleet.hull[i], a[0], a[1], a[2], a[3], dx, dy, dz)
            width += reach(hulls, fleet.hull[j], b[0], b[1], b[2], b[3], dx, dy, dz)
            if not distance < width:
                continue
            touched += 1
            inverse_mass = 1.0 / fleet.mass[i] + 1.0 / fleet.mass[j]
            closing = (
                (velocity[i, 0] - velocity[j, 0]) * dx
                + (velocity[i, 1] - velocity[j, 1]) * dy
                + (velocity[i, 2] - velocity[j, 2]) * dz
            )
            if closing > 0.0:
                bounce = restitution if closing > MIN_BOUNCE_SPEED else 0.0
                impulse = (1.0 + bounce) * closing / inverse_mass
                add_along(velocity, i, -impulse / fleet.mass[i], dx, dy, dz)
                add_along(velocity, j, impulse / fleet.mass[j], dx, dy, dz)
            apart = SEPARATION_SHARE * max(width - distance - OVERLAP_TOLERANCE * width, 0.0) / inverse_mass
            add_along(position, i, -apart / fleet.mass[i], dx, dy, dz)
            add_along(position, j, apart / fleet.mass[j], dx, dy, dz)
    return touched


@kernel
def add_along(array, i, length, dx, dy, dz):
    """array[i] += length (dx, dy, dz), for array (n, 3)."""
    array[i, 0] += length * dx
    array[i, 1] += length * dy
    array[i, 2] += length * dz
