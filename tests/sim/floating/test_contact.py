"""Pulls, collisions, and numbers no body should meet."""

import math

import numpy as np
import pytest

from sim.floating import Body, Hull, MotionCoefficients, make_fleet, make_water, pull, step, still_water
from sim.floating.motion.body_collisions import collide
from sim.floating.motion.motion import advance
from tests.naive_floating import quaternion

FRAME_INTERVAL = 1 / 60
WATER = [(1025.0, math.inf)]
SPILL = [(850.0, 0.2), (1025.0, math.inf)]


@pytest.mark.parametrize("density", [10.0, 500.0, 20000.0])
@pytest.mark.parametrize("size", [0.1, 1.0, 10.0])
def test_a_pulled_point_comes_to_its_target_without_overshoot(density, size):
    hull = Hull.box(size, size, size / 2)
    fleet = make_fleet([Body(hull, density)])
    weight = fleet.mass[0] * 9.81 + 1025 * hull.volume * 9.81
    target = np.array([3.0 * size, 0.0, 3.0 * size])
    pull(fleet, 0, (0.0, 0.0, 0.0), target, limit=50 * weight)
    water = still_water(fleet, WATER)
    far = []
    for _ in range(240):
        step(fleet, water, FRAME_INTERVAL)
        far.append(fleet.position[0, 0] - target[0])
    assert abs(far[-1]) < 1e-3 * size
    assert max(far) < 0.02 * size
    hang = 9.81 / MotionCoefficients().pull_rate ** 2  # the spring gives by g/rate^2 under the weight
    assert fleet.position[0, 2] - target[2] == pytest.approx(-hang, rel=0.05, abs=1e-3)


def test_a_pull_at_a_corner_turns_the_body_and_carries_exactly_its_limit_straight_up():
    fleet = make_fleet([Body(Hull.box(1.0, 1.0, 0.4), 500.0)])
    limit = 0.2 * fleet.mass[0] * 9.81
    pull(fleet, 0, (0.5, 0.5, 0.2), (0.5, 0.5, 50.0), limit)
    water = still_water(fleet, WATER)
    carried = []
    for _ in range(1800):
        step(fleet, water, FRAME_INTERVAL)
        carried.append(fleet.mass[0] * 9.81 - fleet.buoyancy[0])
        assert math.hypot(*fleet.position[0, :2]) < 0.5
    assert abs(fleet.rotation[0, 0]) < 0.999
    assert np.mean(carried[-600:]) == pytest.approx(limit, rel=1e-3)
    pull(fleet, 0, (0, 0, 0), (0, 0, 0), 0.0)
    for _ in range(3600):
        step(fleet, water, FRAME_INTERVAL)
    assert fleet.buoyancy[0] == pytest.approx(fleet.mass[0] * 9.81, rel=1e-3)


@pytest.mark.parametrize("seed", range(10))
def test_collisions_keep_momentum_and_make_no_energy(seed):
    """Many hulls thrown at each other: momentum and centre of mass stay, energy does not grow."""
    rng = np.random.default_rng(seed)
    hulls = [Hull.box(1.0, 0.5, 0.7), Hull.sphere(0.5), Hull.cylinder(0.4, 1.0), Hull.sphere(0.3, 2)]
    hulls[3] = Hull.from_arrays(hulls[3].vertices * [2, 1, 1], hulls[3].faces)
    bodies = [
        Body(hulls[i % 4], 10 ** rng.uniform(1, 4), tuple(rng.uniform(-1, 1, 3)), tuple(quaternion(rng)))
        for i in range(20)
    ]
    fleet = make_fleet(bodies)
    fleet.velocity[:] = rng.normal(0, 3, (20, 3))
    m = fleet.mass[:, None]

    def totals():
        push = (m * fleet.velocity).sum(axis=0)
        centre = (m * fleet.position).sum(axis=0) / m.sum()
        return push, centre, (m * fleet.velocity**2).sum() / 2

    before = totals()
    touched = collide(fleet, 0.5)
    after = totals()
    assert touched > 5
    assert after[0] == pytest.approx(before[0], abs=1e-12 * m.sum())
    assert after[1] == pytest.approx(before[1], abs=1e-12)
    assert after[2] <= before[2] * (1 + 1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_a_pair_keeps_its_angular_momentum(seed):
    rng = np.random.default_rng(seed)
    hulls = [Hull.box(1.0, 0.5, 0.7), Hull.cylinder(0.4, 1.0)]
    fleet = make_fleet([Body(h, 10 ** rng.uniform(1, 4), tuple(rng.uniform(-0.2, 0.2, 3))) for h in hulls])
    fleet.velocity[:] = -10 * fleet.position + rng.normal(0, 0.1, (2, 3))
    place, before = fleet.position.copy(), fleet.velocity.copy()
    assert collide(fleet, 0.5) == 1
    change = fleet.mass[:, None] * np.cross(place, fleet.velocity - before)
    assert np.abs(fleet.velocity - before).max() > 0.1
    assert change.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12 * np.abs(change).max() + 1e-12)


