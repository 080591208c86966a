import dataclasses
import math

import pytest

from sim.knobs import check, clamp, clamp_value, knob, knobs, parse, refusal


@dataclasses.dataclass(frozen=True)
class Params:
    points: int = knob(10, 2, 200, "", "points of the rope")
    stiffness: float = knob(800.0, 1.0, 1e6, "N/m", "of each link", log_from=1.0)
    floor: bool = knob(True, doc="is there a floor")
    integrator: str = knob("rk4", choices=("rk4", "leapfrog"))


WILD = [math.nan, math.inf, -math.inf, 1e300, -1e300, 10**400, True, None, "x", "", [], {}, (1,), b"1", 1j, object()]


def test_knobs_are_listed_in_order_of_declaration():
    assert list(knobs(Params)) == ["points", "stiffness", "floor", "integrator"]
    assert knobs(Params())["stiffness"].unit == "N/m"
    assert knobs(Params)["points"].kind is int


@pytest.mark.parametrize("value", WILD)
@pytest.mark.parametrize("name", list(knobs(Params)))
def test_clamped_values_are_always_of_the_kind_and_in_range(name, value):
    declared = knobs(Params)[name]
    found = clamp_value(declared, value)
    assert type(found) is declared.kind
    if declared.kind in (int, float):
        assert declared.lo <= found <= declared.hi
    if declared.choices:
        assert found in declared.choices


def test_clamping_bounds_numbers_and_makes_defaults_of_nonsense():
    found = clamp(dataclasses.replace(Params(), points=10_000, stiffness=math.nan, integrator="none"))
    assert found == Params(points=200)


@pytest.mark.parametrize("value", [10.6, 11.4])
def test_whole_numbers_are_rounded(value):
    assert clamp_value(knobs(Params)["points"], value) == 11


@pytest.mark.parametrize("value", WILD)
@pytest.mark.parametrize("name", list(knobs(Params)))
def test_checked_values_are_refused_by_name_and_what_is_allowed(name, value):
    if name == "floor" and value is True:
        assert check(Params, {name: value}).floor is True
        return
    with pytest.raises(ValueError, match=rf"^{name}: .* is not allowed; allowed: "):
        check(Params, {name: value})


def test_good_values_pass_unchanged():
    values = {"points": 2, "stiffness": 1e6, "floor": False, "integrator": "leapfrog"}
    assert check(Params, values) == Params(**values)


def test_a_refusal_names_the_range_and_the_unit():
    with pytest.raises(ValueError, match=r"^stiffness: 0 is not allowed; allowed: 1 to 1e\+06 N/m$"):
        check(Params, {"stiffness": 0})
    with pytest.raises(ValueError, match=r"^points: 2\.5 is not allowed; allowed: a whole number from 2 to 200$"):
        check(Params, {"points": 2.5})


def test_unknown_knobs_are_refused_with_the_known_ones():
    with pytest.raises(ValueError, match=r"^mass: no such knob; the knobs are points, stiffness, floor, integrator$"):
        check(Params, {"mass": 1.0})
    with pytest.raises(ValueError, match="no such knob"):
        parse(Params, ["mass=1"])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("points=20", {"points": 20}),
        ("points = 2e1", {}),
        ("stiffness=1e3", {"stiffness": 1000.0}),
        ("floor=off", {"floor": False}),
        ("floor=YES", {"floor": True}),
        ("integrator=leapfrog", {"integrator": "leapfrog"}),
    ],
)
def test_assignments_are_read(text, value):
    if not value:
        with pytest.raises(ValueError, match="no such knob"):
            parse(Params, [text])
    else:
        assert parse(Params, [text]) == value


@pytest.mark.parametrize("text", ["points", "points=", "points=x", "points=nan", "floor=maybe", "stiffness=inf", "=3"])
def test_assignments_of_nonsense_are_refused(text):
    with pytest.raises(ValueError, match=r"not allowed; allowed|no such knob"):
        parse(Params, [text])


@pytest.mark.parametrize(
    "declare",
    [
        lambda: knob(5.0, 0.0, 1.0),
        lambda: knob("c", choices=("a", "b")),
        lambda: knob(1.0, 0.5, 2.0, log_from=0.1),
        lambda: knob(math.nan, 0.0, 1.0),
    ],
)
def test_a_knob_that_contradicts_itself_cannot_be_declared(declare):
    with pytest.raises(ValueError, match="not allowed"):
        declare()


def test_a_refusal_has_one_form():
    assert str(refusal("h", -1, "above 0 s")) == "h: -1 is not allowed; allowed: above 0 s"
