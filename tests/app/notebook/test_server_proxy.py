"""What jupyter-server-proxy is told."""

import tomllib
from pathlib import Path

import pytest

from app.notebook.server_proxy import LAB_VARIABLE, springtide
from app.server.web.access import KEY_HEADER, KEY_VARIABLE, read_key

ROOT = Path(__file__).parents[3]


def test_each_start_has_a_key_of_its_own_that_no_command_line_shows() -> None:
    first, second = springtide(), springtide()
    key = first["environment"][KEY_VARIABLE]  # type: ignore[index]
    assert read_key(key) == key != second["environment"][KEY_VARIABLE]  # type: ignore[index]
    assert first["request_headers_override"] == {KEY_HEADER: key}
    assert key not in " ".join(first["command"])  # type: ignore[arg-type]


def test_the_students_folder_is_made_once_and_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def words() -> list[str]:
        return list(springtide()["command"])[3:]  # type: ignore[call-overload]

    end = ["--no-open", "--resume", "--port", "{port}"]
    monkeypatch.delenv(LAB_VARIABLE, raising=False)
    assert words() == ["app", *end]
    for home in ("HOME", "USERPROFILE"):  # the latter on Windows
        monkeypatch.setenv(home, str(tmp_path))
    monkeypatch.setenv(LAB_VARIABLE, "~/{mine}")
    assert words() == ["app", "lab", str(tmp_path / "{{mine}}"), *end]
    readme = tmp_path / "{mine}" / "README.md"
    readme.write_text("changed", "utf-8")
    words()
    assert readme.read_text("utf-8") == "changed"
    monkeypatch.setenv(LAB_VARIABLE, str(readme / "below"))
    assert words() == ["app", *end]
    assert capsys.readouterr().err.startswith("springtide: SPRINGTIDE_LAB: ")


def test_exercises_are_made_beside_other_files_and_change_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "untitled.txt").write_text("", "utf-8")
    (tmp_path / ".data").mkdir()
    (tmp_path / "rope.py").write_text("mine", "utf-8")
    monkeypatch.setenv(LAB_VARIABLE, str(tmp_path))
    springtide()
    assert (tmp_path / "rope.py").read_text("utf-8") == "mine"
    for name in ("answers.toml", "README.md", "cloth.py", "pictures"):
        assert (tmp_path / name).exists(), name
    (tmp_path / "cloth.py").unlink()  # the folder has its answers: what is missing there was removed
    springtide()
    assert not (tmp_path / "cloth.py").exists()


def test_the_entry_point_is_declared_and_is_taken_by_the_proxy() -> None:
    entries = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["entry-points"]
    assert entries == {"jupyter_serverproxy_servers": {"springtide": "app.notebook.server_proxy:springtide"}}
    config = pytest.importorskip("jupyter_server_proxy.config", reason="the extra jupyter is not installed")
    process = config.ServerProcess(name="springtide", **springtide())
    assert process.launcher_entry.title == "Springtide"
