"""Rules of GLSL that a browser does not check, over all shaders of the program."""

import functools
import math
import random
import re
from pathlib import Path

import pytest

JS = Path(__file__).parents[3] / "app" / "render" / "js"
# A variable with its components and its place in an array, and no function.
NAME = re.compile(r"\b[A-Za-z_][\w.]*\b(?!\()(?:\[[^\]]*\][\w.]*)?")
FUNCTIONS = {"sqrt": math.sqrt}
DRAWS = 20


def calls_of(function: str, text: str) -> list[list[str]]:
    """The arguments of each call of a function in a source."""
    found = []
    for start in re.finditer(rf"\b{function}\(", text):
        arguments, depth, end = [""], 1, start.end()
        while depth:
            letter = text[end]
            depth += (letter == "(") - (letter == ")")
            if letter == "," and depth == 1:
                arguments.append("")
            elif depth:
                arguments[-1] += letter
            end += 1
        found.append([argument.strip() for argument in arguments])
    return found


def value_in(values: dict[str, float], found: re.Match[str]) -> str:
    """The value of a variable, in place of its name."""
    return repr(values[found[0]])


def are_in_order(low: str, high: str) -> bool:
    """True if one edge is below another, for every positive value of the variables in them."""
    draw = random.Random(0)
    for _ in range(DRAWS):
        values = {name: draw.uniform(0.01, 10.0) for name in NAME.findall(f"{low} {high}")}
        edges = [eval(NAME.sub(functools.partial(value_in, values), edge), FUNCTIONS) for edge in (low, high)]
        if not edges[0] < edges[1]:
            return False
    return True


@pytest.mark.parametrize("path", sorted(JS.rglob("*.js")), ids=lambda path: path.name)
def test_every_smoothstep_rises(path):
    """With the first edge at or above the second the result is undefined (GLSL 3.00 ES, 8.3)."""
    for low, high, _ in calls_of("smoothstep", path.read_text(encoding="utf-8")):
        assert are_in_order(low, high), f"smoothstep({low}, {high}, ...)"


def test_edges_in_the_wrong_order_are_seen():
    assert not are_in_order("0.5", "0.1")
    assert not are_in_order("0.10 * openWater[0].y", "-0.02 * openWater[0].y")
    assert are_in_order("rise.x - wide", "rise.x + wide")
    assert calls_of("smoothstep", "a = smoothstep(0.1, f(2.0, 3.0), x);") == [["0.1", "f(2.0, 3.0)", "x"]]
