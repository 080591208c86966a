"""Whatever starts, starts at the time of what it meets, and a run that is cut in pieces is the run in one piece."""

import dataclasses
import itertools
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.floating import Body, FloatState, Hull, float_in
from sim.mooring import Line, LineType, Point, State, System, advance
from sim.mooring import simulate as simulate_mooring
from sim.ocean import SPECTRA, NonlinearSea, RadialSea, Sea, draw_waves
from sim.ocean.any_sea import AnySea
from sim.springs import cloth, rope, simulate
from sim.springs.net import Net, PinPath
from sim.water import Water
from sim.waves import Waves
from tests.refusals import assert_refused

BODIES = [Body(Hull.box(2.0, 2.0, 1.0), density=500.0).afloat(), Body(Hull.cylinder(0.5, 0.5), 400.0).afloat()]
BODIES[1] = BODIES[1]._replace(position=(30.0, 12.0, BODIES[1].position[2]))
CHAIN = LineType("chain", 0.1, 200.0, 1e8)
POINTS = (Point(1, "fixed", (-60.0, 0.0, -30.0)), Point(2, "coupled", (0.0, 0.0, -1.0)))
WAVES = Waves([0.06, 0.11], [0.0, 0.03], [1.0, 0.4], [0.3, 2.0], water=Water(30.0))
MOORING = System((Line(1, CHAIN, 1, 2, 70.0, 8),), POINTS, water=Water(30.0), waves=WAVES)


def changed() -> Sea:
    sea = Sea(32, 120.0, "sea_state", hs=0.5, tp=5.0)
    sea.change(7.25, relax=20.0, hs=1.0)
    return sea


def grown() -> NonlinearSea:
    sea = NonlinearSea(32, 120.0, start=Sea(32, 120.0, "sea_state", hs=0.3, tp=5.0), fade=2.0)
    sea.advance(2.5)
    return sea


SEAS = {
    "tile": lambda: Sea(32, 120.0, "sea_state", hs=0.5, tp=5.0),
    "decaying tile": lambda: Sea(32, 120.0, "sea_state", hs=0.5, tp=5.0, viscosity=1e-3),
    "changing tile": changed,
    "nonlinear, faded in": grown,
    "nonlinear, from another time": lambda: NonlinearSea(32, 120.0, start=WAVES, time=100.0),
    "linear march": lambda: NonlinearSea(32, 120.0, 1, start=WAVES, time=100.0),
    "sum": lambda: RadialSea(draw_waves(SPECTRA["jonswap"], SPECTRA["jonswap"].conditions(wind_speed=5.0), 20)),
}


@pytest.mark.parametrize("kind", SEAS)
def test_bodies_begin_at_the_time_of_their_sea_and_continue_there(kind: str) -> None:
    sea = SEAS[kind]()
    begin = sea.time
    first = float_in(sea, BODIES, 0.5, frames=6)
    assert first.t == pytest.approx(begin + np.linspace(0.0, 0.5, 6), abs=1e-12)
    assert sea.time == pytest.approx(begin + 0.5, abs=1e-12)
    second = float_in(sea, BODIES, 0.5, frames=6)
    assert second.t == pytest.approx(begin + 0.5 + np.linspace(0.0, 0.5, 6), abs=1e-12)
    same = SEAS[kind]()
    again = float_in(same, BODIES, 0.5, frames=6, begin=begin + 0.5)
    assert again.x == pytest.approx(second.x, abs=1e-9)
    assert not np.allclose(first.x, second.x, atol=1e-6)


def test_a_begin_that_a_sea_cannot_have_is_refused() -> None:
    assert_refused("begin", lambda: FloatState(SEAS["tile"](), BODIES, begin=math.nan))
    assert_refused("t", lambda: FloatState(changed(), BODIES, begin=7.0), "7.25 s or later")


def test_bodies_float_on_as_the_sea_changes_and_feel_its_gravity() -> None:
    sea = SEAS["tile"]()
    state = FloatState(sea, BODIES)
    state.advance(1 / 60, 20)
    sea.change(state.t, relax=1.0, gravity=1.62, hs=1.0)
    assert state.gravity == 1.62
    state.fleet.position[0, 2] += 50.0
    state.fleet.velocity[0] = 0.0
    state.advance(1 / 60, 12)
    assert state.fleet.velocity[0, 2] == pytest.approx(-1.62 * 0.2, rel=1e-6)


@pytest.mark.parametrize("kind", SEAS)
def test_bodies_in_a_sea_cut_in_three_and_saved_are_bitwise_those_of_one_run(kind: str, tmp_path: Path) -> None:
    whole, cut = FloatState(SEAS[kind](), BODIES), FloatState(SEAS[kind](), BODIES)
    whole.advance(1 / 60, 43)
    for steps in (11, 25, 7):
        cut.advance(1 / 60, steps)
        (tmp_path / "state").write_bytes(pickle.dumps(cut))
        cut = pickle.loads((tmp_path / "state").read_bytes())
    assert cut.t == whole.t
    for name, one in whole.fleet._asdict().items():
        if isinstance(one, np.ndarray):
            np.testing.assert_array_equal(getattr(cut.fleet, name), one, err_msg=name)


def vessel(t: float) -> tuple[float, float, float]:
    if t < 3.0:
        raise ValueError(f"asked at {t} s, before the start")
    return (0.5 * math.sqrt(t - 3.0), 0.2 * math.sin(t), -1.0)


def pieces_of(run_of: Any, start: State, tmp_path: Path) -> list[Any]:
    """Runs of 0.4 s each, one after the other, from states that were saved."""
    runs = []
    for _ in range(3):
        (tmp_path / "state").write_bytes(pickle.dumps(start))
        runs.append(run_of(0.4, 5, pickle.loads((tmp_path / "state").read_bytes())))
        start = runs[-1].state
    return runs


