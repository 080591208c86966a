"""The arrays of up to WIDTH ropes side by side: flat, in the order (component, point, lane), the lane fastest."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.springs.net import Net

WIDTH = 8  # ropes side by side: one register of 512 bits of float64, or two of 256

Floats = NDArray[np.float64]


class LaneForces(NamedTuple):
    """What moves the ropes and how long their steps are. n = points WIDTH, m = (points - 1) WIDTH."""

    points: int
    h: Floats  # (n,) [s] step of each lane
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


def by_lane(values: Floats, count: int) -> Floats:
    """One number for each lane, (groups, WIDTH), repeated for `count` points: (groups, count WIDTH)."""
    return np.tile(values, count)


def flat(values: Floats) -> Floats:
    """Numbers (groups, WIDTH, ..., points) with the lane last: (groups, ... points WIDTH)."""
    return np.moveaxis(values, 1, -1).reshape(len(values), -1)


def pack(nets: Sequence[Net], h: Floats) -> list[tuple[LaneForces, LaneState]]:
    """The arrays of ropes of equally many points at rest, WIDTH in each group. h: (ropes,) steps [s].

    All groups at once, because numpy takes longer to begin than for the numbers of one group.
    """
    points = nets[0].x0.shape[2]
    groups = len(nets) // WIDTH

    def grouped(values: list[Any]) -> Floats:
        return np.array(values, np.float64).reshape(groups, WIDTH, *np.shape(values[0]))

    step = h.reshape(groups, WIDTH)
    rest, k, b = np.moveaxis(grouped([net.families[0][2:] for net in nets]), -1, 0)
    inverse = grouped([net.inverse_masses() for net in nets])  # (groups, WIDTH, points)
    free = np.where(inverse > 0.0, 1.0, 0.0)
    mass, drag = grouped([net.mass for net in nets]), grouped([net.drag for net in nets])
    gravity = grouped([net.gravity for net in nets])
    half = 0.5 * step[..., None]
    total = inverse[..., 1:] + inverse[..., :-1]
    # exp(-b (w1 + w2) h/2), as `sim.springs.forces.damping` has it; a link between two pins moves nothing.
    taken = -np.expm1(-b[..., None] * total * half)
    share = np.divide(taken, total, out=np.zeros_like(taken), where=total > 0.0)
    forces = (
        by_lane(step, points),
        flat(inverse),
        flat(free * mass[..., None]),
        flat(gravity[..., None] * free[:, :, None]),
        flat(free * drag[..., None]),
        by_lane(k, points - 1),
        by_lane(k * rest, points - 1),
        by_lane(b, points - 1),
        flat(share),
        flat(np.exp(-drag[..., None] * inverse * half)),
    )
    x = flat(grouped([net.x0[:, 0] for net in nets]))
    size = x.shape[1]
    made = []
    for group in range(groups):
        start = x[group]
        state = LaneState(
            x=start,
            v=np.zeros(size),
            dissipated=np.zeros(size // 3),
            low=start.copy(),
            high=start.copy(),
            f=np.zeros(size + 3 * WIDTH),
            a=np.zeros((4, size)),
            stage=np.zeros((2, size)),
        )
        made.append((LaneForces(points, *(values[group] for values in forces)), state))
    return made


def by_rope(flat: Floats) -> Floats:
    """A view of (3 n,) numbers as nets have them: (WIDTH, 3, 1, points)."""
    return flat.reshape(3, 1, -1, WIDTH).transpose(3, 0, 1, 2)
