"""One table of tests over all seas: through `AnySea` alone, each gives the same wave."""

import ast
import math
from pathlib import Path

import numpy as np
import pytest

from sim.floating import Body, FloatState, Hull, MotionCoefficients, float_in, response_amplitude
from sim.floating.motion.rotation import heading_angle
from sim.ocean import RadialSea, Sea
from sim.ocean.any_sea import AnySea
from sim.ocean.nonlinear import NonlinearSea
from sim.ocean.radial.radial_grid import RadialGrid
from sim.water import Water
from sim.waves import STRETCHINGS, Waves
from tests.refusals import assert_refused

ROOT = Path(__file__).parents[3]
KINDS = ("tile", "linear march", "third order", "sum")
LENGTH, AMPLITUDE, T = 100.0, 0.02, 7.3  # [m], [m], [s]
DIRECTIONS = [(4, 0), (3, 3), (0, 4), (-3, 3), (-4, 0), (-3, -3), (0, -4), (3, -3)]  # waves along x and y
DEPTHS = (math.inf, 20.0, 3.0)  # [m]
TABLE = [
    (kind, n, depth)
    for kind in KINDS
    for depth in DEPTHS
    for n in DIRECTIONS
    if kind != "sum" or math.isinf(depth)  # its fluids are deep
]
POINTS = np.random.default_rng(5).uniform(-150.0, 150.0, (20, 2))


def wave(n: tuple[int, int], depth: float, amplitude: float = AMPLITUDE) -> Waves:
    kx, ky = 2.0 * math.pi / LENGTH * np.array(n)
    return Waves([kx], [ky], [amplitude], [0.0], water=Water(depth=depth))


def started(kind: str, sea: AnySea, one: Waves) -> Waves:
    """The wave that a sea started from: a tile draws its phase."""
    return sea.waves_at(0.0).largest(1) if kind == "tile" else one


