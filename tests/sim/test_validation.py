"""Checks of arguments: what passes, what does not, and what the error says."""

import math
import os
import pickle

import numpy as np
import pytest

from sim import validation as v

NOT_NUMBERS = (math.nan, True, np.True_, "1", None, [1.0], 1j)


def refused(call, *arguments, **options) -> str:
    with pytest.raises(ValueError, match=r"^a: .* is not allowed; allowed: \S") as error:
        call("a", *arguments, **options)
    return str(error.value).partition("allowed: ")[2]


def test_an_error_is_the_name_the_value_and_what_is_allowed():
    assert str(v.argument_error("mass", -1.0, "above 0 kg")) == "mass: -1.0 is not allowed; allowed: above 0 kg"


def test_an_error_shows_a_path_whole_and_of_another_text_the_beginning():
    path = os.path.join("a folder  with spaces" * 20, "with the hull boat.obj")
    assert str(v.argument_error("--out", path, "a file")) == f"--out: {path!r} is not allowed; allowed: a file"
    for value in ("1 " * 1000, [0.0] * 1000, os.sep * 5000):
        assert len(str(v.argument_error("a", value, "less"))) < v.MAX_SHOWN_PATH + 50
    assert "1 1..." in str(v.argument_error("a", "1 " * 1000, "less"))


@pytest.mark.parametrize("value", NOT_NUMBERS)
def test_what_is_no_number_is_nan_and_refused(value):
    assert math.isnan(v.as_float(value))
    for call, more in (
        (v.check_number, ("m",)),
        (v.check_number, ("m", 0.0, 1.0)),
        (v.check_positive, ("m",)),
    ):
        refused(call, value, *more)


@pytest.mark.parametrize("value", [1, 1.0, np.int8(1), np.float32(1.0)])
def test_numbers_of_any_kind_are_numbers(value):
    for found in (
        v.check_number("a", value, "m"),
        v.check_number("a", value, "m", 1.0, 1.0),
        v.check_positive("a", value, "m"),
    ):
        assert found == 1.0
        assert type(found) is float
    assert v.as_float(10**400) == math.inf


def test_a_number_lies_in_its_range_with_the_ends_or_without():
    assert v.check_number("a", -1e300, "m") == -1e300
    assert v.check_number("a", 0.0, "m", 0.0, 2.0) == 0.0
    assert v.check_number("a", 2.0, "m", 0.0, 2.0) == 2.0
    assert v.check_number("a", 1e-300, "m", 0.0, 2.0, above=True) == 1e-300
    assert refused(v.check_number, 2.1, "m", 0.0, 2.0) == "from 0 to 2 m"
    assert refused(v.check_number, 0.0, "", 0.0, 2.0, above=True) == "above 0, at most 2"
    assert refused(v.check_number, -0.1, "m", 0.0) == "at least 0 m"
    assert refused(v.check_number, 3.0, "m", high=2.0) == "at most 2 m"
    assert refused(v.check_number, -math.inf, "") == "a finite number"
    assert refused(v.check_number, math.nan, "m") == "a finite number [m]"
    assert refused(v.check_number, math.nan, "m", 1.0, 2.0) == "a finite number from 1 to 2 m"
    for value in (math.inf, "1"):
        assert refused(v.check_number, value, "m", 0.0) == "a finite number of at least 0 m"


def test_a_positive_number_is_above_0_and_infinite_only_where_allowed():
    assert v.check_positive("a", 1e-300, "m") == 1e-300
    assert v.check_positive("a", math.inf, "m", allow_infinite=True) == math.inf
    assert refused(v.check_positive, 0.0, "m") == "above 0 m"
    assert refused(v.check_positive, math.inf, "m") == "a finite number above 0 m"
    assert refused(v.check_positive, -1.0, "m", allow_infinite=True) == "above 0 m, or inf"
    refused(v.check_positive, -math.inf, "m", allow_infinite=True)


