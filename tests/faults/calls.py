"""Which functions each test calls, and which functions a line of a source reaches.

A function is "module:name", with the name as Python qualifies it.
"""

import ast
import functools
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, NamedTuple

import pytest

FunctionDef = ast.FunctionDef | ast.AsyncFunctionDef
COMPILING = ("kernel", "each_link", "njit", "generated", "Force")  # in the names of what makes kernels of functions


class CallRecorder:
    """A plugin of pytest: the functions of the checkout that each test calls.

    Compiled kernels are not seen, but for a run as plain Python; nor is what a test starts in another process. A
    fixture that several tests share counts for the first of them.
    """

    def __init__(self, tree: Path) -> None:
        self.tree = f"{tree}/"
        self.codes: set[CodeType] = set()
        self.called: dict[str, list[str]] = {}

    def trace(self, frame: FrameType, event: str, argument: Any) -> None:
        self.codes.add(frame.f_code)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.codes = set()
        threading.settrace(self.trace)
        sys.settrace(self.trace)
        try:
            return (yield)
        finally:
            sys.settrace(None)
            threading.settrace(None)  # type: ignore[arg-type]
            own = [code for code in self.codes if code.co_filename.startswith((f"{self.tree}sim/", f"{self.tree}app/"))]
            called = {f"{code.co_filename.removeprefix(self.tree)}:{code.co_qualname}" for code in own}
            self.called[item.nodeid] = sorted(called)


class Function(NamedTuple):
    """A function or a method of a source."""

    name: str  # "module:qualified name"
    is_kernel: bool  # whether it is compiled, or makes functions that are
    lines: range  # of its body, from 1
    mentions: frozenset[str]  # names and attributes in it, those of inner functions included

    @property
    def own_name(self) -> str:
        """The name by which others mention it."""
        return self.name.rpartition(":")[2].rpartition(".")[2]


class Source(NamedTuple):
    """What calls are looked up in."""

    functions: tuple[Function, ...]
    bindings: tuple[tuple[range, frozenset[str], frozenset[str]], ...]  # at the top: lines, bound, mentioned
    kernels: tuple[range, ...]  # lines of those that make kernels

    def function_at(self, line: int) -> Function | None:
        """The innermost function with a line (from 1) in its body."""
        around = [function for function in self.functions if line in function.lines]
        return max(around, key=lambda function: function.lines.start, default=None)

    def bound_at(self, line: int) -> frozenset[str]:
        """The names that the statement with a line binds, at the top of the source."""
        return frozenset(name for lines, names, _ in self.bindings if line in lines for name in names)


@functools.cache
def read_source(path: Path, module: str) -> Source:
    """The functions of a source."""
    functions: list[Function] = []
    bindings, kernels = [], []

    def visit(node: ast.AST, prefix: str) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, FunctionDef):
                lines = range(child.body[0].lineno, (child.end_lineno or child.lineno) + 1)
                compiled = any(map(compiles, child.decorator_list)) or "generated" in mentions_of(child)
                functions.append(Function(f"{module}:{prefix}{child.name}", compiled, lines, mentions_of(child)))
                visit(child, f"{prefix}{child.name}.<locals>.")
            else:
                visit(child, f"{prefix}{child.name}." if isinstance(child, ast.ClassDef) else prefix)

    tree = ast.parse(path.read_text("utf-8"))
    visit(tree, "")
    for node in tree.body:
        lines = range(node.lineno, (node.end_lineno or node.lineno) + 1)
        if isinstance(node, ast.ClassDef):
            outside = [mentions_of(child) for child in node.body if not isinstance(child, FunctionDef)]
            bindings.append((lines, frozenset({node.name}), frozenset().union(*outside)))
        elif not isinstance(node, FunctionDef | ast.Import | ast.ImportFrom):
            names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
            bindings.append((lines, frozenset(names), mentions_of(node)))
            if compiles(node):
                kernels.append(lines)
    return Source(tuple(functions), tuple(bindings), tuple(kernels))


def compiles(node: ast.AST) -> bool:
    """True if a decorator or a statement makes kernels."""
    return any(part in name for name in mentions_of(node) for part in COMPILING)


def mentions_of(node: ast.AST) -> frozenset[str]:
    """Names and attributes below a node."""
    return frozenset(getattr(n, "id", getattr(n, "attr", "")) for n in ast.walk(node)) - {""}


def reached(module: str, line: int, sources: dict[str, Source]) -> tuple[set[str], bool]:
    """The functions to see called by a test that reaches a line, and whether a kernel is among them.

    sources: of all modules that a path of imports leads from to `module`, with itself.

    A line of a function that is no kernel is reached by its calls. The others are looked up by the names of the kernel,
    or of what the line binds, through the kernels and bindings that mention them: more functions rather than fewer.
    """
    around = sources[module].function_at(line)
    if around is not None and not around.is_kernel:
        return {around.name}, False
    names = {around.own_name} if around else set(sources[module].bound_at(line))
    before: set[str] = set()
    while names != before:
        before = set(names)
        for source in sources.values():
            for function in source.functions:
                if function.is_kernel and function.mentions & names:
                    names.add(function.own_name)
            for _, bound, mentioned in source.bindings:
                if mentioned & names:
                    names |= bound
    found = [f for source in sources.values() for f in source.functions if f.mentions & names]
    found += [around] if around else []
    with_kernels = any(function.is_kernel for function in found) or any(line in at for at in sources[module].kernels)
    return {function.name for function in found}, with_kernels
