"""Bound waves of a pair of free waves, second order, against their closed form."""

import math

import numpy as np
import pytest

from sim.ocean.nonlinear import NonlinearSea
from tests.naive_waves import second_order_pair

GRAVITY, LENGTH, SIZE = 9.81, 100.0, 24
STEEPNESS = 0.005  # of each wave


def test_the_closed_form_of_waves_along_one_line():
    """On deep water (k1 + k2)/2 and -(k1 - k2)/2 for k1 > k2, and k/2 of a wave with itself (Stokes)."""
    assert second_order_pair((1.0, 0.0), (0.5, 0.0), math.inf, GRAVITY, 1) == pytest.approx(0.75)
    assert second_order_pair((1.0, 0.0), (0.5, 0.0), math.inf, GRAVITY, -1) == pytest.approx(-0.25)
    kd = 1.2
    # Stokes: a^2 k/4 cosh(kd) (2 + cosh 2kd)/sinh^3(kd), here for twice the product of two halves of the wave
    stokes = math.cosh(kd) * (2.0 + math.cosh(2.0 * kd)) / (4.0 * math.sinh(kd) ** 3)
    assert second_order_pair((1.0, 0.0), (1.0, 0.0), kd, GRAVITY, 1) == pytest.approx(2.0 * stokes)


@pytest.mark.parametrize("depth", [math.inf, 8.0])
@pytest.mark.parametrize("pair", [((5, 0), (3, 0)), ((3, 0), (2, 2)), ((3, 1), (0, 3)), ((3, 0), (-3, 1))])
def test_the_fade_in_brings_the_bound_waves(pair, depth):
    """Two free waves start alone; their sum and difference appear while the nonlinear terms are faded in."""
    grid = np.stack(np.meshgrid(*2 * [np.arange(SIZE) * LENGTH / SIZE], indexing="ij"))
    k = np.array(pair) * 2.0 * math.pi / LENGTH
    eta, potential = np.zeros((2, SIZE, SIZE))
    for wave, phase in zip(k, (0.3, 1.1), strict=True):
        size = math.hypot(*wave)
        omega = math.sqrt(GRAVITY * size * math.tanh(min(size * depth, 100.0)))
        theta = np.tensordot(wave, grid, 1) + phase
        eta += STEEPNESS / size * np.cos(theta)
        potential += STEEPNESS / size * GRAVITY / omega * np.sin(theta)
    sea = NonlinearSea(
        length=LENGTH, order=2, depth=depth, start=(eta, potential), fade=80.0, breaking=False, step=0.25
    )
    sea.advance(200.0)
    h = np.fft.fft2(sea.height) / SIZE**2
    first, second = (h[wave] for wave in pair)
    for sign, partner in ((1, second), (-1, np.conj(second))):
        bound = h[tuple(np.add(pair[0], sign * np.array(pair[1])))]
        wanted = second_order_pair(*k, depth, GRAVITY, sign)
        assert bound / (2.0 * first * partner) == pytest.approx(wanted, rel=0.01)