def test_an_angle_is_at_most_a_turn():
    assert v.check_angle("a", -2.0 * math.pi) == -2.0 * math.pi
    assert refused(v.check_angle, 90.0) == "an angle from -2 pi to 2 pi rad"


def test_a_number_has_two_checkers_and_an_angle_its_own():
    checkers = {
        name for name, one in vars(v).items() if name.startswith("check_") and one.__annotations__["return"] is float
    }
    assert checkers == {"check_number", "check_positive", "check_angle"}


def test_whole_numbers_are_whole():
    assert all(map(v.is_whole_number, (0, -3, np.int64(2), 10**400)))
    assert not any(map(v.is_whole_number, (0.0, True, "1", None, np.float64(1.0))))


def test_choices_and_vectors():
    assert v.check_choice("a", "x", ["x", "y"]) == "x"
    assert refused(v.check_choice, "z", ["x", "y"]) == "one of x, y"
    refused(v.check_choice, None, ["x"])
    refused(v.check_choice, ["x"], ["x"])
    assert v.check_vector("a", np.arange(3), "m") == (0.0, 1.0, 2.0)
    assert v.check_vector("a", [1, 2], "m", 2) == (1.0, 2.0)
    for bad in ((1.0, 2.0), (1.0, 2.0, 3.0, 4.0), (1.0, 2.0, math.inf), "123", 1.0):
        assert refused(v.check_vector, bad, "m") == "3 finite numbers [m]"


def test_positions_are_pairs_within_what_a_grid_can_count():
    found = v.check_positions("a", [[1, 2], [3, 4], [5, 6]])
    assert found.tolist() == [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
    assert found.dtype == np.float64
    assert v.check_positions("a", [[1e12, -1e12]]).shape == (1, 2)
    for bad in ([1.0, 2.0], [[1.0, 2.0, 3.0]], [[[1.0, 2.0]]], [["1", "2"]], [[True, False]], [[1.0, 2.0], [3.0]]):
        assert "positions of shape (n, 2)" in refused(v.check_positions, bad)
    for bad in ([[0.0, 1.1e12]], [[math.nan, 0.0]], [[0.0, -math.inf]]):
        assert "at most 1e+12 m" in refused(v.check_positions, bad)


def test_wavenumbers_are_0_or_above_and_have_powers():
    assert v.check_wavenumbers("a", [0.0, 1e20]).tolist() == [0.0, 1e20]
    assert v.check_wavenumbers("a", 2).shape == ()
    for bad in ([-1e-9, 1.0], [1.1e20], [math.nan], math.inf, "2"):
        assert refused(v.check_wavenumbers, bad) == "numbers from 0 to 1e+20 rad/m"


def test_an_array_holds_real_numbers():
    assert v.as_array("a", [1, 2.5], "numbers").tolist() == [1.0, 2.5]
    assert v.as_array("a", [], "numbers").shape == (0,)
    for bad in ([1j], ["1"], [True], [[1.0], [1.0, 2.0]], [None]):
        assert refused(v.as_array, bad, "numbers") == "numbers"


def test_a_solver_that_fails_says_what_is_left_and_no_argument():
    error = v.ConvergenceError("rest of a mooring", "3 N at node 7", 40)
    assert str(error) == "rest of a mooring: no solution after 40 iterations; 3 N at node 7 left"
    again = pickle.loads(pickle.dumps(error))
    assert (again.solver, again.residual, again.iterations) == ("rest of a mooring", "3 N at node 7", 40)
    assert not isinstance(error, ValueError)


def test_an_angle_is_within_one_turn_so_that_degrees_are_noticed():
    for angle in (0.0, 1.0, -math.pi, 2.0 * math.pi, -2.0 * math.pi):
        assert v.check_angle("theta", angle) == angle
    for angle in (6.3, -6.3, 45.0, 360.0, math.nan, math.inf, "east"):
        with pytest.raises(ValueError, match=r"theta: .* an angle from -2 pi to 2 pi rad"):
            v.check_angle("theta", angle)
