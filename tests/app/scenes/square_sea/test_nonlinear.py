"""The square sea beyond linear waves: its presets, what a user does to it, and what the panel says."""

import dataclasses
import math
import queue
from typing import Any

import numpy as np
import pytest

from app.formats.formatting import number
from app.messages import Pause, Play, PointAlong, Reset, RunOn
from app.scenes.quantities import measured
from app.scenes.square_sea import SCENE, report
from app.scenes.square_sea.nonlinear import crest_pace
from app.scenes.square_sea.parameters import LINEAR_ONLY, PRESETS, SquareSeaParams, hidden, solved_points
from app.scenes.square_sea.scene import SquareSeaScene
from app.server.loop.sim_loop import SimLoop
from sim.ocean import Sea
from sim.ocean.nonlinear import NonlinearSea, stokes_wave
from sim.parameters import parameters_of
from sim.validation import DivergenceError

Scene: Any = SquareSeaScene  # its frames and readings have more than every scene has
STEEP: dict[str, Any] = {
    "size": "64", "mesh": "32", "order": 3, "spectrum": "sea_state", "hs": 2.0, "tp": 7.0, "length": 256.0,
}  # fmt: skip


def change(scene: Any, **values: object) -> None:
    scene.change_forces(dataclasses.replace(scene.params, **values))


@pytest.fixture(scope="module")
def draupner() -> Any:
    """The preset at the time of its wave."""
    scene = Scene(SquareSeaParams(**PRESETS["Draupner"]))
    assert SCENE.awaited is not None
    assert not SCENE.awaited.reached(SimLoop(scene).latest)
    scene.advance(round(59.4 * 60))
    return scene


def test_the_draupner_wave_is_as_high_as_it_was_measured(draupner: Any) -> None:
    """18.5 m at Hs 11.9 m; its linear sum is 14.9 m high, and by theory of second order no such crest is to be seen."""
    scene = draupner
    assert scene.sea.significant_height == pytest.approx(11.9, abs=0.1)
    frame = scene.frame()
    assert frame.highest.place[2] == pytest.approx(18.5, abs=0.15)
    assert frame.highest.place[2] == pytest.approx(frame.vertices[..., 2].max(), abs=1e-4)
    assert frame.highest.time == pytest.approx(59.4)
    assert math.dist(frame.highest.place[:2], scene.gauge.at) < 40.0
    found = scene.readings().report.heights
    assert found.theory.linear < found.theory.second_order < 11.0
    assert found.kurtosis > 4.0
    assert 0.0 < found.lost < 0.02


def test_time_slows_while_the_draupner_wave_passes_and_nearly_stands_at_its_crest() -> None:
    scene = Scene(SquareSeaParams(**(PRESETS["Draupner"] | {"size": "64", "mesh": "32", "statistics": False})))
    paces, heights = [], []
    scene.advance(54 * 60)
    while scene.time < 66.0:
        scene.advance(6)
        heights.append(scene.frame().gauge[2])
        paces.append(scene.pace)
    top = int(np.argmax(heights))
    assert max(heights) > 14.0
    assert min(paces) == pytest.approx(15.0 / 10.0 / 2.0 / 10.0, rel=0.1)  # the period over its 10 s, speed, slowest
    assert abs(int(np.argmin(paces)) - top) <= 2
    assert 1.0 == paces[0] == paces[-1] > paces[top - 12] > 3.0 * paces[top]
    before = scene.pace
    scene.params = dataclasses.replace(scene.params, slow_motion=False)
    assert (before, scene.pace) == (1.0, 1.0)


