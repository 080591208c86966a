"""Linear stability of one-step methods on x'' + 2 zeta omega x' + omega^2 x = 0, in units of z = h omega."""

import cmath
from collections.abc import Callable

SCAN = 0.002  # step in z while looking for the first crossing: far below any method's limit
FURTHEST = 64.0


def eigenvalues(zeta: float) -> tuple[complex, complex]:
    """s / omega of the oscillator: -zeta +- sqrt(zeta^2 - 1)."""
    root = cmath.sqrt(zeta * zeta - 1.0)
    return -zeta + root, -zeta - root


def limit_of(growth: Callable[[float], float], slack: float = 1e-9) -> float:
    """The first z at which growth(z) leaves 1, to 1e-9; inf where it never does below 64."""
    low = SCAN
    while growth(low) <= 1.0 + slack:
        low += SCAN
        if low > FURTHEST:
            return float("inf")
    high, low = low, low - SCAN
    for _ in range(24):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if growth(middle) <= 1.0 + slack else (low, middle)
    return low


def limit_of_polynomial(coefficients: tuple[float, ...], zeta: float) -> float:
    """Largest stable z of a Runge-Kutta method with R(s) = sum c_i s^i."""

    def growth(z: float) -> float:
        largest = 0.0
        for s in eigenvalues(zeta):
            r = 0j
            for c in reversed(coefficients):
                r = r * (z * s) + c
            largest = max(largest, abs(r))
        return largest

    return limit_of(growth)
