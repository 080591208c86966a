"""Output of the commands in a terminal of 80 columns: whole, and folded between words."""

import argparse
import csv
import io
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

import pytest
from rich.console import Console

from app.__main__ import Parser, main, make_parser
from app.formats import text_tables
from app.scenes import NAMES, scene_named
from app.study.sweep import workers
from app.study.sweep.case import run_case
from benchmarks import hydrodynamics
from sim.parameters import parameters_of

WIDTH = 80  # [characters]
ASSETS = Path(__file__).parents[3] / "assets"


@pytest.fixture(autouse=True)
def narrow(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    monkeypatch.chdir(tmp_path)


def check_whole(said: str, *texts: str) -> None:
    """Nothing is cut, no line is too long, and all of these texts are there."""
    assert "…" not in said
    for line in said.splitlines():
        assert len(line) <= WIDTH, line
    for text in texts:
        assert text in " ".join(said.split()), text


def parsers(parser: Parser, words: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """The words of every command."""
    yield words
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                inner.add_arguments()
                yield from parsers(inner, (*words, name))


@pytest.mark.parametrize("words", list(parsers(make_parser())), ids=" ".join)
def test_the_help_of_each_command_fits(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([*words, "--help"])
    check_whole(capsys.readouterr().out, "usage: springtide")


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_lists_its_presets_parameters_and_measures(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", name, "--list"]) == 0
    kind, said = scene_named(name), capsys.readouterr().out
    declared = parameters_of(kind.params)
    check_whole(said, *kind.presets, *(f"{key} =" for key in declared), *(p.doc for p in declared.values()))
    for parameter in declared.values():
        assert f"Allowed: {parameter.allowed}." in " ".join(said.split())
    assert said.index("Presets") < said.index("Parameters") < said.index("Measures")


def test_the_lab_says_one_line_a_task_and_each_problem_with_its_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lab", "new", "mine"]) == 0
    path = Path("mine/rope.py")
    wrong = "    return stiffness * (np.linalg.norm(x2 - x1) - rest_length) * (x2 - x1) - damping * (v1 - v2)\n"
    path.write_text(path.read_text("utf-8").replace("    ...\n", wrong, 1), "utf-8")
    line = path.read_text("utf-8").splitlines().index(wrong.rstrip("\n")) + 1
    start = next(i for i in range(line, 0, -1) if path.read_text("utf-8").splitlines()[i - 1].startswith("def "))
    capsys.readouterr()
    assert main(["lab", "check", "mine"]) == 1
    said = capsys.readouterr().out
    first = said.splitlines()[0]
    assert first.startswith("3.2-1")
    assert "wrong" in first
    check_whole(
        said, f"rope.py:{start} spring_force: direction not of unit length: ", "still to do: A rope of 9 springs"
    )
    assert said.count("3.2-2") == 0
    main(["lab", "check", "mine", "--all"])
    everything = capsys.readouterr().out
    check_whole(everything, "3.2-2 not begun")
    assert everything.count("not begun") == 25
    main(["lab", "check", "mine", "mine"])
    said = capsys.readouterr().out
    check_whole(said, "0 of 19", "wrong 1, not begun 25", "2 students, 3.2-1 spring_force: direction not of unit")


def test_the_comparison_of_hulls_is_whole(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    row = hydrodynamics.Compared("Buoy", "response at 0.70 of the frequency of heave", 1.2345, 1.2344, 0.02)
    monkeypatch.setattr(hydrodynamics, "require_capytaine", lambda: None)
    monkeypatch.setattr(hydrodynamics, "make_table", lambda *_, **__: None)
    monkeypatch.setattr(hydrodynamics.Hull, "of", lambda *_: None)
    monkeypatch.setattr(hydrodynamics, "compared", lambda *_: [row])
    assert main(["hydrodynamics", "--compare"]) == 0
    check_whole(capsys.readouterr().out, row.quantity, "1.2345", "1.2344", "+0.01%")


def test_a_sweep_says_how_far_it_is_and_what_it_wrote(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("netCDF4")
    monkeypatch.setattr(workers, "on_cores", lambda jobs: ((i, run_case(*job)) for i, job in jobs.items()))
    Path("s.toml").write_text(
        'scene = "rope"\nseconds = 1.0\n[set]\npoints = 2\nintegrator = "explicit_euler"\n'
        "[parameters]\ntime_step = [0.001, 0.1]\ndrag = [0.0, 1.0]\n",
        "utf-8",
    )
    bar = io.StringIO()
    monkeypatch.setattr("rich._console", Console(file=bar, force_terminal=True, width=WIDTH))
    assert main(["sweep", "s.toml", "--out", f"{'results_' * 6}.nc"]) == 0
    check_whole(re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", bar.getvalue()).replace("\r", "\n"), "4/4")
    check_whole(capsys.readouterr().out, "4 cases", "time_step 2", ".svg")


RESULTS = sorted(
    path for folder in ("bench", "stability") for path in (ASSETS / folder).glob("*.csv") if path.stem != "faults"
)


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.stem)
def test_no_digit_of_a_result_is_cut(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Rows as `bench`, `stability` and `sweep` print them; of the results that are kept, the widest cells."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = [{name: number_or_text(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
    rows = sorted(rows, key=lambda row: -sum(len(text_tables.written(value)) for value in row.values()))[:20]
    text_tables.print_table(path.stem, rows)
    check_whole(capsys.readouterr().out, *(text_tables.written(value) for row in rows for value in row.values()))


def number_or_text(cell: str) -> float | str:
    """A cell of a table of results."""
    try:
        return float(cell)
    except ValueError:
        return cell


@pytest.mark.parametrize("seconds", ["0.02", "0.02 s", "20ms", "1/50", "0,02"])
def test_a_time_may_have_its_unit(seconds: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "rope", "--set", "points=2", "--seconds", seconds, "--out", "a.npz"]) == 0
    assert "to t = 0.0" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["run", "rope", "--seconds", "1 m", "--out", "b.npz"])
    assert "'m' alone may mean two things: write ms or min" in " ".join(capsys.readouterr().err.split())
    with pytest.raises(SystemExit):
        main(["run", "rope", "--seconds", "1 kg", "--out", "b.npz"])
    assert textwrap.shorten(capsys.readouterr().err, 200).endswith("write a number, with or without s")