def test_slow_motion_can_be_switched_off_and_is_that_of_a_high_crest_only() -> None:
    def pace(share: float, phase: float, speed: float = 1.0) -> float:
        omega = 2.0 * math.pi / 10.0
        return crest_pace(share * math.cos(phase), -share * omega * math.sin(phase), 1.0, 10.0, speed)

    assert pace(1.2, 0.0) == pytest.approx(0.1)
    assert pace(1.2, -1.0) == pytest.approx(math.sin(1.0))  # it is known to be high before it is
    assert pace(1.2, -1.0, 8.0) == pytest.approx(math.sin(1.0) / 8.0)  # a wave takes as long at each speed
    assert pace(1.2, 0.0, 0.05) == 1.0  # which is slower already
    assert {pace(share, phase) for share in (0.0, 0.9) for phase in (-1.0, 0.0, 1.0)} == {1.0}
    assert {pace(1.2, phase) for phase in (-1.6, 1.6, 3.0)} == {1.0}  # troughs
    assert crest_pace(1.0, 0.0, 0.0, 10.0, 1.0) == crest_pace(1.0, 0.0, 1.0, 0.0, 1.0) == 1.0  # no waves
    off, on = (Scene(SquareSeaParams(**STEEP, slow_motion=slow)) for slow in (False, True))
    for scene in (off, on):
        scene.advance(2)
        scene.frame()
        scene.gauge.trace.extend([(10.0, 2.2), (10.1, 2.2)])
    assert (off.pace, on.pace < 0.2) == (1.0, True)
    on.gauge.put((0.0, 0.0))
    assert on.pace == 1.0  # it has read nothing there yet
    assert Scene(SquareSeaParams()).pace == 1.0


def test_the_draupner_sea_stands_beside_its_record(draupner: Any) -> None:
    text = str(report.readout(SimLoop(draupner).latest))
    assert "measured" in text
    assert "18.5" in text
    assert "12 to 13 s" in text
    draupner.plot_rows.restart()
    draupner.read_gauge()
    assert draupner.take_plot_rows()[-1][2] == 18.5
    other = Scene(dataclasses.replace(draupner.params, size="64", mesh="32", hs=6.0))
    assert math.isnan(other.take_plot_rows()[-1][2])
    assert "1995" not in str(report.readout(SimLoop(other).latest))


def test_a_high_crest_comes_to_the_staff_of_the_steep_storm() -> None:
    scene = Scene(SquareSeaParams(**PRESETS["Steep storm"]))
    scene.advance(20 * 60)
    heights, paces = [], []
    for _ in range(30):
        scene.advance(6)
        heights.append(scene.frame().gauge[2])
        paces.append(scene.pace)
    assert max(heights) > 1.05 * scene.sea.significant_height
    assert min(paces) < 0.2


def test_order_1_is_the_linear_sea_and_a_rogue_wave_comes_by_linear_sums_too() -> None:
    scene = Scene(SquareSeaParams(size="64", mesh="32"))
    assert scene.marching is None
    assert isinstance(scene.water[0], Sea)
    assert scene.frame().highest is None
    rogue = Scene(SquareSeaParams(**(PRESETS["Draupner"] | {"order": 1})))
    rogue.advance(round(59.4 * 60))
    assert rogue.frame().highest.place[2] == pytest.approx(1.245 * rogue.sea.significant_height, rel=0.06)


def test_the_breather_grows_from_even_waves() -> None:
    scene = Scene(SquareSeaParams(**PRESETS["Peregrine breather"]))
    first = scene.frame()
    assert first.vertices[..., 2].max() == pytest.approx(1.3 * 0.635, rel=0.05)
    assert np.ptp(first.vertices[..., 2], axis=1).max() == 0.0  # long crests
    assert scene.marching.sea.size == (256, 1)
    heights = []
    for _ in range(8):
        scene.advance(321 * 60 if scene.time == 0.0 else 60)
        frame = scene.frame()
        heights.append(frame.gauge[2])
    assert frame.highest.place[2] > 3.2 * 0.635
    assert max(heights) > 3.0 * 0.635  # and the staff stands where it comes
    assert abs(frame.highest.place[0] - scene.gauge.at[0]) < 10.0


@pytest.mark.parametrize("start", ["as set", "groups"])
def test_a_run_goes_on_from_a_checkpoint_as_it_did(start: str) -> None:
    scene = Scene(SquareSeaParams(**STEEP, start=start))
    scene.advance(60)
    scene.frame()
    kept = scene.keep()
    ways = []
    for _ in range(2):
        scene.advance(120)
        ways.append(scene.frame())
        scene.resume(kept)
    assert np.array_equal(ways[0].vertices, ways[1].vertices)
    assert np.array_equal(ways[0].foam, ways[1].foam)
    assert ways[0].highest == ways[1].highest


