"""Waves longer than in a hull's table: the body moves with the water and follows its slope."""

import math

import numpy as np
import pytest

from sim.floating import Body, Hull, MotionCoefficients, float_in, response_amplitude
from sim.floating.linear.hydrodynamics import haskind, linear_hull
from sim.floating.statics.equilibrium import upright
from sim.mooring.moored import moored
from sim.ocean.radial.radial import RadialSea
from sim.water import Water
from sim.waves import Waves

SEA = 1025.0  # [kg/m3]
# Boxes of edges x, y, z [m], density over that of the water, heading [rad], and yaw over k in waves of half the first
# frequency of the table, by Capytaine 3.0.0 with about 500 panels that are symmetric.
BOXES = (
    (49.73, 13.4, 4.86, 0.63, 2.16, 0.4187), (4.19, 1.48, 0.89, 0.44, 0.76, -0.4195),
    (4.98, 20.07, 2.34, 0.47, 0.58, 0.4219), (54.31, 12.76, 4.2, 0.61, -2.12, -0.4128),
    (3.12, 1.01, 0.7, 0.37, 2.65, 0.3602), (1.05, 4.16, 0.79, 0.39, -2.09, 0.3975),
    (36.46, 22.82, 15.86, 0.7, -2.59, -0.2367), (10.18, 4.43, 2.9, 0.65, -1.1, 0.3120),
    (1.96, 3.83, 1.42, 0.61, 2.24, -0.3317), (9.79, 2.38, 0.87, 0.65, -0.8, 0.4623),
    (5.45, 1.39, 0.92, 0.32, -1.53, 0.0373), (29.93, 43.62, 19.79, 0.42, -0.66, -0.2065),
)  # fmt: skip


def boat(length: float, lean: float) -> Hull:
    """A hull without a table of its own: a deck that points ahead, over a keel that is moved by `lean` of its width."""
    deck = np.array([(-3.0, -1.0, 0.8), (-3.0, 1.0, 0.8), (1.0, 1.0, 0.8), (3.0, 0.0, 0.8), (1.0, -1.0, 0.8)])
    keel = deck * [0.9, 0.8, 0.0] + [0.1, lean, 0.0]
    faces = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (5, 6, 7), (5, 7, 8), (5, 8, 9)]
    for i in range(5):
        j = (i + 1) % 5
        faces += [(i, j, i + 5), (j, j + 5, i + 5)]
    return Hull.from_arrays(np.concatenate([deck, keel]) * length / 6.0, np.array(faces))


def over_buoyancy(hull: Hull, ratio: float, low: float) -> Body:
    """A body upright: its centre of gravity over that of buoyancy, `low` of the draft under the water's level."""
    body = Body(hull, density=ratio * SEA)
    draft = body.draft()
    centre = hull.centre + upright(hull, draft).centre
    level = float(hull.centre[2] + hull.extents[2, 0]) + (1.0 - low) * draft
    return Body(hull, mass=ratio * SEA * hull.volume, center_of_gravity=(centre[0], centre[1], level))


def twenty() -> list[tuple[Body, float]]:
    """Random bodies and headings: boxes, cylinders, balls, and hulls without symmetry, with a load of their own."""
    rng = np.random.default_rng(41)
    hulls = [(Hull.box(x, y, z), ratio, heading) for x, y, z, ratio, heading, _ in BOXES[:9]]
    for _ in range(4):
        radius = rng.uniform(0.5, 8.0)
        hulls.append((Hull.cylinder(radius, radius * rng.uniform(0.4, 1.0)), rng.uniform(0.3, 0.7), rng.uniform(-3, 3)))
    hulls += [(Hull.sphere(rng.uniform(0.3, 5.0)), rng.uniform(0.3, 0.7), rng.uniform(-3, 3)) for _ in range(2)]
    hulls += [
        (boat(rng.uniform(2.0, 40.0), rng.uniform(-0.1, 0.1)), rng.uniform(0.3, 0.7), rng.uniform(-3, 3))
        for _ in range(5)
    ]
    return [(over_buoyancy(hull, ratio, rng.uniform(0.1, 0.6)), heading) for hull, ratio, heading in hulls]


def first_frequency(body: Body, gravity: float = 9.81) -> float:
    """The first frequency of the body's table [rad/s]."""
    return float(linear_hull(body.loaded()[0], body.draft()).frequency[0]) * math.sqrt(gravity)


def with_the_water(k: float, heading: float) -> np.ndarray:
    """Motion (5,) of a body much shorter than the wave: surge to pitch."""
    c, s = math.cos(heading), math.sin(heading)
    return np.array([1j * c, 1j * s, 1.0, 1j * k * s, -1j * k * c])


def assert_moves_with_the_water(found: np.ndarray, k: float, heading: float, within: float) -> None:
    scale = np.array([1.0, 1.0, 1.0, k, k])
    np.testing.assert_allclose(found[:5] / scale, with_the_water(k, heading) / scale, atol=within)


@pytest.mark.parametrize("number", range(20))
def test_a_body_moves_with_long_waves(number: int) -> None:
    """2 % at a tenth of the table's first frequency; far below it the meshes of round hulls are off by 2e-5."""
    body, heading = twenty()[number]
    w = first_frequency(body) * np.array([0.1, 1e-3, 1e-6])
    for one, found, within in zip(w, response_amplitude(body, w, heading), (0.02, 1e-4, 1e-4), strict=True):
        k = one**2 / 9.81
        if one == w[2]:  # a slope of 1e-14 is lost in round-off, the way of the water is not
            assert found[:3] == pytest.approx(with_the_water(k, heading)[:3], abs=within)
        else:
            assert_moves_with_the_water(found, k, heading, within)


