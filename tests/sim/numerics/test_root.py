"""The bracketed search: against closed forms, for functions that are smooth, jump, or tell only their sign."""

import math

import numpy as np
import pytest

from sim.numerics.root import narrowed


def counted(value_at):
    """The function, and the list of the places where it was evaluated: each inside the bracket that is known by then.

    It fails after 400 of them.
    """
    places, low, high = [], -math.inf, math.inf

    def asked(x):
        nonlocal low, high
        assert low < x < high
        places.append(x)
        assert len(places) < 400
        found = value_at(x)
        low, high = (x, high) if (found[0] if isinstance(found, tuple) else found) < 0.0 else (low, x)
        return found

    return asked, places


CASES = [
    (lambda x: (x**3 - 2.0, 3.0 * x**2), 0.0, 8.0, 2.0 ** (1 / 3), 14),
    (lambda x: (math.exp(x) - 1e-3, math.exp(x)), -50.0, 3.0, math.log(1e-3), 20),
    (lambda x: (math.atan(x - 3.0), 1.0 / (1.0 + (x - 3.0) ** 2)), -1e3, 1e4, 3.0, 25),
    (lambda x: ((x - 1.0) ** 3, 3.0 * (x - 1.0) ** 2), 0.0, 3.0, 1.0, 110),  # a triple root
]


@pytest.mark.parametrize(("value_at", "low", "high", "root", "most"), CASES)
@pytest.mark.parametrize("has_slope", [True, False])
def test_a_smooth_root_is_found_to_rounding_in_few_steps(value_at, low, high, root, most, has_slope):
    asked, places = counted(value_at if has_slope else lambda x: value_at(x)[0])
    a, b = narrowed(asked, low, high, has_slope=has_slope)
    assert a <= b <= a + 8e-16 * 2 * abs(root)
    assert a == pytest.approx(root, rel=2e-15)
    assert len(places) <= most
    assert value_at(a)[0] < 0.0 <= value_at(b)[0]


def test_a_function_that_tells_only_its_sign_is_halved():
    asked, places = counted(lambda x: 1.0 if x >= 0.3 else -1.0)
    a, b = narrowed(asked, 0.0, 1.0, 1e-3)
    assert a < 0.3 <= b <= a + 1e-3
    assert len(places) <= 11


def test_a_jump_is_enclosed_although_the_value_beside_it_is_small():
    a, b = narrowed(lambda x: -5.0 if x < 0.7 else 1e-9 * (x - 0.7) + 1e-12, 0.0, 1.0, 1e-6)
    assert a < 0.7 <= b <= a + 1e-6


def test_a_step_of_almost_nothing_far_from_the_root_does_not_make_the_search_creep():
    asked, places = counted(lambda x: (-1.0 if x < 0.3 else -1e-300 if x < 0.7 else 1.0, 1.0))
    a, b = narrowed(asked, 0.0, 1.0, has_slope=True)
    assert a < 0.7 <= b == pytest.approx(0.7, rel=1e-15)
    assert len(places) < 250


@pytest.mark.parametrize("factor", [0.1, 0.3, 0.51, 0.7, 3.0])
def test_a_wrong_slope_leads_to_no_place_outside_the_bracket(factor):
    for low, high in ((0.0, 3.0), (-1.0, 1.1), (0.9, 40.0)):
        asked, _ = counted(lambda x: (x - 1.0, factor))
        assert narrowed(asked, low, high, has_slope=True)[1] == pytest.approx(1.0, rel=1e-15)


def test_infinite_values_and_a_flat_part_do_no_harm():
    asked, places = counted(lambda x: -math.inf if x < 1.0 else math.inf if x > 2.0 else x - 1.5)
    a, b = narrowed(asked, 0.0, 9.0)
    assert len(places) < 20
    assert a < 1.5 <= b == pytest.approx(1.5, rel=1e-15)
    a, b = narrowed(lambda x: (min(x - 0.25, 0.0), 1.0 if x < 0.25 else 0.0), 0.0, 1.0, has_slope=True)
    assert a < 0.25 <= b == pytest.approx(0.25, rel=1e-15)  # the smallest of many roots


def test_a_value_of_one_sign_leads_to_an_end():
    assert narrowed(lambda x: 1.0 + x, 1.0, 2.0)[1] == pytest.approx(1.0, rel=1e-15)
    assert narrowed(lambda x: -1.0 - x, 1.0, 2.0)[0] == pytest.approx(2.0, rel=1e-15)


def test_many_searches_at_once_are_those_of_each():
    squares = np.array([2.0, 3.0, 1e-12, 900.0])
    _, b = narrowed(lambda x: x * x - squares, np.zeros(4), np.full(4, 1e3))
    assert np.allclose(b, np.sqrt(squares), rtol=2e-15, atol=0.0)
    single = [narrowed(lambda x, s=s: x * x - s, 0.0, 1e3)[1] for s in squares]
    assert np.allclose(b, single, rtol=2e-15, atol=0.0)


def test_round_off_about_the_root_does_not_make_the_search_creep():
    def rough(x):
        return (x - 1.0) ** 3 + 1e-13 * math.sin(1e9 * x), 3.0 * (x - 1.0) ** 2 + 1e-9

    for has_slope in (True, False):
        asked, places = counted(rough if has_slope else lambda x: rough(x)[0])
        a, b = narrowed(asked, 0.0, 3.0, has_slope=has_slope)
        assert rough(a)[0] < 0.0 <= rough(b)[0]
        assert a == pytest.approx(1.0, abs=1e-4)
        assert len(places) <= 150


@pytest.mark.parametrize(("low", "high"), [(-1.0, 1.0), (-3.0, 1.0), (0.0, 1.0), (-1.0, 0.0)])
@pytest.mark.parametrize("root", [0.0, 1e-320, -1e-320])
def test_a_search_about_0_ends(low: float, high: float, root: float) -> None:
    evaluations = 0

    def value(x: float) -> float:
        nonlocal evaluations
        evaluations += 1
        assert evaluations < 3000
        return x - root

    a, b = narrowed(value, low, high)
    assert a <= max(root, low)
    assert b >= min(root, high)
    assert b - a <= 1e-300
