"""The stiffness of rotation that a body has from the forces on it, as the arms of these forces turn with it.

A `MooredBody` moves by linear theory: a force F at an arm a has the moment a x F, whatever the body's rotation theta.
To first order the moment changes by (theta x a) x F. The symmetric part of that is a stiffness,
(F . a) - (a F^T + F a^T)/2.
"""

import dataclasses
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.mooring.rest.statics import Rest
from sim.springs.points.acceleration import set_rest_forces

if TYPE_CHECKING:
    from sim.mooring.system import System

Array = NDArray[np.float64]


def stiffness_of_turning(arm: Array, force: Array) -> Array:
    """Stiffness (3, 3) [N m/rad] of a force (3,) [N] at an arm (3,) [m]."""
    outer = np.outer(arm, force)
    return float(arm @ force) * np.eye(3) - 0.5 * (outer + outer.T)


def with_turning(system: "System", rest: Rest) -> "System":
    """The system with the stiffness that the bodies have from their lines in a state of rest.

    A body that it would turn over gets none in that direction: `MooredBody` allows no negative stiffness.
    """
    p = system.kernel_view(1.0)
    f = np.zeros(3 * p.cols)
    set_rest_forces(np.ascontiguousarray(rest.nodes).reshape(-1), p, f)
    forces = f.reshape(3, p.cols)
    bodies = []
    for b, body in enumerate(system.bodies):
        stiffness = np.array(body.stiffness, dtype=np.float64)
        for (node, owner), arm in zip(p.carried, p.arms, strict=True):
            if owner == b:
                stiffness[3:, 3:] += stiffness_of_turning(arm, forces[:, node])
        values, shapes = np.linalg.eigh(stiffness)
        least = 1e-9 * float(np.abs(values).max(initial=0.0))
        bodies.append(body._replace(stiffness=(shapes * np.maximum(values, least)) @ shapes.T))
    return dataclasses.replace(system, bodies=tuple(bodies))