def sea_of(kind: str, n: tuple[int, int], depth: float, amplitude: float = AMPLITUDE) -> AnySea:
    """A sea of one regular wave; its water is that of each kind by default."""
    one = wave(n, depth, amplitude)
    if kind == "sum":
        return RadialSea(one, choppiness=0.0)
    if kind == "tile":
        return Sea(
            64, LENGTH, "regular", wave_height=2.0 * amplitude, wave_period=2.0 * math.pi / float(one.omega[0]),
            wind_speed=0.0, wind_direction=math.atan2(n[1], n[0]), depth=depth, choppiness=0.0, precision="double",
        )  # fmt: skip
    return NonlinearSea(64, LENGTH, 1 if kind == "linear march" else 3, start=one, fade=0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_still_water_is_still(kind: str) -> None:
    sea = sea_of(kind, (4, 0), math.inf, amplitude=0.0)
    assert isinstance(sea, AnySea)
    at, flow = sea.at(POINTS, 3.0), sea.kinematics(np.column_stack([POINTS, np.full(20, -1.0)]), 3.0)
    assert sea.time == 3.0
    for values in (at.height, at.slope, at.velocity, at.acceleration, *flow, sea.waves_at().amplitude):
        assert not np.asarray(values).any()
    assert sea.significant_height == 0.0
    assert not sea.on(RadialGrid(8, 8, radius=50.0), 3.0).slope.any()


@pytest.mark.parametrize(("kind", "n", "depth"), TABLE)
def test_a_regular_wave_is_the_same_in_every_sea(kind: str, n: tuple[int, int], depth: float) -> None:
    sea, one = sea_of(kind, n, depth), wave(n, depth)
    hs = math.sqrt(8.0) * AMPLITUDE
    assert sea.significant_height == pytest.approx(hs, rel=2e-3)
    assert sea.water.depth == depth
    assert sea.layers == ((sea.water.density, math.inf),)
    waves = sea.waves_at(T)
    assert waves.water == sea.water
    assert waves.significant_height == pytest.approx(hs, rel=2e-3)
    assert waves.largest(1).significant_height == pytest.approx(hs, rel=2e-3)
    (k,) = one.k
    omega = float(one.omega[0])
    main = waves.largest(1)
    assert (main.kx[0], main.ky[0]) == pytest.approx((one.kx[0], one.ky[0]))  # it goes onward
    assert main.omega[0] == pytest.approx(omega, rel=1e-4)
    # Second order in steepness is k a/2, in shallow water k a/(kh)^3: the largest part of the tolerance.
    slack = 3.0 * k * AMPLITUDE / min(1.0, k * depth) ** 3 + 2e-3
    at = sea.at(POINTS, T)
    assert at.height == pytest.approx(waves.elevation(POINTS, T), abs=slack * AMPLITUDE)
    one, period = started(kind, sea, one), 2.0 * math.pi / omega
    assert at.height == pytest.approx(one.elevation(POINTS, T), abs=(slack + 0.02) * AMPLITUDE)
    later = sea.at(POINTS, T + 0.01 * period)
    rise = (later.height - at.height) / (0.01 * period)
    assert rise == pytest.approx(at.velocity[:, 2], abs=(slack + 0.05) * omega * AMPLITUDE)
    theta = POINTS @ (one.kx[0], one.ky[0]) - one.omega[0] * T + one.phase[0]
    slope = -AMPLITUDE * np.sin(theta)[:, None] * (one.kx[0], one.ky[0])
    assert at.slope == pytest.approx(slope, abs=(slack + 0.02) * k * AMPLITUDE)


@pytest.mark.parametrize(("kind", "n", "depth"), TABLE)
def test_the_water_below_is_the_same_in_every_sea(kind: str, n: tuple[int, int], depth: float) -> None:
    sea = sea_of(kind, n, depth)
    one = started(kind, sea, wave(n, depth))
    (k,) = one.k
    slack = 3.0 * k * AMPLITUDE / min(1.0, k * depth) ** 3 + 0.02
    places = np.column_stack([POINTS, np.full(20, -0.5)])
    for stretching in STRETCHINGS:
        flow, wanted = sea.kinematics(places, T, stretching), one.kinematics(places, T)
        scale = sea.water.density / one.water.density
        for found, expected in zip(flow, (wanted.velocity, wanted.acceleration, scale * wanted.pressure), strict=True):
            assert found == pytest.approx(expected, abs=slack * np.abs(expected).max())
        slack += k * AMPLITUDE  # of a stretching
    assert_refused("stretching", lambda: sea.kinematics(places, T, "linear"))


@pytest.mark.parametrize(("kind", "depth", "choppiness"), [
    (kind, depth, choppiness)
    for kind in KINDS
    for depth in (math.inf, 50.0, 20.0, 8.0, 3.0)
    for choppiness in (0.0, 1.0, 1.5)
    if (kind != "sum" or math.isinf(depth)) and (kind in ("tile", "sum") or choppiness == 0.0)
])  # fmt: skip
def test_the_water_of_the_surface_moves_as_that_at_z_0_whatever_the_drawing(
    kind: str, depth: float, choppiness: float
) -> None:
    """Waves so low that second order is below rounding, at corners of cells, where the fields of a tile are exact."""
    sea = sea_of(kind, (3, -2), depth, amplitude=1e-8)
    if choppiness > 0.0:
        sea = with_choppiness(sea, choppiness)
    corners = LENGTH / 64 * np.array([[0.0, 0.0], [5.0, -3.0], [40.0, 11.0], [-9.0, 30.0]])
    for t in (0.0, 2.9, T, 500.0):
        at, water = sea.at(corners, t), sea.kinematics(np.column_stack([corners, np.zeros(4)]), t)
        for component in range(3):
            of_both = at.velocity[:, component], water.velocity[:, component]
            assert of_both[0] == pytest.approx(of_both[1], abs=1e-6 * np.abs(water.velocity[:, component]).max())
        greatest = np.abs(water.acceleration[:, 2]).max()
        assert at.acceleration == pytest.approx(water.acceleration[:, 2], abs=1e-6 * greatest)
    one = wave((3, -2), depth, 1e-8)
    speed = one.amplitude * one.omega / np.tanh(one.k * min(depth, 1e6))
    along = np.hypot(*sea.at(POINTS, 510.0).velocity[:, :2].T).max()
    assert along == pytest.approx(float(speed[0]), rel=0.05)


def test_in_single_precision_the_water_of_the_surface_moves_as_that_at_z_0_within_1e_6() -> None:
    sea = Sea(64, LENGTH, "jonswap", wind_speed=8.0, depth=20.0, choppiness=0.0)
    corners = LENGTH / 64 * np.array([[0.0, 0.0], [5.0, -3.0], [40.0, 11.0], [-9.0, 30.0]])
    at, water = sea.at(corners, 12.3), sea.kinematics(np.column_stack([corners, np.zeros(4)]), 12.3)
    assert at.velocity == pytest.approx(water.velocity, abs=1e-6 * np.abs(water.velocity).max())
    assert at.acceleration == pytest.approx(water.acceleration[:, 2], abs=1e-6 * np.abs(water.acceleration).max())


def with_choppiness(sea: AnySea, choppiness: float) -> AnySea:
    if isinstance(sea, RadialSea):
        return RadialSea(sea.waves, choppiness=choppiness)
    assert isinstance(sea, Sea)
    sea.choppiness = choppiness
    return sea


@pytest.mark.parametrize(("kind", "depth", "choppiness"), [
    ("tile", math.inf, 0.0), ("tile", 8.0, 1.0), ("linear march", 8.0, 0.0), ("sum", math.inf, 0.0),
    *(pytest.param(*case, marks=pytest.mark.long) for case in [
        ("tile", math.inf, 1.0), ("tile", 8.0, 0.0), ("tile", 4.0, 0.0), ("tile", 4.0, 1.0),
        ("linear march", math.inf, 0.0), ("linear march", 4.0, 0.0),
    ]),
])  # fmt: skip
def test_a_small_body_without_drag_surges_and_sways_as_the_water_and_yaws(
    kind: str, depth: float, choppiness: float
) -> None:
    """By coth(kh) in a long wave of 12 s, along both axes; the yaw is that of the frequency domain, within 1 %."""
    omega = 2.0 * math.pi / 12.0
    k = float(Water(depth).wavenumber(np.array(omega)))
    length, height = 2.0 * math.pi / k, 0.02
    one = Waves([0.6 * k], [0.8 * k], [0.5 * height], [0.0], water=Water(depth))
    # waves (3, 4) of a tile of five wavelengths
    if kind == "tile":
        sea = Sea(
            96, 5.0 * length, "regular", wave_height=height, wave_period=12.0, wind_speed=0.0, depth=depth,
            wind_direction=math.atan2(4.0, 3.0), choppiness=choppiness, precision="double",
        )  # fmt: skip
    else:
        sea = RadialSea(one, choppiness=0.0) if kind == "sum" else NonlinearSea(96, 5.0 * length, 1, start=one)
    turn = 2.0  # [rad]
    rotation = (math.cos(turn / 2.0), 0.0, 0.0, math.sin(turn / 2.0))
    body = Body(Hull.box(0.5, 0.2, 0.1), density=512.5, rotation=rotation).afloat()
    run = float_in(sea, [body], 30.0, frames=301, coefficients=MotionCoefficients(quadratic_drag=0.0))
    wanted = 1.0 / math.tanh(min(k * depth, 300.0)) * 0.5 * height * np.array([0.6, 0.8])
    shape = np.column_stack([np.cos(omega * run.t), np.sin(omega * run.t), np.ones(301), run.t])[60:]
    yaw = [heading_angle(rotation) - turn for rotation in run.rotation[60:, 0]]
    found = np.linalg.lstsq(shape, np.column_stack([run.x[60:, 0, :2], yaw]), rcond=None)[0]
    amplitude = np.hypot(found[0], found[1])
    assert amplitude[:2] == pytest.approx(wanted, rel=5e-3)
    response = response_amplitude(body, omega, math.atan2(0.8, 0.6) - turn, water=Water(depth))
    assert amplitude[2] == pytest.approx(0.5 * height * abs(response[5]), rel=1e-2)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [(4, 0), (0, 4), (-3, 3)])
