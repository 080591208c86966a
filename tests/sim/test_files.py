"""Files that appear whole."""

from pathlib import Path

import pytest

import sim.files
from sim.files import replacing


@pytest.mark.parametrize("refusals", [2, 3])
def test_a_file_that_another_program_has_open_for_a_moment_is_replaced(
    refusals: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, left, replace = tmp_path / "answers.toml", [refusals], sim.files.os.replace

    def refuse(source: Path, target: Path) -> None:
        if left[0]:
            left[0] -= 1
            raise PermissionError(13, "Access is denied", str(target))
        replace(source, target)

    path.write_text("old", "utf-8")
    monkeypatch.setattr(sim.files.os, "replace", refuse)
    monkeypatch.setattr(sim.files, "PAUSES", (0.0, 0.0))
    if refusals == 3:  # one more than there are tries
        with pytest.raises(PermissionError), replacing(path) as draft:
            draft.write_text("new", "utf-8")
        assert path.read_text("utf-8") == "old"
    else:
        with replacing(path) as draft:
            draft.write_text("new", "utf-8")
        assert path.read_text("utf-8") == "new"
    assert list(tmp_path.iterdir()) == [path]  # no draft is left
