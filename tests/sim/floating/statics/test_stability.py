"""Loaded bodies at rest and heeled: closed forms, clipped rectangles, and the pressure on the hull."""

import math
import re
import warnings

import numpy as np
import pytest

from sim.floating import (
    Body,
    Hull,
    MotionCoefficients,
    make_fleet,
    metacentric_height,
    pressure_force,
    response_amplitude,
    righting_arm,
    roll_period,
    step,
    still_water,
)
from sim.floating.motion.rotation import product

LENGTH, WIDTH, HEIGHT, DRAFT = 60.0, 16.0, 6.0, 3.0  # [m]
MASS = 1025.0 * LENGTH * WIDTH * DRAFT
BARGE = Hull.box(LENGTH, WIDTH, HEIGHT)
KG = 4.0  # [m]
SPILL = [(850.0, 1.2), (1025.0, math.inf)]


def barge(kg: float = KG, **more) -> Body:
    return Body(BARGE, mass=MASS, center_of_gravity=(0.0, 0.0, kg - HEIGHT / 2), **more)


def below(points: list[complex], level: float) -> list[complex]:
    """The part of a polygon of complex y + iz under a level."""
    found = []
    for p, q in zip(points, points[1:] + points[:1], strict=True):
        if p.imag <= level:
            found.append(p)
        if (p.imag > level) != (q.imag > level):
            found.append(p + (level - p.imag) / (q.imag - p.imag) * (q - p))
    return found


def area_and_centre(points: list[complex]) -> tuple[float, complex]:
    area, centre = 0.0, 0j
    for p, q in zip(points, points[1:] + points[:1], strict=True):
        cross = (p.conjugate() * q).imag / 2.0
        area, centre = area + cross, centre + cross * (p + q) / 3.0
    return area, centre / area


def arm_of_a_rectangle(heel: float, kg: float) -> float:
    """GZ of the barge's cross-section, clipped by the waterline that leaves its area wet."""
    corners = [complex(y, z - kg) for y, z in ((-8, 0), (8, 0), (8, 6), (-8, 6))]
    turned = [corner * complex(math.cos(heel), math.sin(heel)) for corner in corners]
    lowest, highest = min(p.imag for p in turned), max(p.imag for p in turned)
    wanted = WIDTH * DRAFT
    low, high = lowest + 1e-3, highest - 1e-3
    for _ in range(60):
        level = (low + high) / 2.0
        low, high = (level, high) if area_and_centre(below(turned, level))[0] < wanted else (low, level)
    return -area_and_centre(below(turned, high))[1].real


def test_gm_and_gz_of_a_box_are_those_of_a_wall_sided_hull():
    """GZ = sin(phi) (GM + BM tan(phi)^2/2) until the deck is wet (Scribanti), here at 20.6 degrees."""
    BM = WIDTH**2 / (12.0 * DRAFT)
    GM = DRAFT / 2.0 + BM - KG
    assert metacentric_height(barge()) == pytest.approx(GM, abs=1e-6)
    assert metacentric_height(barge(), axis=1) == pytest.approx(DRAFT / 2 + LENGTH**2 / (12 * DRAFT) - KG, abs=1e-6)
    heel = np.radians(np.linspace(-20.5, 20.5, 21))
    wanted = np.sin(heel) * (GM + 0.5 * BM * np.tan(heel) ** 2)
    assert righting_arm(barge(), heel) == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("kg", [2.0, 4.0, 9.0])
def test_gz_of_a_box_beyond_its_deck_is_that_of_a_clipped_rectangle(kg):
    heel = np.radians(np.linspace(0.0, 60.0, 25))
    wanted = [arm_of_a_rectangle(one, kg) for one in heel]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore" if kg == 9.0 else "error")
        assert righting_arm(barge(kg), heel) == pytest.approx(wanted, abs=1e-6)


def test_a_body_that_is_top_heavy_has_a_negative_gm():
    assert metacentric_height(barge(9.5)) == pytest.approx(DRAFT / 2 + WIDTH**2 / (12 * DRAFT) - 9.5, abs=1e-6)
    with pytest.warns(UserWarning, match=r"^GM = -0\.889 m"):
        assert righting_arm(barge(9.5), [0.05])[0] < 0.0


