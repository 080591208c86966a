"""Reads the text of answers.toml entry by entry where it is no TOML, so that one slip costs one answer.

Its form is the lab's own: headings `[task]`, and below them `name = value`.
"""

import re
import tomllib
from typing import Any, NamedTuple

from sim.quantities import read_number

HEADING = re.compile(r"\s*\[+\s*[\"']?([A-Za-z_]\w*)[\"']?\s*\]*\s*(#.*)?")
ASSIGNMENT = re.compile(r"\s*[\"']?([A-Za-z_]\w*)[\"']?\s*=(.*)")
# A backslash that people mean as one: TOML reads \r of "\rho" as the end of a line.
BACKSLASH = re.compile(r"(?<!\\)(\\\\)*\\(?=[A-Za-z])(?!u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8})")
LITERAL = re.compile(r"=\s*'")  # a text between these quotation marks has no escapes
CURLY = "“”„‟«»"
SHOWN = 60  # characters of a text that is repeated in a message


class Unread(NamedTuple):
    """An unreadable entry. text: as it is in the file. cure: text to write instead."""

    line: int
    text: str
    cure: str

    @property
    def sentence(self) -> str:
        """The entry and the cure in words."""
        text = " ".join(self.text.split())
        text = text if len(text) <= SHOWN else f"{text[:SHOWN]} ..."
        return f"line {self.line}: {text or 'nothing'} cannot be read: {self.cure}"


def loads(text: str, **options: Any) -> dict[str, Any]:
    """A TOML text whose backslashes are meant as such. Raises ValueError, RecursionError."""
    return tomllib.loads(with_backslashes(text), **options)


def with_backslashes(text: str) -> str:
    """A TOML text with doubled backslashes where they are meant as such."""
    lines = text.split("\n")
    return "\n".join(
        line if "\\" not in line or LITERAL.search(line) else BACKSLASH.sub(lambda match: f"{match[0]}\\", line)
        for line in lines
    )


def read_entries(text: str) -> tuple[dict[str, Any], dict[tuple[str, str], Unread], str]:
    """Tables of a text that is no TOML, its unreadable entries, and further faults in words, or "".

    The key of an entry above all headings has the task "".
    """
    table: dict[str, Any] = {}
    unread: dict[tuple[str, str], Unread] = {}
    task, wrong, at = "", "", 0
    lines = text.replace("\r\n", "\n").split("\n")
    while at < len(lines):
        line, first = lines[at], at
        at += 1
        assigned = ASSIGNMENT.fullmatch(line)
        if assigned is None:
            heading = HEADING.fullmatch(line)
            if heading is not None:
                task = heading[1]
                if "]" not in line or "[[" in line:
                    wrong = wrong or f"line {first + 1}: write [{task}]"
            elif line.strip() and line.strip()[0] != "#":
                wrong = wrong or f"line {first + 1}: {line.strip()[:SHOWN]} belongs to no question"
            continue
        while at < len(lines) and not is_start(lines[at]) and not is_toml("\n".join(lines[first:at])):
            at += 1
        entry, key = "\n".join(lines[first:at]), assigned[1]
        owner = table if not task else table.setdefault(task, {})
        try:
            value = loads(entry)[key]
        except (ValueError, RecursionError, KeyError):
            text_of_value = entry.partition("=")[2].strip()
            unread[task, key] = Unread(first + 1, text_of_value, cure_of(text_of_value))
            if not task:
                owner[key] = text_of_value.strip("\"' " + CURLY)
            continue
        if key in owner and owner[key] not in ("", value):
            unread[task, key] = Unread(first + 1, str(value), "this entry is there twice: leave one of them")
        owner[key] = value
    return table, unread, wrong


def is_start(line: str) -> bool:
    """True for a line that begins something else than the rest of a text."""
    return not line.strip() or line.lstrip()[0] == "#" or bool(ASSIGNMENT.fullmatch(line) or HEADING.fullmatch(line))


def is_toml(text: str) -> bool:
    """True if a text is TOML."""
    try:
        loads(text)
    except (ValueError, RecursionError):
        return False
    return True


def cure_of(text: str) -> str:
    """Text to write in place of an unreadable value."""
    if not text:
        return 'write "" if there is no answer yet'
    if "\n" in text:
        return 'write """ before and after a text of several lines'
    if any(mark in text for mark in CURLY):
        return 'write straight quotation marks, " and ", around it'
    if text[0] == '"' and text.count('"') > 2:
        return "write ' for the quotation marks within it"
    if text.count('"') == 1:
        return "a quotation mark is missing at one end"
    try:
        number = read_number(text)
    except ValueError:
        return f'write "{text}", between quotation marks'
    return f'write {number!r}, or "{text}" between quotation marks'
