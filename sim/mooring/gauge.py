"""How long a step a mooring allows: the modes about a state, and the integrator's limit at the damping of each.

Of the free nodes and bodies M u'' + D u' + K u = 0, with the water's inertia in M, links and bed in K, and links, bed
and bodies in D. A mooring has few enough nodes that all modes are found (LAPACK).
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.mooring.statics import Rest, at_rest
from sim.mooring.system import System
from sim.mooring.tangent import damping_matrix, stiffness_matrix
from sim.springs.integrators import Integrator, integrator_named
from sim.springs.line_arrays import INVERSE_MASS, LineArrays
from sim.springs.line_points import inverse_mass_matrices
from sim.springs.stability import Mode, step_limit


def inverse_root_masses(x: NDArray[np.float64], p: LineArrays) -> NDArray[np.float64]:
    """M^-1/2 of the free coordinates about x (3, n), with the water's inertia."""
    nodes = np.flatnonzero(p.inverse_masses[: p.nodes] > 0.0)
    count, first = len(nodes), 3 * len(nodes)
    root = np.zeros((first + 6 * len(p.bodies),) * 2)
    rows = inverse_mass_matrices(np.ascontiguousarray(x).reshape(-1), p).reshape(6, p.cols)[:, nodes]
    halves = root_of(rows[[0, 1, 2, 1, 3, 4, 2, 4, 5]].T.reshape(-1, 3, 3))
    for d in range(3):
        for e in range(3):
            root[d * count + np.arange(count), e * count + np.arange(count)] = halves[:, d, e]
    for b, row in enumerate(p.bodies):
        six = slice(first + 6 * b, first + 6 * b + 6)
        root[six, six] = root_of(row[INVERSE_MASS : INVERSE_MASS + 36].reshape(6, 6))
    return root


def root_of(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Square roots of symmetric matrices (..., n, n)."""
    values, vectors = np.linalg.eigh(matrix)
    return vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :] @ np.swapaxes(vectors, -1, -2)


def modes(system: System, state: Rest | None = None) -> list[Mode]:
    """The modes about a state (None: at rest): all of the stiffness, then the most damped one."""
    x = (at_rest(system) if state is None else state).nodes
    p = system.kernel_view(1.0)
    root = inverse_root_masses(x, p)
    stiffness, damping = root @ stiffness_matrix(x, p) @ root, root @ damping_matrix(x, p) @ root
    squares, shapes = np.linalg.eigh(0.5 * (stiffness + stiffness.T))
    rates = np.einsum("ij,ij->j", shapes, damping @ shapes)
    found = [Mode(float(s), float(s), float(r)) for s, r in zip(squares, rates, strict=True) if s > 1e-9 * squares[-1]]
    if damping.any():
        most, worst = np.linalg.eigh(0.5 * (damping + damping.T))
        square = float(worst[:, -1] @ stiffness @ worst[:, -1])
        found.append(Mode(square, square, float(most[-1])))
    return found


def critical_step(system: System, integrator: str | Integrator, state: Rest | None = None) -> float:
    """The longest step [s] at which small disturbances of a state (None: at rest) do not grow.

    Raises ValueError for an unknown integrator.
    """
    record = integrator_named(integrator)
    return min((step_limit(mode, record) for mode in modes(system, state)), default=math.inf)
