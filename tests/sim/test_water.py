"""The defaults of the library: stated once."""

import ast
from pathlib import Path

import sim
from sim.water import EARTH_GRAVITY, SEA_DENSITY

FOLDER = Path(sim.__file__).parent


def test_default_gravity_and_density_are_stated_once():
    stated = [
        path.relative_to(FOLDER).as_posix()
        for path in sorted(FOLDER.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Constant) and node.value in (EARTH_GRAVITY, SEA_DENSITY)
    ]
    assert stated == ["water.py", "water.py"]
