"""Floats, and lines that float, at the surface: buoyancy ends where the water does, in force, energy and tangent."""

import dataclasses
import math

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, State, System, advance, point_forces, simulate
from sim.springs.analysis.energy import energies as energies_of
from sim.springs.analysis.energy import power
from sim.springs.forces.under_water.water import PIECES, wet_potential, wet_share, wet_slopes
from sim.springs.points.acceleration import set_acceleration
from sim.water import Water
from sim.waves import Waves
from tests.sim.mooring.catenary import catenary
from tests.sim.mooring.dense import stiffness_matrix
from tests.sim.mooring.systems import Shaking

CHAIN = LineType("chain", 0.05, 50.0, 1.674e9)
HAIR = LineType("hair", 1e-9, 1e-9, 1.0)  # slack, and nothing beside the float


def float_on_chain(segments: int = 40) -> System:
    points = (Point(1, "fixed", (0.0, 0.0, -200.0)), Point(2, "free", (5.0, 0.0, -150.0), mass=1000.0, volume=20.0))
    return System((Line(1, CHAIN, 1, 2, 400.0, segments),), points, Water(200.0))


def test_a_float_on_a_slack_line_rests_at_the_surface():
    """MoorPy 1.3.0 has it at z = -0.03 m."""
    rest = float_on_chain().at_rest()
    assert rest.x[1][-1, 2] == pytest.approx(0.0, abs=0.1)
    # Its submerged share carries itself and its line's last link.
    height = 2.0 / 3.0 * (6.0 * 20.0 / math.pi) ** (1.0 / 3.0)
    share = 0.5 - rest.x[1][-1, 2] / height
    half = 0.5 * 10.0 * (50.0 - 1025.0 * CHAIN.volume)
    assert 1025.0 * 20.0 * share * 9.81 == pytest.approx((1000.0 + half) * 9.81 + rest.tension[1][-1], rel=1e-3)


def test_a_line_that_floats_lies_on_the_water_as_deep_as_it_is_heavy():
    kind = LineType("float", 0.2, 20.0, 1e8)
    points = (Point(1, "fixed", (0.0, 0.0, -30.0)), Point(2, "fixed", (10.0, 0.0, 0.0)))
    rest = System((Line(1, kind, 1, 2, 80.0, 40),), points, Water(30.0)).at_rest()
    level = (0.5 - 20.0 / (1025.0 * kind.volume)) * math.pi / 4.0 * 0.2
    afloat = rest.x[1][:, 2] > -0.2
    assert afloat.sum() > 15
    assert np.median(rest.x[1][afloat, 2]) == pytest.approx(level, abs=1e-6)


def one_float(z: float, waves: Waves | None = None) -> tuple[System, np.ndarray]:
    """A float of 0.6 m3 and 300 kg on a hair, at a height z [m]."""
    points = [Point(1, "fixed", (0.0, 0.0, -50.0)), Point(2, "free", (0.0, 0.0, z), 300.0, 0.6, 0.8, 0.5)]
    system = System([Line(1, HAIR, 1, 2, 200.0, 1)], points, Water(50.0), bed_stiffness=0.0, waves=waves)
    return system, np.array([0.0, 0.0, 0.0, 0.0, -50.0, z])


HEIGHT = 2.0 / 3.0 * (6.0 * 0.6 / math.pi) ** (1.0 / 3.0)


