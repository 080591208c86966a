"""Two minutes of a sea are kept in bounded memory, and gone on from to the last bit."""

import numpy as np
import pytest

from app.panel.recording.recorder import MAX_BYTES, Recorder, arrays_of_frame
from app.scenes import scene_named
from app.scenes.checkpoints import arrays_in
from app.server.loop.sim_loop import SimLoop

RATE = 30  # [1/s] frames
DURATION = 130  # [s]


@pytest.mark.parametrize("name", ["square_sea", "radial_sea"])
def test_two_minutes_of_a_sea_are_kept_and_gone_on_from_to_the_last_bit(name: str) -> None:
    kind = scene_named(name)
    params = kind.params()
    loop = SimLoop(kind.make(params), effort=lambda: 0.0)
    recorder = Recorder(kind.packing)
    steps: dict[float, int] = {}  # at each frame
    for tick in range(DURATION * RATE):
        loop.tick(1 / RATE)
        recorder.note(loop.latest, tick / RATE)
        steps[loop.scene.time] = loop.run.counts["steps"]
        assert recorder.memory.bytes <= MAX_BYTES
    arrays: dict[int, int] = {}
    for kept in recorder.frames:
        arrays |= arrays_of_frame(kept.packed) | ({} if kept.state is None else arrays_in(kept.state.value))
    assert recorder.memory.bytes == sum(arrays.values())
    low, high = recorder.span()
    times = np.array([kept.time for kept in recorder.frames])
    assert high - low > 120.0
    assert np.diff(times).max() < 2.0
    assert np.diff(times[times > high - 3.0]).max() < 1.5 / RATE
    recorder.show_time(high - 30.0)
    kept = recorder.resumable()
    assert kept is not None
    assert kept.state is not None
    assert kept.time > high - 31.0
    scene, done = kind.make(params), steps[kept.time]
    scene.resume(kept.state.value)
    for time, count in steps.items():
        if time > kept.time:
            scene.advance(count - done)
            scene.frame()
            done = count
    for key, (array, _) in loop.scene.arrays().items():
        np.testing.assert_array_equal(scene.arrays()[key][0], array, err_msg=key)
    print(f"{name}: {high - low:.0f} s, {len(times)} frames, {recorder.memory.bytes / 1e6:.0f} MB")
