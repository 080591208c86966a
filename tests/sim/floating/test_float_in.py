"""Bodies in a sea, run by one call, beside the response that linear theory gives them."""

import math

import numpy as np
import pytest

from sim.floating import Body, FloatState, Hull, MotionCoefficients, float_in, response_amplitude
from sim.ocean import Sea
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids
from sim.ocean.radial.radial import RadialSea
from sim.waves import Waves
from tests.refusals import assert_refused

FREE = MotionCoefficients(quadratic_drag=0.0)
BUOY = Body(Hull.cylinder(0.5, 1.0), mass=390.0, center_of_gravity=(0.0, 0.0, -0.25))


def regular(k: float, amplitude: float, heading: float = 0.0, **more) -> RadialSea:
    one = np.ones(1)
    return RadialSea(
        Waves(k * math.cos(heading) * one, k * math.sin(heading) * one, amplitude * one, 0.0 * one), **more
    )


@pytest.mark.parametrize("heading", [pytest.param(0.0, marks=pytest.mark.long), 2.0])
def test_a_loaded_barge_heaves_and_pitches_as_its_response_amplitude(heading):
    hull = Hull.box(30.0, 10.0, 5.0)
    density = FluidColumn().surface.density
    mass = 0.5 * density * hull.volume
    inertia = (mass * 3.5**2, mass * 8.0**2, mass * 8.0**2)
    body = Body(hull, mass=mass, center_of_gravity=(0.0, 0.0, 0.5), inertia=inertia).afloat([(density, math.inf)])
    w, amplitude = 0.8, 0.02
    sea = regular(w * w / 9.81, amplitude, heading)
    period = 2.0 * math.pi / float(sea.rate[0])
    run = float_in(sea, [body], 25.0 * period, frames=25 * 40 + 1, coefficients=FREE)
    xi = response_amplitude(body, [w], heading, [(density, math.inf)])[0]
    last = slice(-10 * 40, None)  # ten periods, after the transient has radiated
    wave = np.exp(-1j * float(sea.rate[0]) * run.t[last])
    for motion, measured in ((2, run.x[last, 0, 2]), (4, 2.0 * run.rotation[last, 0, 2])):
        found = 2.0 * np.mean(measured * wave.conj()) / amplitude
        assert abs(found) == pytest.approx(abs(xi[motion]), rel=0.03)


@pytest.mark.parametrize("kind", ["radial", "square"])
def test_a_small_buoy_follows_a_long_wave(kind):
    body = BUOY.afloat()
    if kind == "radial":
        sea = regular(2.0 * math.pi / 80.0, 0.3)
    else:
        sea = Sea(64, 80.0, "regular", wave_height=0.6, wave_period=7.16, wind_speed=0.0)
    run = float_in(sea, [body], 30.0, frames=301)
    assert run.t[-1] == 30.0
    rise = run.x[:, 0, 2] - body.position[2]
    assert np.std(rise[150:] - run.surface[150:, 0]) < 0.05 * np.std(run.surface[150:, 0])
    balance = run.lift[100:, 0].sum(axis=1).mean() / (body.mass * 9.81)
    assert balance == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("kind", ["square", "radial"])
def test_steps_from_outside_are_those_of_a_run(kind):
    """At any length of exchange; where the step changes, within the error of a step."""
    if kind == "radial":
        sea = regular(2.0 * math.pi / 40.0, 0.3)
    else:
        sea = Sea(32, 80.0, "regular", wave_height=0.6, wave_period=7.16, wind_speed=0.0)
    told = []
    run = float_in(sea, [BUOY.afloat()], 3.0, 31, 1 / 80, progress=lambda *done: told.append(done))
    assert told[0] == (1, 31)
    assert told[-1] == (31, 31)
    state, changed = FloatState(sea, [BUOY.afloat()], begin=0.0), FloatState(sea, [BUOY.afloat()], begin=0.0)
    for steps in (1, 7, 0, 232):
        state.advance(1 / 80, steps)
    assert state.t == pytest.approx(3.0)
    assert state.fleet.position == pytest.approx(run.x[-1], abs=1e-12)
    for h, steps in ((1 / 80, 120), (1 / 160, 240)):
        changed.advance(h, steps)
    assert changed.fleet.position == pytest.approx(run.x[-1], abs=2e-3)


