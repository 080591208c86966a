"""The forces that a net declares (`Net.forces`) on a student's rope or cloth, by the program's kernels.

Only the process that runs a student's functions imports this, and only if a net has such a force.
"""

import functools
from typing import Any

import numpy as np

from sim.springs.forces import OWN
from sim.springs.net import Family, Net
from sim.springs.points.acceleration import set_declared

NUMBERS = {force.name: numbers for numbers, force in OWN.items()}


@functools.lru_cache(maxsize=4)
def record(
    declared: tuple[tuple[str, tuple[float, ...]], ...],
    shape: tuple[int, int],
    masses: tuple[float, ...],
    pins: tuple[int, ...],
    h: float,
) -> Any:
    """The kernels' record, for steps of h [s], of a net (rows, cols) that has these forces alone.

    declared: name and numbers of its forces. masses: [kg] of the points. pins: numbers of those that are held.
    """
    equal = len(set(masses)) == 1
    net = Net(
        np.zeros((3, *shape)),
        (Family(0, 1, 1.0, 0.0, 0.0),),
        mass=masses[0] if equal else 1.0,
        drag=0.0,
        gravity=(0.0, 0.0, 0.0),
        pinned=frozenset((pin // shape[1], pin % shape[1]) for pin in pins),
        mass_ratios=None if equal else np.reshape(masses, shape),
        forces=tuple(NUMBERS[name](*numbers) for name, numbers in declared),
    )
    return net.kernel_view(h)


def accelerations(x: np.ndarray, v: np.ndarray, t: float, p: Any) -> np.ndarray:
    """Accelerations (n, 3) [m/s2] by the forces of a record at the time t [s]; x, v: (n, 3)."""
    a = np.zeros(x.size)
    set_declared(np.ascontiguousarray(x.T).reshape(-1), np.ascontiguousarray(v.T).reshape(-1), t, p, a)
    return a.reshape(3, -1).T
