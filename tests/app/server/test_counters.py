"""What was done and what was skipped, scene by scene."""

import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest

from app.messages import Snapshot, WorkCount
from app.panel.work_table import work_rows, work_table
from app.render.injection import record_shaders
from app.scenes import NAMES, scene_named
from app.server.counters import HEAVY_PACKAGES, Unwatched, gather, modules, own_sources
from app.server.loop import FRAME_INTERVAL, SimLoop


def ticked(name: str, ticks: int, **parameters: Any) -> SimLoop:
    """A loop of a scene after so many frames."""
    kind = scene_named(name)
    loop = SimLoop(kind.make(kind.params(**parameters)))
    loop.pacer.learn = lambda steps, seconds: None  # a busy machine drops steps
    for _ in range(ticks):
        loop.tick(FRAME_INTERVAL)
    return loop


def test_a_thing_is_counted_in_one_place():
    assert gather({"a": WorkCount(1)}, {"b": WorkCount(2, 3)}) == {"a": WorkCount(1), "b": WorkCount(2, 3)}
    with pytest.raises(ValueError, match=r"^a: "):
        gather({"a": WorkCount(1)}, {"a": WorkCount(2)})


def test_shares_are_of_all_there_was():
    assert WorkCount(1, 3).skipped_share == 0.75
    assert WorkCount(0).skipped_share == WorkCount(5).skipped_share == 0.0
    (row,) = work_rows({"sent": WorkCount(10, 30, "B")})
    assert row == ("sent [B]", 10, 30, 75.0)
    assert ">a &lt;b&gt;</td>" in work_table({"a <b>": WorkCount(1, 2)})


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_counts_its_work_and_never_less_than_nothing(name: str):
    loop = ticked(name, 20)
    counts = gather(loop.work(), loop.latest.work)
    assert counts["ticks"] == WorkCount(20, 0)
    assert counts["snapshots"].done + counts["snapshots"].skipped >= 20
    assert loop.latest.work, "the scene counts nothing"
    for what, work in counts.items():
        assert work.done >= 0, what
        assert work.skipped >= 0, what


@pytest.mark.parametrize("name", NAMES)
def test_a_paused_scene_does_nothing_but_tick(name: str):
    loop = ticked(name, 3)
    before, loop.running = loop.latest.work, False
    for _ in range(30):
        loop.tick(FRAME_INTERVAL)
    assert loop.latest.work == before
    assert loop.work()["ticks"] == WorkCount(3, 30)
    assert loop.work()["snapshots"].done <= 4


def test_the_rope_holds_its_points_against_what_is_there_only():
    steps = 20
    for there, parameters in ((0, {"floor": False}), (1, {}), (2, {"sphere": True})):
        loop = ticked("rope", steps, **parameters)
        work = loop.latest.work
        # Leapfrog evaluates once a step and once more to begin each frame.
        assert work["force evaluations"] == WorkCount(2 * steps)
        assert work["points held against floor or sphere"] == WorkCount(20 * steps * there, 20 * steps * (2 - there))
        assert work["steps with their energy balance"] == WorkCount(steps, 0)  # kept with the plots closed too


def test_a_flat_sea_needs_one_transform_of_eight():
    small = {"size": "64", "mesh": "32", "length": 64.0}
    assert ticked("square_sea", 9, **small).latest.work["transforms"] == WorkCount(30, 50)
    assert ticked("square_sea", 9, choppiness=0.0, **small).latest.work["transforms"] == WorkCount(10, 70)


def test_the_radial_sea_leaves_out_the_waves_that_its_rings_cannot_show():
    loop = ticked("radial_sea", 5)
    scene = loop.scene
    work = loop.latest.work["waves summed at vertices"]
    assert work.skipped > 0
    # The sum's own share of every surface, drawn in turn with the square sea's, which sums nothing.
    assert (work.done + work.skipped) % (len(scene.sum.waves.kx) * len(scene.grid)) == 0
    bodies = scene.params.bodies
    assert loop.latest.work["steps of bodies"].done == bodies * loop.counts["steps"]


def handed_over(lab: Any, frame: Any) -> tuple[float, float]:
    """(arrays, bytes) that showing a frame of the rope sends."""
    before = lab.transport.work()
    with lab.transport.counted():
        lab.view.show(frame)
    after = lab.transport.work()
    arrays, size = (after[what].done - before[what].done for what in ("arrays sent", "sent to each browser"))
    return arrays, size


