"""From ranges and lists of parameters to cases: every combination, or a Latin hypercube.

A Latin hypercube of n cases (McKay, Beckman and Conover 1979, Technometrics 21:239) divides the range of every
parameter into n equal parts, and has one case in each part.
"""

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from sim.parameters import Parameter

MAX_CASES = 100_000


class Listed(NamedTuple):
    """A list of values."""

    values: tuple[Any, ...]


class Range(NamedTuple):
    """From `low` to `high`, both included. points: number of values on a grid; 0 in a random design."""

    low: float
    high: float
    points: int
    log: bool


Axis = Listed | Range


def at(axis: Axis, share: float, parameter: Parameter) -> Any:
    """The value at `share`, 0 to 1, of the axis. Each value of a list and each whole number has an equal part of it."""
    if isinstance(axis, Listed):
        return axis.values[min(int(share * len(axis.values)), len(axis.values) - 1)]
    low, high = axis.low, axis.high
    if parameter.kind is int and not axis.log:
        return min(int(low + share * (high - low + 1)), int(high))
    if share >= 1.0:
        return high
    value = min(low * (high / low) ** share if axis.log else low + share * (high - low), high)
    return round(value) if parameter.kind is int else value


def grid_values(axis: Axis, parameter: Parameter) -> tuple[Any, ...]:
    """The values of a grid along one axis, rounded for a parameter of whole numbers."""
    if isinstance(axis, Listed):
        return axis.values
    real = parameter._replace(default=0.0)
    values = [at(axis, float(share), real) for share in np.linspace(0.0, 1.0, axis.points)]
    return tuple(round(value) for value in values) if parameter.kind is int else tuple(values)


def grid(axes: dict[str, tuple[Any, ...]]) -> list[dict[str, Any]]:
    """All combinations; the last parameter changes fastest."""
    return [dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values())]


def hypercube(axes: dict[str, Axis], parameters: dict[str, Parameter], count: int, seed: int) -> list[dict[str, Any]]:
    """A Latin hypercube: `count` cases, one in each `count`-th of every axis.

    One line of numpy does what `scipy.stats.qmc` would; scipy is not needed for anything else.
    """
    generator = np.random.default_rng(seed)
    columns = {}
    for name, axis in axes.items():
        shares = (generator.permutation(count) + generator.random(count)) / count
        columns[name] = [at(axis, float(share), parameters[name]) for share in shares]
    return [{name: column[i] for name, column in columns.items()} for i in range(count)]


def size(axes: dict[str, Axis]) -> int:
    """The number of combinations."""
    return math.prod(len(axis.values) if isinstance(axis, Listed) else axis.points for axis in axes.values())
