"""Second-order cones by their definitions, and the way to rest: from anywhere to one state."""

import itertools
import math

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System
from sim.mooring.rest.chains import Chains
from sim.mooring.rest.cones import (
    MIRROR,
    UNIT,
    Scaling,
    determinant,
    longest_above_zero,
    longest_in_cones,
    product,
    quotient,
)
from sim.mooring.rest.interior import InteriorState, along_central_path
from sim.mooring.rest.statics import straight
from sim.water import Water
from tests.sim.mooring.systems import floating_body


def inside(rng: np.random.Generator, count: int) -> np.ndarray:
    """Rows inside the cones, some of them next to the edge."""
    u = rng.normal(size=(count, 4))
    u[:, 0] = np.linalg.norm(u[:, 1:], axis=1) * (1.0 + 10.0 ** rng.uniform(-6.0, 0.0, count))
    return u


def test_the_scaling_maps_both_of_a_pair_to_one_vector():
    rng = np.random.default_rng(1)
    s, z = inside(rng, 50), inside(rng, 50)
    scaling = Scaling(s, z)
    np.testing.assert_allclose(scaling.times(z), scaling.over(s), rtol=1e-5, atol=1e-7 * np.abs(s).max())
    u = rng.normal(size=(50, 4))
    twice = scaling.beta[:, None] ** 2 * (2.0 * scaling.w * np.einsum("ij,ij->i", scaling.w, u)[:, None] - MIRROR * u)
    np.testing.assert_allclose(scaling.times(scaling.times(u)), twice, rtol=1e-6, atol=1e-9 * np.abs(twice).max())
    np.testing.assert_allclose(scaling.over(scaling.times(u)), u, atol=1e-6)


def test_the_algebra_of_the_cones():
    rng = np.random.default_rng(2)
    u, v = rng.normal(size=(2, 20, 4))
    np.testing.assert_allclose(product(u, np.broadcast_to(UNIT, u.shape)), u)
    np.testing.assert_allclose(product(u, v), product(v, u))
    np.testing.assert_allclose(quotient(product(u, v), u), v, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(determinant(u), u[:, 0] ** 2 - (u[:, 1:] ** 2).sum(axis=1))


def test_the_longest_step_ends_on_the_nearest_bound():
    rng = np.random.default_rng(3)
    ends = []
    for u, d in zip(inside(rng, 200), rng.normal(size=(200, 4)), strict=True):
        longest = longest_in_cones(u[None], d[None])
        ends.append(longest)
        far = min(longest, 1e6)
        shares = np.linspace(0.0, far, 50)[:-1, None]
        on_the_way = u + shares * d
        assert (on_the_way[:, 0] > np.linalg.norm(on_the_way[:, 1:], axis=1)).all()
        if math.isfinite(longest):
            beyond = u + (1.0 + 1e-6) * longest * d
            assert beyond[0] < np.linalg.norm(beyond[1:]) * (1.0 + 1e-12)
    assert 0 < np.isinf(ends).sum() < 100
    assert longest_above_zero(np.array([1.0, 2.0, 3.0]), np.array([-4.0, 1.0, -1.0])) == 0.25
    assert longest_above_zero(np.array([1.0]), np.array([2.0])) == math.inf


def test_a_step_ends_at_the_nearest_bound_of_all_numbers_and_none_may_be_on_it():
    cone, ray = np.array([[2.0, 1.0, 0.0, 0.0]]), np.array([1.0])
    state = InteriorState(cone, cone, *(ray for _ in range(6)))
    assert state.is_inside()
    still = InteriorState(*(0.0 * value for value in state))
    assert state.longest(still) == 1.0
    for i, value in enumerate(state):
        change = -2.0 * value
        step = InteriorState(*(change if j == i else one for j, one in enumerate(still)))
        assert state.longest(step) == pytest.approx(0.5)
        for fraction, inside in ((0.5 - 1e-9, True), (0.5, False), (0.6, False)):
            assert state.plus(step, fraction).is_inside() is inside
    # The first number of a cone is positive, too: the negative of a cone's inside is none.
    assert not InteriorState(-cone, cone, *state[2:]).is_inside()


@pytest.mark.parametrize("length", [30.0, 45.0, 90.0])
def test_one_state_is_found_from_any_start(length):
    """A free point that floats, a body and lines that are stretched, hang or lie slack."""
    kind = LineType("line", 0.05, 8.0, 1e7)
    points = (
        Point(1, "fixed", (-25.0, 0.0, -20.0)), Point(2, "free", (-10.0, 0.0, -5.0), mass=50.0, volume=0.5),
        Point(3, "body", (0.0, 0.0, -1.0), body=1), Point(4, "fixed", (20.0, 15.0, -20.0)),
    )  # fmt: skip
    lines = (
        Line(1, kind, 1, 2, 0.5 * length, 8),
        Line(2, kind, 2, 3, 0.5 * length, 8),
        Line(3, kind, 4, 3, length, 12),
    )
    system = System(lines, points, Water(20.0), bodies=(floating_body(10.0),))
    p = system.kernel_view(1.0)
    rng, found = np.random.default_rng(5), []
    for spread in (0.0, 5.0, 500.0):
        start = straight(system)
        start[:, 4 : p.nodes] += spread * rng.normal(size=(3, p.nodes - 4))
        path = itertools.islice(along_central_path(p, Chains(system, p), start), 30)
        found.append(next(near for near in path if near.gap < 1e-10))
    expected = system.at_rest()
    tension = np.concatenate([expected.tension[line.id] for line in lines])
    for near in found:
        assert near.tension == pytest.approx(tension, abs=1e-4 * tension.max())
        assert near.x[2, 1] == pytest.approx(expected.nodes[2, 1], abs=1e-3)  # the float, which slack lines let drift