@pytest.mark.parametrize(("x", "y", "z", "ratio", "heading", "known"), BOXES)
def test_yaw_in_long_waves_is_capytaines(x, y, z, ratio, heading, known) -> None:
    """5 % in waves of half the first frequency; it grows as k, and so do a tenth and a hundredth."""
    body = Body(Hull.box(x, y, z), density=ratio * SEA)
    w = first_frequency(body) * np.array([0.5, 0.1, 0.01])
    yaw = response_amplitude(body, w, heading)[:, 5] * 9.81 / w**2
    assert yaw == pytest.approx(np.full(3, known), rel=0.05)


def test_a_body_on_another_planet_and_in_two_fluids_moves_with_long_waves() -> None:
    body, heading = twenty()[1]
    w = 0.1 * first_frequency(body, 3.71)
    found = response_amplitude(body, [w], heading, [(870.0, 0.1), (SEA, math.inf)], Water(gravity=3.71))[0]
    assert_moves_with_the_water(found, w**2 / 3.71, heading, 0.02)


def test_waves_push_a_moored_body_as_its_own_mass_is_pushed() -> None:
    """The force per metre of a long wave is (M + A) times the acceleration of the water, and C times its slope."""
    body, _ = twenty()[0]
    w = 0.1 * first_frequency(body)
    k, heading = w * w / 9.81, 0.7
    one = np.ones(1)
    waves = Waves(k * math.cos(heading) * one, k * math.sin(heading) * one, one, 0.0 * one, w * one, Water(density=SEA))
    own = moored(1, body, w, waves)
    motion = np.append(with_the_water(k, heading), 0.0)
    wanted = own.stiffness @ motion - w * w * own.mass @ motion
    assert own.excitation is not None
    np.testing.assert_allclose(own.excitation[0, :3], wanted[:3], rtol=0.02)
    np.testing.assert_allclose(own.excitation[0, 3:5], wanted[3:5], rtol=0.02)


def test_the_damping_below_the_table_is_that_of_the_waves_and_fades() -> None:
    """Surge makes waves as k, heave as 1: their damping falls as w^7 and w^3, and yaw's, as k^2, as w^11."""
    linear = linear_hull(Hull.box(4.0, 1.0, 0.7), 0.35)
    first = float(linear.frequency[0])
    at_first, below = linear.at(first)[1], linear.at(first / 10.0)[1]
    for motion, power in ((0, 7), (1, 7), (2, 3), (5, 11)):
        assert below[motion, motion] == pytest.approx(at_first[motion, motion] / 10.0**power, rel=0.1)
    some = [0, 1, 2, 4, 5]  # this box hardly makes waves by roll
    at_first = np.diag(haskind(linear.excitation[0], first**2, math.inf))[some]
    assert at_first == pytest.approx(np.diag(linear.damping[0])[some], rel=0.1)


def test_between_the_first_frequencies_of_a_table_forces_are_those_of_one_with_more() -> None:
    """A table without its second frequency finds that again: to 1 % of the greatest, yaw to 0.5, small roll to 6 %."""
    linear = linear_hull(Hull.box(4.0, 1.0, 0.7), 0.35)
    keep = np.arange(len(linear.frequency)) != 1
    fewer = linear._replace(
        frequency=linear.frequency[keep], added_mass=linear.added_mass[keep], damping=linear.damping[keep],
        excitation=linear.excitation[keep],
    )  # fmt: skip
    k = linear.frequency[1:2] ** 2
    found, known = fewer.around(k)[0], linear.excitation[1]
    for motion in range(6):
        greatest = np.abs(known[:, motion]).max()
        within = {3: 0.06, 5: 0.005}.get(motion, 0.01) * greatest
        np.testing.assert_allclose(found[:, motion], known[:, motion], atol=within)


def steady(body: Body, w: float, heading: float, periods: int = 5, skipped: int = 2) -> np.ndarray:
    """Motion (6,) for 1 m of a regular wave of w [rad/s] that `float_in` finds, about its slow drift."""
    one, k, height = np.ones(1), w * w / 9.81, 1e-3
    sea = RadialSea(Waves(k * math.cos(heading) * one, k * math.sin(heading) * one, height * one, 0.0 * one))
    run = float_in(
        sea, [body], periods * 2.0 * math.pi / w, periods * 40 + 1, coefficients=MotionCoefficients(quadratic_drag=0.0)
    )
    last = slice(skipped * 40, None)
    t = run.t[last]
    columns = np.column_stack([np.cos(w * t), np.sin(w * t), np.ones(len(t)), t])
    path = np.column_stack([run.x[last, 0], 2.0 * run.rotation[last, 0, 1:]])
    fit = np.linalg.lstsq(columns, path, rcond=None)[0]
    return (fit[0] + 1j * fit[1]) / height


@pytest.mark.long
@pytest.mark.parametrize("number", [1, *(pytest.param(number, marks=pytest.mark.stress) for number in (2, 9, 17))])
def test_in_time_a_body_moves_with_long_waves_too(number: int) -> None:
    body, heading = twenty()[number]
    body = body.afloat()
    w = 0.2 * first_frequency(body)
    found = steady(body, w, heading)
    assert_moves_with_the_water(found, w**2 / 9.81, heading, 0.02)
    if number < 9:
        yaw = response_amplitude(body, [w], heading)[0, 5]
        assert found[5] == pytest.approx(yaw, rel=0.05)
