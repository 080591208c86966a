"""The style of docstrings: a first line is a noun phrase or an imperative."""

import ast
import re

from tests.repository.test_layers import below, named

CLAUSE = re.compile(r"(What|Whether|Where|All that|Who)\b|.* what ")
MAX_CLAUSES = 39


def first_lines(source: str) -> list[str]:
    """The first docstring line of a module, and of its classes and functions."""
    described = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docs = [ast.get_docstring(node) for node in ast.walk(ast.parse(source)) if isinstance(node, described)]
    return [doc.partition("\n")[0] for doc in docs if doc]


def test_a_clause_is_told_from_a_noun_phrase():
    source = (
        '"""What it is."""\ndef f():\n    """Return what it is."""\nclass A:\n    """Whatever: a somewhat long name."""'
    )
    assert [bool(CLAUSE.match(line)) for line in first_lines(source)] == [True, True, False]


def test_first_lines_of_docstrings_are_no_clauses():
    wrong = [
        f"{named(path)}: {line}"
        for path in (*below("app"), *below("sim"))
        for line in first_lines(path.read_text("utf-8"))
        if CLAUSE.match(line)
    ]
    assert len(wrong) <= MAX_CLAUSES, "\n".join(wrong)
