"""Accuracy of a time step: the error of oscillation and damping in the motion that gravity causes.

A step of a method multiplies a mode x'' + rate x' + omega^2 x = 0 by two factors, the eigenvalues of its amplification
matrix. Their logarithms over h are the method's own eigenvalues; their distance from the exact ones, over the size of
these, is the error of the mode: of its frequency, of its decay, or of both. So implicit Euler is off by h omega/2,
leapfrog by (h omega)^2/24 without damping. Of an overdamped mode the slow decay counts, which carries the motion and
holds its terminal speed. The fast one counts by the ratio of the two, as far as it is seen: it may be over within a
step.

The error of a motion is the root mean square over its modes, weighted by the squares of the displacements that the
weight of the net would cause. A method of first order may also be late by up to a step, which is no error here.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.springs.analysis.amplification import Changes, exponents

SMALLEST = 1e-300  # size of a factor whose logarithm is taken
STEPS_A_DECADE = 40  # of the search for the first step that is not accurate
SHORTEST, LONGEST = 1e-3, 10.0  # steps of the search, over the tolerance and the time scales of the modes
LEAST_LEFT = 1e-15  # of the square of an amplitude after a step: less is nothing
LEAST_WEIGHT = 1e-12  # of a mode; a lighter one moves by less than a millionth of the motion
LEAST_STIFFNESS = 1e-9  # over that of the stiffest mode, below which it is round-off
SPLIT = 1e-6  # of the stiffness, by which damping divides modes of equal stiffness
DEPENDENT = 1e-9  # eigenvalue of the shapes' mass matrix over the largest one, below which shapes are no new ones


class Motion(NamedTuple):
    """The modes of a motion, m of them."""

    omega: NDArray[np.float64]  # (m,) [rad/s]
    rate: NDArray[np.float64]  # (m,) of damping [1/s]
    weight: NDArray[np.float64]  # (m,) squared displacement, in sum 1


STILL = Motion(np.zeros(0), np.zeros(0), np.zeros(0))  # nothing moves


def mode_errors(
    changes: Changes, omega: NDArray[np.float64], rate: NDArray[np.float64], h: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Relative error of oscillation and damping of modes at steps of h [s], of the common shape of the arguments.

    omega [rad/s] above 0, rate [1/s].
    """
    omega, rate, h = np.broadcast_arrays(omega, rate, h)
    fast, slow = exponents(omega, rate)
    with np.errstate(all="ignore"):  # of steps far beyond the stable ones
        first, second = logarithms(changes(omega, rate, h)) / h
    sizes = np.abs(fast), np.abs(slow)
    errors = []
    for exact, size in ((fast, sizes[0]), (slow, sizes[1])):
        apart = np.abs(exact - first) / size, np.abs(exact - second) / size
        # Near critical damping both are near, and a change of the damping by e moves both by the root of e.
        errors.append(np.minimum(*apart) * np.minimum(1.0, np.maximum(*apart)))
    return np.maximum(errors[1], sizes[1] / sizes[0] * np.minimum(errors[0], 2.0))