@pytest.mark.parametrize("z", [-2.0, -0.3, -0.1, 0.0, 0.25, 0.6])
def test_force_energy_and_tangent_of_a_float_agree(z):
    share = min(max(0.5 - z / HEIGHT, 0.0), 1.0)
    system, x = one_float(z)
    p, v, a = system.kernel_view(1.0), np.zeros(6), np.empty(6)
    v[1::2] = (0.3, 0.0, 0.4)
    set_acceleration(x, v, 0.0, p, a)
    drag = share * 0.5 * 1025.0 * 0.8 * 0.5
    force = np.array([-drag * 0.3, 0.0, -drag * 0.4 + 9.81 * (share * 1025.0 * 0.6 - 300.0)])
    assert a[1::2] == pytest.approx(force / (300.0 + 0.5 * 1025.0 * 0.6), rel=1e-6, abs=1e-7)  # the hair's drag
    h = 1e-4
    energies = [energies_of(x + (0.0, 0.0, 0.0, 0.0, 0.0, d), v, 0.0, p)[2] for d in (h, -h)]
    assert (energies[1] - energies[0]) / (2.0 * h) == pytest.approx(9.81 * (share * 1025.0 * 0.6 - 300.0), rel=1e-5)
    assert power(x, v, 0.0, p, True)[0] == pytest.approx(drag * 0.5**2, rel=1e-6, abs=1e-5)
    slope = 9.81 * 1025.0 * 0.6 / HEIGHT if 0.0 < share < 1.0 else 0.0
    assert stiffness_matrix(x.reshape(3, 2), p)[2, 2] == pytest.approx(slope, rel=1e-6, abs=0.1)


def test_energy_of_buoyancy_ends_above_the_water():
    (low, _), (high, x) = one_float(-9.0), one_float(3.0)
    v = np.zeros(6)
    energies = [
        energies_of(one_float(z)[1], v, 0.0, low.kernel_view(1.0))[2] - 300.0 * 9.81 * z for z in (-9.0, 3.0, 4.0)
    ]
    assert energies == pytest.approx([9.0 * 1025.0 * 0.6 * 9.81, 0.0, 0.0], abs=1e-3)
    assert high.kernel_view(1.0).parts["height"] == pytest.approx([0.0, 0.0, HEIGHT], abs=1e-8)
    assert x[-1] == 3.0


def test_a_float_bobs_with_the_period_of_its_cut_through_the_water():
    system, _ = one_float(0.0)
    level = (0.5 - 300.0 / (1025.0 * 0.6)) * HEIGHT
    free = dataclasses.replace(system, points=(system.points[0], system.points[1]._replace(drag_area=0.0)))
    nodes = np.array([[0.0, 0.0], [0.0, 0.0], [-50.0, level + 0.05]])
    run = simulate(free, duration=8.0, frames=401, step=1e-3, start=State.still(nodes))
    omega = math.sqrt(9.81 * 1025.0 * 0.6 / HEIGHT / (300.0 + 0.5 * 1025.0 * 0.6))
    expected = level + 0.05 * np.cos(omega * run.t)
    assert run.x[1][:, -1, 2] == pytest.approx(expected, abs=1e-4)


def test_a_float_rides_on_long_waves():
    period, amplitude = 12.0, 1.5
    omega = 2.0 * math.pi / period
    k = omega**2 / 9.81
    one = np.ones(1)
    waves = Waves(k * one, 0.0 * one, amplitude * one, 0.0 * one, omega * one, Water(5000.0))
    system, x = one_float(0.0)
    system = dataclasses.replace(system, water=waves.water, waves=waves)
    state = State.still(x.reshape(3, 2))
    advance(system, state, "leapfrog", 5e-3, 6000)
    height = state.x[2, 1] - amplitude * math.cos(k * state.x[0, 1] - omega * state.t)
    assert abs(height - (0.5 - 300.0 / (1025.0 * 0.6)) * HEIGHT) < 0.1 * amplitude


def share_by_pieces(a: float, b: float, height: float) -> float:
    """The reference of `wet_share`."""
    s = (np.arange(PIECES) + 0.5) / PIECES
    return float(np.mean(2.0 * (1.0 - s) * np.clip(0.5 - (a + s * (b - a)) / height, 0.0, 1.0)))


