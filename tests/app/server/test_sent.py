"""A browser is sent what changed and nothing else."""

import dataclasses
import threading
from typing import Any

import numpy as np
import pytest

from app.messages import Snapshot
from app.render.injection import record_shaders


def handed_over(lab: Any, frame: Any) -> tuple[int, int]:
    """(arrays, bytes) that showing a frame of the rope sends."""
    before = lab.transport.sent.copy()
    with lab.transport.counted():
        lab.view.show(frame)
    sent = lab.transport.sent - before
    return sent["arrays"], sent["bytes"]


def tube_bytes(lab: Any) -> int:
    """Size of the drawn tube, packed."""
    return lab.view.ropes.tubes[0]._packed().nbytes


@pytest.fixture
def still(lab: Any) -> Any:
    """A lab without its threads, and its view, which continues drawing for browsers with shaders."""
    lab.served.stop_threads()
    record_shaders(lab.server)
    return lab


def test_a_browser_is_sent_what_changed_and_nothing_else(still: Any):
    still.view.show(still.scene.frame())
    points = 12 * still.scene.params.points
    # The tube and its colours are one packed array.
    assert handed_over(still, still.scene.frame()) == (0, 0)
    still.scene.advance(5)
    assert handed_over(still, still.scene.frame()) == (2, tube_bytes(still) + points)
    frame = still.scene.frame()
    plain = dataclasses.replace(frame.params, show_points=False)
    assert handed_over(still, frame._replace(params=plain)) == (0, 0)


def test_a_rope_that_nobody_sees_move_is_not_sent_until_it_has(still: Any):
    first = still.scene.frame()
    still.view.show(first)
    points = 12 * still.scene.params.points
    # A tenth of what shows, again and again: what has not been shown must add up.
    creep = [first._replace(points=first.points + np.float32(k * 2e-5)) for k in range(1, 12)]
    assert [handed_over(still, frame)[1] for frame in creep[:9]] == [0] * 9
    hanger = still.view.hanger.shapes[0].nbytes  # which moves with the root
    assert handed_over(still, creep[10])[1] == tube_bytes(still) + points + hanger
    assert np.array_equal(still.view.ropes.tension, first.tension)
    # The same holds for colours.
    tint = [creep[10]._replace(tension=first.tension + np.float32(k * 2e-4 * first.full_scale)) for k in range(1, 12)]
    assert [handed_over(still, frame)[1] for frame in tint[:9]] == [0] * 9
    assert handed_over(still, tint[10])[1] == tube_bytes(still)
    plain = dataclasses.replace(first.params, colour="plain")
    assert handed_over(still, tint[10]._replace(params=plain))[1] == tube_bytes(still)


def test_what_is_handed_over_outside_of_counting_is_not_counted(still: Any):
    still.view.show(still.scene.frame())
    before = still.transport.sent.copy()
    still.view.ropes.tubes[0].set(np.zeros_like(still.view.ropes.vertices[0]))
    assert still.transport.sent == before
    with still.transport.counted():
        thread = threading.Thread(
            target=still.view.ropes.tubes[0].set, args=(np.ones_like(still.view.ropes.vertices[0]),)
        )
        thread.start()
        thread.join()
    assert still.transport.sent == before


def test_closed_charts_are_not_drawn(still: Any):
    plots, scene = still.panel.plots, still.scene
    drawn = plots.drawn
    plots.sent_at = -1e9
    plots.update(still.loop.latest, [])
    assert plots.drawn == drawn
    still.loop.run.snapshots.plot_rows.clear()
    scene.params = type(scene.params)(plot_tip=True)
    for _ in range(3):
        scene.advance(3)
    snapshot: Snapshot = still.loop.run.snapshots.snapshot()
    rows = list(still.loop.run.snapshots.plot_rows)
    assert len(rows) >= 2
    for new in (rows, []):  # the second time there is nothing new
        plots.sent_at = -1e9
        plots.update(snapshot, new)
    assert plots.drawn == drawn + 1