def test_gm_in_two_fluids_is_that_of_the_sum_of_both():
    """mass GM = sum of (rho_i - rho_{i-1}) (I + V (z_B - z_G)) over surface and interface."""
    body = barge().afloat(SPILL)
    draft = KG - body.position[2]
    assert 850.0 * 1.2 + 1025.0 * (draft - 1.2) == pytest.approx(1025.0 * DRAFT)
    moment = 0.0
    for change, depth in ((850.0, draft), (175.0, draft - 1.2)):
        moment += change * LENGTH * (WIDTH**3 / 12.0 + WIDTH * depth * (depth / 2.0 - KG))
    assert metacentric_height(body, SPILL) == pytest.approx(moment / MASS, abs=1e-6)


def test_a_uniform_body_is_one_of_the_same_mass_at_its_middle():
    uniform, loaded = Body(BARGE, 512.5), Body(BARGE, mass=MASS, center_of_gravity=(0.0, 0.0, 0.0))
    for body in (uniform, loaded):
        assert body.afloat().position == pytest.approx((0.0, 0.0, 0.0))
        assert metacentric_height(body) == pytest.approx(metacentric_height(uniform))
    fleet = make_fleet([loaded])
    assert fleet.mass[0] == pytest.approx(MASS)
    assert fleet.hulls.inertia[0] == pytest.approx(BARGE.inertia)


@pytest.mark.parametrize("layers", [[(1025.0, math.inf)], SPILL])
def test_a_body_with_trim_is_at_rest(layers):
    """The pressure on the hull carries its weight and turns it no more, and `step` leaves it where it is."""
    body = Body(BARGE, mass=MASS, center_of_gravity=(1.5, -0.4, 0.5), rotation=(0.9, 0.0, 0.0, 0.3)).afloat(layers)
    assert abs(body.rotation[1]) > 0.01
    hull, _ = body.loaded()
    force, moment, top, above = np.zeros(3), np.zeros(3), 0.0, 0.0
    for density, thickness in layers:
        part = pressure_force(hull, body.position, body.rotation, -top, density - above)
        force, moment, top, above = force + part[0], moment + part[1], top + thickness, density
    assert force == pytest.approx([0.0, 0.0, MASS * 9.81], rel=1e-9, abs=1e-3)
    assert np.abs(moment).max() < 1e-8 * MASS * 9.81 * LENGTH
    fleet = make_fleet([body], layers)
    for _ in range(30):
        step(fleet, still_water(fleet, layers), 1 / 30)
    assert fleet.position[0] == pytest.approx(body.position, abs=1e-6)
    assert np.abs(fleet.spin).max() < 1e-8


def test_a_loaded_body_rolls_at_the_period_of_its_inertia():
    """Twice the inertia and a raised centre: the free roll of `step` has the period of the metacentric height."""
    inertia = (MASS * 7.0**2, MASS * 15.0**2, MASS * 15.0**2)
    body = barge(inertia=inertia).afloat()
    period = roll_period(*body.loaded())
    assert period > 1.15 * roll_period(*barge().loaded())
    fleet = make_fleet([body._replace(rotation=(1.0, 1e-3, 0.0, 0.0))])
    heel = []
    for _ in range(int(2.3 * period * 20)):
        step(fleet, still_water(fleet), 1 / 20, MotionCoefficients(quadratic_drag=0.0))
        heel.append(fleet.rotation[0, 1])
    down = np.flatnonzero((np.array(heel[:-1]) > 0.0) & (np.array(heel[1:]) <= 0.0))
    assert (down[1] - down[0]) / 20.0 == pytest.approx(period, rel=0.03)


def test_heel_of_any_shape_and_a_heading_that_does_not_matter():
    turned = barge(rotation=(0.8, 0.0, 0.0, 0.6))
    heel = np.array([[0.1, 0.2], [0.3, -0.4]])
    assert righting_arm(turned, heel) == pytest.approx(righting_arm(barge(), heel), abs=1e-12)
    assert turned.afloat().rotation == pytest.approx((0.8, 0.0, 0.0, 0.6))


def unstable() -> list[Body]:
    """50 bodies that are not stable upright: tall boxes and cylinders with high loads, and uniform logs."""
    rng, found = np.random.default_rng(41), []
    while len(found) < 50:
        x, y, z = np.exp(rng.uniform(math.log(0.5), math.log(60.0), 3))
        hull = Hull.cylinder(y, z) if len(found) % 5 == 4 else Hull.box(x, y, z)
        load = (0.0, 0.0, rng.uniform(-0.2, 0.5) * hull.size[2])
        if len(found) % 2 == 1:
            hull, load = Hull.box(x * y, y, y * rng.uniform(0.8, 1.1)), (0.0, 0.0, 0.0)
        body = Body(hull, mass=rng.uniform(0.1, 0.9) * 1025.0 * hull.volume, center_of_gravity=load)
        if min(metacentric_height(body), metacentric_height(body, axis=1)) < -2e-3 * hull.size.max():
            found.append(body)
    return found


