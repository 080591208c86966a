"""The damped kick of a rope, solved directly for the forces of its dampers, in O(points).

The unknowns are the forces f of the dampers, not velocities: with D v the relative velocities of the links, W = M^-1,
    f/b = D V,  V = U + alpha s W D^T f,  (1/b + alpha s D W D^T) f = D U,
a tridiagonal system, of one number a link where damping is axial, else of one for each component. Its condition does
not grow with b. Drag is divided out of U and W, as (1 + alpha s c w).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.kicks.dampers import turning_time
from sim.springs.kicks.formula import ALPHA


class ChainSystem(NamedTuple):
    """Factors and scratch for kicks of one time s of a rope of n points."""

    eased: NDArray[np.complex128]  # (n,) 1 / (1 + alpha s c w) of each point
    mobility: NDArray[np.complex128]  # (n,) alpha s w of each point, eased
    force: NDArray[np.complex128]  # (3 n,) forces of the dampers on the points before them [N]
    pivot: NDArray[np.complex128]  # (n,) inverse pivots of the elimination
    back: NDArray[np.complex128]  # (n,) factors of the next force on the way back


@kernel
def make_chain(p, s, wanted):
    """Return the system for kicks of a time s [s]; not wanted: of no points."""
    n = p.cols if wanted else 0
    eased, mobility = np.zeros(n, np.complex128), np.zeros(n, np.complex128)
    for j in range(n):
        eased[j] = 1.0 / (1.0 + ALPHA * (s * p.drag * p.inverse_masses[j]))
        mobility[j] = ALPHA * (s * p.inverse_masses[j]) * eased[j]
    force = np.zeros(3 * n, np.complex128)
    return ChainSystem(eased, mobility, force, np.zeros_like(mobility), np.zeros_like(mobility))


@kernel(noalias=True, allocates=False)
def factor_chain(chain, dampers, p):
    """The elimination's factors of isotropic damping, which are the same for all three components."""
    if p.axial:
        return
    back = 0.0j
    for j in range(p.cols - 1):
        b, left, right = dampers.acting[j], chain.mobility[j], chain.mobility[j + 1]
        chain.pivot[j] = b / (1.0 + b * (left + right) - b * left * back)
        back = right * chain.pivot[j]
        chain.back[j] = back


@kernel(inline=True)
def drive(v, load, s, chain, j, i):
    """Complex velocity of point j without dampers; i: index of its component."""
    return (v[i] + ALPHA * (s * load[i])) * chain.eased[j]


@kernel(noalias=True, allocates=False)
def solve_isotropic(v, load, s, chain, p):
    """Set the forces, one component after another."""
    n = p.cols
    for e in range(3):
        o, force = e * n, 0.0j
        left = drive(v, load, s, chain, 0, o)
        for j in range(n - 1):
            right = drive(v, load, s, chain, j + 1, o + j + 1)
            force = chain.pivot[j] * (right - left + chain.mobility[j] * force)
            chain.force[o + j] = force
            left = right
        force = 0.0j
        for turn in range(n - 1):
            j = n - 2 - turn
            force = chain.force[o + j] + chain.back[j] * force
            chain.force[o + j] = force


@kernel(noalias=True, allocates=False)
def solve_axial(v, load, s, closing, chain, dampers, p):
    """Set the forces, those along the links times their directions."""
    n, links, along, time = p.cols, p.cols - 1, dampers.along, turning_time(s, closing)
    force, back, cosine = 0.0j, 0.0j, 0.0  # the cosine between a link and the one before it
    for j in range(links):
        b, left, right, speed = dampers.acting[j], chain.mobility[j], chain.mobility[j + 1], dampers.turning[j] * time
        for e in range(3):
            i = e * n + j
            speed += along[e * links + j] * (drive(v, load, s, chain, j + 1, i + 1) - drive(v, load, s, chain, j, i))
        pivot = b / (1.0 + b * (left + right) - b * left * cosine * back)
        force = pivot * (speed + left * cosine * force)
        cosine = 0.0
        if j + 1 < links:
            for e in range(3):
                cosine += along[e * links + j] * along[e * links + j + 1]
        back = right * cosine * pivot
        chain.force[j], chain.back[j] = force, back
    force = 0.0j
    for turn in range(links):
        j = links - 1 - turn
        force = chain.force[j] + chain.back[j] * force
        chain.force[j] = force * along[j]
        chain.force[n + j] = force * along[links + j]
        chain.force[2 * n + j] = force * along[2 * links + j]


@kernel(noalias=True, allocates=False)
def solve_chain(v, load, s, closing, chain, dampers, p, mean, force):
    """Set the mean velocities (3 n,) [m/s] of a kick, and add the mean forces of linear dampers to force (3 n,) [N]."""
    n = p.cols
    if p.axial:
        solve_axial(v, load, s, closing, chain, dampers, p)
    else:
        solve_isotropic(v, load, s, chain, p)
    for e in range(3):
        o, before = e * n, 0.0j
        for j in range(n):
            after = chain.force[o + j] if j + 1 < n else 0.0j
            mean[o + j] = (drive(v, load, s, chain, j, o + j) + chain.mobility[j] * (after - before)).real
            force[o + j] += after.real - before.real
            before = after
    return True
