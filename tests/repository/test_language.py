"""The style of the texts: first lines of docstrings, comments, and words that are not used.

A first line of a docstring is a noun phrase or an imperative, and so is a comment that explains a name.
"""

import ast
import io
import re
import tokenize
from pathlib import Path

import pytest

from app.scenes import NAMES, scene_named
from sim.parameters import parameters_of
from tests.repository.test_layers import ROOT, below, named

BEGINNINGS = r"(What|Whether|Where|Which|How|Why|When|Who|All that|That|Those|The one|Of)\b"
CLAUSE = re.compile(rf"{BEGINNINGS}|.*\b[Ww]hat\b")
COMMENT = re.compile(r"(What|Whether|How|Which) |(what|whether|how) ")
COMMENT_IN_JS = re.compile(r"(?<!:)//\s*((?:What|Whether|How|Which|what|whether|how) .*)")
AVOIDED = re.compile(
    r"\b(of which|[Tt]here (is|are|was|were) none|(is|are) none of|by no fault|whereof|[Bb]esides|[Hh]ence|for ever"
    r"|but for|so many|[Ww]hoever|expected (is|are) (a|an|the|two)|no longer lives|lives whatever"
    r"|Raises \w+ where|None where|null where|places? of rest|what hangs|number from \d+(?=\")|pictures a second)\b"
)
PAGES = [path for path in sorted((ROOT / "docs").glob("*.md")) if path.name != "physics.md"] + [ROOT / "README.md"]
SCRIPTS = sorted((ROOT / "app").rglob("*.js"))


def first_lines(source: str) -> list[str]:
    """The first docstring line of a module, and of its classes and functions."""
    described = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docs = [ast.get_docstring(node) for node in ast.walk(ast.parse(source)) if isinstance(node, described)]
    return [doc.partition("\n")[0] for doc in docs if doc]


def comments(source: str) -> list[str]:
    """The first line of each comment of a Python source, without its sign."""
    found, last = [], -1  # row of the last comment that has its line to itself: the next line continues it
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            row, is_alone = token.start[0], token.line.lstrip().startswith("#")
            if not is_alone or row != last + 1:
                found.append(token.string.lstrip("# "))
            last = row if is_alone else -1
    return found


def sources() -> list[Path]:
    """The sources of the program."""
    return [*below("app"), *below("sim")]


def test_a_clause_is_told_from_a_noun_phrase():
    source = (
        '"""What it is."""\ndef f():\n    """Return what it is."""\nclass A:\n    """Whatever: a somewhat long name."""'
    )
    assert [bool(CLAUSE.match(line)) for line in first_lines(source)] == [True, True, False]


def test_first_lines_of_docstrings_are_no_clauses():
    lines = [(named(path), line) for path in sources() for line in first_lines(path.read_text("utf-8"))]
    assert [f"{name}: {line}" for name, line in lines if CLAUSE.match(line)] == []


def test_a_comment_that_is_a_clause_is_found_and_one_that_goes_on_is_not():
    source = "# How it is.\nx = 1  # True if so\ny = 2  # whether it is\n# A reason\n# how it came\nz = '# what'\n"
    assert [line for line in comments(source) if COMMENT.match(line)] == ["How it is.", "whether it is"]
    assert COMMENT_IN_JS.findall("let a; // what it is\nconst b = 'http://what is'; // name") == ["what it is"]


def test_comments_are_no_clauses():
    lines = [(named(path), line) for path in sources() for line in comments(path.read_text("utf-8"))]
    wrong = [f"{name}: {line}" for name, line in lines if COMMENT.match(line)]
    for path in SCRIPTS:
        text = path.read_text("utf-8").split("\n")
        first = [line for before, line in zip(["", *text], text, strict=False) if not before.lstrip().startswith("//")]
        wrong += [f"{named(path)}: {found[1]}" for line in first for found in COMMENT_IN_JS.finditer(line)]
    assert wrong == []


@pytest.mark.parametrize("name", NAMES)
def test_hints_of_controls_are_no_clauses(name):
    hints = [parameter.doc for parameter in parameters_of(scene_named(name).params).values()]
    assert len(hints) > 10
    assert [hint for hint in hints if CLAUSE.match(hint)] == []


@pytest.mark.parametrize(
    "text",
    [
        "a file, of which it is one", "by no fault of its own", "expected is a number", "None if there is none",
        "Raises ValueError where it is open", "None where nothing moves", "its place of rest",
        "the weight of what hangs", '"a whole number from 1"',
    ],
)  # fmt: skip
def test_words_that_are_avoided_are_found(text):
    assert AVOIDED.search(text)


def test_words_that_are_avoided_are_nowhere():
    texts = [*sources(), *SCRIPTS, *PAGES, *sorted((ROOT / "app").rglob("*.toml"))]
    lines = [(path, i, line) for path in texts for i, line in enumerate(path.read_text("utf-8").split("\n"), 1)]
    assert [f"{named(path)}:{i}: {line.strip()}" for path, i, line in lines if AVOIDED.search(line)] == []
