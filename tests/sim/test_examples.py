"""Worked examples in docstrings: each gives its stated result, and the main functions have one."""

import doctest
import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in sorted((ROOT / "sim").rglob("*.py"))
    if ">>> " in path.read_text("utf-8")
]
FIRST = {
    "sim.floating.motion.body": ("",),  # of the module
    "sim.floating.statics.equilibrium": ("equilibrium_draft",),
    "sim.floating.motion.float_in": ("",),
    "sim.floating.hulls.hull": ("Hull.box",),
    "sim.floating.statics.hydrostatics": ("submerged",),
    "sim.floating.motion.motion": ("step",),
    "sim.floating.linear.periods": ("heave_period", "roll_period"),
    "sim.floating.linear.response": ("",),
    "sim.floating.statics.righting": ("",),
    "sim.mooring.motion": ("paths_to",),
    "sim.ocean.dispersion": ("omega", "phase_speed", "group_speed"),
    "sim.ocean.radial.gerstner": ("draw_waves",),
    "sim.ocean.nonlinear.sea": ("",),
    "sim.ocean.nonlinear.starts.stokes": ("",),
    "sim.ocean.planets": ("gravity_of",),
    "sim.ocean.radial.radial": ("",),
    "sim.ocean.tile.ripples": ("",),
    "sim.ocean.tile.sea": ("",),
    "sim.ocean.spectra.record": ("Spectrum.frequency_density", "Spectrum.moments"),
    "sim.ocean.statistics.statistics": ("beaufort",),
    "sim.ocean.records.wave_record": ("",),
    "sim.ocean.weathering.spill": ("weather",),
    "sim.particles.rain": ("terminal_speed",),
    "sim.springs.cloth": ("cloth",),
    "sim.springs.rope": ("rope", "lab_units"),
    "sim.springs.simulate": ("simulate",),
    "sim.springs.stability": ("critical_step",),
    "sim.springs.state": ("advance",),
    "sim.springs.statics": ("hanging_chain", "catenary"),
    "sim.waves": ("",),
}


@pytest.mark.parametrize("name", MODULES)
def test_the_examples_of_a_module_give_what_they_say(name: str) -> None:
    found = doctest.testmod(importlib.import_module(name))
    assert found.attempted > 0
    assert found.failed == 0


@pytest.mark.parametrize("name", FIRST)
def test_what_a_user_meets_first_has_an_example(name: str) -> None:
    found = {test.name: test for test in doctest.DocTestFinder().find(importlib.import_module(name))}
    for function in FIRST[name]:
        assert found[f"{name}.{function}".rstrip(".")].examples, function
