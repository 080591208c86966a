"""The short programs of the page: each runs, and has at most 12 lines."""

import re
import shutil
import warnings
from pathlib import Path

import pytest

from tests.docs.pages import ROOT, text_of

PROGRAMS = re.findall(r"^## ([^\n]+)\n\n```python\n(.*?)^```$", text_of(ROOT / "docs" / "programs.md"), re.M | re.S)
MAX_LINES = 12
OPTIONAL = {"with_dataset": "netCDF4", "import capytaine": "capytaine"}
COMPILES = "A heavy bob on a light string"  # for ten seconds, a kernel that no other test runs


@pytest.mark.parametrize(
    ("title", "code"),
    [
        pytest.param(title, code, id=title, marks=pytest.mark.long if title == COMPILES else ())
        for title, code in PROGRAMS
    ],
)
def test_a_program_runs_and_is_short(
    title: str, code: str, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert len([line for line in code.splitlines() if line.strip()]) <= MAX_LINES
    compiled = compile(code, title, "exec")
    for word, package in OPTIONAL.items():
        if word in code:
            pytest.importorskip(package)
    for name in re.findall(r"assets/[\w./]+", code):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings(record=True) as caught:
        exec(compiled, {})
    assert not any("diverged" in str(warning.message) for warning in caught)
    said = capsys.readouterr().out
    assert said
    assert "nan" not in said


def test_there_are_thirteen_programs() -> None:
    assert len(PROGRAMS) == 13