def test_two_spheres_exchange_their_speeds():
    """Equal masses, no loss: the classic; off the line of centres only the normal parts are exchanged."""
    ball = Hull.sphere(0.5)
    fleet = make_fleet([Body(ball, 500.0, (0, 0, 0), velocity=(2.0, 0.3, 0)), Body(ball, 500.0, (0.99, 0, 0))])
    assert collide(fleet, 1.0) == 1
    assert fleet.velocity == pytest.approx(np.array([[0, 0.3, 0], [2.0, 0, 0]]))
    assert collide(fleet, 1.0) == 1
    assert fleet.velocity == pytest.approx(np.array([[0, 0.3, 0], [2.0, 0, 0]]))  # parting: left alone


def test_hulls_are_as_wide_as_they_look():
    """A long box end on reaches half its length, side on half its width."""
    box, ball = Hull.box(4.0, 1.0, 1.0), Hull.sphere(0.5)
    turned = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    for rotation, distance in (((1.0, 0.0, 0.0, 0.0), 2.5), (turned, 1.0)):
        for gap, touching in ((-0.01, 1), (0.01, 0)):
            fleet = make_fleet([Body(box, 500.0, rotation=rotation), Body(ball, 500.0, (distance + gap, 0, 0))])
            assert collide(fleet, 0.0) == touching


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.48, 0.64, 0.6)])
def test_balls_touch_in_any_direction_at_the_sum_of_their_radii(direction):
    for gap, touching in ((-0.01, 1), (0.01, 0)):
        place = (0.8 + gap) * np.array(direction)
        fleet = make_fleet([Body(Hull.sphere(0.5), 500.0), Body(Hull.sphere(0.3), 500.0, tuple(place))])
        assert collide(fleet, 0.0) == touching


def test_bodies_dropped_into_one_another_part():
    ball = Hull.sphere(0.5)
    fleet = make_fleet([Body(ball, 400.0, (0.1 * i, 0.05 * (i % 3), 0.0)) for i in range(10)])
    water = still_water(fleet, WATER)
    for _ in range(1800):
        step(fleet, water, FRAME_INTERVAL)
    apart = np.linalg.norm(fleet.position[:, None] - fleet.position[None], axis=2)[np.triu_indices(10, 1)]
    assert apart.min() > 0.98
    assert np.abs(fleet.velocity).max() < 0.05


