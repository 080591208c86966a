"""A hull as a body of a mooring: its response to waves is that of linear theory, and the account balances."""

import dataclasses
import math

import numpy as np
import pytest

from sim import floating
from sim.mooring import Line, LineType, Point, System, moored, simulate
from sim.mooring.rest.statics import straight
from sim.springs import State
from sim.springs.points.acceleration import set_acceleration
from sim.water import Water
from sim.waves import Waves
from tests.refusals import assert_refused
from tests.sim.mooring.systems import chain_on_bed

RATE, AMPLITUDE = 0.8, 0.5  # [rad/s], [m] of the wave
THREAD = LineType("thread", 1e-3, 1e-3, 10.0)  # a line that does not matter


def wave(heading: float) -> Waves:
    k = RATE**2 / 9.81
    one = np.ones(1)
    kx, ky = k * math.cos(heading) * one, k * math.sin(heading) * one
    return Waves(kx, ky, AMPLITUDE * one, 0.6 * one, RATE * one, Water(300.0))


def box_in_waves(heading: float) -> System:
    waves = wave(heading)
    body = moored(1, floating.Body(floating.Hull.box(12.0, 8.0, 4.0), density=450.0), RATE, waves)
    points = Point(1, "fixed", (0.0, 0.0, -300.0)), Point(2, "body", body.place, body=1)
    return System((Line(1, THREAD, 1, 2, 310.0, 2),), points, Water(300.0), (body,), waves=waves)


@pytest.mark.parametrize("heading", [0.0, 0.7])
def test_a_body_answers_a_wave_by_its_response_amplitude(heading):
    m = box_in_waves(heading).bodies[0]
    D = m.stiffness - RATE**2 * m.mass - 1j * RATE * m.damping
    body = floating.Body(floating.Hull.box(12.0, 8.0, 4.0), density=450.0)
    expected = floating.response_amplitude(body, [RATE], heading)[0]
    # except for the weak restoring of surge and sway, and the symmetry of the matrices
    assert np.abs(np.linalg.solve(D, m.excitation[0]) - expected).max() < 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize("place", [(0.0, 0.0), (7.0, -3.0)])
def test_a_wave_pushes_a_body_where_it_is(place):
    system = box_in_waves(0.7)
    m, waves, t = system.bodies[0], system.waves, 2.3
    x = straight(system)
    x[:2, system.node_count] = place
    x[:2, 1] += place  # the end of the thread
    a = np.empty(x.size)
    set_acceleration(x.reshape(-1), np.zeros(x.size), t, system.kernel_view(1.0), a)
    phase = waves.kx * place[0] + waves.ky * place[1] - RATE * t + 0.6
    push = AMPLITUDE * (m.excitation[0] * np.exp(1j * phase)).real - m.stiffness @ np.array([*place, 0, 0, 0, 0])
    found = a.reshape(3, -1)[:, system.node_count :].T.reshape(-1)
    assert found == pytest.approx(np.linalg.solve(m.mass, push), abs=1e-4 * AMPLITUDE)


def test_the_account_balances_of_a_body_in_waves():
    system = box_in_waves(0.7)
    start = State.still(straight(system))
    run = simulate(system, duration=60.0, frames=61, step=0.01, start=start, with_account=True)
    error = run.energy.total + run.energy.dissipated - run.energy.work
    assert np.abs(error - error[0]).max() < 1e-3 * np.ptp(run.energy.total)
    assert run.energy.dissipated[-1] > 0.0


def test_a_steady_force_moves_the_place_of_rest():
    system = box_in_waves(0.0)
    still = dataclasses.replace(system, waves=None, bodies=(system.bodies[0]._replace(excitation=None),))
    heave = 1e4 / still.bodies[0].stiffness[2, 2]
    pushed = dataclasses.replace(still, bodies=(still.bodies[0]._replace(steady=(0.0, 0.0, 1e4, 0.0, 0.0, 0.0)),))
    assert pushed.at_rest().bodies[1][2] == pytest.approx(heave, rel=1e-3)


@pytest.mark.parametrize(("field", "value"), [("excitation", np.zeros((2, 6))), ("steady", (0.0, 1.0))])
def test_forces_that_are_not_those_of_the_waves_are_refused(field, value):
    system = box_in_waves(0.0)
    with pytest.raises(ValueError, match=f"body 1: {field}: .* is not allowed; allowed: "):
        dataclasses.replace(system, bodies=(system.bodies[0]._replace(**{field: value}),))


@pytest.mark.parametrize(
    ("name", "waves"),
    [
        ("waves", "sea"),
        ("waves", dataclasses.replace(wave(0.0), water=Water())),
        ("waves", dataclasses.replace(wave(0.0), water=Water(300.0, density=1000.0))),
        ("waves: omega", dataclasses.replace(wave(0.0), omega=np.array([1.1 * RATE]))),
    ],
)
def test_waves_in_another_water_are_refused(name, waves):
    still = dataclasses.replace(
        box_in_waves(0.0),
        bodies=(),
        waves=None,
        points=(Point(1, "fixed", (0.0, 0.0, -300.0)), Point(2, "fixed", (0.0, 0.0, 0.0))),
    )
    assert_refused(name, lambda: dataclasses.replace(still, waves=waves))
    both = "waves on water 300 m deep of 1025 kg/m3 under a gravity of 9.81 .*the system's water 300 m .* of 1.62 "
    with pytest.raises(ValueError, match=both):
        dataclasses.replace(still, waves=wave(0.0), water=Water(300.0, 1.62))
    box = floating.Body(floating.Hull.box(12.0, 8.0, 4.0), density=450.0)
    both = r"waves on water 300 m deep of 1025 .* under a gravity of 9.81 .*the body's water .* of 1.62 m/s2"
    with pytest.raises(ValueError, match=both):
        moored(1, box, RATE, wave(0.0), water=Water(300.0, 1.62))


def test_a_body_and_its_waves_have_one_water():
    """Fresh water pushes less: the coefficients are those of its density, at the deeper draft."""
    box, waves = floating.Body(floating.Hull.box(12.0, 8.0, 4.0), density=450.0), wave(0.0)
    fresh = dataclasses.replace(waves.water, density=1000.0)
    found = moored(1, box, RATE, dataclasses.replace(waves, water=fresh))
    assert found.stiffness[2, 2] == pytest.approx(1000.0 * 9.81 * 12.0 * 8.0, rel=1e-9)
    assert found.place[2] == pytest.approx(2.0 - 0.45 * 4.0, rel=1e-9)
    alone = moored(1, box, RATE, water=fresh)
    assert (alone.stiffness == found.stiffness).all()
    assert (alone.mass == found.mass).all()


@pytest.mark.parametrize(("depth", "stiffness", "fits"), [(39.9, 3e6, False), (39.9, 0.0, True), (40.0, 3e6, True)])
def test_a_fixed_point_lies_on_or_above_a_bed_that_there_is(depth, stiffness, fits):
    chain = chain_on_bed(4)
    assert chain.points[0].position[2] == -40.0
    made = {"water": Water(depth), "bed_stiffness": stiffness}
    if fits:
        assert dataclasses.replace(chain, **made).water.depth == depth
    else:
        assert_refused("point 1: position", lambda: dataclasses.replace(chain, **made), "above the bed at z = -39.9 m")
