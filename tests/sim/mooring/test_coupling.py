"""Coupling of a vessel with a mooring: forces at held points, velocities, and steps from outside."""

import math

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, State, System, advance, paths_to, point_forces, simulate
from sim.mooring.motion import paths_of
from sim.water import Water
from tests.refusals import assert_refused
from tests.sim.mooring.systems import CHAIN, Shaking, chain_on_bed, in_vacuum

POINTS = (Point(1, "fixed", (-50.0, 0.0, -20.0)), Point(2, "coupled", (0.0, 0.0, -5.0), mass=100.0, volume=0.05))
HANGING = System((Line(1, CHAIN, 1, 2, 60.0, 20),), POINTS, Water(100.0))  # above the bed


def test_what_holds_a_hanging_line_bears_its_weight_in_water():
    forces = point_forces(HANGING, State.at_rest(HANGING))
    wet = CHAIN.mass - 1025.0 * CHAIN.volume
    weight = 9.81 * (60.0 * wet + 100.0 - 1025.0 * 0.05)
    assert forces[1] + forces[2] == pytest.approx([0.0, 0.0, -weight], abs=1e-6 * weight)


def test_a_coupled_point_that_nobody_moves_stays_in_its_place():
    state = State.at_rest(HANGING)
    before = state.x[:, 1].copy()
    advance(HANGING, state, "leapfrog", 1e-3, 20)
    assert before.tolist() == [0.0, 0.0, -5.0]
    assert (state.x[:, 1] == before).all()
    assert np.abs(state.v).max() < 1e-3


def test_a_fairlead_is_pulled_by_its_last_segment():
    system = chain_on_bed(20)
    rest = system.at_rest()
    force = point_forces(system, State.still(rest.nodes))[2]
    half = 9.81 * 0.5 * 8.0 * (CHAIN.mass - 1025.0 * CHAIN.volume)  # the fairlead is in the surface
    along = rest.x[1][-2] - rest.x[1][-1]
    assert force + (0.0, 0.0, half) == pytest.approx(rest.tension[1][-1] * along / np.linalg.norm(along), rel=1e-9)


def test_momentum_of_a_line_in_a_vacuum_comes_from_what_holds_it():
    """m dv/dt of all nodes is the weight and the forces of both ends, at each of many frames."""
    kind = in_vacuum(LineType("wire", 0.02, 2.0, 1e4))
    points = (Point(1, "fixed", (0.0, 0.0, 0.0)), Point(2, "coupled", (8.0, 0.0, 0.0)))
    system = System((Line(1, kind, 1, 2, 8.5, 10),), points, Water(100.0, density=0.0), bed_stiffness=0.0)
    motion = {2: Shaking((8.0, 0.0, 0.0), 2, 0.5, 3.0)}
    run = simulate(system, 4.0, 2001, 2e-4, motion=motion)
    inner = 2.0 * 0.85  # [kg] of each inner node
    momentum = inner * run.v[1][:, 1:-1].sum(axis=1)
    held = run.force[1] + run.force[2] - (0.0, 0.0, -9.81 * inner)  # without the halves at the ends
    expected = -held - (0.0, 0.0, 9.81 * inner * 9)
    change = (momentum[2:] - momentum[:-2]) / (run.t[2:] - run.t[:-2])[:, None]
    assert np.abs(change - expected[1:-1]).max() < 2e-3 * np.abs(expected).max()


def test_velocities_of_a_run_are_those_of_its_places():
    run = simulate(chain_on_bed(20), 4.0, 1601, motion={2: Shaking((0.0, 0.0, 0.0), 0, 1.0, 5.0)})
    differences = (run.x[1][2:] - run.x[1][:-2]) / (run.t[2:] - run.t[:-2])[:, None, None]
    assert np.abs(differences - run.v[1][1:-1]).max() < 0.01 * np.abs(run.v[1]).max()