def test_a_pull_from_outside_presses_a_buoy_down():
    state = FloatState(regular(1.0, 0.0), [BUOY.afloat()])
    start = state.fleet.position[0, 2]
    state.fleet.mooring[0, 2] = -200.0
    heights = []
    for _ in range(300):
        state.advance(1 / 60, 4)
        heights.append(state.fleet.position[0, 2])
    assert np.mean(heights[150:]) - start == pytest.approx(-200.0 / (1025.0 * 9.81 * math.pi * 0.25), rel=0.05)


@pytest.mark.parametrize(
    ("name", "call", "words"),
    [
        ("h", lambda s: s.advance(0.1, 1), "0.0166"),
        ("steps", lambda s: s.advance(0.01, -1), "at least 0"),
        ("step", lambda s: float_in(s.sea, [], 1.0, 3, 0.1), "0.0166"),
        ("frames", lambda s: float_in(s.sea, [], 1.0, 1), "from 2"),
        ("progress", lambda s: float_in(s.sea, [], 1.0, progress=1), "a function"),
    ],
)
def test_bad_steps_and_frames_are_named(name, call, words):
    assert_refused(name, lambda: call(FloatState(regular(1.0, 0.0), [])), words)


def test_in_still_layers_a_body_at_rest_stays():
    column = FluidColumn(thickness=0.3)
    sea = regular(1.0, 0.0, column=column)
    body = Body(Hull.box(1.0, 1.2, 0.8), density=600.0).afloat(column.layers)
    run = float_in(sea, [body], 2.0, frames=5)
    assert run.x[-1, 0] == pytest.approx(body.position, abs=1e-9)
    assert float_in(sea, [], 1.0, frames=3).x.shape == (3, 0, 3)


def test_a_body_between_the_fluids_follows_the_interface():
    """In waves half as high there as at the surface."""
    column = FluidColumn(oil=fluids()["diesel 2002"], thickness=20.0)
    (oil, _), (water, _) = column.layers
    sea = regular(2.0 * math.pi / 200.0, 1.0, column=column)
    body = Body(Hull.box(0.5, 0.5, 0.3), density=0.5 * (oil + water), position=(0.0, 0.0, -20.0)).afloat(column.layers)
    run = float_in(sea, [body], 40.0, frames=401)
    rise = run.x[:, 0, 2] - body.position[2]
    below = np.array([sea.at(x[None, :2], t).interface[0] for x, t in zip(run.x[:, 0], run.t, strict=True)])
    late = slice(200, None)  # when the start, in still fluids, has faded
    assert np.std(rise[late] - below[late]) < 0.1 * np.std(below[late])
    assert np.std(below[late]) < 0.6 * np.std(run.surface[late, 0])


@pytest.mark.parametrize("kind", ["square", "radial"])
def test_a_body_at_rest_in_the_default_water_stays_at_rest(kind):
    """`afloat`, `Sea` and `RadialSea` have the same default water."""
    ship = Body(Hull.box(10.0, 4.0, 2.0), mass=41000.0, center_of_gravity=(0.0, 0.0, 0.0))
    sea = Sea(32, 100.0, "jonswap", wind_speed=0.0) if kind == "square" else regular(1.0, 0.0)
    run = float_in(sea, [ship.afloat(), BUOY._replace(position=(30.0, 0.0, 0.0)).afloat()], duration=20.0, frames=101)
    assert np.ptp(run.x[:, :, 2], axis=0) == pytest.approx(np.zeros(2), abs=1e-6)


def test_a_body_that_is_not_stable_upright_is_warned_of_with_its_gm():
    sea = Sea(32, 100.0, "jonswap", wind_speed=0.0)
    cork, sinking = Body(Hull.cylinder(0.6, 1.0), density=450.0), Body(Hull.cylinder(0.6, 1.0), density=4500.0)
    with pytest.warns(UserWarning, match=r"^bodies\[1\]: GM = -0.0755 m: it is not stable upright") as warned:
        float_in(sea, [BUOY, cork, cork, sinking], 0.1, frames=3)
    assert len([one for one in warned if "GM" in str(one.message)]) == 1