@pytest.mark.parametrize("motion", [{}, {2: vessel}], ids=["held", "moved"])
@pytest.mark.parametrize("integrator", ["leapfrog", "rk4", "leapfrog_lagged"])
def test_a_mooring_in_waves_cut_in_three_is_bitwise_that_of_one_run(motion, integrator: str, tmp_path: Path) -> None:
    start = State.at_rest(MOORING)
    start.t = 3.0

    def run_of(duration: float, frames: int, state: State) -> Any:
        return simulate_mooring(
            MOORING, duration, frames, 1e-3, integrator, motion=motion, start=state, with_account=True
        )

    whole = run_of(1.2, 13, start)
    pieces = pieces_of(run_of, start, tmp_path)
    assert whole.t == pytest.approx(3.0 + np.linspace(0.0, 1.2, 13), abs=1e-12)
    for name in ("x", "v", "tension", "end_tension"):
        joined = np.concatenate([getattr(piece, name)[1][1 if i else 0 :] for i, piece in enumerate(pieces)])
        np.testing.assert_array_equal(joined, getattr(whole, name)[1], err_msg=name)
        for before, after in itertools.pairwise(pieces):
            np.testing.assert_array_equal(getattr(before, name)[1][-1], getattr(after, name)[1][0], err_msg=name)
    for name in ("dissipated", "work"):
        joined = np.concatenate([getattr(p.energy, name)[1 if i else 0 :] for i, p in enumerate(pieces)])
        np.testing.assert_array_equal(joined, getattr(whole.energy, name), err_msg=name)
    assert np.concatenate([p.t[1 if i else 0 :] for i, p in enumerate(pieces)]) == pytest.approx(whole.t, abs=1e-12)


def test_a_mooring_that_starts_later_meets_the_waves_of_that_time() -> None:
    """`simulate` from a state at 1 s is the run from 0 that has come so far."""
    state = State.at_rest(MOORING)
    whole = simulate_mooring(MOORING, 2.0, 21, 1e-3, start=state)
    advance(MOORING, state, "leapfrog", 1e-3, 1000)
    rest = simulate_mooring(MOORING, 1.0, 11, 1e-3, start=state)
    np.testing.assert_allclose(rest.x[1], whole.x[1][10:], rtol=0, atol=1e-9)
    assert np.abs(rest.x[1] - whole.x[1][:11]).max() > 1e-3


def test_the_velocity_of_a_motion_is_taken_from_times_after_its_start() -> None:
    asked: list[float] = []

    def motion(t: float) -> tuple[float, float, float]:
        asked.append(t)
        return (0.3 * math.sin(2.0 * t), 0.0, -1.0)

    run = simulate_mooring(MOORING, 0.4, 5, 1e-3, motion={2: motion})
    assert min(asked) == 0.0
    assert run.v[1][:, -1, 0] == pytest.approx(0.6 * np.cos(2.0 * run.t), abs=1e-6)


def carried() -> Net:
    """A rope whose first point moves."""
    net = rope(8, stiffness=400.0, mass=0.1, damping=1.0)
    (pin,) = net.pinned
    path = PinPath(-1.0, ((0.0, 0.0, 0.0), (0.3, 0.1, 0.0), (0.0, 0.1, -0.2), (-0.05, 0.0, 0.05)))
    return dataclasses.replace(net, pin_paths=((pin, path),))


NETS = {
    "rope with a moved pin": carried,
    "cloth": lambda: cloth(6, 6, damping=0.01),
    "moving sphere": lambda: dataclasses.replace(
        cloth(6, 6, sphere=(0.5, 0.5, -0.5, 0.4)), sphere_velocity=(0.0, 0.0, 0.3)
    ),
}


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("integrator", ["rk4", "leapfrog_lagged", "implicit_euler", "tr_bdf2"])
def test_a_net_cut_in_three_is_bitwise_that_of_one_run(name: str, integrator: str, tmp_path: Path) -> None:
    net = NETS[name]()

    def run_of(duration: float, frames: int, state: State) -> Any:
        return simulate(net, duration, frames, 1e-3, integrator, start=state, with_account=True)

    start = State.at_rest(net)
    start.t = 0.5
    whole, pieces = run_of(1.2, 13, start), pieces_of(run_of, start, tmp_path)
    for field in ("x", "v"):
        joined = np.concatenate([getattr(piece, field)[1 if i else 0 :] for i, piece in enumerate(pieces)])
        np.testing.assert_array_equal(joined, getattr(whole, field), err_msg=field)
    assert pieces[-1].state.t == whole.state.t
    assert pieces[-1].state.force_evals == whole.state.force_evals == sum(p.force_evals for p in pieces)


def test_an_adaptive_run_continues_at_the_time_of_its_state() -> None:
    net = carried()
    whole = simulate(net, 1.0, 11, integrator="dop853", rtol=1e-10, atol=1e-12)
    first = simulate(net, 0.4, 5, integrator="dop853", rtol=1e-10, atol=1e-12)
    assert first.state is not None
    rest = simulate(net, 0.6, 7, integrator="dop853", rtol=1e-10, atol=1e-12, start=first.state)
    assert rest.t == pytest.approx(whole.t[4:])
    assert rest.x == pytest.approx(whole.x[4:], abs=1e-7)
    assert_refused("start", lambda: simulate(net, 1.0, start=first.state, x=whole.x[0]), "x and v")


def test_any_sea_has_a_time_to_begin_at() -> None:
    for make in SEAS.values():
        sea = make()
        assert isinstance(sea, AnySea)
        assert FloatState(sea, BODIES).t == sea.time
