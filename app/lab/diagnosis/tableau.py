"""The tableau of a step: the states at which it computes the acceleration, and the combination of the results.

A step of a general one-step method takes combinations of x, v and the accelerations so far, with powers of h as
coefficients. It is called with an acceleration that returns a vector of an orthogonal basis for each state, so that the
coefficients are scalar products, and with several steps h, so that each is a polynomial in h.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

POINTS = 8  # of the moved rope: 24 dimensions
MOST_STAGES = 12
# [s], of the calls: where the polynomials of h between 0.15 and 2.5 are known best.
STEPS = tuple(1.325 - 1.175 * np.cos(np.pi * (np.arange(8) + 0.5) / 8))
POWERS = np.arange(-1, 5)  # of h
LINEAR = 1e-5  # fraction of a vector that no combination explains, above which a step is not one of these methods
ROUNDING = 1e-9  # of a coefficient in double precision
AMPLIFIED = 120.0  # ratio of the error of a coefficient to that of the results, with these steps and powers
FIRST_ACCELERATION = 2  # column of a tableau

Step = Callable[..., Any]


class StepTableau(NamedTuple):
    """The coefficients of a step.

    positions, velocities: (stages + 1, columns, powers) of the states at which the acceleration is computed, and last
    of the result. Columns: x, v, then the acceleration of each stage. tolerance: of a coefficient. with_velocity:
    whether the acceleration depends on the velocity.
    """

    positions: np.ndarray
    velocities: np.ndarray
    tolerance: float
    with_velocity: bool

    @property
    def stages(self) -> int:
        return len(self.positions) - 1

    def step(self, x: Any, v: Any, h: float, acceleration: Step) -> tuple[np.ndarray, np.ndarray]:
        """One step as a task has it, with the arguments of `apply`."""
        x, v = np.asarray(x, np.float64), np.asarray(v, np.float64)
        return self.apply(x, v, h, lambda x, v: np.asarray(acceleration(x, v), np.float64))

    def apply(self, x: np.ndarray, v: np.ndarray, h: float, acceleration: Step) -> tuple[np.ndarray, np.ndarray]:
        """One step of the method."""
        known = np.zeros((FIRST_ACCELERATION + self.stages, *x.shape))
        known[:FIRST_ACCELERATION] = x, v
        powers = h ** POWERS.astype(float)
        for stage in range(self.stages):
            state = (np.tensordot(part[stage] @ powers, known, 1) for part in (self.positions, self.velocities))
            known[FIRST_ACCELERATION + stage] = acceleration(*state)
        return np.tensordot(self.positions[-1] @ powers, known, 1), np.tensordot(self.velocities[-1] @ powers, known, 1)


class NoTableau(Exception):  # noqa: N818 - a property of a step, not an error
    """Raised for a step that is no combination of x, v and accelerations with powers of h."""


class Oracle:
    """An acceleration that returns the next vector of a basis at each call, and keeps the states."""

    def __init__(self, basis: np.ndarray) -> None:
        self.basis = basis
        self.states: list[tuple[np.ndarray, ...]] = []

    def __call__(self, x: Any, v: Any) -> np.ndarray:
        shape = (POINTS, 3)
        state = np.array(x, np.float64), np.array(v, np.float64)
        if any(part.shape != shape for part in state):
            raise ValueError(f"positions and velocities must have shape (n, 3), not {np.shape(x)} and {np.shape(v)}")
        self.states.append(state)
        return self.basis[min(len(self.states), MOST_STAGES) + FIRST_ACCELERATION - 1].reshape(shape).copy()


class StepCall(NamedTuple):
    """One call of a step. rows: (stages + 1, 2, dimensions) coordinates of the states and of the result."""

    rows: np.ndarray
    noise: float  # coordinates along what no combination can contain


@functools.cache
def orthogonal_basis() -> np.ndarray:
    """(24, 24) orthogonal rows with entries of the order of 1."""
    size = 3 * POINTS
    return np.linalg.qr(np.random.default_rng(20150130).normal(size=(size, size)))[0] * np.sqrt(size)


def call_step(step: Step, h: float) -> StepCall:
    """The coordinates of the states and results of a step. Raises NoTableau."""
    basis = orthogonal_basis()
    oracle = Oracle(basis)
    x, v = (row.reshape(POINTS, 3).copy() for row in basis[:FIRST_ACCELERATION])
    result = step(x, v, h, oracle)
    if len(oracle.states) > MOST_STAGES:
        raise NoTableau
    states = [*oracle.states, tuple(np.asarray(part, np.float64) for part in result)]
    rows = np.array([[basis @ part.ravel() / basis.shape[0] for part in state] for state in states])
    if not np.isfinite(rows).all():
        raise NoTableau
    known = FIRST_ACCELERATION + len(oracle.states)
    return StepCall(rows[:, :, :known], float(np.abs(rows[:, :, known:]).max(initial=0.0)))


def read_tableau(step: Step, *, with_velocity: bool) -> StepTableau:
    """The tableau of a step(x, v, h, acceleration).

    Each call of the acceleration is a stage, also one that the result does not depend on (`pruned`), or at a state of
    an earlier one (`merged`). with_velocity: whether the
    acceleration depends on the velocity. Raises NoTableau.
    """
    calls = [call_step(step, h) for h in STEPS]
    if len({call.rows.shape for call in calls}) > 1:
        raise NoTableau
    rows = np.array([call.rows for call in calls])
    scale = max(1.0, float(np.abs(rows).max()))
    powers = np.array(STEPS)[:, None] ** POWERS.astype(float)
    fitted, *_ = np.linalg.lstsq(powers, rows.reshape(len(STEPS), -1), rcond=None)
    left = np.abs(powers @ fitted - rows.reshape(len(STEPS), -1)).max()
    noise = max(float(left), *(call.noise for call in calls))
    if noise > LINEAR * scale:
        raise NoTableau
    tolerance = max(ROUNDING * scale, AMPLIFIED * noise)
    coefficients = np.moveaxis(fitted.reshape(len(POWERS), *rows.shape[1:]), 0, -1)
    coefficients[np.abs(coefficients) < tolerance] = 0.0
    if not with_velocity:
        coefficients[:-1, 1] = 0.0  # no acceleration depends on them
    return StepTableau(coefficients[:, 0], coefficients[:, 1], tolerance, with_velocity)


def pruned(tableau: StepTableau) -> StepTableau:
    """A tableau without the stages that its result does not depend on."""
    depends = [
        {int(j) for j in np.flatnonzero(np.any(tableau.positions[i], axis=1) | np.any(tableau.velocities[i], axis=1))}
        for i in range(tableau.stages + 1)
    ]
    used: set[int] = set()
    waiting = [tableau.stages]
    while waiting:
        for column in depends[waiting.pop()]:
            stage = column - FIRST_ACCELERATION
            if stage >= 0 and stage not in used:
                used.add(stage)
                waiting.append(stage)
    return with_stages(tableau, sorted(used))


def with_stages(tableau: StepTableau, stages: list[int]) -> StepTableau:
    """A tableau with some of its stages."""
    rows = [*stages, tableau.stages]
    columns = [0, 1, *(stage + FIRST_ACCELERATION for stage in stages)]
    positions, velocities = (part[rows][:, columns] for part in (tableau.positions, tableau.velocities))
    return tableau._replace(positions=positions, velocities=velocities)


def merged(tableau: StepTableau) -> StepTableau:
    """A tableau whose stages at the same state are one."""
    positions, velocities = tableau.positions.copy(), tableau.velocities.copy()
    unique_stages: list[int] = []
    for stage in range(tableau.stages):
        for other in unique_stages:
            apart = max(np.abs(part[stage] - part[other]).max() for part in (positions, velocities))
            if apart <= tableau.tolerance:
                for part in (positions, velocities):
                    part[:, other + FIRST_ACCELERATION] += part[:, stage + FIRST_ACCELERATION]
                    part[:, stage + FIRST_ACCELERATION] = 0.0
                break
        else:
            unique_stages.append(stage)
    return with_stages(tableau._replace(positions=positions, velocities=velocities), unique_stages)


def order_of(tableau: StepTableau) -> int:
    """The order of a method: half the step leaves 2^-(order + 1) of the error of a step; 0 without one."""
    x, v = np.array([0.7, -0.4]), np.array([0.3, 0.9])

    def acceleration(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return -2.0 * x - x**3 + x[::-1] - (0.8 * v if tableau.with_velocity else 0.0)

    def exact(h: float) -> np.ndarray:
        y = np.array([x, v])
        f = lambda y: np.array([y[1], acceleration(*y)])  # noqa: E731
        n = 40
        for _ in range(n):
            k1 = f(y)
            k2 = f(y + h / n / 2 * k1)
            k3 = f(y + h / n / 2 * k2)
            y = y + h / n / 6 * (k1 + 2 * k2 + 2 * k3 + f(y + h / n * k3))
        return y

    steps = (0.04, 0.02)
    errors = [float(np.abs(np.array(tableau.apply(x, v, h, acceleration)) - exact(h)).max()) for h in steps]
    return max(0, round(np.log2(errors[0] / errors[1])) - 1) if errors[1] > 0.0 else len(POWERS)
