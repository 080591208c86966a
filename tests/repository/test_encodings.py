"""Text pipes state their encoding, as the default differs between systems. For files ruff's PLW1514 does this."""

import ast

from tests.repository.test_layers import SOURCES, named

TEXT = ("text", "universal_newlines")


def pipes_without_encoding(source: str) -> list[int]:
    """The lines of the calls that open text pipes in the encoding of the machine, without saying so."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            given = {keyword.arg: keyword.value for keyword in node.keywords}
            in_text = any(isinstance(given.get(name), ast.Constant) and given[name].value is True for name in TEXT)
            if in_text and "encoding" not in given:
                found.append(node.lineno)
    return found


def test_a_text_pipe_without_an_encoding_is_found():
    assert pipes_without_encoding('run("a", text=True)\nPopen("b", text=True, encoding="utf-8")\ndraw(text="c")') == [1]


def test_text_pipes_state_their_encoding():
    """`encoding="locale"` of a Python process that prints as its machine does."""
    lines = [f"{named(path)}:{line}" for path in SOURCES for line in pipes_without_encoding(path.read_text("utf-8"))]
    assert lines == []
