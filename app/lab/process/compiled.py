"""Compiles a student's functions with numba, in the process that runs them; only that process imports this.

Not by `sim.jit.kernel`: these functions change with each save, so nothing is cached, and an index out of range must be
an error. A compiled function replaces the plain one if both agree. A method of integration is not compiled: its
argument, the acceleration, is a Python function.
"""

import importlib.util
import sys
import types
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, cast

import numba
import numpy as np

from app.lab.process.rope_march import LINKS, REFERENCE

SAMPLES = 4
TOLERANCE = 1e-9  # of the largest value of a result
SEED = 20150130
COMPILED = ("spring_force", "rope_acceleration", "sphere_force")


@numba.njit(boundscheck=True)
def links(x, v, mass, stiffness, damping, drag, rest_length, gravity, spring_force):
    """The accelerations of a rope, as `Functions.rope` has them, by a compiled `spring_force`."""
    a = -drag * v
    for i in range(len(x) - 1):
        j = i + 1
        pull = spring_force(x[i].copy(), x[j].copy(), v[i].copy(), v[j].copy(), stiffness, damping, rest_length)
        a[i] += pull
        a[j] -= pull
    a /= mass
    a[:, 2] -= gravity
    a[0] = 0.0
    return a


def compile_functions(path: Path, own: Collection[str]) -> tuple[dict[str, Callable[..., Any]], str]:
    """Compiled functions of a student by name, and the reason why one failed, or ""."""
    plain, compiled = load(path, "plain"), load(path, "compiled")
    for name, value in vars(compiled).copy().items():
        if isinstance(value, types.FunctionType) and value.__module__ == compiled.__name__:
            setattr(compiled, name, numba.njit(boundscheck=True)(value))
    functions: dict[str, Callable[..., Any]] = {}
    why = ""
    for name in COMPILED:
        if name not in own or not hasattr(compiled, name):
            continue
        try:
            if agrees(getattr(plain, name), getattr(compiled, name), inputs_of(name)):
                functions[name] = getattr(compiled, name)
            else:
                why = f"{name} gives another result when it is compiled"
        except Exception as error:  # whatever numba, or the student's function, does
            why = f"{name}: {first_line(error)}"
    if "spring_force" in functions:
        loop = cast(Callable[..., Any], links)
        spring = functions["spring_force"]

        def rope(x: Any, v: Any, *numbers: float) -> np.ndarray:
            return loop(x, v, *numbers, spring)

        x = np.cumsum(np.ones((4, 3)), axis=0)
        rope(x, x, 1.0, 800.0, 7.0, 1.0, 0.2, 10.0)
        functions[LINKS] = rope
    return functions, why


def load(path: Path, name: str) -> types.ModuleType:
    """The student's module, run again."""
    spec = importlib.util.spec_from_file_location(f"{path.stem}_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def inputs_of(name: str) -> Callable[[np.random.Generator], tuple[Any, ...]]:
    """Maker of arguments for a function, from its task."""
    return sys.modules[REFERENCE[name].__module__].inputs


def agrees(plain: Callable[..., Any], compiled: Callable[..., Any], inputs: Callable[..., tuple[Any, ...]]) -> bool:
    """True if both give the same results at random inputs. Raises their errors."""
    rng = np.random.default_rng(SEED)
    for _ in range(SAMPLES):
        arguments = inputs(rng)
        results = []
        for function in (plain, compiled):
            values = (a.astype(np.float64) if isinstance(a, np.ndarray) else float(a) for a in arguments)
            results.append(np.asarray(function(*values), np.float64))
        a, b = results
        if a.shape != b.shape or not np.allclose(a, b, rtol=0.0, atol=TOLERANCE * np.abs(a).max(initial=0.0)):
            return False
    return True


def first_line(error: Exception) -> str:
    """An error's text on one line: numba's has many, and only those after the heading matter."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    told = [line for line in lines if not line.startswith(("Failed in", "During:", "File", "-", "["))]
    return (told or lines or [type(error).__name__])[0]
