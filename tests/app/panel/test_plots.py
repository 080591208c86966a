"""The scales of the charts."""

import math

import numpy as np
import pytest

from app.panel.plots import MIN_FILLED, SHOWN_ROWS, at_times, beside, scale_of


@pytest.mark.parametrize(
    ("low", "high"),
    [(0.0, 1.0), (-137.2, 118.4), (0.4371, 0.4379), (-1e-13, 3e-13), (2e7, 9e7), (5.0, 5.0), (0.0, 0.0)],
)
def test_a_scale_holds_its_data_between_round_ticks_with_words_of_their_own(low: float, high: float) -> None:
    scale = scale_of(low, high)
    slack = 1e-6 * scale.step
    assert scale.low <= low + slack
    assert scale.high >= high - slack
    assert 2 <= len(scale.ticks) <= 7
    assert len(set(scale.words)) == len(scale.words)
    mantissa = scale.step / 10.0 ** math.floor(math.log10(scale.step) + 1e-9)
    assert min(abs(mantissa - round_one) for round_one in (1, 2, 2.5, 5, 10)) < 1e-6


def test_a_scale_is_kept_while_the_data_fill_it() -> None:
    scale = scale_of(-1.0, 1.0)
    assert scale.fits(-0.9, 1.0)
    assert not scale.fits(-1.1, 1.0)
    assert not scale.fits(0.0, 0.9 * MIN_FILLED * 2.0)


def test_a_negative_tick_has_a_minus_sign_and_zero_has_none() -> None:
    assert scale_of(-1.0, 1.0).words == ("\N{MINUS SIGN}1.0", "\N{MINUS SIGN}0.5", "0.0", "0.5", "1.0")


def test_kept_curves_stand_at_their_times_beside_those_of_the_next_run() -> None:
    kept = [(0.0, 0.0), (1.0, 2.0), (2.0, math.nan), (3.0, 6.0)]
    now = np.array([(0.5, 1.0), (1.5, 3.0)])
    before = np.array(beside([tuple(row) for row in now.tolist()], kept))
    assert before[:, 0].tolist() == [1.0, 2.0, 3.0]
    times = np.union1d(now[:, 0], before[:, 0])
    assert times.tolist() == [0.5, 1.0, 1.5, 2.0, 3.0]
    np.testing.assert_array_equal(at_times(times, now, 1), [1.0, 2.0, 3.0, math.nan, math.nan])
    np.testing.assert_array_equal(at_times(times, before, 1), [math.nan, 2.0, math.nan, math.nan, 6.0])
    assert beside([], kept) == kept
    assert len(beside([(5e3, 0.0)], [(float(t), 0.0) for t in range(10_000)])) == SHOWN_ROWS