def test_the_wave_gauge_reads_the_surface_and_a_click_moves_it() -> None:
    scene = Scene(SquareSeaParams(**STEEP))
    scene.advance(120)
    scene.handle(PointAlong((100.0, 120.0, 12.0), (0.9, 0.3, -0.4)))
    x, y, z = scene.frame().gauge
    assert scene.gauge_placed
    sea: NonlinearSea = scene.marching.sea
    assert z == pytest.approx(float(sea.height_at([[x, y]], sea.time)[0][0]), abs=1e-9)
    assert z == pytest.approx(float(sea.height_at([[x, y]], sea.time, exact=True)[0][0]), abs=0.05)


def test_new_weather_begins_a_new_sea_and_another_grid_shows_the_same() -> None:
    scene = Scene(SquareSeaParams(**STEEP))
    scene.advance(120)
    before = scene.marching.sea
    change(scene, size="128")
    assert scene.marching.sea.size == (128, 128)
    assert scene.marching.sea.height[::2, ::2] == pytest.approx(before.height, abs=1e-9)
    change(scene, hs=1.0)
    assert scene.marching.sea.significant_height == pytest.approx(0.5 * before.significant_height, rel=0.05)
    assert scene.marching.sea.time == scene.time == 2.0
    scene.advance(10)
    assert scene.frame().time == pytest.approx(2.0 + 1.0 / 6.0)


def test_a_sea_that_is_too_steep_stops_with_words_and_keeps_its_last_state() -> None:
    scene = Scene(SquareSeaParams(**(STEEP | {"length": 64.0}), start="groups"))
    wave = stokes_wave(0.8 * 64.0 / (2.0 * math.pi), 64.0, order=20)
    x = np.arange(64.0)
    start = wave.elevation(x), wave.potential(x)
    scene.marching.sea = NonlinearSea(length=64.0, order=3, start=start, breaking=False)  # k a = 0.4
    loop = SimLoop(scene)
    for _ in range(200):
        loop.tick(1 / 10)
        if loop.run.halted:
            break
    assert "fails after" in loop.run.halted
    assert "lower order" in loop.run.halted
    assert np.isfinite(loop.latest.frame.vertices).all()
    with pytest.raises(DivergenceError):
        scene.advance(60)
    assert np.isfinite(scene.frame().vertices).all()


def test_foam_is_where_crests_fall_by_half_of_gravity() -> None:
    """The Jacobian is 1 - k eta, and k eta g the downward acceleration at a crest."""
    scene = Scene(SquareSeaParams(**(STEEP | {"hs": 5.0}), foam_by_wind=False, foam_threshold=0.5))
    scene.advance(600)
    frame = scene.frame()
    jacobian = scene.fields().jacobian[::2, ::2]
    assert 0.0 < scene.foam.cover < 0.1
    assert (frame.foam[jacobian > 0.5] == 0.0).all()
    assert (frame.foam[jacobian < 0.4] > 0.5).all()


def test_the_panel_compares_crests_with_theory_and_says_what_broke() -> None:
    loop = SimLoop(Scene(SquareSeaParams(**STEEP)))
    for _ in range(30):
        loop.tick(1 / 30)
    text = str(report.readout(loop.latest))
    for words in ("crest over significant height", "skewness", "kurtosis", "Forristall", "Breaking has dissipated"):
        assert words in text
    highest = loop.latest.frame.highest
    assert f"Highest crest: {number(highest.place[2])} m" in report.marks(loop.latest)["order"]
    level = SimLoop(Scene(SquareSeaParams(**(STEEP | {"hs": 0.0}))))
    level.tick(1 / 30)
    assert "crest over" not in str(report.readout(level.latest))


def test_what_only_a_linear_sea_has_is_hidden() -> None:
    assert hidden(SquareSeaParams(**STEEP)) >= LINEAR_ONLY.keys()
    assert not hidden(SquareSeaParams()) & (LINEAR_ONLY.keys() - {"rings"})
    plain, other = (Scene(SquareSeaParams(**STEEP, **more)) for more in ({}, {"viscosity": 0.01, "choppiness": 0.0}))
    for scene in (plain, other):
        scene.advance(60)
    assert np.array_equal(plain.frame().vertices, other.frame().vertices)


