"""`changed_moordyn`: a MoorDyn file with changed line lengths and line-type diameters, and nothing else changed."""

import re
from collections.abc import Mapping
from typing import TypeVar

from sim.mooring.moordyn.rows import ends_first
from sim.mooring.moordyn.sections import LINES, POINTS, TYPES, Section, split_sections
from sim.validation import Refusals, argument_error, check_positive

K = TypeVar("K", int, str)

WORD = re.compile(r"\S+")
DIAMETER = 1  # place of the word in a row of line types


def changed_moordyn(
    content: bytes, lengths: Mapping[int, float] | None = None, diameters: Mapping[str, float] | None = None
) -> bytes:
    """Content of a file with changed numbers; all other bytes stay.

    lengths: unstretched [m], by the ID of the line. diameters: [m], by the name of the line type. Raises ValueError for
    a line or type that the file does not have, a number that is not above 0, and a file that cannot be read.
    """
    text, wrong = content.decode("utf-8", "surrogateescape"), Refusals()
    sections = split_sections(text, wrong)
    wrong.check()
    lines, types, points = (sections.get(name, Section([], [])) for name in (LINES, TYPES, POINTS))
    known = {int(row.words[0]) for row in points.rows if row.words[0].isdecimal()}
    place = 4 if ends_first(lines, known) else 2
    rows = text.splitlines(keepends=True)
    numbers = {int(row.words[0]): row.number for row in lines.rows if row.words[0].isdecimal()}
    for number, value in rows_to_change("length of line", lengths or {}, numbers):
        rows[number - 1] = with_word(rows[number - 1], place, value)
    names = {row.words[0]: row.number for row in types.rows}
    for number, value in rows_to_change("diameter of line type", diameters or {}, names):
        rows[number - 1] = with_word(rows[number - 1], DIAMETER, value)
    return "".join(rows).encode("utf-8", "surrogateescape")


def rows_to_change(what: str, values: Mapping[K, float], numbers: Mapping[K, int]) -> list[tuple[int, float]]:
    """Number of the row and new value of each change. numbers: of the existing rows, by line or type."""
    for key, value in values.items():
        if key not in numbers:
            raise argument_error(what, key, f"one of {sorted(numbers)}")
        check_positive(f"{what} {key}", value, "m")
    return [(numbers[key], float(value)) for key, value in values.items()]


def with_word(row: str, place: int, value: float) -> str:
    """A row with a number in place of one of its words; the words after it keep their columns if there is room."""
    word = list(WORD.finditer(row))[place]
    written, rest = repr(value), row[word.end() :]
    gap = len(rest) - len(rest.lstrip(" "))
    longer = len(written) - len(word[0])
    spaces = max(gap - longer, 1) if gap > 1 and rest.strip() else gap
    return row[: word.start()] + written + " " * spaces + rest[gap:]
