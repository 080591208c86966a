"""Arguments that the particles refuse, each by its name."""

import math
from functools import partial

import pytest

from sim.particles.fire import Fire
from sim.particles.jet import Jet
from sim.particles.plume import flame_height, track
from sim.particles.rain import Rain, rainfall, terminal_speed
from tests.refusals import Row, assert_refused, each

NAN, INF = math.nan, math.inf
REFUSED: list[Row] = [
    *each(partial(Fire, (0.0, 0.0, 0.0)), power=[-1.0], count=[0], life=[INF], wind=[(NAN, 0.0)]),
    *each(partial(Jet, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)), flow=[0.0], spread=[-1.0], count=[0], drag_time=[0.0]),
    ("power", lambda: track(-1.0, 4.0, 5.0, 1.0), ""),
    ("diameter", lambda: track(1e6, 0.0, 5.0, 1.0), ""),
    ("wind_speed", lambda: track(1e6, 4.0, -1.0, 1.0), ""),
    ("duration", lambda: track(1e6, 4.0, 5.0, 0.0), ""),
    ("power", lambda: flame_height(-1.0, 1.0), ""),
    ("diameter", lambda: flame_height(1e6, INF), ""),
    *each(partial(Rain, length=50.0, ceiling=20.0), rate=[0.0, NAN]),
    *each(partial(Rain, 10.0, length=50.0, ceiling=20.0), length=[-1.0], ceiling=[INF], count=[0], wind=[(1.0, NAN)]),
    *each(rainfall, rate=[0.0, -1.0, NAN]),
    *each(terminal_speed, diameter=[-0.001]),
    *each(partial(terminal_speed, 0.001), gravity=[-9.0]),
]


@pytest.mark.parametrize(("name", "call", "words"), REFUSED)
def test_a_bad_argument_is_refused_by_name(name, call, words):
    assert_refused(name, call, words)
