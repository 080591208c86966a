"""Threads of the program."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = sorted(path for top in ("app", "sim") for path in (ROOT / top).rglob("*.py"))


def threads_of(path: Path) -> list[ast.Call]:
    """The calls in a source that make a thread."""
    text = path.read_text("utf-8")
    if "Thread(" not in text:
        return []
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    return [call for call in calls if ast.unparse(call.func) in ("threading.Thread", "Thread")]


@pytest.mark.parametrize("path", [path for path in SOURCES if threads_of(path)], ids=lambda path: path.stem)
def test_no_thread_keeps_a_program_alive_that_ends(path: Path) -> None:
    for call in threads_of(path):
        given = {keyword.arg: ast.unparse(keyword.value) for keyword in call.keywords}
        assert given.get("daemon") == "True", ast.unparse(call)
