"""Bodies against the committed boundary-element coefficients: periods, decay, response in regular waves."""

import math
import re
import warnings

import numpy as np
import pytest

from benchmarks.linear_motion import first_swings, linear_decay, linear_response
from sim.floating import (
    Body,
    Hull,
    MotionCoefficients,
    equilibrium_draft,
    heave_period,
    make_fleet,
    make_water,
    roll_period,
    step,
    still_water,
)
from sim.floating.linear.excitation import WaveExcitation
from sim.floating.linear.hydrodynamics import (
    DEEPEST,
    DIRECTIONS,
    LinearHull,
    afloat,
    lagrange,
    linear_hull,
    natural_frequency,
    plane_force,
    upright,
)
from sim.floating.linear.linear_table import table_of
from sim.floating.motion.body import lower_factor
from sim.floating.statics.prediction import predict
from sim.ocean.radial.radial import RadialSea
from sim.validation import ApproximationWarning
from sim.waves import Waves

WATER = ((1025.0, math.inf),)
FREE = MotionCoefficients(quadratic_drag=0.0)
INTERVAL = 1 / 60
# Hulls and directions [rad]: in a plain run, and among the long tests.
SAMPLE, SECOND = (("ball", 0.0), ("barge", 0.6), ("own", 2.5)), (("box", 0.6), ("drum", 2.5))


def wedge() -> Hull:
    """A hull of one's own: a boat with a flat stern, which has the coefficients of a box."""
    deck = [(-3.0, -1.0, 0.8), (-3.0, 1.0, 0.8), (1.0, 1.0, 0.8), (3.0, 0.0, 0.8), (1.0, -1.0, 0.8)]
    keel = [(x, y, 0.0) for x, y, _ in deck]
    faces = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (5, 6, 7), (5, 7, 8), (5, 8, 9)]
    for i in range(5):
        j = (i + 1) % 5
        faces += [(i, j, i + 5), (j, j + 5, i + 5)]
    return Hull.from_arrays(np.array(deck + keel), np.array(faces))


HULLS = {
    "box": (Hull.box(1.8, 1.8, 1.05), 450.0),
    "drum": (Hull.cylinder(0.9, 1.05), 450.0),
    "ball": (Hull.sphere(0.75), 450.0),
    "barge": (Hull.box(2.0, 6.0, 1.0), 400.0),
    "own": (wedge(), 400.0),
}


def solid(hull: Hull, density: float) -> np.ndarray:
    mass = np.zeros((6, 6))
    mass[:3, :3], mass[3:, 3:] = density * hull.volume * np.eye(3), density * hull.inertia
    return mass


def stiffness(hull: Hull, draft: float) -> np.ndarray:
    """Of the mesh itself, which floats a little off its closed form where it is round."""
    plane, C = plane_force(hull, draft), np.zeros((6, 6))
    C[2, 2], C[3, 3], C[4, 4] = plane.rise[2], plane.slope[1, 3], -plane.slope[0, 4]
    return 1025.0 * 9.81 * C


def place(hull: Hull, density: float) -> tuple[float, float, float]:
    return (0.0, 0.0, float(-hull.extents[2, 0]) - equilibrium_draft(hull, density, WATER))