def test_on_a_grid_every_sea_has_the_heights_that_it_has_at_points(kind: str, n: tuple[int, int]) -> None:
    sea, grid, centre = sea_of(kind, n, math.inf), RadialGrid(64, 64, inner=0.2, radius=20.0), (30.0, -7.0)
    drawn = sea.on(grid, T, centre)
    places = drawn.vertices[:, :2]
    assert places.mean(axis=0) == pytest.approx(centre, abs=1e-4)
    at = sea.at(places, T)
    assert drawn.vertices[:, 2] == pytest.approx(at.height, abs=0.02 * AMPLITUDE)
    assert drawn.slope == pytest.approx(at.slope, abs=0.05 * 0.25 * AMPLITUDE)
    assert drawn.jacobian == pytest.approx(np.ones(len(grid)))


@pytest.mark.parametrize(
    ("kind", "n"),
    [
        *((kind, (4, 0)) for kind in KINDS),
        *(pytest.param(kind, (0, -4), marks=pytest.mark.long if kind == "third order" else ()) for kind in KINDS),
    ],
)
def test_a_small_body_follows_the_surface_of_every_sea(kind: str, n: tuple[int, int]) -> None:
    sea = sea_of(kind, n, math.inf, amplitude=0.1)
    buoy = Body(Hull.cylinder(0.25, 0.5), mass=48.0, center_of_gravity=(0.0, 0.0, -0.12)).afloat(sea.layers)
    state = FloatState(sea, [buoy])
    rest, start = float(state.fleet.position[0, 2]), sea.at(state.fleet.position[:, :2], 0.0)
    state.fleet.position[0, 2] += start.height[0]
    state.fleet.velocity[0] = start.velocity[0]
    miss, surface = [], []
    for _ in range(24):
        state.advance(1 / 60, 20)
        surface.append(float(state.surface[0]))
        miss.append(float(state.fleet.position[0, 2]) - rest - surface[-1])
    assert np.std(surface[6:]) == pytest.approx(0.1 / math.sqrt(2.0), rel=0.2)
    assert np.std(miss[6:]) < 0.1 * np.std(surface[6:])


