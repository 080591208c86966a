"""The text of a MoorDyn file as rows of words, by section."""

import math
import re
from pathlib import Path
from typing import NamedTuple

from sim.tables import Row, number_of
from sim.validation import Refusals, argument_error, unreadable

HEADER = re.compile(r"-{3,}\s*(.*?)\s*-*$")
COUNT = re.compile(r"\d+\s+N[A-Z]\w+", re.ASCII)  # "3 NLines - number of lines", of version 1
MAX_BYTES = 20_000_000
TYPES, BODIES, POINTS, LINES, OPTIONS = "LINE TYPES", "BODIES", "POINTS", "LINES", "OPTIONS"
ROD_TYPES, RODS = "ROD TYPES", "RODS"
# Sections that are read, and those that are refused if they have rows: what they describe no System holds.
NAMES = {
    "LINE TYPES": TYPES, "LINE DICTIONARY": TYPES, "BODIES": BODIES, "BODY LIST": BODIES, "BODY PROPERTIES": BODIES,
    "POINTS": POINTS, "POINT LIST": POINTS, "POINT PROPERTIES": POINTS, "CONNECTION PROPERTIES": POINTS,
    "CONNECTIONS": POINTS, "NODE PROPERTIES": POINTS, "LINES": LINES, "LINE LIST": LINES, "LINE PROPERTIES": LINES,
    "OPTIONS": OPTIONS, "SOLVER OPTIONS": OPTIONS, "ROD TYPES": ROD_TYPES, "ROD DICTIONARY": ROD_TYPES, "RODS": RODS,
    "ROD LIST": RODS, "ROD PROPERTIES": RODS,
}  # fmt: skip
REFUSED = {
    "FAILURE": "FAILURE", "CONTROL": "CONTROL", "EXTERNAL LOADS": "EXTERNAL LOADS", "SYROPE IC": "SYROPE IC",
}  # fmt: skip
UNREAD = ("OUTPUT", "NEED THIS LINE", "END")  # outputs are what MoorDyn would write


class Section(NamedTuple):
    """A section of a file."""

    columns: list[str]  # names, in small letters; none of OPTIONS
    rows: list[Row]


def read_text(path: Path) -> str:
    """The text of a file. Raises ValueError if it cannot be read."""
    try:
        if path.exists() and not path.is_file():
            raise argument_error("file", str(path), "a file")
        if path.is_file() and path.stat().st_size > MAX_BYTES:
            raise argument_error("file", str(path), f"a file of at most {MAX_BYTES // 1_000_000} MB")
        return decoded(path.read_bytes())
    except OSError as error:
        raise unreadable("file", path, error) from None


def decoded(content: bytes) -> str:
    """The content of a file as text; bytes that are not UTF-8, as in comments, become marks."""
    return content.decode("utf-8-sig", "replace")


def name_of(header: str) -> str:
    """The section that the text between the dashes names, also with more text behind it; "" for another."""
    name = re.sub(r"\s+", " ", header).upper()
    known = (*NAMES, *REFUSED, *UNREAD)
    candidates = [
        one for one in known if re.match(rf"{one}(?![A-Z])", name) or (one == "OUTPUT" and name.startswith(one))
    ]
    return max(candidates, key=len, default="")


def split_sections(text: str, wrong: Refusals) -> dict[str, Section]:
    """The rows of each section that is read; refusals go to `wrong`."""
    sections: dict[str, Section] = {}
    refused: dict[str, int] = {}
    current = ""
    skip, at = 0, 0
    for number, line in enumerate(text.splitlines(), 1):
        header = HEADER.match(line.strip())
        if header:
            name, at = name_of(header.group(1)), number
            current = NAMES.get(name) or REFUSED.get(name, "")
            skip = 0 if current == OPTIONS else 2
            if current in sections:
                with wrong:
                    raise argument_error(f"line {number}: section", header.group(1), f"one section {current}")
                current = ""
            elif current in NAMES.values():
                sections[current] = Section([], [])
            elif not current and not name and number > 2 and is_section(header.group(1)):
                with wrong:
                    raise argument_error(f"line {number}: section", header.group(1), f"one of {sorted(NAMES)}")
            continue
        if not current:
            continue
        words = re.split(r"(?:^|\s)[#!]", line, maxsplit=1)[0].split()  # without a comment
        if skip == 2 and COUNT.match(line.strip()):
            continue
        if skip:
            skip -= 1
            with wrong:
                check_names(current, number, line, words)
            if skip and current in sections:
                sections[current].columns.extend(word.lower() for word in words)
        elif words and current in sections:
            sections[current].rows.append(Row(number, words))
        elif words:
            refused.setdefault(current, at)
    for name, number in refused.items():
        with wrong:
            raise argument_error(f"line {number}: section", name, "a mooring of lines, points, rods and bodies only")
    return sections


def is_section(name: str) -> bool:
    """True if a line of dashes seems to begin a section: it has a name, and is not the title of the file."""
    return bool(re.search(r"[A-Za-z]", name)) and "MOORDYN" not in name.upper()


def check_names(section: str, number: int, line: str, words: list[str]) -> None:
    """Raises ValueError for a row of numbers where names of columns or units are expected."""
    if any(number_of(word) is not None for word in words):
        raise argument_error(f"{section}, line {number}", line.strip(), "a line of column names, then one of units")


def number_in(where: str, text: str) -> float:
    """The finite number that `text` is, with or without a comma behind it; raises ValueError otherwise."""
    plain = text.removesuffix(",")
    value = number_of(plain)
    if value is None or math.isinf(value):
        raise argument_error(where, text, "a finite number")
    if "," in plain:
        raise argument_error(where, text, f"a number with a decimal point; MoorDyn reads {plain.partition(',')[0]}")
    return value


def whole_in(where: str, text: str) -> int:
    """The whole number that `text` is; raises ValueError otherwise."""
    value = number_in(where, text)
    if value != int(value):
        raise argument_error(where, text, "a whole number")
    return int(value)


def numbers_in(where: str, text: str, counts: tuple[int, ...]) -> list[float]:
    """The numbers of "1|2|3", as many as one of `counts`; raises ValueError otherwise."""
    words = text.split("|")
    if len(words) not in counts:
        raise argument_error(where, text, f"{' or '.join(map(str, counts))} numbers, with | between them")
    return [number_in(where, word) for word in words]


def check_columns(where: str, words: list[str], least: int, most: int, numbers: int | None = None) -> list[str]:
    """The words. Raises ValueError unless there are as many as a row of that section has.

    numbers: number of columns from which on a word that is no number begins a comment, as in MoorDyn; None for no such.
    """
    if numbers is not None:
        end = next((i for i, word in enumerate(words) if i >= numbers and number_of(word.strip(",")) is None), None)
        words = words[:end]
    if not least <= len(words) <= most:
        counts = f"{least}" if least == most else f"{least} to {most}"
        raise argument_error(where, " ".join(words), f"{counts} columns")
    return words
