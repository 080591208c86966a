"""A scene is compiled ahead once, and again when a source that its kernels can reach has changed."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from app.__main__ import main
from app.scenes.ahead import compiling
from app.scenes.ahead.compiling import Job
from sim import jit
from sim.cache import host_levels

DRAWING = Job("rope", "drawing", True)


@pytest.fixture
def compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What the pieces of a scene of two pieces, and one of its drawing, have compiled."""
    found: list[str] = []

    def side(*pieces: str) -> Callable[[str], SimpleNamespace]:
        table = {piece: lambda piece=piece: found.append(piece) for piece in (*pieces, "on use")}
        ahead = {piece: table[piece] for piece in pieces}
        on_use = {"on use": table["on use"]}
        return lambda name: SimpleNamespace(
            WARM_UP=ahead, warm_up=lambda: ahead, needs=lambda params: params, warm_up_on_use=lambda: on_use
        )

    monkeypatch.setattr(jit, "CACHE", tmp_path)
    monkeypatch.setattr(jit, "SHARED", ())
    monkeypatch.setattr(compiling, "scene_named", side("gauge", "rk4"))
    monkeypatch.setattr(compiling, "view_named", side("drawing"))
    compiling.hash_of.cache_clear()
    return found


def test_a_scene_is_compiled_once_and_again_after_an_edit(compiled: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    compiling.prepare("rope", drawn=False)
    compiling.prepare("rope", drawn=False)
    assert compiled == ["gauge", "rk4"]
    compiling.prepare("rope")
    compiling.prepare("rope")
    assert compiled == ["gauge", "rk4", "drawing"]
    monkeypatch.setattr(compiling, "hash_of", lambda name, drawn: "hash after an edit")
    compiling.prepare("rope", drawn=False)
    assert compiled == ["gauge", "rk4", "drawing", "gauge", "rk4"]


def test_parameters_need_only_their_own_pieces(compiled: list[str]) -> None:
    """Those of the drawing come last."""
    needed = ("rk4",)  # as parameters of this scene are its needs
    assert compiling.uncompiled("rope", needed) == [Job("rope", "rk4"), DRAWING]  # type: ignore[arg-type]
    compiling.compile_job(Job("rope", "rk4"))
    assert compiling.uncompiled("rope", needed) == [DRAWING]  # type: ignore[arg-type]
    assert compiling.uncompiled("rope") == [Job("rope", "gauge"), DRAWING]
    compiling.prepare("rope")
    assert not compiling.uncompiled("rope")


def test_a_scene_that_is_compiled_as_a_whole_is_not_asked_again(
    compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(name: str) -> SimpleNamespace:
        raise AssertionError(f"{name} is imported")

    compiling.prepare("rope", drawn=False)
    with monkeypatch.context() as patched:
        patched.setattr(compiling, "scene_named", refuse)
        with pytest.raises(AssertionError, match="is imported"):
            compiling.uncompiled("rope")
    compiling.prepare("rope")
    monkeypatch.setattr(compiling, "scene_named", refuse)
    monkeypatch.setattr(compiling, "view_named", refuse)
    assert compiling.uncompiled("rope") == []


def test_a_piece_on_use_is_compiled_when_parameters_first_need_it(compiled: list[str]) -> None:
    compiling.prepare("rope")
    assert "on use" not in compiled
    assert not compiling.uncompiled("rope")
    needed = ("rk4", "on use")
    assert compiling.uncompiled("rope", needed) == [Job("rope", "on use")]  # type: ignore[arg-type]
    compiling.compile_job(Job("rope", "on use"))
    assert compiled[-1] == "on use"
    assert not compiling.uncompiled("rope", needed)  # type: ignore[arg-type]


def test_what_fails_is_not_remembered(compiled: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def fails() -> None:
        raise RuntimeError

    monkeypatch.setattr(
        compiling,
        "scene_named",
        lambda name: SimpleNamespace(warm_up=lambda: {"rk4": fails}, needs=None, warm_up_on_use=dict),
    )
    with pytest.raises(RuntimeError):
        compiling.compile_job(Job("rope", "rk4"))
    assert Job("rope", "rk4") in compiling.uncompiled("rope")


def test_a_level_that_this_processor_does_not_have_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for level in {"x86-64-v3", "arm64", "i386"} - set(host_levels()):
        assert main(["warmup", "--into", str(tmp_path / "shared"), "--processor", level]) == 2
        assert capsys.readouterr().err.startswith(f"springtide: --processor: '{level}' is not allowed; allowed: what")
    assert not list(tmp_path.iterdir())
    assert main(["warmup", "--processor", "x86-64-v3"]) == 2
    assert "together with --into" in capsys.readouterr().err


def test_all_levels_of_this_processor_go_into_one_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs: list[tuple[str, str]] = []

    def run(command: list[str], env: dict[str, str], check: bool) -> SimpleNamespace:
        runs.append((env["NUMBA_CPU_NAME"], env["SPRINGTIDE_CACHE"]))
        return SimpleNamespace(returncode=3 * (len(runs) == 4))

    monkeypatch.setattr("app.commands.warmup.subprocess.run", run)
    words = ["warmup", "--into", str(tmp_path), "--processor", "all"]
    monkeypatch.setattr("sim.cache.host_levels", lambda: ("x86-64-v4", "x86-64-v3"))
    monkeypatch.setattr("app.commands.warmup.host_levels", lambda: ("x86-64-v4", "x86-64-v3"))
    assert main(words) == 0
    assert runs == [("x86-64-v4", str(tmp_path)), ("x86-64-v3", str(tmp_path))]
    assert main(words) == 3  # the second one fails
    monkeypatch.setattr("sim.cache.host_levels", lambda: ())
    monkeypatch.setattr("app.commands.warmup.host_levels", lambda: ())
    assert main(words) == 2
    assert len(runs) == 4
