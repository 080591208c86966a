"""What may be set side by side, and what is said of it."""

from pathlib import Path

import pytest

from app.__main__ import main
from app.scenes import NAMES, scene_named
from app.scenes.comparisons import (
    COMPARISONS,
    MAX_PANES,
    comparison_named,
    differences,
    headings,
    middle_of,
    read_comparison,
    with_shared,
)
from app.scenes.setups import make_setup, read_setup, write_file
from sim.parameters import check_record


def panes(*words: str) -> list:
    setups = [read_setup(word) for word in words]
    return [(scene_named(setup.scene), setup.params) for setup in setups]


@pytest.mark.parametrize("name", COMPARISONS)
def test_the_comparisons_that_are_ready_can_be_read_and_differ_under_one_sky(name: str) -> None:
    setups = comparison_named(name)
    assert 2 <= len(setups) <= MAX_PANES
    first = setups[0].params
    assert [with_shared(setup.params, first) for setup in setups] == [setup.params for setup in setups]
    said = headings([(scene_named(setup.scene), setup.params) for setup in setups])
    assert len(set(said)) == len(said)
    assert all(len(words) < 120 for words in said)


def test_set_ups_are_read_as_scene_preset_link_and_file(tmp_path: Path) -> None:
    kind = scene_named("rope")
    stiff = check_record(kind.params, {"stiffness": 2000.0})
    file = tmp_path / "stiff.json"
    file.write_text(write_file(kind, stiff), "utf-8")
    assert read_setup("rope").params == make_setup(kind).params
    assert read_setup("rope:Stiff rope").params == check_record(kind.params, kind.presets["Stiff rope"])
    assert read_setup("?scene=rope&stiffness=2000").params == stiff
    assert read_setup("http://localhost:8080/?scene=rope&stiffness=2000").params == stiff
    assert read_setup(str(file)).params == stiff
    assert len(read_comparison(["moons"])) == 3


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["rope"], "set-ups side by side: 'rope' is not allowed; allowed: one of planets"),
        (["rope"] * 4, "set-ups side by side: 4 is not allowed; allowed: 2 to 3"),
        (["rope", "rop"], f"scene: 'rop' is not allowed; allowed: one of {', '.join(sorted(NAMES))}"),
        (["rope", "rope:Nope"], "preset: 'Nope' is not allowed; allowed: one of Lab code"),
        (["rope", "?scene=rope&stiffness=-4"], "stiffness: '-4' is not allowed; allowed: 1 to 1e9 N/m"),
        (["rope", "none.json"], "set-up: none.json: no such file"),
    ],
)
def test_what_cannot_be_set_side_by_side_is_refused_in_one_line(
    words: list[str], line: str, capsys: pytest.CaptureFixture
) -> None:
    assert main(["beside", *words, "--no-open", "--port", "0"]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"springtide: {line}")
    assert said.count("\n") == 1


def test_only_what_differs_and_means_something_is_said() -> None:
    earth, mars = panes("?scene=square_sea&planet=Earth&sky=park", "?scene=square_sea&planet=Mars&sky=sunset")
    assert differences([earth, mars]) == [["Planet: Earth, 9.81 m/s²"], ["Planet: Mars, 3.73 m/s²"]]
    by_mass, own = panes("?scene=square_sea", "?scene=square_sea&planet=by+gravity&gravity=3.71")
    assert differences([by_mass, own]) == [["Planet: By mass"], ["Planet: By gravity", "Gravity: 3.71 m/s²"]]
    clean, oil = panes("?scene=radial_sea", "?scene=radial_sea&spill=layer&thickness=0.5")
    assert differences([clean, oil]) == [["Oil spill: No oil"], ["Oil spill: Layer of oil", "Layer thickness: 0.5 m"]]
    assert headings([clean, clean]) == ["Radial sea", "Radial sea"]
    rope, sea = panes("?scene=rope", "?scene=square_sea")
    assert [words.split(" · ")[0] for words in headings([rope, sea])] == ["Rope", "Square sea"]


def test_the_middle_of_a_square_sea_is_that_of_its_tile() -> None:
    sea = scene_named("square_sea")
    assert middle_of("square_sea", check_record(sea.params, {"length": 128.0})) == (64.0, 64.0)
    assert middle_of("radial_sea", scene_named("radial_sea").params()) == (0.0, 0.0)
