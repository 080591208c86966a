"""Hours of running, with the memory watched.

`SPRINGTIDE_STRESS_SOAK=3600 pytest -m stress tests/stress/test_soak.py` serves each scene for a real hour; without it,
an hour of simulated time runs as fast as possible, and a served one lasts as long as stated below.
"""

import time

import pytest

from app.messages import Play, Reset
from app.scenes import NAMES
from app.scenes.ahead.compiling import prepare
from app.server.loop.clock import MAX_CATCH_UP
from app.server.viewer import Viewer
from sim.parameters import parameters_of
from tests.stress.clients import clients_of, until
from tests.stress.hammer import Hammer
from tests.stress.memory import GROWTH, resident
from tests.stress.tally import SERVED, Tally

HOUR = 3600.0  # [s] of simulated time
# Smaller, or in longer steps, so that an hour of it fits in a minute or two.
PRESS = {"cloth": {"rows": 8, "cols": 8, "time_step": 1e-3}, "radial_sea": {"time_step": 1 / 20}}


def test_an_hour_of_simulated_time(hammer: Hammer, tally: Tally) -> None:
    for name, value in PRESS.get(hammer.name, {}).items():
        hammer.set(name, value)
    speed = hammer.parameters["speed"].high
    hammer.set("speed", speed)
    hammer.loop.clock.effort = lambda: 0.0  # as on a machine that always keeps up
    hammer.loop.run.fixed_step.cost_unknown = True
    frames = round(HOUR / (speed * MAX_CATCH_UP))
    start = hammer.loop.scene.time
    hammer.frame(frames // 5, wall=MAX_CATCH_UP)
    before = resident()
    hammer.frame(frames - frames // 5, wall=MAX_CATCH_UP)
    after = resident()
    assert not hammer.loop.run.halted, hammer.loop.run.halted
    assert hammer.loop.scene.time - start > 0.99 * HOUR
    tally.notes.append(f"{hammer.name}: an hour simulated in {frames:,} frames, {before:.0f} MB then {after:.0f} MB")
    assert after < GROWTH * before
    hammer.loop.clock.effort = time.thread_time


@pytest.mark.parametrize("name", NAMES)
def test_served_while_clients_come_and_go(name: str, tally: Tally) -> None:
    prepare(name)
    viewer = Viewer("127.0.0.1", 0)
    viewer.open(name)
    plots = [parameter for parameter in parameters_of(viewer.settings.params) if parameter.startswith("plot_")]
    with clients_of(viewer.port) as clients:
        stays = clients.join()
        for plot in plots:
            viewer.panel.controls[plot].set(True)
        before, half = 0.0, time.monotonic() + 0.5 * SERVED
        end = time.monotonic() + SERVED
        visits = 0
        while time.monotonic() < end:
            visitor = clients.join()
            time.sleep(min(1.0, SERVED / 20))
            clients.kill(visitor)
            visits += 1
            if visits % 10 == 0:
                viewer.commands.put(Reset())
                viewer.commands.put(Play())
            if not before and time.monotonic() > half:
                before = resident()
        after = resident()
        assert not viewer.loop.run.halted
        shown, got = viewer.served.shown_serial, clients.received[stays]
        until(lambda: viewer.served.shown_serial > shown and clients.received[stays] > got, "still served")
    viewer.shut()
    tally.notes.append(
        f"{name}: served for {SERVED:g} s to one client and {visits} that came and were killed, "
        f"{before:.0f} MB then {after:.0f} MB"
    )
    assert after < GROWTH * before
