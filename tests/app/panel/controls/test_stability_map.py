"""The map in the panel, without a browser."""

import dataclasses
import math
import re
import threading
from typing import Any

import pytest

from app.panel.controls import stability_map as live
from app.scenes.rope import SCENE
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import build
from sim.springs.analysis.growth import EXPLODING, STABLE
from sim.springs.stability import critical_step
from sim.validation import ConvergenceError
from tests.app.channels import FakeChannel


class Handle:
    """Stands for whatever the panel adds."""

    def __init__(self) -> None:
        self.content = ""
        self._impl = self
        self.uuid = "the-slider"

    def on_click(self, action: Any) -> None:
        self.click = action

    def on_update(self, action: Any) -> None:
        self.update = action


class Gui:
    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: Handle()


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "ROWS", 5)
    monkeypatch.setattr(live, "COLS", 12)


def make(params: Any) -> tuple[live.StabilityMapPanel, dict[str, float]]:
    """A map and what its clicks have set."""
    taken: dict[str, float] = {}
    return live.StabilityMapPanel(Gui(), SCENE.stability_map, lambda: params, taken.update, FakeChannel()), taken


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("units", ["lab", "material"])
def test_the_map_turns_at_the_critical_step(units: str):
    params = RopeParams(units=units, time_step=1 / 120, floor=False)
    shown, _ = make(params)
    shown.measure(shown.asked)
    shown.draw()
    assert shown.axes is not None
    assert len(shown.rows) == 5
    for stiffness, row in zip(shown.axes.stiffnesses, shown.rows, strict=True):
        net = build(dataclasses.replace(params, **{shown.axes.parameter: float(stiffness)}))
        assert row.critical == pytest.approx(critical_step(net, "leapfrog"), rel=0.05)
        holds = shown.axes.steps < row.critical
        assert (row.outcomes == STABLE)[holds].all()  # with damping leapfrog's critical step is a bound
        assert (row.outcomes != STABLE)[shown.axes.steps > 1.5 * row.critical].all()
    assert shown.rows[-1].outcomes[-1] == EXPLODING
    assert "measuring" not in shown.html.content
    # The step and the stiffness that are set, at their places on the axes.
    (cross,) = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', shown.html.content)
    rate = getattr(params, shown.axes.parameter)
    across = math.log(params.time_step / shown.axes.steps[0]) / math.log(shown.axes.steps[-1] / shown.axes.steps[0])
    up = math.log(rate / shown.axes.stiffnesses[0]) / math.log(shown.axes.stiffnesses[-1] / shown.axes.stiffnesses[0])
    assert float(cross[0]) == pytest.approx(live.LEFT + live.WIDE * across, abs=0.1)
    assert float(cross[1]) == pytest.approx(live.TOP + live.HIGH * (1.0 - up), abs=0.1)


@pytest.mark.usefixtures("small")
def test_a_click_sets_step_and_stiffness_within_the_map():
    params = RopeParams()
    shown, taken = make(params)
    shown.go((0.5, 0.5))
    assert taken == {}  # no map yet
    shown.axes = live.axes_of(params, "stiffness")
    shown.go((0.0, 1.0))
    assert taken["time_step"] == pytest.approx(shown.axes.steps[0], rel=0.01)
    assert taken["stiffness"] == pytest.approx(shown.axes.stiffnesses[-1], rel=0.01)
    shown.go((-9.0, 7.0))
    assert taken["time_step"] == pytest.approx(shown.axes.steps[0], rel=0.01)


def test_the_map_keeps_to_what_the_parameters_allow():
    low = live.axes_of(RopeParams(time_step=1e-5, stiffness=1.0), "stiffness")
    assert low.steps[0] == pytest.approx(1e-5)
    assert low.stiffnesses[0] == pytest.approx(1.0)
    high = live.axes_of(RopeParams(time_step=0.1, stiffness=1e9), "stiffness")
    assert high.steps[-1] == pytest.approx(0.1)
    assert high.stiffnesses[-1] == pytest.approx(1e9)


def test_a_map_of_other_parameters_says_so():
    params = RopeParams()
    axes = live.axes_of(params, "stiffness")
    moved = dataclasses.replace(params, time_step=0.001, stiffness=5e3, colour="plain", plot_energy=True, speed=2.0)
    assert axes.is_of(moved)
    other = dataclasses.replace(params, damping=0.0)
    assert not axes.is_of(other)
    assert "Settings have changed: measure again" in live.picture(axes, [], other)
    assert "measure again" not in live.picture(axes, [], moved)


@pytest.mark.usefixtures("small")
def test_a_method_that_takes_no_damping_says_so():
    shown, _ = make(RopeParams(integrator="pefrl"))
    shown.measure(shown.asked)
    shown.draw()
    assert "PEFRL allows no damping" in shown.html.content


@pytest.mark.usefixtures("small")
def test_a_network_that_does_not_come_to_rest_says_so(monkeypatch, capsys):
    def fail(_: object) -> None:
        raise ConvergenceError("a state of rest", "3 J of motion", 10)

    monkeypatch.setattr("sim.springs.analysis.stability_map.find_rest_positions", fail)
    shown, _ = make(RopeParams())
    shown.measure(shown.asked)
    shown.draw()
    assert "The map could not be measured: a state of rest: no solution after 10 iterations" in shown.html.content
    assert capsys.readouterr().err == ""


@pytest.mark.usefixtures("small")
def test_asking_again_ends_the_measurement_before():
    shown, _ = make(RopeParams())
    shown.asked = 2
    before = set(threading.enumerate())
    shown.measure(1)
    assert shown.rows == []
    assert set(threading.enumerate()) <= before  # a thread of a test before may have ended meanwhile


@pytest.mark.usefixtures("small")
def test_a_map_that_cannot_be_measured_says_why(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture):
    shown, _ = make(RopeParams())

    def fail(*_: Any) -> None:
        raise ZeroDivisionError("no such net")

    monkeypatch.setattr(live, "measure_row", fail)
    shown.measure(shown.asked)
    shown.draw()
    assert "could not be measured: ZeroDivisionError: no such net" in shown.html.content
    capsys.readouterr()


@pytest.mark.usefixtures("small")
def test_leaving_the_scene_stops_the_measurement():
    shown, _ = make(RopeParams())
    number = shown.asked
    shown.close()
    shown.measure(number)
    assert shown.rows == []


def test_the_map_has_its_axes():
    axes = live.axes_of(RopeParams(), "stiffness")
    picture = live.picture(axes, [], RopeParams())
    assert "time step h [s]" in picture
    assert "stiffness [N/m]" in picture
    assert picture.count(">10⁴</text>") == 1
