"""One name for one thing: names that others replaced stay gone, and the glossary names what there is."""

import io
import re
import tokenize

from tests.repository.test_layers import ROOT, below, named

# Former name -> the name that says it.
FORMER = {
    "KeptState": "Checkpoint",
    "Kept": "RecordedFrame",
    "Keeper": "SetupSaver",
    "Moment": "LastFrame",
    "Beside": "ComparisonCalls",
    "Comparing": "Comparisons",
    "Screen": "MessageFilter",
    "Look": "FileWatch",
    "Pace": "RateLimit",
    "Runs": "RunSequence",
    "pacer": "fixed_step",
    "WavePace": "WaveSlope",
    "writeHalves": "writeHalfFloats",
}
FORMER_FILES = {
    "job", "moments", "pace", "pacer", "left_runs", "runs", "access.js", "half", "halve", "where", "shown", "sense",
}  # fmt: skip
OTHER = {  # of a former name, in a sense of its own: a type in one file
    "Look": {"app/panel/plots.py"},
    "Runs": {"app/render/markup/line_chart.py"},
}
ALSO_NAMED = {"sim/ocean/spectra/moments.py"}  # of a spectrum, the term of the field
GLOSSARY = re.compile(r"^## Words\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)


def names_in(source: str) -> set[str]:
    """The names of a Python source, without those in strings."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return {token.string for token in tokens if token.type == tokenize.NAME}


def test_a_name_is_found_in_code_and_not_in_a_text():
    assert {"Kept", "Look"} <= names_in("def f(x: Kept) -> Look: ...")
    assert names_in('"""Kept in the list."""\nx = "Kept"') == {"x"}


def test_former_names_are_gone():
    for path in (*below("app"), *below("sim")):
        here = names_in(path.read_text("utf-8")) & FORMER.keys()
        assert {name for name in here if named(path) not in OTHER.get(name, ())} == set(), named(path)
    for path in (ROOT / "app").rglob("*.js"):
        assert not re.search(r"\bwriteHalves\b", path.read_text("utf-8")), named(path)


def test_former_files_are_gone():
    files = [path for top in ("app", "sim") for end in ("py", "js") for path in (ROOT / top).rglob(f"*.{end}")]
    wrong = [named(path) for path in files if FORMER_FILES & {path.stem, path.name}]
    assert set(wrong) == ALSO_NAMED


def test_the_glossary_has_each_word_once_and_its_names_are_there():
    (words,) = GLOSSARY.findall((ROOT / "docs" / "architecture.md").read_text("utf-8"))
    entries = re.findall(r"^- \*\*(.+?)\*\*", words, re.MULTILINE)
    each = [word for entry in entries for word in re.split(r", | and ", entry)]
    assert len(each) == len(set(each)) > 10
    there = set().union(*(names_in(path.read_text("utf-8")) for path in (*below("app"), *below("sim"))))
    for code in re.findall(r"`([\w.]+)`", words):
        assert set(code.split(".")) <= there | {"sim", "app"}, code
    assert set(FORMER) & set(re.findall(r"`(\w+)`", words)) == set()