@pytest.mark.parametrize("seed", range(6))
def test_anything_thrown_anywhere_stays_finite_and_slow(seed):
    """Densities 10 to 20000, sizes 0.1 to 10 m, upside down, deep under, high above, in a rough two-layer sea."""
    rng = np.random.default_rng(seed)
    bodies = []
    for i in range(24):
        size = 10 ** rng.uniform(-1, 1)
        hull = [
            Hull.box(size, size * rng.uniform(0.1, 1), size * rng.uniform(0.05, 1)),
            Hull.sphere(size / 2, 2),
            Hull.cylinder(size / 2, size * rng.uniform(0.05, 2)),
        ][i % 3]
        bodies.append(
            Body(
                hull,
                10 ** rng.uniform(1, 4.3),
                (40.0 * i, 0.0, rng.uniform(-20, 20)),
                tuple(quaternion(rng)),
                tuple(rng.normal(0, 10, 3)),
                tuple(rng.normal(0, 10, 3)),
            )
        )
    fleet = make_fleet(bodies)
    coefficients = MotionCoefficients(
        gravity=[9.81, 0.1, 45.0][seed % 3], linear_drag=0.3 * (seed > 2), quadratic_drag=1.0 * (seed > 2)
    )
    fastest = 0.0
    for frame in range(600):
        phase = 0.3 * fleet.position[:, 0] - 1.7 * frame * FRAME_INTERVAL
        water = make_water(
            fleet,
            SPILL,
            2.0 * np.cos(phase),
            slope=np.stack([-0.6 * np.sin(phase), 0 * phase], axis=1),
            velocity=np.stack([3.4 * np.cos(phase), 0 * phase, 3.4 * np.sin(phase)], axis=1),
            acceleration=-5.8 * np.cos(phase),
        )
        step(fleet, water, FRAME_INTERVAL, coefficients)
        fastest = np.abs(fleet.velocity).max()
    assert np.isfinite(fleet.position).all()
    assert np.linalg.norm(fleet.rotation, axis=1) == pytest.approx(np.ones(24), abs=1e-12)
    free_fall = 60 + coefficients.gravity * 10
    assert fastest < 3 * free_fall


@pytest.mark.parametrize("field", ["position", "velocity", "spin", "rotation"])
@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e300])
def test_a_state_that_is_not_finite_is_reported_and_undone(field, bad):
    fleet = make_fleet([Body(Hull.sphere(0.5, 2), 500.0, (3.0 * i, 0, 0)) for i in range(3)])
    getattr(fleet, field)[1, 1] = bad
    before = fleet.position.copy()
    if bad == 1e300 and field in ("position", "velocity"):  # far away is a place, and drag stops any speed
        step(fleet, still_water(fleet, WATER), FRAME_INTERVAL)
        assert np.isfinite(fleet.position).all()
        assert np.isfinite(fleet.velocity).all()
        return
    with pytest.raises(FloatingPointError, match="body 1"):
        step(fleet, still_water(fleet, WATER), FRAME_INTERVAL)
    assert np.array_equal(fleet.position, before, equal_nan=True)


@pytest.mark.parametrize("field", ["height", "slope", "velocity", "acceleration", "interface", "relief"])
def test_water_that_is_not_finite_is_reported(field):
    fleet = make_fleet([Body(Hull.box(1.0, 1.0, 0.4), 500.0, (3.0 * i, 0, 0)) for i in range(2)])
    shape = {"slope": (2, 2), "velocity": (2, 3), "relief": (16,)}.get(field, (2,))
    bad = np.zeros(shape)
    bad[-1] = math.nan
    arguments = {"height": np.zeros(2), field: bad}
    with pytest.raises(FloatingPointError, match="body 1"):
        step(fleet, make_water(fleet, SPILL, **arguments), FRAME_INTERVAL)


def test_no_bodies_is_a_fleet_too():
    fleet = make_fleet([])
    assert step(fleet, still_water(fleet, WATER), FRAME_INTERVAL) == 0


def test_whatever_the_arguments_one_signature_is_compiled():
    """Another dtype or layout would stop a running scene for seconds while it compiles."""
    for bodies in ([Body(Hull.box(1, 1, 1), 500)], [Body(Hull.sphere(1, 2))] * 3, []):
        fleet = make_fleet(bodies)
        n = len(bodies)
        step(fleet, still_water(fleet, WATER, level=1), 1, MotionCoefficients(gravity=10))
        water = make_water(fleet, [(850, 1), (1025, math.inf)], np.zeros(n, dtype=np.float32), slope=np.zeros((2, n)).T)
        step(fleet, water, FRAME_INTERVAL, substeps=2)
    assert len(advance.signatures) == 1
    assert len(collide.signatures) == 1