# Nothing rights a sphere of one density; a square box rolls as it pitches.
@pytest.mark.parametrize(
    ("name", "axis"),
    [
        *[("ball", 2), ("barge", 3)],
        *[pytest.param(name, axis, marks=pytest.mark.long) for name, axis in (("box", 2), ("drum", 4))],
        *[pytest.param(name, 2, marks=pytest.mark.stress) for name in ("drum", "barge")],
        *[
            pytest.param(name, axis, marks=pytest.mark.stress)
            for name in ("box", "drum", "barge")
            for axis in (3, 4)
            if (name, axis) not in (("drum", 4), ("barge", 3))
        ],
    ],
)
def test_free_decay_is_that_of_the_coefficients(name: str, axis: int) -> None:
    hull, density = HULLS[name]
    size, seconds = 1e-3, 12
    angle = [1.0, 0.0, 0.0, 0.0]
    x, y, z = place(hull, density)
    if axis == 2:
        z += size
    else:
        angle[axis - 2] = size / 2
    fleet = make_fleet([Body(hull, density, (x, y, z), tuple(angle))], WATER)
    water, found = still_water(fleet, WATER), []
    rest = place(hull, density)[2]
    for _ in range(seconds * 60):
        step(fleet, water, INTERVAL, FREE)
        found.append(fleet.position[0, 2] - rest if axis == 2 else 2 * fleet.rotation[0, axis - 2])
    linear = afloat(hull, density, WATER).linear
    t = INTERVAL * np.arange(1, seconds * 60 + 1)
    wanted = linear_decay(linear, solid(hull, density), stiffness(hull, linear.draft), axis, t) * size
    period, ratio = first_swings(np.array(found))
    wanted_period, wanted_ratio = first_swings(wanted)
    assert period == pytest.approx(wanted_period, rel=0.01)
    assert ratio == pytest.approx(wanted_ratio, rel=0.05)
    undamped = heave_period(hull, density, WATER) if axis == 2 else roll_period(hull, density, WATER, axis=axis - 3)
    if wanted_ratio > 0.6:  # stronger damping makes the period itself longer
        assert period * INTERVAL == pytest.approx(undamped, rel=0.02)


def marks_of(name: str, direction: float) -> list[pytest.MarkDecorator]:
    """The marks of a case: a plain run tries three, the long tests two more, and -m stress all others."""
    one = name, direction
    return [] if one in SAMPLE else [pytest.mark.long] if one in SECOND else [pytest.mark.stress]


@pytest.mark.parametrize(
    ("name", "direction"),
    [pytest.param(name, direction, marks=marks_of(name, direction)) for name in HULLS for direction in (0.0, 0.6, 2.5)],
)
def test_response_in_regular_waves_is_that_of_the_coefficients(name: str, direction: float) -> None:
    """Heave, and the motions that come with it, from 0.3 to 3 times resonance, begun in the steady state."""
    hull, density = HULLS[name]
    body = Body(hull, density, place(hull, density))
    known = afloat(hull, density, WATER)
    linear, width = known.linear, np.array([float(np.ptp(hull.extents[0]))])
    C = stiffness(hull, linear.draft)
    own = 2 * math.pi / heave_period(hull, density, WATER)
    found, wanted = [], []
    for ratio in (0.3, 0.7, 1.0, 1.4, 2.0, 3.0):
        w, amplitude = own * ratio, 1e-3
        k = w * w / 9.81
        one = np.ones(1)
        sea = RadialSea(Waves(k * math.cos(direction) * one, k * math.sin(direction) * one, amplitude * one, 0 * one))
        excitation = WaveExcitation([body], width, WATER)
        X = 1025.0 * 9.81 * at_direction(excitation.kinds[0].around(k * one)[0], direction)
        xi = linear_response(linear, solid(hull, density), C, X, w)
        velocity = amplitude * -1j * w * xi
        fleet = make_fleet([body], WATER)
        fleet.position[0] += (amplitude * xi[:3]).real
        fleet.rotation[0, 1:] = (amplitude * xi[3:]).real / 2
        fleet.velocity[0], fleet.spin[0] = velocity[:3].real, velocity[3:].real
        poles = known.memory.poles[:, None] * math.sqrt(9.81)
        fleet.memory[0] = (velocity / (-1j * w - poles) + velocity.conj() / (1j * w - poles)) / 2
        steps = round(5 * 2 * math.pi / w / INTERVAL)
        rows = []
        for i in range(steps):
            middle = (i + 0.5) * INTERVAL
            at = sea.at(fleet.position[:, :2], middle, width)
            forces = excitation.forces(fleet, at.label, sea.waves_at(middle), middle, INTERVAL)
            water = make_water(
                fleet, WATER, at.height, slope=at.slope, velocity=at.velocity, acceleration=at.acceleration,
                excitation=forces, lead=INTERVAL / 2,
            )  # fmt: skip
            step(fleet, water, INTERVAL, FREE)
            rows.append(np.append(fleet.position[0] - body.position, 2 * fleet.rotation[0, 1:]))
        t = INTERVAL * np.arange(1, steps + 1)
        fit = np.linalg.lstsq(np.column_stack([np.cos(w * t), np.sin(w * t), np.ones(steps), t]), np.array(rows))[0]
        found.append((fit[0] + 1j * fit[1]) / amplitude)
        wanted.append(xi)
    heave = np.array(found)[:, 2], np.array(wanted)[:, 2]
    np.testing.assert_allclose(np.abs(heave[0]), np.abs(heave[1]), rtol=0.02, atol=1e-3)
    for axis in (0, 1) if name == "ball" else (0, 1, 3, 4):  # a ball hardly turns
        result, linear_one = np.array(found)[:, axis], np.array(wanted)[:, axis]
        np.testing.assert_allclose(result, linear_one, atol=0.02 * np.abs(linear_one).max() + 2e-3)


