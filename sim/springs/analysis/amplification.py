"""Linear stability of one-step methods on x'' + rate x' + omega^2 x = 0.

The unit is z, the step times the size of the faster eigenvalue: h omega up to critical damping, and close to h rate far
above it. In this unit a limit stays between 1 and 10 at every damping ratio zeta = rate / (2 omega), 0 to infinity.
"""

import functools
import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped

SCAN = 0.002  # step in z while looking for the first crossing: far below any method's limit
FIRST = SCAN * np.arange(1, 2001)  # the first four units of z, scanned in one go: most methods have their limit there
FURTHEST = 64.0
PARTS, REFINEMENTS = 64, 4  # of a step in which the crossing lies: one evaluation of 64 costs hardly more than of one
SLACK = 1e-9  # growth above 1 that is taken for round-off


def fastest(omega: float, rate: float) -> float:
    """Size of the faster eigenvalue [1/s] of x'' + rate x' + omega^2 x = 0."""
    half = 0.5 * rate
    if half <= omega:
        return omega
    return half + math.sqrt((half - omega) * (half + omega)) if half < math.inf else math.inf


def eigenvalues(zeta: float) -> tuple[complex, complex]:
    """The two eigenvalues of the oscillator over the size of the faster one, which is the first; zeta may be inf."""
    if zeta < 1.0:
        first = complex(-zeta, math.sqrt(1.0 - zeta * zeta))
        return first, first.conjugate()
    return -1.0 + 0j, -1.0 / fastest(1.0, 2.0 * zeta) ** 2 + 0j


def exponents(omega: NDArray[np.float64], rate: NDArray[np.float64]) -> NDArray[np.complex128]:
    """The two eigenvalues [1/s] of x'' + rate x' + omega^2 x = 0, (2, ...): the faster one first."""
    half = 0.5 * rate
    root = np.sqrt((half - omega) * (half + omega) + 0j)
    fast = -half - root
    # Their product is omega^2: the difference of two large numbers would lose the slow one.
    return np.array(
        [fast, np.divide(np.square(omega), fast, out=np.zeros_like(fast), where=fast != 0.0)], np.complex128
    )


Changes: TypeAlias = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]], NDArray[np.complex128]]


def changes_of_function(function: Callable[[NDArray[np.complex128]], NDArray[np.complex128]]) -> Changes:
    """`changes` of a one-step method: function(s) is its R(s) - 1, s the step times an eigenvalue."""
    return lambda omega, rate, h: function(h * exponents(omega, rate))


def changes_of_polynomial(coefficients: tuple[float, ...]) -> Changes:
    """`changes` of an explicit Runge-Kutta method with R(s) = sum c_i s^i, c_0 = 1."""
    return changes_of_function(lambda s: s * np.polynomial.polynomial.polyval(s, coefficients[1:]))


def changes_of_matrix(trace: NDArray[np.float64], determinant: NDArray[np.float64]) -> NDArray[np.complex128]:
    """`changes` of a method, from trace and determinant of A - I."""
    half = 0.5 * trace
    root = np.sqrt(half * half - determinant + 0j)
    large = half + np.where(half < 0.0, -root, root)
    # Their product is the determinant: the difference of two near numbers would lose the small one.
    return np.array(
        [large, np.divide(determinant + 0j, large, out=np.zeros_like(large), where=large != 0.0)], np.complex128
    )


def changes_of_nystroem(
    step: tuple[Any, Any, Any], omega: NDArray[np.float64], rate: NDArray[np.float64], h: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """`changes` of an explicit Nystroem method. step: the first arguments of `nystroem_growth`."""
    c, velocity, position = step
    square, damping = (h * omega) ** 2, h * rate
    ends = []
    for x, v in ((1.0, 0.0), (0.0, 1.0)):
        k = np.zeros((len(c), *square.shape))
        for i, time in enumerate(c):
            xs = x + time * v + np.tensordot(position[i], k, 1)
            k[i] = -square * xs - damping * (v + np.tensordot(velocity[i], k, 1))
        ends.append((v + np.tensordot(position[-1], k, 1), np.tensordot(velocity[-1], k, 1)))
    (a, b), (c0, d) = ends
    return changes_of_matrix(a + d, a * d - b * c0)


def stable_step_of(limit: Callable[[float], float], omega: float, rate: float) -> float:
    """Largest stable step [s] of a method, from limit(zeta), its step times `fastest`; inf if nothing moves."""
    size = fastest(omega, rate)
    if size == 0.0:
        return math.inf
    return limit(0.5 * rate / omega if omega > 0.0 else math.inf) / size


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
    """Largest stable z of an explicit Runge-Kutta method with R(s) = sum c_i s^i.

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


def stable_step_of_polynomial(coefficients: tuple[float, ...], omega: float, rate: float) -> float:
    """Largest stable step [s] of an explicit Runge-Kutta method, see `limit_of_polynomial`."""
    return stable_step_of(functools.partial(limit_of_polynomial, coefficients), omega, rate)


def stable_step_of_nystroem(step: tuple[Any, Any, Any], omega: float, rate: float) -> float:
    """Largest stable step [s] of an explicit Nystroem method. step: the first arguments of `nystroem_growth`."""
    return stable_step_of(lambda zeta: limit_of(nystroem_growth(*step, zeta)), omega, rate)


def nystroem_growth(c: Any, velocity: Any, position: Any, zeta: float) -> Callable[[Any], Any]:
    """Largest eigenvalue of a step of an explicit Nystroem method, as a function of z.

    c: (stages,) times; velocity, position: (stages + 1, stages) weights of the stages, and of the new state last. The
    step matrix's entries are polynomials in z, found once: a stage adds two powers.
    """
    first, second = eigenvalues(zeta)
    rate, square = -(first + second).real, (first * second).real
    one = np.zeros(2 * len(c) + 3)
    one[0] = 1.0
    entries = []
    for x, v in ((one, 0.0 * one), (0.0 * one, one)):
        k = np.zeros((len(c), len(one)))
        for i, time in enumerate(c):
            xs = x + time * times_z(v) + times_z(times_z(position[i] @ k))
            k[i] = -square * xs - rate * (v + times_z(velocity[i] @ k))
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
