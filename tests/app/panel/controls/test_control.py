"""A control: what it is set to is bounded, shown and passed on; the value itself is the panel's."""

import math
import re
import threading
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest
import viser

from app.panel.controls.control import SliderScale, title
from app.panel.controls.controls import Controls
from app.panel.controls.remedy import Remedy
from app.scenes import NAMES, scene_named
from app.scenes.contract import Advice
from app.server.viewer import Viewer
from sim.parameters import Parameter, clamp_value, parameters_of
from tests import coroutines
from tests.app.server.visitors import until, visitor


def test_what_a_control_is_set_to_is_bounded_shown_and_passed_on(lab: Viewer) -> None:
    control = lab.panel.controls["stiffness"]
    control.set(1e20)
    assert lab.settings.params.stiffness == 1e9
    assert control.field.value == "1e9"
    assert control.slider is not None
    assert control.slider.value == (9.0,)
    control.set(float("nan"))
    assert lab.settings.params.stiffness == 800.0
    assert control.field.value == "800"
    before = lab.settings.params
    lab.settings.set("stiffness", 800.0)
    assert lab.settings.params is before  # nothing has changed
    control.set(1234.5)
    assert 1234.5 not in [value for value in vars(control).values() if isinstance(value, float)]  # it is the panel's
    lab.settings.load("Lab scene: 50 points")
    assert lab.settings.params.points == 50
    assert lab.panel.controls["points"].field.value == "50"


