"""The pages of the documentation, and what they name."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent.parent
PAGES = (ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md")))
TODAY = tuple(page for page in PAGES if page.name != "CHANGELOG.md")  # which name only what is there now
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`([^`\n]+)`")
PATH = re.compile(r"(?:sim|app|tests|assets|docs|\.ci)(?:/[\w.-]+)+/?")
TEST = re.compile(r"(tests(?:/[\w.-]+)+\.py)::(\w+)")


class Named(NamedTuple):
    """Something that a page names."""

    page: str
    what: str

    def __str__(self) -> str:
        return f"{self.page}: {self.what}"


def text_of(page: Path) -> str:
    """The page as it is."""
    return page.read_text("utf-8")


def prose_of(page: Path) -> str:
    """The page without its fenced blocks."""
    return FENCE.sub("", text_of(page))


def links() -> list[Named]:
    """Every relative link and picture."""
    return [
        Named(page.relative_to(ROOT).as_posix(), target)
        for page in PAGES
        for target in LINK.findall(prose_of(page))
        if not re.match(r"[a-z]+:", target)
    ]


def code() -> list[Named]:
    """Every word in backticks."""
    return [Named(page.relative_to(ROOT).as_posix(), word) for page in TODAY for word in CODE.findall(prose_of(page))]


def paths() -> list[Named]:
    """Every path of this repository in backticks."""
    return [Named(named.page, found) for named in code() for found in PATH.findall(named.what)]


def named_tests() -> list[Named]:
    """Every `path::test` in backticks."""
    return [named for named in code() if TEST.fullmatch(named.what)]


def commands() -> list[Named]:
    """Every call of `springtide`, in backticks or a fenced block."""
    found = [named for named in code() if named.what.startswith("springtide")]
    for page in TODAY:
        for _, block in FENCE.findall(text_of(page)):
            found += [
                Named(page.relative_to(ROOT).as_posix(), line[line.index("springtide") :])
                for line in block.splitlines()
                if re.search(r"(?:^|[\s/])springtide(?:\s|$)", line)
            ]
    return found
