"""The user's own set-ups: kept, listed, replaced, removed, and bounded."""

from pathlib import Path
from typing import Any

import pytest

from app.scenes import own_setups, scene_named
from app.scenes.own_setups import folder_of, keep_own, own_files, remove_own
from app.scenes.setups import write_file


@pytest.fixture
def kind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setenv("SPRINGTIDE_DATA", str(tmp_path))
    return scene_named("rope")


def keep(kind: Any, name: str, points: int) -> None:
    keep_own(kind, name, write_file(kind, kind.params(points=points), name=name))


def test_what_is_kept_is_listed_replaced_and_removed(kind: Any) -> None:
    assert own_files(kind) == {}
    for name, points in (("Stiff", 12), ("stiff!", 13), ("../../<b>ö", 14), ("Stiff", 15)):
        keep(kind, name, points)
    assert {name: setup.params.points for name, (_, setup) in own_files(kind).items()} == {  # type: ignore[attr-defined]
        "../../<b>ö": 14,
        "Stiff": 15,
        "stiff!": 13,
    }
    assert {path.parent for path, _ in own_files(kind).values()} == {folder_of(kind)}
    assert own_files(scene_named("race")) == {}
    remove_own(kind, "Stiff")
    assert [*own_files(kind)] == ["../../<b>ö", "stiff!"]
    with pytest.raises(ValueError, match="name: 'Stiff' is not allowed"):
        remove_own(kind, "Stiff")
    with pytest.raises(ValueError, match="a name, for the list of presets"):
        keep(kind, "", 3)


def test_files_that_are_no_set_ups_are_left_out_and_the_number_is_bounded(
    kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    keep(kind, "Good", 9)
    folder = folder_of(kind)
    (folder / "a.json").write_text("{", "utf-8")
    (folder / "b.json").write_bytes(b"\xff" * 100)
    (folder / "c.json").write_text("x" * 1_000_000, "utf-8")
    (folder / "d.json").write_text('{"scene": "race", "parameters": {}}', "utf-8")
    (folder / "e.json").mkdir()
    assert [*own_files(kind)] == ["Good"]
    monkeypatch.setattr(own_setups, "MAX_OWN", 1)
    for path in folder.glob("?.json"):
        path.rmdir() if path.is_dir() else path.unlink()
    keep(kind, "Good", 10)
    with pytest.raises(ValueError, match="at most 1: remove one first"):
        keep(kind, "More", 10)


def test_files_that_cannot_be_read_hide_none_that_can_however_many_they_are(
    kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own_setups, "MAX_OWN", 2)
    keep(kind, "zeta", 9)
    for number in range(5):
        (folder_of(kind) / f"a{number}.json").write_text("{", "utf-8")
    keep(kind, "zeta", 10)
    keep(kind, "eta", 11)
    assert {name: setup.params.points for name, (_, setup) in own_files(kind).items()} == {"eta": 11, "zeta": 10}  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="at most 2: remove one first"):
        keep(kind, "theta", 12)


@pytest.mark.parametrize("name", ["con", "NUL", "aux", "com1", "?"])
def test_a_name_that_windows_reserves_is_none_of_a_file(kind: Any, name: str) -> None:
    keep(kind, name, 9)
    assert own_files(kind)[name][0].name.startswith("set-up")
