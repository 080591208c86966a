"""Text pipes and files state their encoding, as the default differs between systems.

Ruff's PLW1514 finds files that are opened in other ways than by `Path.read_text` and `Path.write_text`.
"""

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


def test_text_files_state_their_encoding():
    before = {"read_text": 0, "write_text": 1}  # arguments before the encoding
    wrong = []
    for path in SOURCES:
        text = path.read_text("utf-8")
        if not any(name in text for name in before):
            continue
        for call in (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)):
            name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
            named_ones = {word.arg for word in call.keywords}
            if name in before and len(call.args) <= before[name] and "encoding" not in named_ones:
                wrong.append(f"{named(path)}:{call.lineno}")
    assert not wrong
