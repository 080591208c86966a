"""The linearised forces of a mooring as dense matrices: the slow reference of `sim.springs.stability`."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.mooring import System
from sim.mooring.tangent import carried_coordinates, free_coordinates, set_tangents
from sim.springs.forces.matrices import DAMPING, STIFFNESS
from sim.springs.integrators import Integrator
from sim.springs.points.line_arrays import BODY_MASS, LineArrays
from sim.springs.points.line_arrays import STIFFNESS as OF_BODY
from sim.springs.points.line_points import set_inverse_masses

Array = NDArray[np.float64]


def tangent_matrix(x: Array, p: LineArrays, part: int) -> Array:
    """A part of the tangent of all forces about x (3, n), in free coordinates; see `sim.springs.forces.matrices`."""
    free = free_coordinates(p)
    carried, moves = carried_coordinates(p)
    count, bodies = len(free), 2 * len(p.bodies)
    nodes = np.zeros((count + 3 * bodies, 3 * p.nodes))  # unit motions
    nodes[np.arange(count), free] = 1.0
    nodes[count:, carried] = moves.T
    units = np.zeros((len(nodes), 3, p.cols))
    units[:, :, : p.nodes] = nodes.reshape(len(nodes), 3, p.nodes)
    # Of a body's two points the first is its displacement, the second its rotation.
    units[count:, :, p.nodes :] = np.eye(3 * bodies).reshape(3 * bodies, bodies, 3).swapaxes(1, 2)
    found = np.empty_like(units)
    size = 3 * p.cols
    set_tangents(np.ascontiguousarray(x).reshape(-1), units.reshape(-1, size), p, part, found.reshape(-1, size))
    nodes = found[:, :, : p.nodes].reshape(len(units), 3 * p.nodes)
    six = nodes[:, carried] @ moves + found[:, :, p.nodes :].swapaxes(1, 2).reshape(len(units), 3 * bodies)
    return np.concatenate((nodes[:, free], six), axis=1)


def stiffness_matrix(x: Array, p: LineArrays) -> Array:
    """The matrix K [N/m] about x (3, n), in free coordinates."""
    return tangent_matrix(x, p, STIFFNESS)


def damping_matrix(x: Array, p: LineArrays) -> Array:
    """The matrix D [N s/m] about x (3, n), in free coordinates; drag is none at rest."""
    return tangent_matrix(x, p, DAMPING)


def mass_matrix(x: Array, p: LineArrays) -> Array:
    """The matrix M [kg] about x (3, n), in free coordinates, with the water's."""
    nodes = np.flatnonzero(p.inverse_masses[: p.nodes] > 0.0)
    count, first = len(nodes), 3 * len(nodes)
    found = np.zeros((first + 6 * len(p.bodies),) * 2, dtype=np.float64)
    set_inverse_masses(np.ascontiguousarray(x).reshape(-1), p)
    rows = p.inertia.reshape(6, p.cols)[:, nodes]
    blocks = np.linalg.inv(rows[[0, 1, 2, 1, 3, 4, 2, 4, 5]].T.reshape(-1, 3, 3))
    for d in range(3):
        for e in range(3):
            found[d * count + np.arange(count), e * count + np.arange(count)] = blocks[:, d, e]
    for b, row in enumerate(p.bodies):
        six = slice(first + 6 * b, first + 6 * b + 6)
        found[six, six] = row[BODY_MASS:OF_BODY].reshape(6, 6)
    return found


def unit_mass_matrices(system: System, x: Array) -> tuple[Array, Array]:
    """K and D about x (3, n) in coordinates in which M is 1: their eigenvalues are omega^2 and rates."""
    p = system.kernel_view(1.0)
    inverse = np.linalg.inv(np.linalg.cholesky(mass_matrix(x, p)))
    K, D = (inverse @ part(x, p) @ inverse.T for part in (stiffness_matrix, damping_matrix))
    return 0.5 * (K + K.T), 0.5 * (D + D.T)


def frequencies_squared(system: System, x: Array | None = None) -> Array:
    """omega^2 [1/s^2] of all undamped modes about x (3, n) (None: at rest), rising."""
    K, _ = unit_mass_matrices(system, system.at_rest().nodes if x is None else x)
    return np.linalg.eigvalsh(K).astype(np.float64)


def longest_steps(K: Array, D: Array, integrators: Sequence[Integrator]) -> list[float]:
    """The longest stable step [s] of all damped modes, the eigenvalues of s^2 + s D + K, with each integrator.

    Leapfrog's is that of K alone. K, D: see `unit_mass_matrices`.
    """
    stiffest = math.sqrt(np.linalg.eigvalsh(K)[-1])
    pairs = []
    for s in np.linalg.eigvals(np.block([[np.zeros_like(K), np.eye(len(K))], [-K, -D]])):
        if s.real < -1e-6:  # a real eigenvalue is the fast one of an oscillator without stiffness
            pairs.append((abs(s), -2.0 * s.real) if abs(s.imag) > 1e-6 else (0.0, -s.real))
    steps = []
    for integrator in integrators:
        if integrator.name == "leapfrog":
            steps.append(integrator.stable_step(stiffest, 0.0))
        elif integrator.name == "symplectic_euler":
            steps.append(longest_step_of_euler(K, D, 2.0 / stiffest))
        else:
            steps.append(min(integrator.stable_step(*pair) for pair in pairs))
    return steps


def longest_step_of_euler(K: Array, D: Array, start: float) -> float:
    """The step [s] at which h^2 K + 2 h D reaches 4, by iteration from a step."""
    h = start
    for _ in range(200):
        before, h = h, 2.0 / math.sqrt(np.linalg.eigvalsh(K + 2.0 / h * D)[-1])
        if abs(h - before) < 1e-6 * h:
            return h
    raise AssertionError(f"no step found: {before} s, then {h} s")
