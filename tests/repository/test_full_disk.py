"""The full disk of the tests itself."""

import importlib
import sys

import pytest

from tests.full_disk import full_disk


def test_an_import_while_the_disk_is_full_leaves_no_cut_byte_code(tmp_path, monkeypatch):
    (tmp_path / "imported_on_a_full_disk.py").write_text("x = 1\n" * 1000, "utf-8")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    with full_disk(100):
        importlib.import_module("imported_on_a_full_disk")
        with pytest.raises(OSError, match="large"):
            (tmp_path / "long").write_bytes(bytes(101))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["imported_on_a_full_disk.py", "long"]
    assert not sys.dont_write_bytecode
