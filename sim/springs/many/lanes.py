"""The arrays of up to WIDTH ropes side by side: flat, in the order (component, point, lane), the lane fastest."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.springs.net import Net

WIDTH = 8  # ropes side by side: one register of 512 bits of float64, or two of 256

Floats = NDArray[np.float64]


class LaneForces(NamedTuple):
    """What moves the ropes and how long their steps are. n = points WIDTH, m = (points - 1) WIDTH."""

    points: int
    h: Floats  # (n,) [s] step of each lane; 0 for a lane that has finished: its steps then change nothing
    inverse_masses: Floats  # (n,) [1/kg], 0 where pinned
    masses: Floats  # (n,) [kg], 0 where pinned
    weight: Floats  # (3 n,) [m/s^2] gravity, 0 where pinned
    drag: Floats  # (n,) [N s/m], 0 where pinned
    stiffness: Floats  # (m,) k [N/m] of the link from this point to the next
    tension_at_rest: Floats  # (m,) k d [N], d the rest length
    damping: Floats  # (m,) b [N s/m]
    share: Floats  # (m,) [kg] of a link's relative velocity that half a step's damping takes, as momentum
    keep: Floats  # (n,) what drag leaves of a velocity after half a step


class LaneState(NamedTuple):
    """What changes as the ropes move, and scratch."""

    x: Floats  # (3 n,) [m]
    v: Floats  # (3 n,) [m/s]
    dissipated: Floats  # (n,) [J] what damping took: of each link at its first point, and of each point
    low: Floats  # (3 n,) [m] smallest value of each coordinate so far at which forces were evaluated
    high: Floats  # (3 n,) [m] largest
    f: Floats  # (3 (n + WIDTH),) [N] of the links: scratch, its first and last WIDTH of each component stay 0
    a: Floats  # (4, 3 n) [m/s^2] scratch
    stage: Floats  # (2, 3 n) scratch


def by_lane(values: Sequence[float], count: int) -> Floats:
    """One number for each lane, repeated for `count` points: (count WIDTH,)."""
    return np.tile(np.asarray(values, np.float64), count)


def pack(nets: Sequence[Net], h: Floats) -> tuple[LaneForces, LaneState]:
    """The arrays of WIDTH ropes of equally many points, at rest. h: (WIDTH,) steps [s]."""
    points = nets[0].x0.shape[2]
    links = np.array([net.families[0][2:] for net in nets])  # (WIDTH, 3): rest length, stiffness, damping
    inverse = np.array([net.inverse_masses() for net in nets]).T  # (points, WIDTH)
    free = inverse > 0.0
    mass, drag = np.array([net.mass for net in nets]), np.array([net.drag for net in nets])
    gravity = np.array([net.gravity for net in nets]).T  # (3, WIDTH)
    total = inverse[1:] + inverse[:-1]
    # exp(-b (w1 + w2) h/2), as `sim.springs.forces.damping` has it; a link between two pins moves nothing.
    taken = -np.expm1(-links[:, 2] * total * 0.5 * h)
    share = np.divide(taken, total, out=np.zeros_like(taken), where=total > 0.0)
    forces = LaneForces(
        points=points,
        h=by_lane(h, points),
        inverse_masses=inverse.ravel(),
        masses=(free * mass).ravel(),
        weight=(gravity[:, None] * free).ravel(),
        drag=(free * drag).ravel(),
        stiffness=by_lane(links[:, 1], points - 1),
        tension_at_rest=by_lane(links[:, 1] * links[:, 0], points - 1),
        damping=by_lane(links[:, 2], points - 1),
        share=share.ravel(),
        keep=np.exp(-drag * inverse * 0.5 * h).ravel(),
    )
    x = np.stack([net.x0[:, 0] for net in nets], axis=-1).ravel()
    state = LaneState(
        x=x,
        v=np.zeros_like(x),
        dissipated=np.zeros(x.size // 3),
        low=x.copy(),
        high=x.copy(),
        f=np.zeros(x.size + 3 * WIDTH),
        a=np.zeros((4, x.size)),
        stage=np.zeros((2, x.size)),
    )
    return forces, state


def stop_lane(forces: LaneForces, lane: int) -> None:
    """Make every further step of this lane one of no length."""
    forces.h[lane::WIDTH] = 0.0
    forces.share[lane::WIDTH] = 0.0
    forces.keep[lane::WIDTH] = 1.0


def by_rope(flat: Floats) -> Floats:
    """A view of (3 n,) numbers as nets have them: (WIDTH, 3, 1, points)."""
    return flat.reshape(3, 1, -1, WIDTH).transpose(3, 0, 1, 2)
