"""Saved versions of a folder, found by looks at the stamps of its files."""

import os
from pathlib import Path

import pytest

from app.lab import versions
from app.lab.versions import Look, Versions, stamps


def test_a_look_finds_what_was_written_made_and_removed(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    look = Look(folder, ".py")
    assert not look.has_changed()  # there is no folder yet
    folder.mkdir()
    assert look.has_changed()
    for change in (
        lambda: (folder / "a.py").write_text("x"),
        lambda: (folder / "a.py").write_text("xy"),
        lambda: os.utime(folder / "a.py", ns=(1, 1)),
        lambda: (folder / "a.py").rename(folder / "b.py"),
        lambda: (folder / "b.py").unlink(),
        lambda: (folder / "c.py").symlink_to(folder / "b.py"),
    ):
        before = stamps(folder, ".py")
        change()
        found = stamps(folder, ".py") != before
        assert look.has_changed()
        assert found != (folder / "c.py").is_symlink()  # a link to nothing is no file
    (folder / "notes.txt").write_text("x")
    look.sure_at = 0.0
    assert not look.has_changed()
    look.forget()
    assert look.has_changed()


def test_a_second_save_that_changes_no_stamp_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr(versions.time, "monotonic", lambda: clock[0])
    path, folder = tmp_path / "mine" / "rope.py", tmp_path / "copies"
    path.parent.mkdir()
    folder.mkdir()
    look = Versions(path.parent, (), folder)

    def save(text: str) -> None:
        path.write_text(text)
        os.utime(path, ns=(2 * 10**9, 2 * 10**9))  # of a file system that counts in steps of 2 s

    save("x = 1")
    first = look.look()
    assert first is not None
    assert look.look() is None
    save("x = 2")
    clock[0] += 2.0
    second = look.look()
    assert second is not None
    assert (first.number, first.texts["rope.py"]) == (1, b"x = 1")
    assert (second.number, second.texts["rope.py"]) == (2, b"x = 2")
    clock[0] += 1000.0
    assert look.look() is None


def test_a_version_that_could_not_be_copied_is_found_again(tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text("x = 1")
    look = Versions(tmp_path, (), tmp_path / "copies")
    for _ in range(2):
        with pytest.raises(FileNotFoundError):
            look.look()
    (tmp_path / "copies").mkdir()
    found = look.look()
    assert found is not None
    assert found.texts == {"rope.py": b"x = 1"}