@pytest.mark.parametrize("seed", range(4))
def test_the_submerged_share_of_a_segment_has_its_slopes_and_potential(seed):
    rng = np.random.default_rng(seed)
    for _ in range(50):
        height = 10.0 ** rng.uniform(-2.0, 0.5)
        a, b = rng.uniform(-2.0, 2.0, 2) * 10.0 ** rng.uniform(-1.0, 1.0)
        share = wet_share(a, b, height)
        assert share == pytest.approx(share_by_pieces(a, b, height), abs=1e-14)
        if share in (0.0, 1.0):
            continue
        h = 1e-6 * height
        by_a = (wet_potential(a + h, b, height) - wet_potential(a - h, b, height)) / (2.0 * h)
        assert by_a == pytest.approx(0.5 * share, abs=1e-6)  # both ends of a segment have half of its volume
        s = (np.arange(PIECES) + 0.5) / PIECES
        if (np.abs(np.abs(a + s * (b - a)) - 0.5 * height) > 2.0 * h).all():
            moves = ((h, 0.0), (0.0, h))
            slopes = [(wet_share(a - x, b - y, height) - wet_share(a + x, b + y, height)) / (2.0 * h) for x, y in moves]
            assert wet_slopes(a, b, height) == pytest.approx(slopes, rel=1e-6, abs=1e-6 / height)


HEAVY = LineType("chain", 0.18, 40.0, 5e7)


def hung_from(top: float, segments: int) -> System:
    """A line of 230 m above an anchor 100 m deep, with its fairlead 200 m away and at a height [m]."""
    points = (Point(1, "fixed", (0.0, 0.0, -100.0)), Point(2, "coupled", (200.0, 0.0, top)))
    return System((Line(1, HEAVY, 1, 2, 230.0, segments),), points, Water(100.0), bed_stiffness=0.0)


@pytest.mark.parametrize("top", [0.0, -0.02, -1.0])
@pytest.mark.parametrize(("segments", "error"), [(10, 3e-3), (20, 8e-4), (40, 2.5e-4)])
def test_the_force_at_a_fairlead_in_the_waterline_is_of_second_order(top, segments, error):
    """Against the elastic catenary in water. Half a dry half segment would be 4 % of V at 10 segments."""
    system = hung_from(top, segments)
    force = point_forces(system, State.still(system.at_rest().nodes))[2]
    weight = 9.81 * (HEAVY.mass - 1025.0 * HEAVY.volume)
    exact = catenary(230.0, HEAVY.stiffness, weight, 200.0, 100.0 + top, on_bed=False)
    assert -force[2] == pytest.approx(exact.vertical, rel=error)
    assert -force[0] == pytest.approx(exact.horizontal, rel=2.0 * error)


def test_a_line_to_a_fairlead_in_the_air_is_wet_up_to_the_surface():
    """The forces on both ends of the line bear its weight without that of the water that its wet length displaces."""
    for top in (1.0, 2.5, 4.0):
        system = hung_from(top, 10)
        rest = system.at_rest()
        forces = point_forces(system, State.still(rest.nodes))
        (x0, _, z0), (x1, _, z1) = rest.x[1][-2:]
        dry = 23.0 * z1 / (z1 - z0)
        displaced = 1025.0 * HEAVY.volume * (230.0 - dry)
        assert math.hypot(x1 - x0, z1 - z0) == pytest.approx(23.0, rel=1e-2)
        found = -(forces[1] + forces[2])[2] / 9.81
        one_piece = 1025.0 * HEAVY.volume * 23.0 / PIECES
        assert abs(found - (HEAVY.mass * 230.0 - displaced)) < 0.6 * one_piece


@pytest.mark.parametrize("top", [0.0, 0.7])
def test_energy_of_a_line_through_the_surface_is_conserved(top):
    """Its fairlead moves through the surface, and its water puts in what it is given there."""
    kind = LineType("rope", 0.2, 20.0, 1e5, damping=0.0, drag_across=0.0, drag_along=0.0)
    points = (Point(1, "fixed", (0.0, 0.0, -20.0)), Point(2, "coupled", (12.0, 0.0, top)))
    system = System((Line(1, kind, 1, 2, 26.0, 6),), points, Water(20.0), bed_stiffness=0.0)
    motion = {2: Shaking((12.0, 0.0, top), 2, 1.5, 4.0)}
    run = simulate(system, 6.0, 13, 2e-4, motion=motion, with_account=True)
    assert np.ptp(run.energy.work) > 50.0
    assert np.abs(run.energy.error).max() < 1e-4  # [J]
