"""Which functions each test calls, so that a fault is tried first against the quick tests that reach it."""

import ast
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest


class CallRecorder:
    """A plugin of pytest: the functions of the checkout that each test calls, as "module:line of the definition".

    Compiled kernels are not seen, but for a run as plain Python. A fixture that several tests share counts for the
    first of them.
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
            self.called[item.nodeid] = sorted(
                f"{code.co_filename.removeprefix(self.tree)}:{code.co_firstlineno}" for code in own
            )


def function_at(source: str, line: int) -> int | None:
    """The first line, decorators included, of the innermost function around a line (from 1), or None."""
    found = None
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.body[0].lineno <= line <= (
            node.end_lineno or 0
        ):
            first = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
            found = first if found is None else max(found, first)
    return found


def is_kernel(source: str, first: int) -> bool:
    """Whether the function that begins at a line is compiled."""
    return source.split("\n")[first - 1].strip().startswith("@kernel")
