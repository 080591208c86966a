"""Linear stability of one-step methods on x'' + 2 zeta omega x' + omega^2 x = 0, in units of z = h omega."""

import cmath
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from sim.interruption import raise_if_stopped

SCAN = 0.002  # step in z while looking for the first crossing: far below any method's limit
FIRST = SCAN * np.arange(1, 2001)  # the first four units of z, scanned in one go: most methods have their limit there
FURTHEST = 64.0
PARTS, REFINEMENTS = 64, 4  # of a step in which the crossing lies: one evaluation of 64 costs hardly more than of one
SLACK = 1e-9  # growth above 1 that is taken for round-off


def eigenvalues(zeta: float) -> tuple[complex, complex]:
    """s / omega of the oscillator: -zeta +- sqrt(zeta^2 - 1)."""
    root = cmath.sqrt(zeta * zeta - 1.0)
    return -zeta + root, -zeta - root


def limit_of(growth: Callable[[Any], Any]) -> float:
    """The first z at which growth(z), of many z at a time, leaves 1, to 1e-9; inf where it never does below 64."""
    known, z = 0.0, FIRST
    while True:
        raise_if_stopped()
        left = growth(z) > 1.0 + SLACK
        if left.any():
            break
        known += SCAN * len(FIRST)
        z = known + FIRST
        if known >= FURTHEST:
            return float("inf")
    known, part = known + SCAN * int(left.argmax()), SCAN
    for _ in range(REFINEMENTS):
        part /= PARTS
        left = growth(known + part * np.arange(1, PARTS)) > 1.0 + SLACK
        known += part * (int(left.argmax()) if left.any() else PARTS - 1)
    return known


@functools.cache
def first_powers(count: int) -> Any:
    """Powers 0 to count - 1 of the z that are scanned first, (z, count)."""
    return np.vander(FIRST, count, increasing=True)


@functools.lru_cache(maxsize=1000)
def limit_of_polynomial(coefficients: tuple[float, ...], zeta: float) -> float:
    """Largest stable z of a Runge-Kutta method with R(s) = sum c_i s^i.

    |R|^2 along the ray of an eigenvalue is a polynomial in z with real coefficients: one product with the powers of
    all z that are tried. Below zeta = 1 the two eigenvalues are conjugate, and one is enough.
    """
    squares = []
    for eigenvalue in eigenvalues(zeta)[: 1 if zeta < 1.0 else 2]:
        along = np.array(coefficients) * eigenvalue ** np.arange(len(coefficients))
        squares.append(np.convolve(along, along.conj()).real)
    polynomials = np.array(squares).T

    def growth(z: Any) -> Any:
        powers = first_powers(len(polynomials)) if z is FIRST else np.vander(z, len(polynomials), increasing=True)
        return np.sqrt(abs((powers @ polynomials).max(axis=1)))

    return limit_of(growth)


def nystroem_growth(c: Any, velocity: Any, position: Any, zeta: float) -> Callable[[Any], Any]:
    """Largest eigenvalue of a step of x'' + 2 zeta x' + x = 0, of an explicit Nystroem method, as a function of h = z.

    c: (stages,) times; velocity, position: (stages + 1, stages) weights of the stages, and of the new state last. The
    step matrix's entries are polynomials in z, found once: a stage adds two powers.
    """
    one = np.zeros(2 * len(c) + 3)
    one[0] = 1.0
    entries = []
    for x, v in ((one, 0.0 * one), (0.0 * one, one)):
        k = np.zeros((len(c), len(one)))
        for i, time in enumerate(c):
            xs = x + time * times_z(v) + times_z(times_z(position[i] @ k))
            k[i] = -xs - 2.0 * zeta * (v + times_z(velocity[i] @ k))
        entries += [x + times_z(v) + times_z(times_z(position[-1] @ k)), v + times_z(velocity[-1] @ k)]
    matrix = np.array(entries).T

    def growth(z: Any) -> Any:
        a, c0, b, d = np.polynomial.polynomial.polyval(z, matrix)
        half = 0.5 * (a + d)
        root = np.sqrt(half * half - (a * d - b * c0) + 0j)
        return np.maximum(abs(half + root), abs(half - root))

    return growth


def times_z(coefficients: Any) -> Any:
    """Coefficients of a polynomial, the lowest first, times z; the highest is 0."""
    return np.concatenate(([0.0], coefficients[:-1]))


def polynomial_of(a: tuple[tuple[float, ...], ...], b: tuple[float, ...]) -> tuple[float, ...]:
    """Coefficients of the stability polynomial, 1 and b A^(i-1) 1, of an explicit method's slopes and weights."""
    size = len(b)
    slopes = np.array([(*row, *(0.0,) * (size - len(row))) for row in a])
    powers, coefficients = np.ones(size), [1.0]
    for _ in range(size):
        coefficients.append(float(np.dot(b, powers)))
        powers = slopes @ powers
    return tuple(coefficients)
