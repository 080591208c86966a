"""Floating bodies that hold lines, by linear theory: M q'' + B q' + C q = forces, steady ones and those of waves.

Their masses and what they carry are in `sim.springs.points.line_points`.
"""

from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING as OF_DAMPING
from sim.springs.forces.matrices import STIFFEST
from sim.springs.forces.matrices import STIFFNESS as OF_STIFFNESS
from sim.springs.forces.record import LINES, Force
from sim.springs.points.line_arrays import DAMPING, PLACE, STIFFNESS
from sim.springs.points.line_points import add_six, half_form, matrix_times, six
from sim.waves import AMPLITUDE, sums_at


@kernel(allocates=False)
def outer_force(x, t, p, b):
    """Steady force and that of waves on body b: a Re(X exp(i theta)) of each wave, theta where the body is now."""
    n, j = p.cols, p.nodes + 2 * b
    px, py = p.bodies[b, PLACE] + x[j], p.bodies[b, PLACE + 1] + x[n + j]
    f = p.steady[b]
    if p.excitation.shape[2] == 0:
        return f[0], f[1], f[2], f[3], f[4], f[5]
    e = sums_at(px, py, None, t, p.waves, p.waves, AMPLITUDE, p.excitation, b, p.depth).response
    return f[0] + e[0], f[1] + e[1], f[2] + e[2], f[3] + e[3], f[4] + e[4], f[5] + e[5]


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    n = p.cols
    for b in range(p.bodies.shape[0]):
        j, s = p.nodes + 2 * b, 1.0 if with_damping else 0.0
        k, d = matrix_times(p.bodies, b, STIFFNESS, six(x, n, j)), matrix_times(p.bodies, b, DAMPING, six(v, n, j))
        e = outer_force(x, t, p, b)
        add_six(
            a, n, j,
            (
                e[0] - k[0] - s * d[0], e[1] - k[1] - s * d[1], e[2] - k[2] - s * d[2],
                e[3] - k[3] - s * d[3], e[4] - k[4] - s * d[4], e[5] - k[5] - s * d[5],
            ),
        )  # fmt: skip


@kernel(allocates=False)
def energy(x, t, p):
    """1/2 q C q [J]."""
    total = 0.0
    for b in range(p.bodies.shape[0]):
        total += half_form(p, b, STIFFNESS, six(x, p.cols, p.nodes + 2 * b))
    return total


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """The damping takes, and waves and steady forces put in."""
    n, lost, work = p.cols, 0.0, 0.0
    for b in range(p.bodies.shape[0]):
        u, e = six(v, n, p.nodes + 2 * b), outer_force(x, t, p, b)
        work += u[0] * e[0] + u[1] * e[1] + u[2] * e[2] + u[3] * e[3] + u[4] * e[4] + u[5] * e[5]
        lost += 2.0 * half_form(p, b, DAMPING, u) if with_damping else 0.0
    return lost, work


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """C, and B."""
    n = p.cols
    if part not in (OF_STIFFNESS, STIFFEST, OF_DAMPING):
        return
    start = DAMPING if part == OF_DAMPING else STIFFNESS
    for b in range(p.bodies.shape[0]):
        j = p.nodes + 2 * b
        add_six(out, n, j, matrix_times(p.bodies, b, start, six(u, n, j)))


FORCE = Force(
    "bodies", rank=80, nets=LINES, accelerate=accelerate, energy=energy, power=power, tangent=tangent,
    stores="elastic", is_smooth=True,
)  # fmt: skip