def logarithms(changes: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """log(1 + y) of complex y, to round-off where y is small."""
    re, im = changes.real, changes.imag
    size = np.maximum(re * (2.0 + re) + im * im, LEAST_LEFT - 1.0)
    return 0.5 * np.log1p(size) + 1j * np.arctan2(im, 1.0 + re)


def motion_errors(changes: Changes, motion: Motion, h: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative error (n,) of oscillation and damping of a motion at steps h (n,) [s]; 0 of one without modes."""
    if not len(motion.omega):
        return np.zeros_like(h)
    errors = mode_errors(changes, motion.omega, motion.rate, h[:, None])
    # While the whole swings once, faster modes swing more often and are off by more, until damping ends them or they
    # are out of phase.
    slow = exponents(motion.omega, motion.rate)[1]
    size = np.abs(slow)
    whole = math.sqrt(float((motion.weight * size**2).sum()))
    swings = np.clip(size / whole, 1.0, size / np.maximum(-slow.real, SMALLEST * size))
    errors = np.maximum(errors, np.minimum(errors * swings, 1.0))
    return np.sqrt((motion.weight * errors**2).sum(axis=1))


def longest_accurate(changes: Changes, motion: Motion, longest: float, tolerance: float) -> float:
    """The step [s] up to which the error of a motion stays within `tolerance`, at most `longest` [s].

    By the first of many steps at which it does not, refined by a power law. inf where none is found, `longest` is inf.
    """
    if not len(motion.omega) or longest <= 0.0:
        return longest
    fast, slow = (np.abs(values) for values in exponents(motion.omega, motion.rate))
    last = min(longest, LONGEST / float(slow.min()))
    first = min(SHORTEST * tolerance / float(fast.max()), last)
    steps = np.geomspace(first, last, 2 + int(STEPS_A_DECADE * math.log10(last / first)))
    errors = motion_errors(changes, motion, steps)
    wrong = ~(errors <= tolerance)  # NaN as well
    if not wrong.any():
        return longest
    i = int(wrong.argmax())
    if i == 0:
        return 0.0
    low, high = math.log(max(errors[i - 1], SMALLEST)), math.log(errors[i]) if errors[i] < math.inf else math.inf
    part = (math.log(tolerance) - low) / (high - low)
    return float(steps[i - 1] * (steps[i] / steps[i - 1]) ** part)


def coarse_shapes(count: int, most: int) -> NDArray[np.float64]:
    """Hat functions (m, count) over `count` points in a row, m = `most` at most: between them all is linear."""
    m = min(count, most)
    places = np.linspace(0.0, m - 1.0, count)
    return np.maximum(0.0, 1.0 - np.abs(places - np.arange(m)[:, None]))


def motion_of(
    shapes: NDArray[np.float64],
    stiff: NDArray[np.float64],
    damped: NDArray[np.float64],
    loads: NDArray[np.float64],
    least: float,
) -> Motion:
    """The motion that loads cause, of the modes within a space of shapes (Rayleigh and Ritz).

    shapes: (m, size) vectors M^1/2 u; stiff, damped: (m, size) their products with K and D; loads: (3, size), which
    count alike. least: square of a frequency [1/s^2] that holds the softest modes, as a pendulum is held.
    """
    weights, vectors = np.linalg.eigh(shapes @ shapes.T)
    independent = weights > DEPENDENT * weights[-1]
    change = vectors[:, independent] / np.sqrt(weights[independent])
    k, d = (change.T @ (shapes @ products.T) @ change for products in (stiff, damped))
    squares = np.linalg.eigvalsh(k)
    largest = float(squares[-1])
    if largest <= 0.0 and least <= 0.0:
        return STILL
    # Between the modes of K and M and, where damping rules, those of K and D; of equal stiffness, as across a slack
    # rope, those of D.
    slow = math.sqrt(max(float(squares[0]), least, SPLIT * largest))
    share = SPLIT * max(largest, least) / max(float(np.trace(d)), SMALLEST)
    # The generalised problem as a plain one: with L L^T = D + slow M, that of L^-1 (K + share D) L^-T.
    inverse = np.linalg.inv(np.linalg.cholesky(d + slow * np.eye(len(d))))
    modes = inverse.T @ np.linalg.eigh(inverse @ (k + share * d) @ inverse.T)[1]
    modes /= np.linalg.norm(modes, axis=0)
    squares, rates = (np.einsum("im,ij,jm->m", modes, matrix, modes) for matrix in (k, d))
    pulled = (((loads @ shapes.T) @ change @ modes) ** 2).sum(axis=0)
    held = np.maximum(squares, least)
    counts = held > LEAST_STIFFNESS * largest
    weight = np.where(counts, pulled / np.where(counts, held, 1.0) ** 2, 0.0)
    counts &= weight > LEAST_WEIGHT * weight.sum()
    if not counts.any():
        return STILL
    return Motion(np.sqrt(held[counts]), np.maximum(rates[counts], 0.0), weight[counts] / weight[counts].sum())
