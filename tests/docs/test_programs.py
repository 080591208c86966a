"""The short programs of the page: each runs, and has at most 12 lines."""

import re

import pytest

from tests.docs.pages import ROOT, text_of

PROGRAMS = re.findall(r"^## ([^\n]+)\n\n```python\n(.*?)^```$", text_of(ROOT / "docs" / "programs.md"), re.M | re.S)
MAX_LINES = 12


@pytest.mark.parametrize(("title", "code"), PROGRAMS, ids=[title for title, _ in PROGRAMS])
def test_a_program_runs_and_is_short(
    title: str, code: str, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "with_dataset" in code:
        pytest.importorskip("xarray")
    monkeypatch.chdir(ROOT)
    assert len([line for line in code.splitlines() if line.strip()]) <= MAX_LINES
    exec(compile(code, title, "exec"), {})
    said = capsys.readouterr().out
    assert said
    assert "nan" not in said


def test_there_are_programs() -> None:
    assert len(PROGRAMS) == 6
