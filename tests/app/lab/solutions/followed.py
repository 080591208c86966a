"""Does what a sentence of the check says, as a student would do it."""

import ast
import re
from collections.abc import Iterator

CHANGE = re.compile(
    r"(?:^|(?<=\. )|(?<=, and ))"
    r"(?:[Ww]ith (?P<after>.+?) in place of (?P<before>.+?)|[Ww]ithout (?P<gone>.+?)) in line (?P<line>\d+)"
)
CONDITION = re.compile(r"It is right if the condition (.+) in line (\d+) (always|never) holds\.")
BEHIND = re.compile(r"The return in line (\d+) stands inside the loop.* Behind the loop it is right\.")
ORDER = re.compile(r"With line (\d+) before line (\d+) it is right\.")
EACH = re.compile(r"In line (\d+) .* are names of one and the same array\. With an array for each it is right\.")


def says_a_repair(text: str) -> bool:
    """True if a sentence says what makes a function right."""
    return "it is right" in text.lower()


def followed(source: str, text: str) -> str:
    """A file after the changes that a sentence asks for. Raises ValueError unless a text stands at one place."""
    tree = ast.parse(source)
    if found := CONDITION.search(text):
        replace(tree, int(found[2]), found[1], str(found[3] == "always"))
    elif found := BEHIND.search(text):
        for block, i in blocks(tree):
            loop = block[i]
            if isinstance(loop, ast.For | ast.While) and loop.body[-1].lineno == int(found[1]):
                block.insert(i + 1, loop.body.pop())
                break
    elif found := ORDER.search(text):
        block, i = next((block, i) for block, i in blocks(tree) if block[i].lineno == int(found[2]))
        block[i], block[i + 1] = block[i + 1], block[i]
    elif found := EACH.search(text):
        block, i = next((block, i) for block, i in blocks(tree) if block[i].lineno == int(found[1]))
        line = block[i]
        assert isinstance(line, ast.Assign)
        block[i : i + 1] = [ast.Assign([target], line.value, lineno=line.lineno) for target in line.targets]
    else:
        assert text.endswith("it is right."), text
        for change in CHANGE.finditer(text):
            replace(tree, int(change["line"]), change["before"] or change["gone"], change["after"] or "")
    return ast.unparse(ast.fix_missing_locations(tree)) + "\n"


def blocks(tree: ast.AST) -> Iterator[tuple[list[ast.stmt], int]]:
    """Each statement by the list that holds it, and its number there."""
    for node in ast.walk(tree):
        for field in ("body", "orelse", "finalbody"):
            block = getattr(node, field, None)
            if isinstance(block, list):
                yield from ((block, i) for i in range(len(block)))


def replace(tree: ast.AST, line: int, before: str, after: str) -> None:
    """Put a text in place of another one in a line, as Python writes it. Raises ValueError unless it is there once."""
    places = [
        (parent, field, held, node)
        for parent in ast.walk(tree)
        for field, held in ast.iter_fields(parent)
        for node in (held if isinstance(held, list) else [held])
        if isinstance(node, ast.expr | ast.stmt) and node.lineno == line and ast.unparse(node) == before
    ]
    outer = [place for place in places if not (isinstance(place[3], ast.expr) and isinstance(place[0], ast.Expr))]
    if len(outer) != 1:
        raise ValueError(f"line {line} has {before!r} {len(outer)} times")
    parent, field, held, node = outer[0]
    new = ast.parse(after).body if after else [ast.Pass()]
    value = new[0].value if isinstance(new[0], ast.Expr) and isinstance(node, ast.expr) else new[0]
    if isinstance(held, list):
        held[held.index(node)] = value
    else:
        setattr(parent, field, value)
