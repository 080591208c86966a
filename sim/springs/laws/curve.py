"""The law of one link of a line: it only pulls, with a constant stiffness or by a table of strain and tension.

Between two rows of a table the tension is linear in the strain, and beyond the last as steep as before it. A table
begins at strain 0 without tension, and both numbers grow from row to row: so the energy is convex, and to each tension
belongs one length.

Damping acts as in `slack`, or as in MoorDyn: whole at any length, so that a slack link resists its ends like a dashpot.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.laws import slack
from sim.springs.laws.record import Law


class TensionCurve(NamedTuple):
    """Numbers of the law, for a link of its own."""

    table: NDArray[np.float64]  # (rows, 3) of all links: strain, tension [N], energy per length [N]
    first: float  # row of the link's own table
    rows: float  # their number; 0: a constant stiffness
    slack_damping: bool  # as in MoorDyn


@kernel(allocates=False)
def curve_at(law, strain):
    """(tension [N], its derivative by the strain [N], energy per length [N]) at a strain; 0 of a negative one."""
    curves, i, last = law.table, int(law.first), int(law.first) + int(law.rows) - 2
    if strain <= 0.0:
        return 0.0, 0.0, 0.0
    while i < last and strain > curves[i + 1, 0]:
        i += 1
    slope = (curves[i + 1, 1] - curves[i, 1]) / (curves[i + 1, 0] - curves[i, 0])
    beyond = strain - curves[i, 0]
    return curves[i, 1] + slope * beyond, slope, curves[i, 2] + (curves[i, 1] + 0.5 * slope * beyond) * beyond


@kernel(inline=True)
def force_density(law, k, rest, length):
    if law.rows > 0.0:
        return curve_at(law, length / rest - 1.0)[0] / length
    return slack.force_density(law, k, rest, length)


@kernel(inline=True)
def stiffness(law, k, rest, length):
    if law.rows > 0.0:
        return curve_at(law, length / rest - 1.0)[1] / rest
    return slack.stiffness(law, k, rest, length)


@kernel(inline=True)
def energy(law, k, rest, length):
    if law.rows > 0.0:
        return curve_at(law, length / rest - 1.0)[2] * rest
    return slack.energy(law, k, rest, length)


@kernel(inline=True)
def damping(law, k, b, rest, length, rate):
    if law.slack_damping:
        return b
    return slack.without_push(b, length * force_density(law, k, rest, length), rate) if length > rest else 0.0


OF_LINES = Law(
    "curve", "Link of a line under water", TensionCurve(np.zeros((0, 3)), 0.0, 0.0, False), force_density, stiffness,
    energy, slack.length, damping,
)  # fmt: skip
