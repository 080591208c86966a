"""Plot rows come at the rate that a scene declares, evenly, and wait in bounded memory."""

from typing import Any

import numpy as np
import pytest

from app.scenes import plot_rows, scene_named
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.plot_rows import ROW_INTERVAL, PlotRows
from app.scenes.radial_sea.scene import PLOT_INTERVAL
from app.scenes.square_sea.scene import PLOT_ROW_INTERVAL, SquareSeaScene

DURATION = 10.0  # [s]
SMALL: dict[str, tuple[dict[str, Any], float]] = {  # parameters, and the declared interval [s]
    "rope": ({"points": 3, "integrator": "rk4"}, ROW_INTERVAL),
    "race": ({"points": 3, "ropes": 1}, ROW_INTERVAL),
    "cloth": ({"rows": 3, "cols": 3, "integrator": "rk4", "stiffness": 50.0}, ROW_INTERVAL),
    "square_sea": ({"size": "64", "mesh": "32", "statistics": False}, PLOT_ROW_INTERVAL),
    "radial_sea": ({"bodies": 1, "rings": 20, "spokes": 24}, PLOT_INTERVAL),
}


def small_scene(name: str, step: float) -> Any:
    values = SMALL[name][0]
    kind = scene_named(name)
    if name == "square_sea":
        return SquareSeaScene(kind.params(**values), step=step)  # type: ignore[arg-type]
    return kind.make(kind.params(**values, time_step=step))


@pytest.mark.parametrize(
    ("name", "step"),
    [
        pytest.param(name, step, marks=pytest.mark.long if (name, step) == ("radial_sea", 1 / 600) else ())
        for name in SMALL
        for step in (1 / 60, 1 / 120, 1 / 600)
    ],
)
def test_rows_come_at_the_declared_rate_and_evenly(name: str, step: float) -> None:
    scene, interval = small_scene(name, step), SMALL[name][1]
    count = round(DURATION / interval)
    steps = round(FRAME_INTERVAL / scene.step)
    scene.frame()  # of the start
    for _ in range(round(DURATION / FRAME_INTERVAL)):
        scene.advance(steps)
        if name == "square_sea":
            scene.frame()  # evaluates the surface, which the others do as they advance
    rows = scene.take_plot_rows()
    assert bool(rows) is (name != "race")
    times = np.array([row[0] for row in rows])
    if name == "race":
        times = scene.curves()["plot_errors"].columns[0][1:]  # the first is that of the first tick
    assert abs(len(times) - count) <= 1
    assert times[0] == 0.0 or name == "race"
    np.testing.assert_allclose(np.diff(times), interval, atol=1e-9)


def test_rows_keep_their_rate_where_no_step_meets_their_interval() -> None:
    rows = PlotRows(interval=0.1)
    for i in range(1000):
        t = 0.07 * i
        if rows.is_due(t):
            rows.add(t, 0.0)
    times = np.array([row[0] for row in rows.take()])
    assert len(times) == 700
    assert np.abs(times - 0.1 * np.arange(700)).max() < 0.07


@pytest.mark.parametrize("name", [name for name in SMALL if name != "race"])
def test_a_long_run_holds_no_more_rows_than_a_short_one(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As `springtide run` does it: it takes no rows. Those of a race are thinned out as it continues."""
    monkeypatch.setattr(plot_rows, "MAX_WAITING_ROWS", 16)
    scene = small_scene(name, 1 / 60)
    for _ in range(240):
        scene.advance(1)
        scene.frame()
    rows = scene.take_plot_rows()
    assert len(rows) == 16
    assert rows[-1][0] == pytest.approx(4.0, abs=2.0 * SMALL[name][1])  # the newest are kept