def at_direction(table: np.ndarray, direction: float) -> np.ndarray:
    index, weights = lagrange(np.append(DIRECTIONS, 2 * math.pi), direction)
    return weights @ np.concatenate([table, table[:1]])[index]


def test_the_hemisphere_has_the_added_mass_of_hulme() -> None:
    """Hulme 1982, table 1: heave added mass over the displaced mass, by kR."""
    linear = afloat(Hull.sphere(1.0), 512.5, WATER).linear
    for kr, known in ((0.1, 0.8627), (0.4, 0.6452), (1.0, 0.4284)):
        a, _ = linear.at(math.sqrt(kr))
        assert a[2, 2] / linear.volume == pytest.approx(known, rel=3e-3)
    assert linear.infinite[2, 2] / linear.volume == pytest.approx(0.5, rel=3e-3)


def test_the_factor_of_an_added_mass_makes_it_again_without_motions_that_give_energy() -> None:
    """Even where heave and pitch of the water are nearly one motion."""
    coupled = np.diag([3.0, 2.0, 4.0, 1.0, 9.0, 5.0])
    coupled[2, 4] = coupled[4, 2] = 0.99 * 6.0
    for added in (coupled, afloat(*HULLS["barge"], WATER).linear.infinite):
        factor = lower_factor(added)
        assert factor @ factor.T == pytest.approx(added, abs=1e-9 * np.abs(added).max())
        assert np.array_equal(factor, np.tril(factor))
    coupled[2, 4] = coupled[4, 2] = 1.01 * 6.0
    nearest = lower_factor(coupled) @ lower_factor(coupled).T
    assert nearest == pytest.approx(coupled, abs=0.01 * 9.0)
    assert np.linalg.eigvalsh(nearest).min() > -1e-9


def test_forces_fade_over_the_hull_s_length_beyond_the_highest_frequency() -> None:
    linear = afloat(Hull.sphere(1.0), 512.5, WATER).linear
    last = linear.frequency[-1] ** 2
    at, beyond = linear.around(np.array([last, last + 1.5 / linear.length]))
    np.testing.assert_allclose(beyond, math.exp(-1.5) * at, rtol=1e-9, atol=1e-12)


def test_the_swings_of_a_damped_cosine_have_its_period_and_ratio() -> None:
    period, rate = 23.7, 0.01  # [samples], of each sample
    t = np.arange(100)
    found, ratio = first_swings(np.exp(-rate * t) * np.cos(2.0 * math.pi / period * t))
    assert found == pytest.approx(period, rel=1e-3)
    assert ratio == pytest.approx(math.exp(-rate * period), rel=0.01)


