"""The examples of docs/contributing.md, and copies of the sources that they are added to."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "contributing.md"
EXAMPLES = PAGE.parent / "examples"  # whole files, each at its path in the sources
BLOCK = re.compile(r"^```(?P<language>\w+)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(examples/(?P<path>[^)]+\.(?P<language>\w+))\)")
LANGUAGES = {"py": "python", "toml": "toml"}
COPIED = (
    ".ci",
    "sim",
    "app",
    "benchmarks",
    "tests",
    "docs",
    "README.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "pyproject.toml",
)
SECONDS = 240  # [s] that one command may take, kernels compiled


class Block(NamedTuple):
    """A file that a section of the page links to, or one of its fenced blocks."""

    language: str
    path: str  # of the file that it is or changes, relative to the root; "" for commands
    text: str


def section(heading: str) -> list[Block]:
    """The linked files and the blocks below a heading of the page. Raises KeyError for an unknown heading."""
    parts = re.split(r"^## (.+)$", PAGE.read_text("utf-8"), flags=re.MULTILINE)
    body = dict(zip(parts[1::2], parts[2::2], strict=True))[heading]
    blocks = [
        Block(LANGUAGES[link["language"]], link["path"], (EXAMPLES / link["path"]).read_text("utf-8"))
        for link in LINK.finditer(body)
    ]
    for found in BLOCK.finditer(body):
        named = re.search(r"^Change `([^`]+)`:\n\n\Z", body[: found.start()], re.MULTILINE)
        # A second change of one file follows the first block without another line.
        path = named[1] if named else blocks[-1].path if found["language"] == "diff" else ""
        blocks.append(Block(found["language"], path, found["text"]))
    return blocks


def changed(source: str, diff: str) -> str:
    """A source with the change of a `diff` block: its old lines, which must be there once, are replaced by the new."""
    lines = diff.splitlines(keepends=True)
    old = "".join(line[1:] for line in lines if line[0] in " -")
    new = "".join(line[1:] for line in lines if line[0] in " +")
    assert source.count(old) == 1, f"there {source.count(old)} times:\n{old}"
    return source.replace(old, new)


def copy_of_sources(folder: Path) -> Path:
    """A copy of what the program and its tests are made of, in a new folder below this one."""
    copy = folder / "copy"
    copy.mkdir()
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, copy / name)
    # Pictures and benchmark results are not read by the program.
    shutil.copytree(ROOT / "assets", copy / "assets", ignore=shutil.ignore_patterns("pictures", "bench", "stability"))
    return copy


def add(blocks: list[Block], copy: Path) -> set[str]:
    """Write the files of an example, and apply its changes; returns the paths that were touched."""
    touched = set()
    for block in blocks:
        if not block.path:
            continue
        target = copy / block.path
        if block.language == "diff":
            target.write_text(changed(target.read_text("utf-8"), block.text), "utf-8")
        else:
            assert not target.exists(), f"{block.path} is there already"
            target.parent.mkdir(exist_ok=True)
            target.write_text(block.text, "utf-8")
        touched.add(block.path)
    return touched


def commands(blocks: list[Block]) -> list[str]:
    """The lines of the `sh` blocks."""
    return [line for block in blocks if block.language == "sh" for line in block.text.splitlines()]


def run(copy: Path, *arguments: str, **variables: str) -> str:
    """Run `python` with arguments in a copy; returns what it printed. Fails the test where the exit status is not 0.

    variables: of the environment.
    """
    environment = {**os.environ, "PYTHONPATH": str(copy), **variables}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=copy, env=environment, capture_output=True, encoding="locale", timeout=SECONDS
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout + done.stderr


def run_command(copy: Path, line: str, **variables: str) -> str:
    """Run a line of a `sh` block, `springtide ...` or `python ...`, in a copy. variables: of the environment."""
    first, *rest = shlex.split(line)
    assert first in ("springtide", "python"), line
    return run(copy, *(["-m", "app"] if first == "springtide" else []), *rest, **variables)
