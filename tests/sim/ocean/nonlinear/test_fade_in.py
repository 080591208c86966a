"""The fading in of nonlinear terms against its formula, and without a jump at its end."""

import math

import pytest

from sim.ocean.nonlinear.fade_in import FadeIn


def test_terms_grow_by_the_formula_and_are_whole_from_the_end_on() -> None:
    fade_in = FadeIn(3.0, 2.0)
    for t, share in ((3.0, 0.0), (4.0, 1.0 - math.exp(-1.0 / 16.0)), (5.0, 1.0 - math.exp(-1.0))):
        assert fade_in.factor(t) == pytest.approx(share, rel=1e-12)
    assert [fade_in.factor(t) for t in (math.nextafter(fade_in.end, 0.0), fade_in.end, 1e200)] == [1.0] * 3


def test_without_a_fade_in_terms_act_at_once() -> None:
    assert FadeIn(3.0, 0.0).end == 3.0
    assert FadeIn(3.0, 0.0).factor(3.0) == 1.0
