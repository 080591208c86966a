"""Tables in a terminal: whole at any width, as rows or, if they are too wide, as lines "name: value unit"."""

import shutil
import textwrap
from pathlib import Path
from typing import Any

import numpy as np

Rows = list[dict[str, Any]]


def columns(rows: Rows) -> list[str]:
    """The columns of all rows, in the order of their first appearance."""
    return list(dict.fromkeys(name for row in rows for name in row))


def written(value: Any) -> str:
    """A value as a table on screen shows it."""
    if value is None:
        return ""
    if isinstance(value, float | np.floating):
        return f"{value:.4g}" if np.isfinite(value) else "-"
    return str(value)


def print_table(title: str, rows: Rows) -> None:
    """Print a table; one that is too wide for the terminal as lines "name: value unit", so that no digit is cut."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console, names = Console(), columns(rows)
    # Headings are folded between words, values are not. Rich cuts digits where it folds headings.
    cells = {name: [written(row.get(name)) for row in rows] for name in names}
    widths = {name: max(map(len, [*cells[name], *name.split()])) for name in names}
    left = console.width - 1 - sum(3 + width for width in widths.values())
    if left < 0:
        lines = [*([title] if title else []), *(line for row in rows for line in ("", *lines_of(row)))]
        folded = [line for text in lines for line in fold(text, console.width) or [""]]
        console.print("\n".join(folded), markup=False, highlight=False, soft_wrap=True)
        return
    table = Table(title=escape(title) or None, title_justify="left")
    for name in names:
        more = min(left, max(0, len(name) - widths[name]))
        left -= more
        heading = textwrap.fill(name, widths[name] + more, break_on_hyphens=False)
        is_number = any(isinstance(row.get(name), int | float) for row in rows)
        table.add_column(escape(heading), justify="right" if is_number else "left", no_wrap=True)
    for row in zip(*cells.values(), strict=True):
        table.add_row(*map(escape, row))
    console.print(table)


def say(text: str, path: Path | None = None) -> None:
    """Print a text at the width of the terminal, folded between words, after the path that it is about.

    A path is never folded. It has a line of its own, to be copied whole, unless it fits on one line with the text.
    """
    width = shutil.get_terminal_size().columns
    if path is None:
        lines = fold(text, width)
    elif len(line := f"{path}: {text}") <= width:
        lines = [line]
    else:
        lines = [str(path), *fold(f"  {text}", width)]
    print("\n".join(lines))


def fold(text: str, width: int) -> list[str]:
    """A line folded between words, the further lines indented."""
    indent = " " * (len(text) - len(text.lstrip()))
    return textwrap.wrap(
        text, width, drop_whitespace=True, initial_indent="", subsequent_indent=f"{indent}  ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def lines_of(row: dict[str, Any]) -> list[str]:
    """A row as lines "name: value unit", with the unit in brackets at the end of a name; empty cells are left out."""
    lines: list[str] = []
    for name, value in row.items():
        words, bracket, unit = name.removesuffix("]").rpartition(" [") if name.endswith("]") else (name, "", "")
        if text := written(value):
            lines.append(f"{'  ' if lines else ''}{words}: {text}{' ' if bracket else ''}{unit}")
    return lines
