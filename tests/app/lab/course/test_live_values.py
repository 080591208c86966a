"""Live values of a scene: how they are written, and conditions on them."""

import pytest

from app.lab.course.live_values import LiveNumber, fill_in, names_in, read_conditions

VALUES = {"depth": LiveNumber(0.25, "m"), "share": LiveNumber(0.125), "law": "lab", "on": True, "n": LiveNumber(3e7)}


@pytest.mark.parametrize(
    ("template", "text"),
    [
        ("{depth}", "0.25\u00a0m"), ("{depth:1}", "0.2\u00a0m"), ("{depth:.3}", "0.250\u00a0m"),
        ("{depth:u}", "250 mm"),
        ("{share}", "0.125"), ("{share:%}", "12.5\u00a0%"), ("{share:u}", "0.125"), ("{n:n}", "30 million"),
        ("{law} {on}", "lab True"), ("{nothing} {depth.value}", "… …"), ("{{}}", "{}"),
    ],
)  # fmt: skip
def test_values_are_written_with_their_units(template: str, text: str) -> None:
    assert fill_in(template, VALUES) == text


def test_small_lengths_and_times_are_written_in_easy_units() -> None:
    assert f"{LiveNumber(0.031, 'm')}" == "31 mm"
    assert f"{LiveNumber(1 / 60, 's')}" == "16.7 ms"
    assert f"{LiveNumber(0.0, 'm')}" == "0\u00a0m"


@pytest.mark.parametrize("template", ["{", "{a", "{a:long}", "}"])
def test_a_text_that_could_not_be_filled_in_is_refused(template: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        names_in(template)


@pytest.mark.parametrize(
    ("name", "value", "holds"),
    [
        ("depth", 0.25, True), ("depth", "> 0.2", True), ("depth", "< 0.2", False), ("depth", ">= 0.25", True),
        ("depth", "<= 0.25", True), ("depth", "> 0.25", False), ("depth", "lab", False), ("depth", True, False),
        ("law", "lab", True), ("law", "other", False), ("law", "> 1", False), ("on", True, True), ("on", False, False),
        ("on", 1, False), ("nothing", 1, False),
    ],
)  # fmt: skip
def test_conditions_hold_or_not(name: str, value: object, holds: bool) -> None:
    (condition,) = read_conditions("here", {name: value})
    assert condition.holds(VALUES) == holds


@pytest.mark.parametrize("value", ["> much", [1], {}, None])
def test_a_condition_of_another_form_is_refused(value: object) -> None:
    with pytest.raises(ValueError, match="here: depth"):
        read_conditions("here", {"depth": value})
