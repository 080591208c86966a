import dataclasses
import math

import numpy as np
import pytest

from sim.frames import steps_for
from sim.springs import INTEGRATORS, rope, simulate
from sim.springs.state import State, advance
from sim.springs.statics import hanging_chain
from tests.sim.springs.nets import DAMPABLE, patch


def test_frames_are_equally_spaced_from_the_start_to_the_end():
    run = simulate(rope(6), duration=2.0, frames=61, step=1 / 1200, integrator="rk4")
    assert run.t.tolist() == np.linspace(0.0, 2.0, 61).tolist()
    assert run.x.shape == run.v.shape == (61, 6, 3)
    assert all(energy.shape == (61,) for energy in run.energy)
    assert (rope(6).x0[:, 0] == run.x[0].T).all()
    assert (run.v[0] == 0.0).all()
    assert run.diverged_at is None
    assert np.isfinite(run.x).all()


def test_a_net_of_rows_has_frames_of_rows():
    run = simulate(patch(), duration=0.1, frames=3, step=1e-3, integrator="leapfrog")
    assert run.x.shape == (3, 3, 4, 3)
    assert (np.moveaxis(run.x[0], -1, 0) == patch().x0).all()


@pytest.mark.parametrize(
    ("duration", "step", "per_frame"), [(1.0, 0.1, 1), (1.0, 0.03, 4), (1.0, 0.05, 2), (2.0, 5.0, 1)]
)
def test_steps_are_shortened_equally_to_fill_a_frame(duration, step, per_frame):
    run = simulate(rope(4, stiffness=8.0, damping=0.1), duration=duration, frames=11, step=step, integrator="rk4")
    assert run.force_evals == 4 * per_frame * 10


def test_round_off_in_the_ratio_costs_no_extra_step():
    assert steps_for(0.3, 0.1) == 3
    assert steps_for(2.0 / 60, 1 / 1200) == 40
    assert steps_for(0.31, 0.1) == 4


@pytest.mark.parametrize("name", DAMPABLE)
def test_frames_are_the_states_that_advance_passes_through(name):
    net = rope(7)
    run = simulate(net, duration=0.2, frames=3, step=1e-3, integrator=name)
    state = State.at_rest(net)
    for _ in range(200):
        advance(net, state, name, 1e-3, 1)
    assert np.moveaxis(run.x[-1], -1, 0) == pytest.approx(state.x[:, 0], abs=1e-13)


@pytest.mark.parametrize("name", DAMPABLE)
def test_velocities_are_at_the_frame_s_time_even_where_the_method_s_trail(name):
    run = simulate(rope(5), duration=0.5, frames=5001, step=1e-4, integrator=name)
    differences = (run.x[2:] - run.x[:-2]) / (run.t[2:] - run.t[:-2])[:, None, None]
    # Half a step of an acceleration of tens of m/s^2 would be 1e-3 m/s off and more.
    order = max(INTEGRATORS[name].order, INTEGRATORS[name].undamped_order)
    assert np.abs(differences - run.v[1:-1])[1:].max() < (1e-4 if order > 1 else 5e-3)


def test_explicit_euler_explodes_at_the_lab_s_defaults_at_the_step_that_left_the_bound():
    net = rope()
    with pytest.warns(RuntimeWarning, match=r"explicit_euler in steps of 0\.0166667 s diverged at") as caught:
        run = simulate(net, duration=10.0, frames=61, step=1 / 60, integrator="explicit_euler")
    assert [warning.filename for warning in caught] == [__file__]  # once, and at the line of the caller
    state = State.at_rest(net)
    steps = 0
    while np.abs(state.x).max() < 1e9:
        advance(net, state, INTEGRATORS["explicit_euler"], 10.0 / 60 / 10, 1)
        steps += 1
    assert run.diverged_at == pytest.approx(steps / 60, abs=1e-9)
    good = run.t < run.diverged_at
    assert np.isfinite(run.x[good]).all()
    assert np.isnan(run.x[~good]).all()
    assert np.isnan(np.array(run.energy)[:, ~good]).all()
    assert 0 < good.sum() < 61


