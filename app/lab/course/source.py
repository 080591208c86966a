"""The functions in a Python file of a student's, found without running it.

Of several definitions of one name the last one counts, as in Python. If a file cannot be parsed, each function is
read on its own, so that the others are still known.
"""

import ast
import codecs
import io
import re
import tokenize
from collections.abc import Iterator, Mapping
from typing import NamedTuple

PARSE_ERRORS = (SyntaxError, ValueError, RecursionError, MemoryError)  # the last two where it nests too deeply
DEFINITION = re.compile(r"(?:async\s+)?def\s+(\w+)")  # at the beginning of a line
STATEMENT = re.compile(r"[\w@]")  # the beginning of a line that ends the block before


class Definition(NamedTuple):
    """The last statement that gives a name its value."""

    first: int  # number of its first line, from 1
    last: int
    is_begun: bool  # more than a function whose body is a docstring, `...` and `pass`


class Source(NamedTuple):
    """The definitions of one file."""

    definitions: Mapping[str, Definition]
    is_parsed: bool  # False: the file has an error of syntax

    def has(self, name: str) -> bool:
        """True if a function is begun or can be; of a file that cannot be parsed, if nothing else is to blame."""
        return name in self.definitions or (not self.is_parsed and self.is_begun(name))

    def is_begun(self, name: str) -> bool:
        """True if a function has a body.

        True without a function too: running the file says what is wrong. Of a file that cannot be parsed, only if none
        of its functions has a body.
        """
        own_definition = self.definitions.get(name)
        if self.is_parsed:
            return own_definition is None or own_definition.is_begun
        others = any(definition.is_begun for definition in self.definitions.values())
        return not others or (own_definition is not None and own_definition.is_begun)

    def line_of(self, name: str) -> int | None:
        """The line on which a function begins; None without one."""
        return self.definitions[name].first if name in self.definitions else None

    def name_at(self, line: int) -> str:
        """The function in which a line lies, or ""."""
        return next(
            (name for name, definition in self.definitions.items() if definition.first <= line <= definition.last), ""
        )


def read_source(data: bytes) -> Source:
    """The definitions of a file; never raises."""
    try:
        tree = ast.parse(decoded(data))
    except PARSE_ERRORS:
        return Source(dict(blocks(data.decode("utf-8", "replace").splitlines())), is_parsed=False)
    return Source({name: definition_of(node, tree) for name, node in bindings(tree.body)}, is_parsed=True)


def decoded(data: bytes) -> str:
    """The text of a Python file. Raises SyntaxError, in Python's words, for bytes that are not of its encoding."""
    encoding = "utf-8"
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
        return data.decode(encoding)
    except LookupError as error:  # an encoding of something else than text
        raise SyntaxError(str(error), ("", 1, None, None)) from None
    except UnicodeDecodeError as error:
        if codecs.lookup(encoding).name not in ("utf-8", "utf-8-sig"):
            raise SyntaxError(f"(unicode error) {error}", place_of_byte(data, error.start)) from None
    except SyntaxError as error:  # an unknown encoding, or no UTF-8 in the first two lines
        if "unknown encoding" in str(error.msg):
            raise SyntaxError(error.msg, ("", 1, None, None)) from None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        text = f"Non-UTF-8 code starting with '\\x{data[error.start]:02x}', but no encoding declared"
        raise SyntaxError(f"{text}; save the file as UTF-8", place_of_byte(data, error.start)) from None


def place_of_byte(data: bytes, index: int) -> tuple[str, int, None, None]:
    """The place of a byte, as a SyntaxError takes it."""
    return "", data.count(b"\n", 0, index) + 1, None, None


def bindings(body: list[ast.stmt]) -> Iterator[tuple[str, ast.stmt]]:
    """The names that statements give a value to, in their order, without those inside of functions and classes."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name, node
            continue
        if isinstance(node, ast.Import | ast.ImportFrom):
            for alias in node.names:
                yield alias.asname or alias.name, node
        targets = [*getattr(node, "targets", []), getattr(node, "target", None)]
        targets += [item.optional_vars for item in getattr(node, "items", [])]
        for target in filter(None, targets):
            for part in ast.walk(target):
                if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
                    yield part.id, node
        for part in (node, *getattr(node, "handlers", []), *getattr(node, "cases", [])):
            yield from bindings([*getattr(part, "body", []), *getattr(part, "orelse", [])])
        yield from bindings(getattr(node, "finalbody", []))


def definition_of(node: ast.stmt, tree: ast.Module) -> Definition:
    """The definition that a statement is; one inside of `if` counts as begun, as only running it decides."""
    empty = isinstance(node, ast.FunctionDef) and node in tree.body and all(is_empty(line) for line in node.body)
    return Definition(node.lineno, node.end_lineno or node.lineno, not empty)


def is_empty(line: ast.stmt) -> bool:
    """True if a line is a docstring, `...` or `pass`."""
    return isinstance(line, ast.Pass) or (isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant))


def blocks(lines: list[str]) -> Iterator[tuple[str, Definition]]:
    """The functions of a file that cannot be parsed, each from its `def` to the next statement at the margin."""
    for first, line in enumerate(lines):
        match = DEFINITION.match(line)
        if match:
            after = range(first + 1, len(lines))
            end = next((number for number in after if STATEMENT.match(lines[number])), len(lines))
            try:
                node = ast.parse("\n".join(lines[first:end])).body[0]
                is_begun = not (isinstance(node, ast.FunctionDef) and all(is_empty(part) for part in node.body))
            except PARSE_ERRORS:
                is_begun = True
            yield match[1], Definition(first + 1, end, is_begun)
