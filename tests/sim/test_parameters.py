import dataclasses
import math

import pytest

from sim.parameters import check_record, clamp_value, parameter, parameters_of, parse_assignments, similar


@dataclasses.dataclass(frozen=True)
class Params:
    points: int = parameter(10, 2, 200, "", "points of the rope")
    stiffness: float = parameter(800.0, 1.0, 1e6, "N/m", "of each link", log_from=1.0)
    floor: bool = parameter(True, doc="is there a floor")
    integrator: str = parameter("rk4", choices=("rk4", "leapfrog"))


WILD = [math.nan, math.inf, -math.inf, 1e300, -1e300, 10**400, True, None, "x", "", [], {}, (1,), b"1", 1j, object()]


def test_parameters_are_listed_in_order_of_declaration():
    assert list(parameters_of(Params)) == ["points", "stiffness", "floor", "integrator"]
    assert parameters_of(Params())["stiffness"].unit == "N/m"
    assert parameters_of(Params)["points"].kind is int


@pytest.mark.parametrize("value", WILD)
@pytest.mark.parametrize("name", list(parameters_of(Params)))
def test_clamped_values_are_always_of_the_kind_and_in_range(name, value):
    declared = parameters_of(Params)[name]
    found = clamp_value(declared, value)
    assert type(found) is declared.kind
    if declared.kind in (int, float):
        assert declared.low <= found <= declared.high
    if declared.choices:
        assert found in declared.choices


@pytest.mark.parametrize("value", [10.6, 11.4])
def test_whole_numbers_are_rounded(value):
    assert clamp_value(parameters_of(Params)["points"], value) == 11


@pytest.mark.parametrize("value", WILD)
@pytest.mark.parametrize("name", list(parameters_of(Params)))
def test_checked_values_are_refused_by_name_and_what_is_allowed(name, value):
    if name == "floor" and value is True:
        assert check_record(Params, {name: value}).floor is True
        return
    with pytest.raises(ValueError, match=rf"^{name}: .* is not allowed; allowed: "):
        check_record(Params, {name: value})


def test_good_values_pass_unchanged():
    values = {"points": 2, "stiffness": 1e6, "floor": False, "integrator": "leapfrog"}
    assert check_record(Params, values) == Params(**values)


def test_a_refusal_names_the_range_and_the_unit():
    with pytest.raises(ValueError, match=r"^stiffness: 0 is not allowed; allowed: 1 to 1e6 N/m$"):
        check_record(Params, {"stiffness": 0})
    with pytest.raises(ValueError, match=r"^points: 2\.5 is not allowed; allowed: a whole number from 2 to 200$"):
        check_record(Params, {"points": 2.5})


def test_unknown_parameters_are_refused_with_the_known_ones():
    with pytest.raises(
        ValueError, match=r"^mass: no such parameter; the parameters are points, stiffness, floor, integrator$"
    ):
        check_record(Params, {"mass": 1.0})
    with pytest.raises(ValueError, match="no such parameter"):
        parse_assignments(Params, ["mass=1"])


@pytest.mark.parametrize(
    ("name", "meant"), [("pointz", "points"), ("Stiffness", "stiffness"), ("stiff", "stiffness"), ("flor", "floor")]
)
def test_an_unknown_parameter_that_resembles_one_asks_for_it(name, meant):
    with pytest.raises(ValueError, match=rf"^{name}: no such parameter; did you mean {meant}\?$"):
        check_record(Params, {name: 1})


def test_a_choice_that_resembles_some_asks_for_them():
    with pytest.raises(ValueError, match=r"^integrator: 'frog' .* rk4, leapfrog; did you mean leapfrog\?$"):
        check_record(Params, {"integrator": "frog"})
    with pytest.raises(ValueError, match=r"one of rk4, leapfrog$"):
        check_record(Params, {"integrator": "none"})


def test_the_panel_shows_titles_and_the_record_holds_names():
    @dataclasses.dataclass(frozen=True)
    class Titled:
        method: str = parameter("rk4", choices={"rk4": "Runge-Kutta 4", "leapfrog": "Leapfrog"}, title="Method")

    declared = parameters_of(Titled)["method"]
    assert declared.title == "Method"
    assert declared.choices == ("rk4", "leapfrog")
    assert [declared.title_of(name) for name in declared.choices] == ["Runge-Kutta 4", "Leapfrog"]
    assert [declared.choice_of(title) for title in declared.choice_titles] == list(declared.choices)
    assert parameters_of(Params)["integrator"].choice_titles == ("Rk4", "Leapfrog")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("points=20", {"points": 20}),
        ("stiffness=1e3", {"stiffness": 1000.0}),
        ("floor=off", {"floor": False}),
        ("floor=YES", {"floor": True}),
        ("integrator=leapfrog", {"integrator": "leapfrog"}),
    ],
)
def test_assignments_are_read(text, value):
    assert parse_assignments(Params, [text]) == value


@pytest.mark.parametrize(
    "text", ["points", "points=", "points=x", "points=nan", "floor=maybe", "stiffness=inf", "=3", "points = 20"]
)
def test_assignments_of_nonsense_are_refused(text):
    with pytest.raises(ValueError, match=r"not allowed; allowed|no such parameter"):
        parse_assignments(Params, [text])


@pytest.mark.parametrize(
    "declare",
    [
        lambda: parameter(5.0, 0.0, 1.0),
        lambda: parameter("c", choices=("a", "b")),
        lambda: parameter(1.0, 0.5, 2.0, log_from=0.1),
        lambda: parameter(math.nan, 0.0, 1.0),
        lambda: parameter("a", choices={"a": "Same", "b": "Same"}),
    ],
)
def test_a_parameter_that_contradicts_itself_cannot_be_declared(declare):
    with pytest.raises(ValueError, match="not allowed"):
        declare()


@dataclasses.dataclass(frozen=True)
class Free:
    size: float = parameter(1.0)
    count: int = parameter(1)


def test_a_parameter_without_a_range_takes_any_number_of_its_kind():
    found = check_record(Free, {"size": -1e300, "count": -7})
    assert (found.size, found.count) == (-1e300, -7)
    assert check_record(Free, {"count": 10**30}).count == 10**30
    for bad in (math.nan, math.inf, 10**400):
        with pytest.raises(ValueError, match=r"^count: "):
            check_record(Free, {"count": bad})
    assert clamp_value(parameters_of(Free)["count"], math.inf) == 1
    assert clamp_value(parameters_of(Free)["size"], 10**400) == math.inf


@pytest.mark.parametrize("value", [1, 0, 1.0, "True", None])
def test_only_true_and_false_are_truth_values(value):
    with pytest.raises(ValueError, match=r"^floor: "):
        check_record(Params, {"floor": value})


def test_a_name_resembles_those_that_it_is_a_part_of_and_those_that_are_written_alike():
    names = ("wind_speed", "wind_direction", "gust", "width")
    assert similar("wind", names) == ["wind_speed", "wind_direction"]
    assert similar("wi", names) == []
    assert similar("gus", names) == ["gust"]
    assert similar("gsut", names) == ["gust"]
