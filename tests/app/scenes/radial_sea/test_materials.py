"""Where the radial sea's bodies and the rig stand in the drawn water."""

import dataclasses
import math

import numpy as np
import pytest

from app.render.material import MAX_WATERLINES, Waterline, waterline_table
from app.scenes import scene_named
from app.scenes.radial_sea.drawing.materials import waterlines_of
from app.scenes.radial_sea.oil.well_blowout import RIG


def frame_of(**values: object):
    kind = scene_named("radial_sea")
    return kind.make(dataclasses.replace(kind.params(), **values)).frame()


def test_legs_and_bodies_stand_where_they_are() -> None:
    frame = frame_of(waves=False)
    lines = waterlines_of(frame)
    legs, bodies, deck = lines[:4], lines[4:-1], lines[-1]
    assert np.mean([leg.centre for leg in legs], axis=0) == pytest.approx(RIG)
    for line, kind, position in zip(bodies, frame.kinds, frame.positions, strict=True):
        assert line.centre == pytest.approx(tuple(position[:2]))
        width = 2.0 * (line.half_sides[0] + line.corner)
        assert width == pytest.approx(float(np.ptp(frame.hulls[kind].extents[0])))
        assert (line.half_sides == (0.0, 0.0)) == (kind != "crate")
        assert line.top == pytest.approx(float(position[2] + frame.hulls[kind].extents[2, 1]), abs=1e-5)
    assert deck.centre == RIG
    assert [line.bottom > 0.0 for line in lines] == [False] * (len(lines) - 1) + [True]


def test_without_a_rig_only_bodies_stand_in_the_water() -> None:
    frame = frame_of(rig=False)
    assert len(waterlines_of(frame)) == len(frame.kinds)


def test_a_turned_body_has_a_turned_waterline() -> None:
    frame = frame_of(waves=False)
    angle = 0.7
    turned = np.tile(np.array([math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)], np.float32), (len(frame.kinds), 1))
    assert waterlines_of(frame._replace(rotations=turned))[4].heading == pytest.approx(angle)


def test_a_crowd_has_as_many_waterlines_as_the_shader_takes() -> None:
    frame = frame_of(bodies=30)
    assert len(waterlines_of(frame)) == MAX_WATERLINES
    with pytest.raises(ValueError, match="waterlines"):
        waterline_table([Waterline((0.0, 0.0), 0.0, (0.0, 0.0), 1.0)] * (MAX_WATERLINES + 1))


def test_an_empty_place_has_no_corner() -> None:
    table = waterline_table([Waterline((1.0, 2.0), 0.5, (3.0, 4.0), 5.0, 7.0, 6.0, (1.0, 0.0, 1.0))])
    cosine, sine = 0.8775826, 0.4794255
    assert table[:4].ravel() == pytest.approx([1.0, 2.0, cosine, sine, 3.0, 4.0, 5.0, 7.0, 1.0, 0.0, 1.0, 6.0])
    assert not table[4:].any()
