"""The last moments of a run that diverged, shown again by the loop."""

import numpy as np
import pytest

from app.messages import Change, LastFrame, Pause, Play, Reset, StepOnce
from app.render.cameras import fit_cameras
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.rope.parameters import PRESETS, RopeParams
from app.scenes.rope.scene import RopeScene
from app.server.loop.replay import MOMENT_INTERVAL, Replay
from app.server.loop.sim_loop import SimLoop
from sim.parameters import check_record
from tests.app.render.test_cameras import FakeCamera

MOMENTS = tuple(LastFrame(0.1 * k, k, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)) for k in range(4))


def diverged(**changes: object) -> SimLoop:
    """A loop in which the rope has just diverged."""
    loop = SimLoop(RopeScene(check_record(RopeParams, {**PRESETS["Euler explodes"], **changes})))
    for _ in range(1000):
        loop.tick(FRAME_INTERVAL)
        if loop.run.replay is not None:
            return loop
    pytest.fail("it did not diverge")


def spread(loop: SimLoop) -> float:
    """Largest distance [m] of a drawn point from the root."""
    points = loop.latest.frame.points
    return float(np.linalg.norm(points - points[0], axis=1).max())


def test_every_moment_is_shown_once_whatever_the_ticks_are() -> None:
    for tick in (0.3 * MOMENT_INTERVAL, MOMENT_INTERVAL, 100.0):
        replay, seen = Replay(MOMENTS, "why"), [0]
        while not replay.ended:
            if replay.play(tick):
                seen.append(replay.number)
        assert seen == [0, 1, 2, 3]


def test_the_explosion_is_shown_slowly_up_to_beyond_its_bounds_and_then_said() -> None:
    loop = diverged()
    assert loop.run.running
    assert not loop.run.halted
    first, spreads, times = loop.run.replay, [], []
    assert len(first.moments) == 60
    ticks = 0
    while loop.run.running:
        loop.tick(FRAME_INTERVAL)
        ticks += 1
        assert loop.run.replay is first
        assert loop.latest.status.replayed is not None
        spreads.append(spread(loop))
        times.append(loop.latest.status.time)
    assert 59 * MOMENT_INTERVAL < ticks * FRAME_INTERVAL < 62 * MOMENT_INTERVAL
    assert (np.diff(times) >= 0.0).all()
    assert times[-1] - times[0] == pytest.approx(59 / 60, abs=0.01)
    assert spreads[0] < 3.5
    assert spreads[-1] > loop.scene.motion.max_reach
    assert "became unstable" in loop.run.halted
    assert loop.latest.status.halted == loop.run.halted


def test_a_divergence_within_a_frame_is_shown_step_by_step() -> None:
    loop = diverged(time_step=2e-4, stiffness=3e6, damping=10.0)
    times = np.diff([moment.time for moment in loop.run.replay.moments])
    assert times[-5:] == pytest.approx(2e-4)
    low, high = np.array([loop.run.replay.moment.low, loop.run.replay.moment.high])
    assert (low <= high).all()


def test_pause_stops_the_replay_and_step_shows_the_next_moment() -> None:
    loop = diverged()
    loop.tick(2 * MOMENT_INTERVAL)
    number = loop.run.replay.number
    loop.commands.put(Pause())
    for _ in range(20):
        loop.tick(FRAME_INTERVAL)
    assert loop.run.replay.number == number
    loop.commands.put(StepOnce())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.replay.number == number + 1
    loop.commands.put(Play())
    loop.tick(MOMENT_INTERVAL)
    assert loop.run.replay.number == number + 2


def test_a_reset_ends_the_replay_and_other_forces_halt_at_the_last_good_state() -> None:
    loop = diverged()
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.replay is None
    assert loop.latest.status.replayed is None
    assert loop.run.running
    loop = diverged()
    params = check_record(RopeParams, {**PRESETS["Euler explodes"], "stiffness": 10.0})
    loop.commands.put(Change(params, "forces"))
    loop.tick(FRAME_INTERVAL)
    assert loop.run.replay is None
    assert "became unstable" in loop.run.halted
    loop.commands.put(Play())
    for _ in range(20):
        loop.tick(FRAME_INTERVAL)
    assert loop.run.running


def test_a_step_by_hand_that_diverges_halts_at_once() -> None:
    loop = SimLoop(RopeScene(check_record(RopeParams, PRESETS["Euler explodes"])), paused=True)
    for _ in range(400):
        loop.commands.put(StepOnce())
        loop.tick(FRAME_INTERVAL)
        if loop.run.halted:
            break
    assert "became unstable" in loop.run.halted
    assert loop.run.replay is None


class Client:
    def __init__(self) -> None:
        self.camera = FakeCamera()


class Server:
    def __init__(self) -> None:
        self.client = Client()

    def get_clients(self) -> dict[int, Client]:
        return {0: self.client}


@pytest.mark.parametrize(("size", "moves"), [(0.1, False), (20.0, True)])
def test_a_camera_is_fitted_by_moving_away_and_never_nearer(size: float, moves: bool) -> None:
    server, view, angle = Server(), ((0.0, -4.0, 2.0), (0.0, 0.0, 2.0)), 1.3
    fit_cameras(server, view, angle, ((-size, -size, 2.0 - size), (size, size, 2.0 + size)))
    position, target = np.array(server.client.camera.position), np.array(server.client.camera.look_at)
    np.testing.assert_allclose(target, view[1])
    distance = np.linalg.norm(position - target)
    assert (distance > 4.0) == moves
    corners = np.array(np.meshgrid(*[[-size, size]] * 3)).reshape(3, -1).T
    along = corners @ [0.0, 1.0, 0.0] + distance
    across = np.linalg.norm(corners[:, [0, 2]], axis=1)
    assert (np.arctan2(across, along) < 0.5 * angle).all()
