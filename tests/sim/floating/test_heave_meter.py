"""The heave meter on a sine."""

import math

import numpy as np
import pytest

from sim.floating import HeaveMeter


def test_the_heave_meter_times_a_sine() -> None:
    meter = HeaveMeter(1)
    for i in range(1200):
        meter.update(i / 60, np.array([0.5 + 0.1 * math.sin(2 * math.pi * i / 60 / 1.7)]), 1 / 60)
    assert meter.period(0, 20.0) == pytest.approx(1.7, rel=0.01)
    assert math.isnan(meter.period(0, 100.0))