@pytest.mark.parametrize("kind", KINDS)
def test_a_hull_with_coefficients_of_one_depth_is_refused_in_another(kind: str, hull_of_20_m) -> None:
    for depth in (math.inf, 20.0, 3.0) if kind != "sum" else (math.inf,):
        sea = sea_of(kind, (4, 0), depth)
        if depth == 20.0:
            assert FloatState(sea, [hull_of_20_m]).gravity == sea.water.gravity
        else:
            assert_refused("bodies[0]", lambda sea=sea: FloatState(sea, [hull_of_20_m]), "20 m deep")


@pytest.fixture(scope="module")
def hull_of_20_m() -> Body:
    """A box with a table of coefficients that is taken for one of water 20 m deep."""
    import dataclasses

    from sim.floating.linear.hydrodynamics import table_length
    from sim.floating.linear.linear_table import table_of

    hull, table = Hull.box(4.0, 4.0, 2.0), table_of("box")
    rows = {name: getattr(table, name)[:1, 2:3] for name in ("added_mass", "damping", "infinite", "excitation")}
    own = table._replace(aspect=table.aspect[:1], draft=table.draft[2:3], depth=20.0 / table_length(hull), **rows)
    return Body(dataclasses.replace(hull, shape=dataclasses.replace(hull.shape, table=own)), density=512.5)


def test_no_code_outside_the_seas_tells_them_apart() -> None:
    seas, found = {"Sea", "NonlinearSea", "RadialSea"}, []
    for path in (p for top in ("app", "sim") for p in (ROOT / top).rglob("*.py")):
        if "ocean" in path.relative_to(ROOT).parts:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("isinstance", "type"):
                names = {each.id for each in ast.walk(node) if isinstance(each, ast.Name)}
                found += [f"{path.name}:{node.lineno}"] if names & seas else []
    assert found == []
