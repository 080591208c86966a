"""Worked examples in docstrings: each gives what it says."""

import doctest
import importlib

import pytest

MODULES = (
    "sim.floating.body",
    "sim.floating.float_in",
    "sim.floating.response",
    "sim.floating.stability",
    "sim.ocean.kinematics",
    "sim.ocean.spectra.record",
    "sim.ocean.zero_crossings",
)


@pytest.mark.parametrize("name", MODULES)
def test_the_examples_of_a_module_give_what_they_say(name: str) -> None:
    found = doctest.testmod(importlib.import_module(name))
    assert found.attempted > 0
    assert found.failed == 0
