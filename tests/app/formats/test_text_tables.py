"""Tables on screen are whole, however narrow the terminal is."""

import csv
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.commands.lab_folders import print_results
from app.formats import text_tables
from benchmarks.compare import shown as shown_ratio

COMMITTED = sorted((Path(__file__).parents[3] / "assets" / "bench").glob("*.csv"))
WIDTH = 80  # of the terminal
LONG = 123456.789012345


def wide_rows(number_of_columns: int) -> text_tables.Rows:
    """Rows of words, numbers and a missing number, with numbers that begin alike."""

    def value(row: int, i: int) -> object:
        return (None, i / 7.0, f"word{row}-{i}", 10**9 + 17 * i + row)[(i + row) % 4]

    return [{f"quantity {i} [unit{i}]": value(row, i) for i in range(number_of_columns)} for row in range(3)]


def number_of(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text or None


def read(path: Path) -> text_tables.Rows:
    with path.open(newline="", encoding="utf-8") as file:
        return [{name: number_of(cell) for name, cell in row.items()} for row in list(csv.DictReader(file))[:40]]


def check_whole(said: str, rows: text_tables.Rows) -> None:
    """Every value of the rows is a word of what was printed, with its name before it or above it."""
    cells = [*re.split(r"[│┃\n]", said), " ".join(said.split())]
    for row in rows:
        for name, value in row.items():
            text = text_tables.written(value)
            words = " ".join(text.split())
            if text:
                assert any(text == cell.strip() or f": {words} " in f"{cell} " for cell in cells), (name, text)
                assert all(word in said for word in re.sub(r"[\[\]]", " ", name).split()), name


PRINTERS: dict[str, Callable[[], text_tables.Rows]] = {
    "few columns": lambda: wide_rows(3),
    "many columns": lambda: wide_rows(12),
    "long words": lambda: [{"row": "a b " * 30 + "c", "error [m]": LONG}],
    "ratios": lambda: [
        shown_ratio(
            {"row": "kernels: " + "cloth of many points, " * 4, "time": "ns per point and step"}
            | {"A": LONG, "B": LONG, "B / A": 1.0, "least": 0.9, "largest": 1.1}
        )
    ],
    **{path.stem: lambda path=path: read(path) for path in COMMITTED},
}


@pytest.mark.parametrize("name", PRINTERS)
def test_every_value_is_whole_in_a_narrow_terminal(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    rows = PRINTERS[name]()
    text_tables.print_table(name, rows)
    said = capsys.readouterr().out
    assert "…" not in said
    check_whole(said, rows)
    if "│" in said:
        assert max(map(len, said.splitlines())) <= WIDTH


def test_a_table_that_does_not_fit_is_printed_as_lines(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = {"method": "rk4", "error [m]": 1.25e-9, "steps": None, "least [ms]": 3.0, "of [many] kinds": 7}
    assert text_tables.lines_of(row) == ["method: rk4", "  error: 1.25e-09 m", "  least: 3 ms", "  of [many] kinds: 7"]
    for width, is_table in ((100, True), (30, False)):
        monkeypatch.setenv("COLUMNS", str(width))
        text_tables.print_table("Title", [row])
        said = capsys.readouterr().out
        assert ("│" in said) == is_table
        assert "Title" in said


def test_no_digit_and_no_border_is_cut_at_any_width(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = {"network": "rope, axial damping", "integrator": "implicit_midpoint", "step off at most [%]": 0.25,
           "at damping [N s/m]": 1000.0}  # fmt: skip
    heights = []
    for width in range(60, 100):
        monkeypatch.setenv("COLUMNS", str(width))
        text_tables.print_table("", [row])
        lines = capsys.readouterr().out.splitlines()
        if lines[0].startswith("┏"):
            assert {(len(line) <= width, line[-1]) for line in lines} <= {(True, mark) for mark in "┓┃┩│┘"}
            assert re.findall(r"[^│ ][^│]*[^│ ]", lines[-2]) == [text_tables.written(value) for value in row.values()]
            heights.append(len(lines))
    assert heights == sorted(heights, reverse=True)  # headings are folded no more than they need
    assert heights[-1] == 5


def test_a_table_that_just_fits_is_printed_as_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = {"first": 1.25, "second": "words"}
    width = len("│  1.25 │  words │")  # with a place for the longest word of a heading
    for columns, is_table in ((width, True), (width - 1, False)):
        monkeypatch.setenv("COLUMNS", str(columns))
        text_tables.print_table("", [row])
        lines = capsys.readouterr().out.splitlines()
        assert lines[0].startswith("┏") is is_table
        assert max(map(len, lines)) <= columns


def test_a_line_is_folded_between_words_and_indented_further() -> None:
    lines = text_tables.fold("  " + "word " * 9, 20)
    assert lines == ["  word word word", *["    word word word"] * 2]


@pytest.mark.parametrize("width", [30, 80])
@pytest.mark.parametrize(
    "path", [Path("out.nc"), Path("/a folder", "of a long name, with spaces " * 4, "out.nc")], ids=["short", "long"]
)
def test_a_path_is_whole_and_the_text_about_it_does_not_depend_on_its_length(
    path: Path, width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    text_tables.say("8 cases", path)
    assert capsys.readouterr().out in (f"{path}: 8 cases\n", f"{path}\n  8 cases\n")
    text_tables.say("8 cases over a grid of three parameters", path)
    lines = capsys.readouterr().out.splitlines()
    assert str(path) in lines[0]
    if lines[0] == str(path):
        assert lines[1].startswith("  8 cases")
        assert max(map(len, lines[1:])) <= width
    else:
        assert lines == [f"{path}: 8 cases over a grid of three parameters"]
        assert len(lines[0]) <= width


def test_the_results_of_the_lab_are_folded_and_not_cut(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    task = SimpleNamespace(
        name="long", item="2.10", optional=True, title="A long title of a task that goes on and on, and on"
    )
    problems = ["rope.py:7 step_rk4: wrong: (x, v) is 0.1234567890123456789012345678901234567890123456789 m, not 1 m"]
    missing = ["Which of the methods takes energy from the rope, and which one adds energy to it in each step?"]
    entry = SimpleNamespace(task=task, state="incomplete", problems=problems, missing=missing, program=None, answers=())
    named: Any = SimpleNamespace(
        folder=Path("a_folder_with_a_long_name_" * 4), tasks=[entry], seconds=1.0, count=lambda optional: (0, 1),
        answers=SimpleNamespace(name="Anna-" * 20, error=""),
    )  # fmt: skip
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    for results, texts in (
        ([named], [task.title, problems[0], missing[0], "incomplete", "2.10", "(optional)"]),
        ([named, named], [named.folder.name, named.answers.name, "0 of 1"]),
    ):
        print_results(results)
        said = capsys.readouterr().out
        assert "…" not in said
        for text in texts:
            assert text in " ".join(said.split()), text
