"""Four elastic lines a body, for many bodies at once: ropes as heavy as water, straight while taut, without a state.

T = EA (l/L - 1) while taut, 0 while slack: a link that only pulls, and no catenary, as nothing bends it. Lines that are
just taut at rest do not pull there, and one of each opposite two pulls elsewhere. So a body is held by
K = EA/L cos^2 of their slope, alike in all level directions. Mass and drag of the lines are left out.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.floating.motion.rigid import set_six
from sim.floating.motion.rotation import axes_of, body_z_axes, cross, dot, four, plus, scaled, three
from sim.jit import kernel

Array = NDArray[np.float64]
DIRECTIONS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])  # from a body to its anchors


class MooringLines(NamedTuple):
    """The lines of n bodies."""

    fairlead: Array  # (n,) [m] height over the body's centre along its z axis
    anchors: Array  # (n, 4, 3) [m]
    length: Array  # (n, 4) [m] unstretched
    stiffness: Array  # (n,) EA [N]


def just_taut(rest: Array, fairlead: Array, stiffness: Array, depth: float, reach: float) -> MooringLines:
    """Lines without tension where the fairleads rest (n, 3) [m]; fairlead (n,) [m], stiffness (n,) [N]: as above.

    depth, reach [m]: of the anchors below still water, and level from the fairleads.
    """
    level = rest[:, None, :2] + reach * DIRECTIONS
    anchors = np.concatenate((level, np.full((*level.shape[:2], 1), -depth)), axis=2)
    return MooringLines(fairlead, anchors, np.linalg.norm(anchors - rest[:, None], axis=2), stiffness)


def fairleads(lines: MooringLines, position: Array, rotation: Array) -> Array:
    """Places (n, 3) [m] of the fairleads; position (n, 3) [m] and rotation (n, 4) are the bodies'."""
    return position + lines.fairlead[:, None] * body_z_axes(rotation)


@kernel
def set_pulls(lines, position, rotation, force, tension):
    """Set force (n, 6) [N, N m] and tension (n, 4) [N]: see `pulls`."""
    for i in range(position.shape[0]):
        arm = scaled(lines.fairlead[i], axes_of(four(rotation, i))[2])
        fairlead, pull = plus(three(position, i), 1.0, arm), (0.0, 0.0, 0.0)
        for k in range(lines.length.shape[1]):
            way = plus(three(lines.anchors[i], k), -1.0, fairlead)
            distance = math.sqrt(dot(way, way))
            tension[i, k] = lines.stiffness[i] * max(distance / lines.length[i, k] - 1.0, 0.0)
            pull = plus(pull, tension[i, k] / distance, way)
        set_six(force[i], pull, cross(arm, pull))


def pulls(lines: MooringLines, position: Array, rotation: Array) -> tuple[Array, Array]:
    """Force and moment (n, 6) [N, N m] about each body's centre in world axes, and tensions (n, 4) [N].

    position (n, 3) [m] and rotation (n, 4) are the bodies'.
    """
    force, tension = np.empty((len(position), 6)), np.empty(lines.length.shape)
    set_pulls(lines, position, rotation, force, tension)
    return force, tension
