"""The rows of words of a text table, and its comments."""

import csv
import re
from pathlib import Path
from typing import NamedTuple

from sim.tables.numbers import number_of
from sim.validation import argument_error

COMMENTS = ("#", "%", "//", "!")
MARKS = (";", "\t", ",")  # between words, in the order of trial; spaces otherwise
MAX_COLUMNS = 1000
MAX_ROWS = 1_000_000
MAX_LINE = 100_000  # characters
SPACED = re.compile(r"\s+(?![^\[(]*[\])])")  # spaces that are not in brackets
BRACKETED = re.compile(r"[\[(][^\[\]()]*[\])]")
OPENED = re.compile(r"\s+(?=[\[(])")  # a space between a name and its unit


class Row(NamedTuple):
    """The words of a line."""

    number: int  # of the line, from 1
    words: list[str]


def line_error(path: Path, number: int, allowed: str) -> ValueError:
    """The error of a line."""
    return argument_error("path", f"{path}, line {number}", allowed)


def split_rows(text: str, path: Path) -> tuple[list[Row], list[Row]]:
    """The rows of a table, and its lines of comments before the first row of numbers, as rows without their sign.

    Semicolons, tabs and spaces between words allow decimal commas. Raises ValueError for a table that is too large.
    """
    rows: list[Row] = []
    comments: list[Row] = []
    for number, line in enumerate(text.replace("\u2212", "-").splitlines(), start=1):
        plain = line.strip()
        if not plain:
            continue
        sign = next((one for one in COMMENTS if plain.startswith(one)), None)
        if sign is not None:
            if not rows:
                comments.append(Row(number, words_of(plain.lstrip("#%/! "), path, number)))
            continue
        rows.append(Row(number, words_of(line, path, number)))
        if len(rows) > MAX_ROWS:
            raise argument_error("path", f"{path} of more than {MAX_ROWS} rows", f"at most {MAX_ROWS}")
    if rows and all(len(row.words) > 1 and row.words[-1] == "" for row in rows):  # a mark at the end of each line
        rows = [Row(row.number, row.words[:-1]) for row in rows]
    return rows, comments


def words_of(line: str, path: Path, number: int) -> list[str]:
    """The words of a line. Raises ValueError that names it where it or they are too many."""
    if len(line) > MAX_LINE:
        raise line_error(path, number, f"a line of at most {MAX_LINE} characters")
    outside = BRACKETED.sub("", line)
    mark = next((mark for mark in MARKS if mark in outside), None)
    is_spaced = mark is None or (mark == "," and is_decimal(line))
    count = len(outside.split()) if is_spaced else outside.count(mark or "") + 1
    if count > MAX_COLUMNS:
        raise line_error(path, number, f"at most {MAX_COLUMNS} columns, not {count}")
    if is_spaced:
        words = SPACED.split(OPENED.sub("", line.strip()))
    elif '"' not in line:
        words = re.split(rf"{mark}(?![^\[(]*[\])])", line) if outside != line else line.split(mark)
    else:
        try:
            words = next(csv.reader([line], delimiter=mark or ",", skipinitialspace=True), [])
        except csv.Error:
            raise line_error(path, number, "words of a table") from None
    words = [word.strip().strip('"') for word in words]
    return words if mark == "," and not is_spaced else [with_point(word) for word in words]


def is_decimal(line: str) -> bool:
    """True for numbers with decimal commas between spaces, as in "0,05 1,2"."""
    words = line.split()
    return len(words) > 1 and all(re.fullmatch(r"[-+]?\d+(?:,\d+)?(?:[eE][-+]?\d+)?", word) for word in words)


def with_point(word: str) -> str:
    """A number with its decimal comma as a point; other words as they are."""
    pointed = word.replace(",", ".")
    return pointed if number_of(pointed) is not None else word