@pytest.mark.parametrize("scene", NAMES)
def test_a_folder_has_the_controls_of_its_group_and_no_others(scene: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Folder(nullcontext[None]):
        def __init__(self, title: str, *, expand_by_default: bool) -> None:
            super().__init__()
            self.title = title

    made: list[tuple[str, str]] = []
    parameters = parameters_of(scene_named(scene).params)
    gui: Any = SimpleNamespace(add_folder=Folder)
    settings: Any = SimpleNamespace(params=scene_named(scene).params())
    controls = Controls(gui, settings)
    monkeypatch.setattr(controls, "make", lambda folder, name: made.append((folder.title, name)))
    for group in dict.fromkeys(parameter.group for parameter in parameters.values()):
        controls.add_group(group, is_open=False)
    controls.add_group("no such group", is_open=False)
    assert sorted(made) == sorted((parameter.group, name) for name, parameter in parameters.items())
    assert "no such group" not in controls.folders


def test_two_threads_that_write_the_first_line_make_one(lab: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    lab.served.stop_threads()
    control = lab.panel.controls["stiffness"]
    made: list[viser.GuiHtmlHandle] = []
    making, go_on = threading.Event(), threading.Event()
    add_html = control.gui.add_html

    def add_slowly(*arguments: Any, **named: Any) -> viser.GuiHtmlHandle:
        if not making.is_set():  # the first one waits until the other has had time to come here
            making.set()
            go_on.wait(0.5)
        made.append(add_html(*arguments, **named))
        return made[-1]

    monkeypatch.setattr(control.gui, "add_html", add_slowly)
    with ThreadPoolExecutor(2) as threads:
        first = threads.submit(control.write, "too stiff")
        assert making.wait(30.0)
        second = threads.submit(control.refuse, "no such number")
        wait([second], 0.2)  # with a lock it waits for the first
        go_on.set()
        first.result(30.0)
        second.result(30.0)
    assert len(made) == 1
    assert "too stiff" in made[0].content
    assert "no such number" in made[0].content


NUMBERS = [
    pytest.param(parameter, id=f"{scene}-{name}")
    for scene in NAMES
    for name, parameter in parameters_of(scene_named(scene).params()).items()
    if parameter.kind in (int, float)
]


@pytest.mark.parametrize("p", NUMBERS)
def test_a_slider_reaches_both_bounds_in_fine_steps_and_shows_each_number_in_its_place(p: Parameter) -> None:
    scale = SliderScale(p)
    low, high = (math.log10(p.log_from), math.log10(p.high)) if p.log_from else (p.low, p.high)
    assert (scale.low, scale.high) == pytest.approx((low, high), rel=1e-12)
    assert (high - low) / scale.step < 401.0  # a keyboard crosses it in so many presses
    assert (scale.value(scale.low), scale.value(scale.high)) == (p.low, p.high)
    # Numbers of a few digits.
    before = p.low
    for step in range(1, 40):
        value = clamp_value(p, scale.value(scale.low + (scale.high - scale.low) * step / 40))  # as the settings take it
        assert type(value) is p.kind
        assert before <= value <= p.high
        assert value == float(f"{value:.6g}")
        before = value
    assert before > p.low
    # The default is where it is shown.
    shown = scale.value(scale.position(p.default))
    coarse = abs(scale.value(min(scale.position(p.default) + scale.step, scale.high)) - p.default)
    assert abs(shown - p.default) <= max(coarse, 1e-9 * abs(p.default))
    # One step from its ends it means a number one step from its bounds.
    for position in (low + scale.step, high - scale.step):
        exact = 10.0**position if p.log_from else position
        value = clamp_value(p, scale.value(position))
        # Three digits by decades, multiples of the step otherwise; integers are whole.
        rounding = max(0.005 * exact if p.log_from else 0.5 * scale.step, 0.5 if p.kind is int else 0.0)
        assert value == pytest.approx(exact, abs=1.001 * rounding)
        if p.kind is float:
            assert p.low < value < p.high
            half = 0.501 * scale.step  # and round-off
            assert scale.position(value) == pytest.approx(position, abs=half)
    # Numbers beyond it stand at its ends.
    assert scale.position(p.low) == scale.low
    assert scale.position(p.high) == scale.position(2.0 * p.high - p.low) == scale.high
    middle = math.sqrt(p.log_from * p.high) if p.log_from else 0.5 * (p.low + p.high)
    assert scale.position(middle) == pytest.approx(0.5 * (scale.low + scale.high))
    if p.log_from:
        assert scale.position(0.5 * p.log_from) == scale.position(0.0) == scale.low


def test_a_list_shows_titles_and_the_record_has_names(lab: Viewer) -> None:
    control = lab.panel.controls["integrator"]
    assert control.field.value == "Leapfrog"
    assert control.field.options[:4] == (
        "Euler, explicit (lab eq. 5)", "Euler, symplectic (lab's code)", "Runge-Kutta 4 (RK4)", "Leapfrog",
    )  # fmt: skip
    lab.settings.set("integrator", "rk4")
    assert control.field.value == "Runge-Kutta 4 (RK4)"
    assert lab.settings.params.integrator == "rk4"
    event = SimpleNamespace(client_id=1, target=SimpleNamespace(value="Euler, implicit"))
    coroutines.run(control.on_field(event))
    assert lab.settings.params.integrator == "implicit_euler"


FIRST_FOLDER, LAST_FOLDERS = "Main", ("Surroundings", "Time", "Look", "Plots")
PANEL_UNITS = re.compile(r"|[A-Za-z%°µ]+([²³]|·[a-z]+|/[a-z]+[²³]?)*")


@pytest.mark.parametrize("scene", NAMES)
def test_the_folders_of_every_scene_are_in_one_order(scene: str) -> None:
    parameters = parameters_of(scene_named(scene).params())
    folders = list(dict.fromkeys(parameter.group for parameter in parameters.values()))
    assert folders[0] == FIRST_FOLDER
    shared = [folder for folder in folders if folder in LAST_FOLDERS]
    assert shared == [folder for folder in LAST_FOLDERS if folder in folders]
    assert folders[-len(shared) :] == shared
    assert parameters["speed"].group == "Time"


@pytest.mark.parametrize("scene", NAMES)
def test_what_the_panel_calls_things_is_typeset(scene: str) -> None:
    for name, parameter in parameters_of(scene_named(scene).params()).items():
        assert PANEL_UNITS.fullmatch(parameter.unit), name
        texts = (title(name, parameter), parameter.doc, *parameter.choice_titles)
        assert not any(re.search(r"_|\^|\b(deg|rad)\b", text) for text in texts), name
        assert parameter.doc[0].isupper() or parameter.doc[0].isdigit(), name
        assert not parameter.doc.endswith("."), name


def test_a_folder_is_shown_where_it_has_a_control_and_a_line_with_its_control() -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("radial_sea", scene_named("radial_sea").params(spill="layer"))
        panel = viewer.panel
        panel.controls["exposure"].write("a line")
        line = panel.controls["exposure"].line
        assert line is not None
        assert (panel.controls.folders["Oil"].visible, line.visible) == (True, True)
        panel.settings.set("spill", "none")
        assert (panel.controls.folders["Oil"].visible, line.visible) == (False, False)
        panel.controls["exposure"].write("another line")
        assert not line.visible
        assert panel.controls.folders["Main"].visible
        panel.settings.set("spill", "mixed")
        assert (panel.controls.folders["Oil"].visible, line.visible) == (True, True)
    finally:
        viewer.shut()


def test_a_slider_that_a_browser_moves_sets_the_value_at_its_place(lab: Viewer) -> None:
    control = lab.panel.controls["stiffness"]
    for position, value in ((2.0, 100.0), (3.5, 10**3.5)):
        event: Any = SimpleNamespace(client_id=1, target=SimpleNamespace(value=(position,)))
        coroutines.run(control.on_slider(event))
        assert lab.settings.params.stiffness == pytest.approx(value, rel=0.02)
    before = lab.settings.params
    coroutines.run(control.on_slider(SimpleNamespace(client_id=None, target=None)))  # the program moved it
    assert lab.settings.params is before


@pytest.mark.parametrize(("position", "end"), [(99.0, "high"), (1e300, "high"), (-1e300, "low")])
def test_a_place_beyond_the_end_of_a_slider_is_its_end(lab: Viewer, position: float, end: str) -> None:
    control = lab.panel.controls["stiffness"]
    slider, bound, times = control.slider, getattr(control.parameter, end), []
    assert slider is not None
    slider.on_update(lambda event: times.append(event.client_id))  # called after the control's own

    async def slide() -> None:
        async with visitor(lab) as browser:
            for _ in range(2):  # the second one changes nothing, and is answered too
                times.clear()
                await browser.send(slider, [position])
                await until(lambda: browser.client in times)
                assert lab.settings.params.stiffness == bound
                assert slider.value == (getattr(control.scale, end),)

    coroutines.run(slide())


def test_the_button_of_a_remedy_is_hidden_until_there_is_an_advice(server: Any) -> None:
    remedy = Remedy(server.gui, "Take {}", lambda advice: None)
    shown = [remedy.button.visible]
    for advice in (Advice("time_step", 0.1, "1/10 s"), None):
        remedy.show(advice)
        shown.append(remedy.button.visible)
    assert shown == [False, True, False]
    assert remedy.button.label == "Take 1/10 s"
