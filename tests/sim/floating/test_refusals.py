"""Refusals of the library of floating bodies: the error names the argument, its value and the allowed ones."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from sim.floating import (
    SHAPES,
    Body,
    Fleet,
    Hull,
    MotionCoefficients,
    equilibrium_draft,
    float_in,
    heave_period,
    make_fleet,
    make_water,
    metacentric_height,
    pressure_force,
    pull,
    response_amplitude,
    righting_arm,
    roll_period,
    step,
    still_water,
    submerged,
)
from sim.ocean import Sea
from sim.water import Water
from tests.refusals import Row, assert_refused, each

BOX = Hull.box(1.0, 1.0, 1.0)
CALM = Sea(16, 50.0, wind_speed=0.0)
WATER = [(1025.0, math.inf)]
SPILL = [(850.0, 0.2), (1025.0, math.inf)]
NAN, INF = math.nan, math.inf
HERE = (0.0, 0.0, 0.0)


def cube(size: float, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    return BOX.vertices * size + np.array([x, y, z])


def of_parts(*parts: tuple[np.ndarray, np.ndarray]) -> Hull:
    vertices = np.concatenate([points for points, _ in parts])
    return Hull.from_arrays(vertices, np.concatenate([faces + 8 * i for i, (_, faces) in enumerate(parts)]))


def one() -> Fleet:
    return make_fleet([Body(BOX)])


def step_box(duration=0.01, substeps=None, fleet=None, **coefficients) -> None:
    fleet = fleet or one()
    step(fleet, still_water(one(), WATER), duration, MotionCoefficients(**coefficients), substeps)


def body(**values) -> None:
    make_fleet([Body(**{"hull": BOX, **values})])


def pull_box(body=0, point=HERE, target=HERE, limit=1.0) -> None:
    pull(one(), body, point, target, limit)


def draft(hull=BOX, density=500.0, **values) -> None:
    equilibrium_draft(hull, density, **values)


LAYERS = [
    [], [(850.0, 0.2)], [(850.0, INF), (1025.0, INF)], [(1025.0, 0.2), (850.0, INF)], [(850.0, -0.2), (1025.0, INF)],
    [(NAN, 0.2), (1025.0, INF)], [(850.0, NAN), (1025.0, INF)], [("850", "0.2"), ("1025", "inf")], [(True, INF)],
]  # fmt: skip
LENGTHS = [0.0, -1.0, INF, 1e9]
REFUSED: list[Row] = [
    *each(draft, density=[-5.0, 0.0], gravity=[INF, 0.0], layers=[*LAYERS, 1025.0]),
    *each(partial(heave_period, BOX, 500.0, WATER), added=[-100, NAN]),
    *each(partial(roll_period, BOX, 500.0, WATER), added=[-1], axis=[1.0, True]),
    *each(partial(Hull.box, 1.0, z=1.0), y=LENGTHS),
    *each(Hull.sphere, radius=LENGTHS),
    *each(partial(Hull.cylinder, 1.0), height=LENGTHS),
    *each(partial(Hull.sphere, 1.0), frequency=[True]),
    *each(partial(Hull.of_shape, SHAPES["box"]), size=[True]),
    ("faces", lambda: of_parts((cube(1), BOX.faces), (cube(0.5, 3, 0, 0), BOX.faces[:, ::-1])), "inside out"),
    ("faces", lambda: of_parts((cube(1), BOX.faces), (cube(1, 0.5, 0, 0), BOX.faces)), "overlap"),
    ("faces", lambda: of_parts((cube(1), BOX.faces), (cube(1, 0.9, 0.9, 0.9), BOX.faces)), "overlap"),
    ("faces", lambda: Hull.from_arrays(BOX.vertices, BOX.faces + 0.4), "0.4"),
    ("faces", lambda: Hull.from_arrays(BOX.vertices, np.full((4, 3), "a")), "'a'"),
    *each(partial(pressure_force, BOX), density=[-1, NAN], gravity=[NAN]),
    *each(partial(submerged, BOX), position=["abc", (0, 0, NAN), (0, 0)], rotation=[(0, 0, 0, 0), (1, 0, INF, 0)]),
    *each(partial(submerged, BOX), surface=[NAN, [0.0, 0.0, 0.0]]),
    *each(body, "bodies[0].", density=[-1.0], position=[("a", 0, 0), (0, 0, NAN)]),
    *each(body, "bodies[0].", rotation=[(0, 0, 0, 0)], spin=[(0, 0)]),
    *each(partial(body, mass=500.0), "bodies[0].", density=[500.0]),
    *each(body, "bodies[0].", mass=[0.0, NAN, "1"], center_of_gravity=[(0, 0), (0, 0, NAN), 1.0]),
    *each(body, "bodies[0].", inertia=[(1.0, 2.0), (1.0, 1.0, -1.0), np.ones((3, 3)), "round", (NAN, 1.0, 1.0)]),
    *each(Body(BOX).afloat, layers=LAYERS),
    ("density", lambda: Body(BOX, density=2000.0).afloat(), "at most 1025 kg/m3, or it sinks"),
    ("mass", lambda: Body(BOX, mass=2000.0).afloat(), "at most 1025 kg, or it sinks"),
    ("bodies", lambda: make_fleet(Body(BOX)), "a list of bodies"),
    ("body", lambda: Body(BOX, mass=500.0, center_of_gravity=(0.4, 0.0, 3.0)).afloat(), "60 degrees"),
    *each(partial(metacentric_height, Body(BOX)), axis=[2, True, "roll"]),
    *each(partial(righting_arm, Body(BOX)), heel=[30.0, [0.1, NAN]]),
    *each(partial(response_amplitude, Body(BOX)), frequency=[-1.0, [0.0], [NAN], "fast"]),
    *each(partial(response_amplitude, Body(BOX), [1.0]), heading=[NAN, "ahead"], layers=LAYERS),
    *each(lambda water: response_amplitude(Body(BOX), [1.0], water=water), water=[9.81, NAN]),
    ("water: gravity", lambda: response_amplitude(Body(BOX), [1.0], water=Water(gravity=0.0)), "above 0"),
    ("center_of_gravity", lambda: response_amplitude(Body(BOX, mass=500.0, center_of_gravity=(0.1, 0, -0.4)), [1]), ""),
    *each(partial(float_in, bodies=[], duration=1.0), sea=[None, "calm"]),
    *each(partial(float_in, CALM, []), duration=[0.0, NAN, "1"]),
    *each(partial(float_in, CALM, [], 1.0), frames=[1, 2.5, True]),
    *each(step_box, duration=[True, "a", NAN], substeps=[1.7, True, 0]),
    *each(step_box, gravity=[True, NAN], restitution=["a", 2.0], linear_drag=[-1.0]),
    ("duration", lambda: step_box(1e6), "s for bodies this stiff"),
    ("water", lambda: step_box(fleet=make_fleet([Body(BOX)] * 2)), ""),
    *each(pull_box, body=[0.5, False, 3], limit=["a", True, -1], point=["abc", (0, NAN, 0)]),
    ("level", lambda: still_water(one(), WATER, NAN), "nan"),
    ("layers", lambda: still_water(one(), [(700.0, 0.1), (850.0, 0.2), (1025.0, INF)]), ""),
    *each(partial(make_water, one(), WATER, np.zeros(1)), lead=[NAN], slope=[np.zeros(3)]),
    ("height", lambda: make_water(one(), WATER, np.array(["a"])), "'a'"),
]


@pytest.mark.parametrize(("name", "call", "words"), REFUSED)
def test_a_bad_argument_is_refused_by_name(name: str, call: Callable[[], object], words: str) -> None:
    assert_refused(name, call, words)


def test_what_is_allowed_stays_allowed() -> None:
    """A generator of layers, numpy's whole numbers, parts that touch or are apart, a hollow, a face without area."""
    pairs = (pair for pair in SPILL)
    assert equilibrium_draft(BOX, 500.0, pairs) == equilibrium_draft(BOX, 500.0, SPILL)  # type: ignore[arg-type]
    assert len(Hull.sphere(1.0, np.int64(4)).faces) == 320  # type: ignore[arg-type]
    assert of_parts((cube(1), BOX.faces), (cube(0.5, 3, 0, 0), BOX.faces)).volume == pytest.approx(1.125)
    assert of_parts((cube(1), BOX.faces), (cube(1, 1, 0, 0), BOX.faces)).volume == pytest.approx(2.0)
    assert of_parts((cube(1), BOX.faces), (cube(0.5), BOX.faces[:, ::-1])).volume == pytest.approx(0.875)
    a, b, c = BOX.faces[0]
    split = np.concatenate([BOX.faces[1:], [[a, 8, c], [8, b, c], [a, b, 8]]])  # 8 is on the edge from a to b
    points = np.concatenate([cube(1), [(cube(1)[a] + cube(1)[b]) / 2], cube(0.5, 3, 0, 0)])
    assert Hull.from_arrays(points, np.concatenate([split, BOX.faces + 9])).volume == pytest.approx(1.125)