@pytest.mark.parametrize("name", ["box", "cylinder", "sphere"])
def test_tables_obey_haskind_and_take_energy(name: str) -> None:
    """Damping follows from the excitation: B = k w/(4 pi) int |X|^2 db in these units (Newman 1977, section 6.18)."""
    table = table_of(name)
    hull, density = {"box": HULLS["box"], "cylinder": HULLS["drum"], "sphere": HULLS["ball"]}[name]
    linear = afloat(hull, density, WATER).linear
    for i, frequency in enumerate(linear.frequency[4:16], start=4):
        k = frequency**2
        expected = k * frequency / 2 * np.mean(np.abs(linear.excitation[i, :, 2]) ** 2)
        scale = linear.damping[:, 2, 2].max()
        assert linear.damping[i, 2, 2] == pytest.approx(expected, abs=(0.02 if i < 15 else 0.04) * scale)
    assert (np.einsum("adnii->adni", table.damping[:, 1:-1])[:, :, :14, :3] > -1e-4).all()


def test_the_tables_of_a_ball_obey_haskind_within_half_a_percent() -> None:
    """At their own drafts, up to one and a quarter radii."""
    table = table_of("sphere")
    frequency, damping = table.frequency[:14], table.damping[0, :6, :14, 2, 2]
    expected = frequency**3 / 2 * np.abs(table.excitation[0, :6, :14, 0, 2]) ** 2
    np.testing.assert_allclose(damping, expected, atol=5e-3 * damping.max())


def test_a_turned_hull_and_a_turned_wave_are_one() -> None:
    barge, crosswise = Hull.box(6.0, 2.0, 1.0), Hull.box(2.0, 6.0, 1.0)
    a, b = afloat(barge, 400.0, WATER).linear, afloat(crosswise, 400.0, WATER).linear
    assert a.infinite[0, 0] == pytest.approx(b.infinite[1, 1])
    assert a.infinite[4, 4] == pytest.approx(b.infinite[3, 3])
    quarter = len(DIRECTIONS) // 4
    np.testing.assert_allclose(a.excitation[:, 0, 2], b.excitation[:, quarter, 2], rtol=1e-9)
    np.testing.assert_allclose(a.excitation[:, 0, 0], b.excitation[:, quarter, 1], rtol=1e-9)
    np.testing.assert_allclose(a.excitation[:, 0, 4], -b.excitation[:, quarter, 3], rtol=1e-6, atol=1e-9)


def test_the_memory_is_that_of_the_coefficients_at_the_own_frequencies() -> None:
    """Of roll and pitch of a long hull, which differ: there the fit has its weight."""
    hull, density = HULLS["barge"]
    known = afloat(hull, density, WATER)
    linear, poles, residues = known.linear, known.memory.poles, known.memory.residues
    s, cut = 1j * linear.frequency[:, None], upright(hull, linear.draft)
    wanted = linear.damping + s[:, :, None] * (linear.added_mass - linear.infinite)
    fit = np.einsum("pij,fp->fij", residues, 1 / (s - poles))
    fit += np.einsum("pij,fp->fij", residues.conj(), 1 / (s - poles.conj()))
    for axis in (0, 1):
        stiffness = cut.second[1 - axis] + cut.volume * cut.centre[2]
        own = natural_frequency(linear, 3 + axis, cut.volume / hull.volume * hull.inertia[axis, axis], stiffness)
        nearest, d = int(np.argmin(np.abs(linear.frequency - own))), 3 + axis
        assert abs(fit[nearest, d, d] / wanted[nearest, d, d] - 1.0) < 0.025


def test_size_and_gravity_scale_periods() -> None:
    small, large = Hull.box(1.0, 1.0, 0.6), Hull.box(4.0, 4.0, 2.4)
    assert heave_period(large, 450.0, WATER) == pytest.approx(2 * heave_period(small, 450.0, WATER), rel=1e-6)
    assert heave_period(small, 450.0, WATER, 2.0) == pytest.approx(
        heave_period(small, 450.0, WATER) * math.sqrt(9.81 / 2.0), rel=1e-9
    )
    for gravity in (1.6, 25.0):
        fleet = make_fleet([Body(small, 450.0, (0.0, 0.0, place(small, 450.0)[2] + 1e-3))], WATER)
        z, water, h = [], still_water(fleet, WATER), INTERVAL * math.sqrt(9.81 / gravity)
        for _ in range(400):
            step(fleet, water, h, FREE._replace(gravity=gravity))
            z.append(fleet.position[0, 2] - place(small, 450.0)[2])
        if gravity == 1.6:
            first = z
    np.testing.assert_allclose(z, first, atol=1e-9)


