"""Long solves end early: at Ctrl-C, and where another thread asks for it."""

import signal
import threading
import time

import numpy as np
import pytest

from app.scenes.race.parameters import RaceParams
from app.scenes.race.scene import RaceScene
from sim.interruption import InterruptionError, stop_request, use_request
from sim.springs import INTEGRATORS, State, advance, cloth, rope, simulate

STIFF = cloth(24, 24, stiffness=1e6, shear=1e6, bend=1e6)
LONG, STIFF_ROPE = rope(4), rope(50, stiffness=1e9)


def solve(name, seconds):
    """Minutes to hours for many seconds, if nothing ends it."""
    if name == "rk4":
        simulate(LONG, duration=seconds, frames=2, step=1e-8, integrator=name)
    elif name == "dop853":
        simulate(STIFF_ROPE, duration=seconds, frames=2, integrator=name, rtol=1e-12, atol=1e-15)
    else:
        simulate(STIFF, duration=seconds, frames=2, step=1 / 60, integrator=name)


ENDLESS = [*(name for name, record in INTEGRATORS.items() if record.implicit), "dop853", "rk4"]


@pytest.fixture
def request_of_this_thread():
    """A request as the simulation's thread has one; what was there before comes back."""
    before, request = stop_request(), np.zeros(4, np.int64)
    use_request(request)
    yield request
    use_request(before)


def soon(action, seconds=0.3):
    thread = threading.Thread(target=lambda: (time.sleep(seconds), action()))
    thread.start()
    return thread


@pytest.mark.parametrize("name", ENDLESS)
def test_ctrl_c_ends_a_solve_in_the_middle(name):
    solve(name, 1e-4)  # compiles
    thread = soon(lambda: signal.raise_signal(signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        solve(name, 50.0)
    thread.join()
    solve(name, 1e-4)  # the next one is not ended


@pytest.mark.parametrize("name", ENDLESS)
def test_another_thread_ends_a_solve_in_the_middle(name, request_of_this_thread):
    def ask():
        request_of_this_thread[0] = 1

    solve(name, 1e-4)
    thread = soon(ask)
    with pytest.raises(InterruptionError):
        solve(name, 50.0)
    thread.join()


def test_a_state_stays_that_of_a_whole_step(request_of_this_thread):
    state = State.at_rest(STIFF)
    advance(STIFF, state, INTEGRATORS["implicit_euler"], 1 / 60, 1)
    before = state.copy()
    request_of_this_thread[0] = 1
    with pytest.raises(InterruptionError):
        advance(STIFF, state, INTEGRATORS["implicit_euler"], 1 / 60, 1)
    assert (state.t, state.steps) == (before.t, before.steps)
    assert np.array_equal(state.x, before.x)
    assert np.array_equal(state.v, before.v)


def test_a_race_that_is_ended_early_goes_on_from_where_all_its_ropes_were(request_of_this_thread):
    ended, other = (
        RaceScene(RaceParams(ropes=2, integrator="leapfrog", integrator_2="implicit_euler")) for _ in range(2)
    )
    for scene in (ended, other):
        scene.advance(3)
    second = ended.race.entrants[1]
    first = second.after

    def until_asked(net, ticks):
        request_of_this_thread[0] = 1
        return first(net, ticks)

    second.after = until_asked
    with pytest.raises(InterruptionError):
        ended.advance(1)
    second.after = first
    request_of_this_thread[0] = 0
    for scene in (ended, other):
        scene.advance(2)
    assert ended.time == other.time
    assert np.array_equal(ended.race.points(), other.race.points())
    assert np.array_equal(ended.race.references[0].x, other.race.references[0].x)