def test_steps_from_outside_are_those_of_a_run():
    """A vessel that gives places and velocities every 0.05 s moves the lines as a function of the time does."""
    system, motion = chain_on_bed(20), Shaking((0.0, 0.0, 0.0), 0, 1.0, 5.0)
    run = simulate(system, 1.0, 21, 1e-3, motion={2: motion})
    state = State.at_rest(system)
    state.v[:, 1] = motion.velocity(0.0)
    for frame in range(1, 21):
        t = 0.05 * frame
        paths = paths_to(system, state, {2: (motion(t), motion.velocity(t))}, 0.05)
        advance(system, state, "leapfrog", 1e-3, 50, driven={"paths": paths})
    assert state.t == pytest.approx(1.0)
    assert np.abs(state.x[:, system.nodes_of[1]].T - run.x[1][-1]).max() < 1e-9
    assert point_forces(system, state)[2] == pytest.approx(run.force[2][-1], rel=1e-6)


def test_a_run_begins_with_the_motion_s_velocity_and_at_the_state_s_places():
    state = State.at_rest(HANGING)
    moved = simulate(HANGING, 0.1, 2, motion={2: lambda t: (0.5 * t, 0.0, -5.0)})
    assert moved.v[1][0, -1] == pytest.approx((0.5, 0.0, 0.0), abs=1e-9)
    state.x[0, 1], state.t, state.work, state.force_evals = 0.2, 3.0, 5.0, 7
    held = simulate(HANGING, 0.1, 2, start=state)
    assert held.x[1][:, -1] == pytest.approx(np.array([(0.2, 0.0, -5.0)] * 2))
    assert held.force_evals == simulate(HANGING, 0.1, 2, held.step).force_evals


def test_coupled_points_without_an_end_stop_where_they_are():
    state = State.at_rest(HANGING)
    state.x[0, 1], state.v[0, 1], state.t = 1.0, 0.3, 2.0
    paths = paths_to(HANGING, state, {}, 0.5)
    advance(HANGING, state, "leapfrog", 1e-3, 500, driven={"paths": paths})
    assert state.x[:, 1] == pytest.approx((1.0, 0.0, -5.0), abs=1e-9)
    assert np.abs(state.v[:, 1]).max() < 1e-9


@pytest.mark.parametrize(
    ("name", "call", "words"),
    [
        ("ends", lambda s: paths_to(HANGING, s, {1: ((0, 0, 0), (0, 0, 0))}, 1.0), "coupled"),
        ("ends[2]: place", lambda s: paths_to(HANGING, s, {2: ((0, 0), (0, 0, 0))}, 1.0), "3"),
        ("ends[2]: velocity", lambda s: paths_to(HANGING, s, {2: ((0, 0, 0), math.nan)}, 1.0), "3"),
        ("duration", lambda s: paths_to(HANGING, s, {}, 0.0), "above 0"),
        ("driven", lambda s: advance(HANGING, s, "rk4", 1e-3, 1, driven={"path": s.x}), "paths"),
        ("driven: paths", lambda s: advance(HANGING, s, "rk4", 1e-3, 1, driven={"paths": s.x}), "(1, 5, 3)"),
        ("driven: current", lambda s: advance(HANGING, s, "rk4", 1e-3, 1, driven={"current": [0.0]}), "(3,)"),
        ("integrator", lambda s: advance(HANGING, s, "implicit_euler", 1e-3, 1), "leapfrog"),
        ("state.x", lambda s: point_forces(chain_on_bed(5), s), "(3, 6)"),
        ("start", lambda s: simulate(HANGING, 1.0, 2, start=HANGING.at_rest()), "a State"),
    ],
)
def test_bad_arguments_are_named(name, call, words):
    assert_refused(name, lambda: call(State.at_rest(HANGING)), words)


def test_the_paths_of_a_motion_go_through_its_places_and_velocities():
    motion = Shaking((0.0, 0.0, -5.0), 1, 2.0, 6.0)
    state = State.at_rest(HANGING)
    state.t = 12.0
    path = paths_of(HANGING, state, {2: motion}, 0.2)[0]
    for s in (0.0, 0.2):
        assert np.polynomial.polynomial.polyval(s, path[:4]) == pytest.approx(motion(12.0 + s), abs=1e-12)
        slope = np.polynomial.polynomial.polyder(path[:4])
        assert np.polynomial.polynomial.polyval(s, slope) == pytest.approx(motion.velocity(12.0 + s), abs=1e-12)