def moved(body: Body, by: float = 1e-6) -> Body:
    """The body with one vertex moved along y [m]: no real mesh is symmetric."""
    points = body.hull.vertices + body.hull.centre
    points[3, 1] += by
    return body._replace(hull=Hull.from_arrays(points, body.hull.faces))


def answers(body: Body) -> tuple[float | str, str]:
    """The tilt [degrees] of rest, or the words of its refusal; and those of the refused response."""
    try:
        rest: float | str = math.degrees(2.0 * math.asin(math.hypot(*body.afloat().rotation[1:3])))
    except ValueError as error:
        rest = str(error)
    with pytest.raises(ValueError, match=r"^body: 'GM = -") as refused:
        response_amplitude(body, [1.0])
    return rest, str(refused.value)


def test_an_unstable_body_is_at_rest_where_it_turns_over_to_or_refused_with_its_gm():
    """And its response is refused, and GZ about the upright position warned of; the same for a mesh that is moved."""
    leaning, refused = 0, 0
    for body in unstable():
        (rest, words), (rest_of_moved, words_of_moved) = answers(body), answers(moved(body))
        assert words == words_of_moved
        if isinstance(rest, str):
            refused += 1
            assert re.match(r"body: 'GM = -\d.* m' is not allowed; allowed: .*stable within 60 degrees", rest)
            assert rest_of_moved == rest
        else:
            leaning += 1
            assert 1.0 < rest < 60.0
            assert rest_of_moved == pytest.approx(rest, abs=0.01)
        with pytest.warns(UserWarning, match=r"^GM = -\d.*: the body is not stable upright"):
            arms = righting_arm(body, [-0.02, 0.02, 0.3])
        with pytest.warns(UserWarning, match="GM"):
            assert righting_arm(moved(body), [-0.02, 0.02, 0.3]) == pytest.approx(arms, abs=1e-3)
    assert leaning >= 10
    assert refused >= 10


def test_a_square_log_of_half_the_density_of_water_floats_on_its_edge():
    """Its diagonal in the water: the rest of a square section at half the density (Gilbert 1991, section 4)."""
    rest = Body(Hull.box(10.0, 1.0, 1.0), density=512.5).afloat()
    assert rest.rotation == pytest.approx((math.cos(math.pi / 8), math.sin(math.pi / 8), 0.0, 0.0), abs=1e-6)
    assert rest.position[2] == pytest.approx(0.0, abs=1e-9)


def test_a_leaning_body_stays_at_rest_in_still_water():
    body = Body(Hull.box(10.0, 1.0, 1.1), density=450.0).afloat()
    assert abs(body.rotation[1]) > 0.3
    fleet = make_fleet([body])
    for _ in range(60):
        step(fleet, still_water(fleet), 1 / 60)
    assert fleet.position[0] == pytest.approx(body.position, abs=1e-6)
    assert fleet.rotation[0] == pytest.approx(body.rotation, abs=1e-6)


def test_a_ball_of_any_mesh_is_neither_stable_nor_unstable_and_floats_upright():
    for frequency in (1, 3, 5):
        for density in (100.0, 300.0, 800.0):
            ball = Body(Hull.sphere(1.0, frequency), density=density)
            assert ball.afloat().rotation == (1.0, 0.0, 0.0, 0.0)
            assert abs(response_amplitude(ball, [0.1])[0, 2]) == pytest.approx(1.0, abs=0.01)


def test_a_stable_mesh_that_is_not_quite_symmetric_has_a_response():
    body, w = Body(Hull.box(8.0, 4.0, 2.0), density=500.0), [0.5, 1.5]
    np.testing.assert_allclose(
        response_amplitude(moved(body), w, 0.3)[:, 2:5], response_amplitude(body, w, 0.3)[:, 2:5], atol=0.02
    )


def test_a_capsized_body_keeps_its_heading_at_rest():
    """Upside down with its x axis along y, it is at rest upright with the x axis along y."""
    half = math.sqrt(0.5)
    inverted = product((half, 0.0, 0.0, half), (0.0, 1.0, 0.0, 0.0))
    rest = barge(rotation=inverted).afloat()
    assert rest.rotation == pytest.approx((half, 0.0, 0.0, half))