def test_the_grid_of_a_high_order_is_smaller_and_the_panel_says_so() -> None:
    assert [solved_points(SquareSeaParams(size="512", order=order)) for order in (1, 3, 4)] == [512, 256, 128]
    assert solved_points(SquareSeaParams(size="512", order=7, start="breather")) == 512
    loop = SimLoop(Scene(SquareSeaParams(**(STEEP | {"size": "256", "order": 4}))))
    assert "128 × 128 at most" in report.marks(loop.latest)["size"]


def test_measures_for_sweeps() -> None:
    scene = Scene(SquareSeaParams(**STEEP))
    scene.advance(300)
    found = {name: measure.value for name, measure in measured(SCENE, scene).items()}
    height = scene.marching.sea.height
    assert found["crest_height"] == pytest.approx(height.max(), rel=1e-6)
    away = height - height.mean()
    assert found["kurtosis"] == pytest.approx((away**4).mean() / (away**2).mean() ** 2, rel=1e-5)
    assert found["skewness"] == pytest.approx((away**3).mean() / (away**2).mean() ** 1.5, rel=1e-4)
    assert found["breaking_loss"] == scene.marching.sea.energy.breaking


def test_a_run_goes_on_until_an_event_begins() -> None:
    loop = SimLoop(Scene(SquareSeaParams(size="64", mesh="32")), queue.SimpleQueue(), paused=True)
    loop.handle(Pause())
    loop.handle(RunOn(lambda snapshot: 0.5 <= snapshot.status.time % 1.0 < 0.8))
    ends = []
    for _ in range(2):
        for _ in range(100):
            loop.tick(1 / 30)
            if not loop.run.running:
                break
        ends.append(loop.latest.status.time)
        assert not loop.latest.status.running
        loop.handle(RunOn(lambda snapshot: 0.5 <= snapshot.status.time % 1.0 < 0.8))
    assert ends == pytest.approx([0.5, 1.5], abs=0.04)  # the event of now is over before the next begins
    for forget in (Pause(), Reset()):
        loop.handle(RunOn(lambda snapshot: True))
        loop.handle(forget)
        loop.handle(Play())
        for _ in range(3):
            loop.tick(1 / 30)
        assert loop.run.running


def test_the_event_is_a_crest_of_1_25_hs(draupner: Any) -> None:
    assert SCENE.awaited is not None
    assert SCENE.awaited.offered(SquareSeaParams(**STEEP))
    assert not SCENE.awaited.offered(SquareSeaParams())
    assert SCENE.awaited.reached(SimLoop(draupner).latest)


def ends() -> list[tuple[str, object]]:
    found: list[tuple[str, object]] = []
    for name, declared in parameters_of(SquareSeaParams).items():
        low_high = (declared.kind(declared.low), declared.kind(declared.high)) if not declared.choices else ()
        found += [(name, value) for value in declared.choices or low_high or (False, True)]
    return [(name, value) for name, value in found if name not in ("size", "mesh")]


@pytest.mark.stress
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("order", [3, 7])
def test_steep_seas_at_the_ends_of_all_sliders_go_on_or_stop_with_words(order: int) -> None:
    """Each slider at each end on a steep sea, 20 s: the run continues, or halts with a reason; the loss is shown."""
    steep = STEEP | {"order": order, "hs": 3.0, "statistics": True}
    stopped = []
    for name, value in ends():
        more = {"deep": False} if name == "depth" else {"planet": "by gravity"} if name == "gravity" else {}
        params = SquareSeaParams(**(steep | more | {name: value}))
        loop = SimLoop(Scene(params))
        for _ in range(20):
            loop.tick(1.0 / max(params.speed, 0.05) if name != "speed" else 0.2)
            if loop.run.halted:
                break
        frame = loop.latest.frame
        assert np.isfinite(frame.vertices).all(), (name, value)
        if loop.run.halted:
            assert "cannot be followed" in loop.run.halted, (name, value, loop.run.halted)
            stopped.append((name, value))
        elif loop.latest.readings.report is not None and loop.latest.readings.report.heights is not None:
            lost = loop.latest.readings.report.heights.lost
            assert 0.0 <= lost <= 1.0, (name, value)
    # Where waves of 3 m stand in water that cannot carry them, or on planets where they are steeper than they can be.
    assert {name for name, _ in stopped} <= {"depth", "hs", "tp", "gravity", "planet_mass", "planet", "second_height",
                                             "length", "wave_height", "order"}  # fmt: skip