def tube_bytes(lab: Any) -> int:
    """What the drawn tube takes, packed."""
    return lab.view.tube._packed().nbytes


@pytest.fixture
def still(lab: Any) -> Any:
    """A lab without its threads, and its view, which goes on drawing for browsers with shaders."""
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
    plain = still.scene.frame()._replace(show_points=False)
    assert handed_over(still, plain) == (0, 0)


def test_a_rope_that_nobody_sees_move_is_not_sent_until_it_has(still: Any):
    first = still.scene.frame()
    still.view.show(first)
    points = 12 * still.scene.params.points
    # A tenth of what shows, again and again: what has not been shown must add up.
    creep = [first._replace(points=first.points + np.float32(k * 2e-5)) for k in range(1, 12)]
    assert [handed_over(still, frame)[1] for frame in creep[:9]] == [0] * 9
    assert handed_over(still, creep[10])[1] == tube_bytes(still) + points
    assert np.array_equal(still.view.tension, first.tension)
    # The same holds for colours.
    tint = [creep[10]._replace(tension=first.tension + np.float32(k * 2e-4 * first.full_scale)) for k in range(1, 12)]
    assert [handed_over(still, frame)[1] for frame in tint[:9]] == [0] * 9
    assert handed_over(still, tint[10])[1] == tube_bytes(still)
    assert handed_over(still, tint[10]._replace(colour="plain"))[1] == tube_bytes(still)


def test_a_rope_at_rest_is_not_looked_at_again():
    steps = 120
    hangs = ticked("rope", steps, gravity=0.0).latest.work["stability checks"]
    falls = ticked("rope", steps).latest.work["stability checks"]
    assert hangs == WorkCount(0, steps)
    assert falls.done in (3, 4)
    # An implicit method's Newton corrections are news at any time.
    assert ticked("rope", steps, gravity=0.0, integrator="tr_bdf2").latest.work["stability checks"].done > 0


def test_what_is_handed_over_outside_of_counting_is_not_counted(still: Any):
    still.view.show(still.scene.frame())
    before = still.transport.work()
    still.view.tube.set(np.zeros_like(still.view.vertices))
    assert still.transport.work() == before
    with still.transport.counted():
        thread = threading.Thread(target=still.view.tube.set, args=(np.ones_like(still.view.vertices),))
        thread.start()
        thread.join()
    assert still.transport.work() == before


def test_closed_charts_are_not_drawn(still: Any):
    plots, scene = still.panel.plots, still.scene
    charts = len(still.panel.kind.plots) + len(still.panel.kind.curves)
    drawn, spared = plots.work()["charts drawn"][:2]
    plots.sent_at = -1e9
    plots.update(still.loop.latest, [])
    assert plots.work()["charts drawn"] == WorkCount(drawn, spared + charts)
    still.loop.plot_rows.clear()
    scene.params = type(scene.params)(plot_tip=True)
    for _ in range(3):
        scene.advance(3)
    snapshot: Snapshot = still.loop.snapshot()
    rows = list(still.loop.plot_rows)
    assert len(rows) >= 2
    for new in (rows, []):  # the second time there is nothing new
        plots.sent_at = -1e9
        plots.update(snapshot, new)
    assert plots.work()["charts drawn"] == WorkCount(drawn + 1, spared + 3 * charts - 1)


def test_processor_time_counts_while_nobody_looks_only():
    watch = Unwatched()
    for audience in (1, 0, 1, 0):
        watch.note(audience)
    assert watch.work()["processor time, nobody looking"] == WorkCount(0.0, 0.0, "s")
    end = time.process_time() + 0.05
    while time.process_time() < end:
        pass
    watch.note(0)
    assert 0.05 <= watch.busy < 5.0
    watch.note(1)
    assert watch.busy < 5.0
    assert watch.since is None


def test_the_rope_imports_neither_seas_nor_transforms():
    code = (
        "import sys, app.server.counters as l; from app.scenes import scene_named; scene_named('rope');"
        "print(sorted(n for n in sys.modules if n.startswith('sim.')), l.modules()['heavy packages imported'].done,"
        "l.modules()['modules imported'].done)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120)
    names, heavy, own = done.stdout.rpartition("]")[0], *done.stdout.split()[-2:]
    for other in ("ocean", "floating", "particles"):
        assert f"sim.{other}" not in names
    assert int(heavy) == 0
    assert int(own) < own_sources() / 2
    assert modules()["heavy packages imported"].done <= len(HEAVY_PACKAGES)
