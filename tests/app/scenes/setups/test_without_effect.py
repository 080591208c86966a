"""Parameters without effect are named in one line each, with the parameter that makes them so."""

import pytest

from app.__main__ import main
from app.scenes import NAMES, scene_named
from app.scenes.setups import Setup, make_setup, read_query, without_effect
from app.study.sweep.spec import make_spec
from sim.parameters import parameters_of

SAID = {
    "?scene=square_sea&planet=Mars&gravity=5": "gravity has no effect with planet=Mars",
    "?scene=square_sea&spectrum=pierson_moskowitz&fetch=1e4": "fetch has no effect with spectrum=pierson_moskowitz",
    "?scene=square_sea&deep=true&depth=3": "depth has no effect with deep=true",
    "?scene=rope&sphere=false&sphere_radius=0.3": "sphere_radius has no effect with sphere=false",
    "?scene=race&ropes=1&spacing=2": "spacing has no effect with ropes=1",
    "?scene=mooring&wave_height=0&regular=true": "regular has no effect with wave_height=0.0",
    "?scene=radial_sea&spill=none&spill_volume=50": "spill_volume has no effect with spill=none",
}


@pytest.mark.parametrize("query", SAID)
def test_a_link_with_a_parameter_without_effect_is_answered_with_a_line(query):
    assert without_effect(read_query(query)) == [SAID[query]]


def test_run_says_it_on_the_error_stream(tmp_path, capsys):
    words = ["--set", "planet=Mars", "gravity=5", "size=64", "mesh=32"]
    assert (
        main(["run", "square_sea", "--seconds", "0.1", "--rate", "10", "--out", str(tmp_path / "a.npz"), *words]) == 0
    )
    assert "gravity has no effect with planet=Mars" in capsys.readouterr().err.splitlines()[-1]


def test_a_sweep_names_a_fixed_parameter_without_effect_in_any_case():
    content = {"scene": "square_sea", "seconds": 1.0, "parameters": {"wind_speed": [8.0, 10.0]},
               "set": {"planet": "Mars", "gravity": 5.0}}  # fmt: skip
    assert make_spec(content).notes == ("gravity has no effect with planet=Mars",)
    content["parameters"] = {"planet": ["Mars", "by gravity"]}
    del content["set"]["planet"]
    assert make_spec(content).notes == ()


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_said_of_presets_and_of_parameters_that_act(name):
    kind = scene_named(name)
    for preset in kind.presets:
        assert without_effect(make_setup(kind, preset)) == []
    params = kind.params()
    acting = {one: getattr(params, one) for one in parameters_of(params) if one not in kind.hidden(params)}
    changed = {one: value for one, value in acting.items() if isinstance(value, float)}
    assert without_effect(Setup(name, params, changed)) == []