@pytest.mark.parametrize(
    ("hull", "density", "words"),
    [
        (Hull.box(120.0, 12.0, 9.0), 500.0, "length over width 10 (table: 1 to 5)"),
        (Hull.box(12.0, 120.0, 9.0), 500.0, "length over width 10 (table: 1 to 5)"),
        (Hull.box(1.0, 1.0, 1.0), 20.0, "draft over half the width 0.039 (table: 0.06 to 4.2)"),
        (Hull.cylinder(0.2, 4.0), 900.0, "draft over half the width 17.6 (table: 0.06 to 4.2)"),
        (Hull.sphere(0.5), 1020.0, "draft over half the width 1.92 (table: 0.15 to 1.9)"),
    ],
)
def test_a_hull_outside_its_table_is_warned_of_by_name(hull: Hull, density: float, words: str) -> None:
    with pytest.warns(ApproximationWarning, match="^" + re.escape(f"{hull.shape.name}: {words} is outside")):
        heave_period(hull, density)
    assert predict(hull, density, WATER, 1025.0).outside == words


@pytest.mark.parametrize(
    ("hull", "density"), [(Hull.box(5.0, 1.0, 1.0), 500.0), (Hull.sphere(0.5), 1025.0), (Hull.sphere(0.5), 2000.0)]
)
def test_a_hull_inside_its_table_or_wholly_under_water_is_not_warned_of(hull: Hull, density: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        make_fleet([Body(hull, density)])
        assert predict(hull, density, WATER, 1025.0).outside == ""


@pytest.mark.parametrize("size", [(3.0, 0.6, 2.0), (3.0, 2.0, 0.6)])
def test_a_hull_wholly_under_water_has_the_coefficients_of_one_that_is_nearly(size: tuple[float, float, float]) -> None:
    hull = Hull.box(*size)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # one is outside its table in length over width
        nearly, wholly = linear_hull(hull, DEEPEST * size[2]), linear_hull(hull, 5.0 * size[2])
    for name in LinearHull._fields:
        one, other = getattr(nearly, name), getattr(wholly, name)
        if isinstance(one, np.ndarray):
            assert one == pytest.approx(other), name


def test_a_long_hull_does_not_feel_short_waves_along_it_and_feels_them_across() -> None:
    linear = afloat(Hull.box(30.0, 6.0, 2.0), 500.0, WATER).linear
    i = int(np.argmin(np.abs(linear.frequency - math.sqrt(2 * math.pi / 10))))
    ahead, abeam = np.abs(linear.excitation[i, 0, 2]), np.abs(linear.excitation[i, 9, 2])
    assert abeam > 5 * ahead


@pytest.mark.parametrize(("axis", "partner"), [(3, 1), (4, 0)])
def test_a_free_body_rolls_and_pitches_with_the_sway_and_surge_that_come_with_it(axis, partner):
    """The frequency at which the two motions together are free, by the eigenvalues of their matrices."""
    hull = Hull.box(60.0, 16.0, 6.0)
    linear = linear_hull(hull, 3.0)
    inertia, stiffness = 30.0 * linear.volume, 2.0 * linear.volume
    for added in (1.0, 0.5):
        own = natural_frequency(linear, axis, inertia, stiffness, added)
        a, _ = linear.at(own)
        pair = np.ix_((axis, partner), (axis, partner))
        mass = np.diag([inertia, linear.volume]) + added * a[pair]
        rates = np.linalg.eigvals(np.linalg.solve(mass, np.diag([stiffness, 0.0])))
        assert own**2 == pytest.approx(rates.real.max(), rel=1e-6)
        assert added * a[partner, partner] > 0.05 * linear.volume