def test_explicit_euler_grows_by_the_lab_s_factor():
    """rho = 1.181 a step, of a small disturbance of the hanging rope."""
    net = rope()
    state = State(np.ascontiguousarray(hanging_chain(net).x.T[:, None]), np.zeros_like(net.x0))
    state.v[2, 0, 1:] = 1e-9 * (-1.0) ** np.arange(9)
    sizes = []
    for _ in range(2):
        advance(net, state, INTEGRATORS["explicit_euler"], 1 / 60, 40)
        sizes.append(np.abs(state.v).max())
    assert (sizes[1] / sizes[0]) ** (1 / 40) == pytest.approx(1.181, rel=5e-3)


def test_the_other_integrators_hold_the_lab_s_defaults():
    for name in set(DAMPABLE) - {"explicit_euler"}:
        assert simulate(rope(), duration=5.0, frames=11, step=1 / 60, integrator=name).diverged_at is None


def test_progress_is_told_of_every_frame():
    told = []
    simulate(
        rope(3),
        duration=0.1,
        frames=6,
        step=0.01,
        integrator="leapfrog",
        progress=lambda done, frames: told.append((done, frames)),
    )
    assert told == [(i, 6) for i in range(1, 7)]


def test_a_lone_pinned_point_stays():
    run = simulate(rope(1), duration=0.1, frames=3, step=0.01, integrator="rk4")
    assert (run.x == 0.0).all()


def test_a_heavy_bob_on_a_light_string_swings_as_a_compound_pendulum_does():
    links, length, string, bob, angle = 6, 1.0, 1e-3, 5.0, 0.02
    spacing = length / links
    masses = np.full(links + 1, string)
    masses[-1] = bob
    net = rope(links + 1, length, masses, 1e7, 0.0, 0.0)
    along = np.arange(links + 1)[:, None] * spacing
    start = along * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    run = simulate(net, duration=5.0, frames=5001, step=8e-6, integrator="leapfrog", x=start)
    crossings = np.flatnonzero(np.diff(np.sign(run.x[:, -1, 0])))
    before, after = run.x[crossings, -1, 0], run.x[crossings + 1, -1, 0]
    times = run.t[crossings] + run.t[1] * before / (before - after)
    inertia = float((masses * along[:, 0] ** 2).sum())
    moment = 9.81 * float((masses * along[:, 0]).sum())
    period = 2.0 * math.pi * math.sqrt(inertia / moment) * (1.0 + angle**2 / 16.0)
    assert 2.0 * np.diff(times).mean() == pytest.approx(period, rel=1e-4)


def test_a_point_that_is_thrown_flies_as_galileo_says():
    net = dataclasses.replace(rope(2, drag=0.0, stiffness=0.0, damping=0.0), pinned=frozenset())
    run = simulate(net, duration=1.0, frames=11, v=[(3.0, 0.0, 4.0), (0.0, 2.0, 0.0)])
    fallen = -0.5 * 9.81 * run.t**2
    assert np.allclose(run.x[:, 0, 0], 3.0 * run.t, atol=1e-12)
    assert np.allclose(run.x[:, 0, 2], 4.0 * run.t + fallen, atol=1e-12)
    assert np.allclose(run.x[:, 1, 1], 2.0 * run.t, atol=1e-12)


def test_a_run_goes_on_from_the_end_of_another():
    net = rope(8)
    whole = simulate(net, duration=1.0, frames=3, step=1e-3, integrator="rk4")
    first = simulate(net, duration=0.5, frames=2, step=1e-3, integrator="rk4")
    second = simulate(net, duration=0.5, frames=2, step=1e-3, integrator="rk4", x=first.x[-1], v=first.v[-1])
    assert np.abs(second.x[-1] - whole.x[-1]).max() < 1e-12


def test_energies_have_names_and_what_is_not_known_is_nan():
    closed, damped = rope(6, damping=0.0, drag=0.0), rope(6)
    run = simulate(closed, duration=0.5, frames=6, step=1e-3, integrator="rk4")
    assert np.array_equal(run.energy.total, run.energy.kinetic + run.energy.elastic + run.energy.gravity)
    assert run.energy.error[0] == 0.0
    assert 0.0 < np.abs(run.energy.error).max() < 1e-4
    unknown = simulate(damped, duration=0.5, frames=6, step=1e-3, integrator="rk4").energy
    assert np.isnan(unknown.dissipated).all()
    assert np.isnan(unknown.error).all()
    known = simulate(damped, duration=0.5, frames=6, step=1e-3, integrator="rk4", with_account=True).energy
    assert known.dissipated[-1] > 0.1
    assert np.abs(known.error).max() < 1e-4 * known.dissipated[-1]
