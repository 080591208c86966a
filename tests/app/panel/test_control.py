"""A control: what it is set to is bounded, shown and passed on; the value itself is the panel's."""

from app.server.viewer import Viewer


def test_what_a_control_is_set_to_is_bounded_shown_and_passed_on(lab: Viewer) -> None:
    control = lab.panel.controls["stiffness"]
    control.set(1e20)
    assert lab.panel.params.stiffness == 1e9
    assert control.field.value == 1e9
    assert control.slider is not None
    assert control.slider.value == (9.0,)
    control.set(float("nan"))
    assert lab.panel.params.stiffness == 800.0
    assert control.field.value == 800.0


def test_setting_what_is_set_already_changes_no_record(lab: Viewer) -> None:
    before = lab.panel.read()
    lab.panel.set("stiffness", 800.0)
    assert lab.panel.read() is before


def test_a_preset_is_shown_and_holds_its_number(lab: Viewer) -> None:
    lab.panel.load("Lab scene: 50 points")
    params, number = lab.panel.read()
    assert number == 1
    assert params.points == lab.panel.controls["points"].field.value == 50


def test_a_control_holds_no_value_of_its_own(lab: Viewer) -> None:
    control = lab.panel.controls["stiffness"]
    control.set(1234.5)
    assert 1234.5 not in [value for value in vars(control).values() if isinstance(value, float)]
