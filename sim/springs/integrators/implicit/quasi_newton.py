"""Memory of the last steps of a quasi-Newton method, which improves the next ones (L-BFGS, Nocedal 1980).

Factors of an approximate matrix turn forces into steps. Each step shows how the forces really change along it, and
corrects the product of the inverse and any vector, at the cost of two passes over the memory. With linear forces the
steps are those of conjugate gradients with the factors as preconditioner; other forces are followed as they turn.

Chosen among the solvers of a curtain of 64 x 64 at 1e5 N/m, each step solved to 1 % of its change. Cores in real time:

- this one, with new factors after 12 corrections: 1.2 to 1.4; with those of the step's start only: 1.5 to 1.8;
- a start without motion, instead of the last velocities: 3.1;
- Newton with conjugate gradients, compressed links cut off: more than 3, as it converges linearly;
- Newton with the whole matrix, with or without larger pivots: 2.2 to 3.1, as it is quadratic only near the end.

Conjugate gradients need 1 to 5 iterations with these factors, and more than 150 at 1e6 N/m with blocks of 3 x 3,
Gauss-Seidel, geometric or algebraic multigrid. Dissection on two threads saves 9 to 17 % of the time on the wall.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.integrators.implicit.dissection import solve
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.points.vector_ops import add_scaled

KEPT = 5  # steps
LEAST_RESISTANCE = 1e-6  # of the forces' work, that they must lose along a step which is kept


class StepMemory(NamedTuple):
    """The last steps: how far they went, how much force they took, and the reciprocal of their product."""

    steps: NDArray[np.float64]  # (KEPT, 3 rows cols)
    changes: NDArray[np.float64]  # (KEPT, 3 rows cols)
    weights: NDArray[np.float64]  # (KEPT,)
    parts: NDArray[np.float64]  # (KEPT,) scratch
    left: NDArray[np.float64]  # (3 rows cols,) scratch


@kernel
def make_memory(size):
    return StepMemory(
        np.zeros((KEPT, size)), np.zeros((KEPT, size)), np.zeros(KEPT), np.zeros(KEPT), np.zeros(size)
    )  # fmt: skip


@kernel(allocates=False)
def set_step(memory, count, grid, r, u):
    """Set the step u that takes the forces r, by the factors of `grid` and the last of `count` steps.

    Nocedal & Wright, Numerical Optimization, algorithm 7.4. r, u: (3 rows cols,), different arrays.
    """
    for j in range(r.shape[0]):
        memory.left[j] = r[j]
    known = min(count, KEPT)
    for back in range(known):
        q = (count - 1 - back) % KEPT
        part = memory.weights[q] * dot(memory.steps[q], memory.left)
        memory.parts[q] = part
        add_scaled(memory.left, -part, memory.changes[q])
    solve(grid, memory.left, u)
    for on in range(known):
        q = (count - known + on) % KEPT
        add_scaled(u, memory.parts[q] - memory.weights[q] * dot(memory.changes[q], u), memory.steps[q])


@kernel(allocates=False)
def remember(memory, count, u, length, before, after):
    """The number of steps after one of `length` times u, from forces `before` to `after`, which may be no more than
    `count`: a step that met no resistance tells nothing.
    """
    q = count % KEPT
    product = size = 0.0
    for j in range(u.shape[0]):
        s, y = length * u[j], before[j] - after[j]
        memory.steps[q, j], memory.changes[q, j] = s, y
        product += s * y
        size += s * before[j]
    if not product > LEAST_RESISTANCE * size > 0.0:
        return count
    memory.weights[q] = 1.0 / product
    return count + 1
