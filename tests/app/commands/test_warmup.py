"""A scene is compiled ahead once, and again when a source that its kernels can reach has changed."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

import app.scenes
from app.scenes import warmup


def test_a_scene_is_compiled_once_and_again_after_an_edit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[str] = []

    def side(name: str) -> SimpleNamespace:
        def warm_up() -> Iterator[str]:
            compiled.append(name)
            yield "everything"

        return SimpleNamespace(warm_up=warm_up)

    monkeypatch.setattr(warmup, "CACHE", tmp_path)
    monkeypatch.setattr(warmup, "scene_named", side)
    monkeypatch.setattr(app.scenes, "view_module", side)
    warmup.prepare("rope", drawn=False)
    warmup.prepare("rope", drawn=False)
    assert len(compiled) == 1
    warmup.prepare("rope")
    warmup.prepare("rope", drawn=False)
    assert len(compiled) == 3  # the scene again, and its drawing
    monkeypatch.setattr(warmup, "reachable_hash", lambda *_: "hash after an edit")
    warmup.prepare("rope", drawn=False)
    assert len(compiled) == 4
