"""The rows of words of a text table, and its comments."""

import csv
import re
from pathlib import Path
from typing import NamedTuple

from sim.quantities import ALONE, EXPONENT, decimal_sign, with_point, written_plainly
from sim.validation import argument_error

COMMENTS = ("#", "%", "//", "!")
MARKS = (";", "\t", ",")  # between words, in the order of trial; spaces otherwise
MAX_COLUMNS = 1000
MAX_ROWS = 1_000_000
MAX_LINE = 100_000  # characters
SPACED = re.compile(r"\s+(?![^\[(]*[\])])")  # spaces that are not in brackets
BRACKETED = re.compile(r"[\[(][^\[\]()]*[\])]")
SEPARATOR = re.compile(r"\s*\"?sep=(.?)\"?\s*", re.IGNORECASE)  # the first line that Excel writes and obeys
MAX_TRIED = 1000  # lines in which decimal commas between spaces are looked for
COMMA = re.compile(r"[-+]?\d*,\d+(?:[eEdD][-+]?\d+)?", re.ASCII)
CLOCK_COMMA = re.compile(r"\d:\d\d,\d+", re.ASCII)  # 23:50:00,5
WORD = re.compile(r"[-+]?\d*,?\d+(?:[eEdD][-+]?\d+)?|[\d:T/.-]*\d(?:,\d+)?Z?", re.ASCII)
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

    Numbers with decimal commas, or with signs between groups of digits, get a decimal point. A first line "sep=;" of
    Excel tells the mark between words. Raises ValueError for a table that is too large, and for numbers such as 1,000
    if no other one tells which sign is the decimal one.
    """
    rows: list[Row] = []
    comments: list[Row] = []
    lines = text.replace("\u2212", "-").splitlines()
    named = SEPARATOR.fullmatch(lines[0]) if lines else None
    fixed = (named[1] or "\t") if named else ""
    is_spaced = not fixed and any(is_decimal(line) for line in lines[:MAX_TRIED])
    for number, line in enumerate(lines, start=1):
        plain = line.strip()
        if not plain or (number == 1 and named):
            continue
        sign = next((one for one in COMMENTS if plain.startswith(one)), None)
        if sign is not None:
            if not rows:
                comments.append(Row(number, words_of(plain.lstrip("#%/! "), path, number, fixed)))
            continue
        rows.append(Row(number, words_of(line, path, number, fixed, is_spaced)))
        if len(rows) > MAX_ROWS:
            raise argument_error("path", f"{path} of more than {MAX_ROWS} rows", f"at most {MAX_ROWS}")
    if rows and all(len(row.words) > 1 and row.words[-1] == "" for row in rows):  # a mark at the end of each line
        rows = [Row(row.number, row.words[:-1]) for row in rows]
    return with_points(rows, path), comments


def words_of(line: str, path: Path, number: int, fixed: str = "", is_spaced: bool = False) -> list[str]:
    """The words of a line; fixed: the mark between them, if the file names it; is_spaced: other lines have spaces.

    Raises ValueError that names it where it or they are too many.
    """
    if len(line) > MAX_LINE:
        raise line_error(path, number, f"a line of at most {MAX_LINE} characters")
    outside = BRACKETED.sub("", line)
    mark = fixed or next((mark for mark in MARKS if mark in outside), None)
    is_spaced = mark is None or (mark == "," and not fixed and (is_decimal(line) or (is_spaced and is_numbers(line))))
    count = len(outside.split()) if is_spaced else outside.count(mark or "") + 1
    if count > MAX_COLUMNS:
        raise line_error(path, number, f"at most {MAX_COLUMNS} columns, not {count}")
    if is_spaced:
        words = SPACED.split(OPENED.sub("", line.strip()))
    elif '"' not in line:
        words = re.split(rf"{re.escape(mark or ',')}(?![^\[(]*[\])])", line) if outside != line else line.split(mark)
    else:
        try:
            words = next(csv.reader([line], delimiter=mark or ",", skipinitialspace=True), [])
        except csv.Error:
            raise line_error(path, number, "words of a table") from None
    return [word.strip().strip('"') for word in words]


def is_numbers(line: str) -> bool:
    """True for words between spaces that are all numbers, dates or times, with decimal commas or without."""
    return all(WORD.fullmatch(word) for word in line.split())


def is_decimal(line: str) -> bool:
    """True for numbers with decimal commas between spaces, as in "0,05 1,2"."""
    if "," not in line or ";" in line or "\t" in line.strip():
        return False
    words = line.split()
    return len(words) > 1 and any(COMMA.fullmatch(word) for word in words) and is_numbers(line)


def with_points(rows: list[Row], path: Path) -> list[Row]:
    """Rows with a decimal point in all numbers; the sign that one number shows is that of the others.

    Raises ValueError if no number shows it, or if they show both.
    """
    if not any("," in word for row in rows for word in row.words):
        return rows
    signs: dict[str, tuple[int, str]] = {}  # decimal sign, "?," if a comma may be either -> line, and a word
    for row in rows:
        for word in row.words:
            if "," in word or "." in word:
                sign = decimal_sign(word)
                signs.setdefault(sign + "," if sign == "?" and "," in word else sign, (row.number, word))
    if {".", ","} <= signs.keys():
        number, word = max(signs["."], signs[","])
        first = min(signs["."], signs[","])
        raise line_error(path, number, f"one decimal sign: {word} here, and {first[1]} in line {first[0]}")
    decimal = next((sign for sign in (",", ".") if sign in signs), "")
    if not decimal and "?," in signs:
        number, word = signs["?,"]
        raise line_error(
            path, number, f"a decimal point: {word} may be {word.replace(',', '.')} or {word.replace(',', '')}"
        )
    return [Row(row.number, [pointed(word, decimal) for word in row.words]) for row in rows] if decimal else rows


def pointed(word: str, decimal: str) -> str:
    """A number of this decimal sign, written with a point and no signs between groups; another word as it is."""
    if "," not in word and (decimal == "." or "." not in word):
        return word
    if CLOCK_COMMA.search(word):
        return word.replace(",", ".")
    plain = written_plainly(word)
    if not ALONE.fullmatch(plain):
        return word
    exponent = EXPONENT.search(plain)
    end = exponent.start() if exponent else len(plain)
    try:
        return with_point(plain[:end], decimal) + plain[end:]
    except ValueError:
        return word
