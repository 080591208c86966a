"""Collisions of bodies: an impulse along the line of their centres, equal and opposite.

Each hull is as wide as its collision form (box, cylinder or ellipsoid of its extents) is along the line to the other's
centre. This is simple on purpose: no friction, no rotation, and corners that pass beside the line of centres may
overlap. An impulse along that line keeps the momentum and the angular momentum of the pair exactly.
"""

import math

from sim.floating.motion.rotation import axes_of, dot, four, plus, scaled, set_three, three, turn_back
from sim.floating.shapes.record import COLLISION_FORMS
from sim.jit import kernel

BOX, CYLINDER = COLLISION_FORMS.index("box"), COLLISION_FORMS.index("cylinder")
SEPARATION_SHARE = 0.2  # part of an overlap that one frame removes: a few frames part two bodies, none throws them
OVERLAP_TOLERANCE = 1e-3  # part of the distance at touch that may overlap, so that bodies at rest do not chatter
MIN_BOUNCE_SPEED = 0.2  # [m/s] of approach, below which bodies do not bounce


@kernel
def reach(fleet, i, direction):
    """Half width [m] of body i along a unit vector in the world."""
    hulls, q = fleet.hulls, fleet.hull[i]
    bx, by, bz = turn_back(axes_of(four(fleet.rotation, i)), direction)
    x, y, z = abs(bx) / hulls.half[q, 0], abs(by) / hulls.half[q, 1], abs(bz) / hulls.half[q, 2]
    if hulls.collision[q] == BOX:  # the ray leaves by one of its faces
        return 1.0 / max(x, y, z)
    if hulls.collision[q] == CYLINDER:
        return 1.0 / max(math.hypot(x, y), z)
    return 1.0 / math.sqrt(x * x + y * y + z * z)


@kernel
def collide(fleet, restitution):
    """Separate the bodies of a fleet that overlap and reverse those that approach; returns how many pairs touched.

    restitution: speed of separation over speed of approach, 0 to 1.
    """
    radius, position, velocity = fleet.hulls.radius, fleet.position, fleet.velocity
    touched = 0
    for i in range(fleet.mass.size):
        for j in range(i + 1, fleet.mass.size):
            between = plus(three(position, j), -1.0, three(position, i))
            near, square = radius[fleet.hull[i]] + radius[fleet.hull[j]], dot(between, between)
            if not square < near * near:
                continue
            distance = math.sqrt(square)
            along = scaled(1.0 / distance, between) if distance > 0.0 else (1.0, 0.0, 0.0)
            width = reach(fleet, i, along) + reach(fleet, j, along)
            if not distance < width:
                continue
            touched += 1
            inverse_mass = 1.0 / fleet.mass[i] + 1.0 / fleet.mass[j]
            closing = dot(plus(three(velocity, i), -1.0, three(velocity, j)), along)
            if closing > 0.0:
                bounce = restitution if closing > MIN_BOUNCE_SPEED else 0.0
                part(fleet, velocity, i, j, scaled((1.0 + bounce) * closing / inverse_mass, along))
            apart = SEPARATION_SHARE * max(width - distance - OVERLAP_TOLERANCE * width, 0.0) / inverse_mass
            part(fleet, position, i, j, scaled(apart, along))
    return touched


@kernel(inline=True)
def part(fleet, array, i, j, impulse):
    """Move bodies i and j, or change their velocities, by equal and opposite impulses; array (n, 3)."""
    set_three(array, i, plus(three(array, i), -1.0 / fleet.mass[i], impulse))
    set_three(array, j, plus(three(array, j), 1.0 / fleet.mass[j], impulse))
