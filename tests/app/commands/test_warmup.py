"""What is compiled ahead is compiled once an installation, not once a cache directory."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from app.scenes import warmup


def test_an_installation_does_not_rely_on_what_another_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled: list[str] = []

    def side(name: str) -> SimpleNamespace:
        def warm_up() -> Iterator[str]:
            compiled.append(name)
            yield "everything"

        return SimpleNamespace(warm_up=warm_up)

    monkeypatch.setattr(warmup, "CACHE", tmp_path)
    monkeypatch.setattr(warmup, "scene_named", side)
    monkeypatch.setattr(warmup, "view_named", side)
    warmup.prepare("rope", drawn=False)
    warmup.prepare("rope", drawn=False)
    assert len(compiled) == 1
    warmup.prepare("rope")
    warmup.prepare("rope", drawn=False)
    assert len(compiled) == 3  # the scene again, and its drawing
    # numba files kernels by where their source is: those of another place are of no use here.
    monkeypatch.setattr(warmup, "PLACE", "elsewhere")
    warmup.prepare("rope", drawn=False)
    assert len(compiled) == 4
