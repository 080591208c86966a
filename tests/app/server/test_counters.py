"""What was done and what was skipped, scene by scene."""

import subprocess
import sys
import time
from typing import Any

import numpy as np
import pytest

from app.scenes import NAMES, scene_named
from app.server.counters import HEAVY, Unwatched, WorkCount, gather, modules, own_sources, rows, table
from app.server.loop import FRAME_INTERVAL, SimLoop


def ticked(name: str, ticks: int, **parameters: Any) -> SimLoop:
    """A loop of a scene after so many frames."""
    module = scene_named(name)
    loop = SimLoop(module.make(module.params(**parameters)))
    loop.pacer.learn = lambda steps, seconds: None  # a busy machine drops steps
    for _ in range(ticks):
        loop.tick(FRAME_INTERVAL)
    return loop


def test_a_thing_is_counted_in_one_place():
    assert gather({"a": WorkCount(1)}, {"b": WorkCount(2, 3)}) == {"a": WorkCount(1), "b": WorkCount(2, 3)}
    with pytest.raises(ValueError, match=r"^a: "):
        gather({"a": WorkCount(1)}, {"a": WorkCount(2)})


def test_shares_are_of_all_there_was():
    assert WorkCount(1, 3).share == 0.75
    assert WorkCount(0).share == WorkCount(5).share == 0.0
    (row,) = rows({"sent": WorkCount(10, 30, "B")})
    assert row == {"what": "sent [B]", "done": 10, "skipped": 30, "skipped [%]": 75.0}
    assert "<td>a &lt;b&gt;</td>" in table({"a <b>": WorkCount(1, 2)})


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_counts_its_work_and_never_less_than_nothing(name: str):
    loop = ticked(name, 20)
    works = gather(loop.work(), loop.latest.work)
    assert works["ticks"] == WorkCount(20, 0)
    assert works["snapshots"].done + works["snapshots"].skipped >= 20
    assert len(loop.latest.work) >= 3
    for what, work in works.items():
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
        assert work["steps with their energy balance"] == WorkCount(0, steps)
    balanced = ticked("rope", steps, plot_energy=True)
    assert balanced.latest.work["steps with their energy balance"] == WorkCount(steps, 0)


def test_a_flat_sea_needs_one_transform_of_eight():
    small = {"size": "64", "mesh": "32", "length": 64.0}
    assert ticked("phillips", 9, **small).latest.work["transforms"] == WorkCount(30, 50)
    assert ticked("phillips", 9, choppiness=0.0, **small).latest.work["transforms"] == WorkCount(10, 70)


def test_the_radial_sea_leaves_out_the_waves_that_its_rings_cannot_show():
    loop = ticked("radial", 5)
    scene = loop.scene
    work = loop.latest.work["waves summed at vertices"]
    assert work.skipped > 0
    # The sum's own share of every surface, drawn in turn with the square sea's, which sums nothing.
    assert (work.done + work.skipped) % (len(scene.sum.waves.kx) * len(scene.grid)) == 0
    bodies = scene.params.bodies
    assert loop.latest.work["steps of bodies"].done == bodies * loop.counts["steps"]


def handed_over(lab: Any, picture: Any) -> tuple[WorkCount, WorkCount]:
    """(arrays, bytes) that showing a picture of the rope adds to the ledger."""
    before = lab.traffic.work()
    with lab.traffic.counted():
        lab.view.show(picture)
    after = lab.traffic.work()
    arrays, size = (
        WorkCount(after[what].done - before[what].done, after[what].skipped - before[what].skipped)
        for what in ("arrays sent", "sent to each browser")
    )
    return arrays, size


def test_a_browser_is_sent_what_changed_and_nothing_else(lab: Any):
    lab.close()  # its threads, not the server
    lab.view.show(lab.scene.frame())
    tube, points = lab.view.vertices.nbytes, 12 * lab.scene.params.points
    # The tube and its colours are one array.
    assert handed_over(lab, lab.scene.frame()) == (WorkCount(0, 2), WorkCount(0, 2 * tube + points))
    lab.scene.advance(5)
    assert handed_over(lab, lab.scene.frame()) == (WorkCount(2, 0), WorkCount(2 * tube + points, 0))
    plain = lab.scene.frame()._replace(show_points=False)
    assert handed_over(lab, plain) == (WorkCount(0, 1), WorkCount(0, 2 * tube))


def test_a_rope_that_nobody_sees_move_is_not_sent_until_it_has(lab: Any):
    lab.close()
    first = lab.scene.frame()
    lab.view.show(first)
    tube, points = lab.view.vertices.nbytes, 12 * lab.scene.params.points
    kept, sent = WorkCount(0, 2 * tube + points), WorkCount(2 * tube + points, 0)
    # A tenth of what shows, again and again: what has not been shown must add up.
    creep = [first._replace(points=first.points + np.float32(k * 2e-5)) for k in range(1, 12)]
    assert [handed_over(lab, picture)[1] for picture in creep[:9]] == [kept] * 9
    assert handed_over(lab, creep[10])[1] == sent
    assert np.array_equal(lab.view.tension, first.tension)
    # So with colours.
    tint = [creep[10]._replace(tension=first.tension + np.float32(k * 2e-4 * first.full_scale)) for k in range(1, 12)]
    assert [handed_over(lab, picture)[1] for picture in tint[:9]] == [kept] * 9
    assert handed_over(lab, tint[10])[1].done == 2 * tube
    assert handed_over(lab, tint[10]._replace(colour="plain"))[1].done == 2 * tube


def test_a_rope_at_rest_is_not_looked_at_again():
    steps = 120
    hangs = ticked("rope", steps, gravity=0.0).latest.work["looks at the stability"]
    falls = ticked("rope", steps).latest.work["looks at the stability"]
    assert hangs == WorkCount(0, steps)
    assert falls.done in (3, 4)
    # An implicit method's Newton corrections are news at any time.
    assert ticked("rope", steps, gravity=0.0, integrator="tr_bdf2").latest.work["looks at the stability"].done > 0


def test_what_other_threads_hand_over_is_not_counted(lab: Any):
    lab.close()
    lab.view.show(lab.scene.frame())
    before = lab.traffic.work()
    lab.view.tube.set(np.zeros_like(lab.view.vertices))
    assert lab.traffic.work() == before


def test_closed_charts_are_not_drawn(lab: Any):
    lab.close()
    plots = lab.panel.plots
    charts = len(lab.panel.kind.plots) + len(lab.panel.kind.curves)
    drawn, spared = plots.work()["charts drawn"][:2]
    plots.sent_at = -1e9
    plots.update(lab.loop.latest, lab.scene.params)
    assert plots.work()["charts drawn"] == WorkCount(drawn, spared + charts)
    params = type(lab.scene.params)(plot_tip=True)
    lab.scene.set_params(params)
    for _ in range(3):
        lab.scene.advance(3)
    snapshot = lab.loop.snapshot(0.0)
    for _ in range(2):  # the second time there is nothing new
        plots.sent_at = -1e9
        plots.update(snapshot._replace(samples=() if plots.rows else snapshot.samples), params)
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
    assert modules()["heavy packages imported"].done <= len(HEAVY)
