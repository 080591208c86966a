"""`springtide lab new` and `springtide lab check`."""

import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from app.files import check_out_file
from app.lab.check import FolderResult, check_folder
from app.lab.folder import make_folder
from app.lab.report import page_of
from app.lab.results_file import csv_text, json_text
from app.lab.task import load_tasks
from sim.files import replacing

STYLES = {"right": "green", "wrong": "red", "failed": "red", "incomplete": "yellow", "not begun": "dim"}
PARALLEL = 2  # folders of a class that are checked at the same time


def new(folder: Path, tasks: Sequence[Path], *, solutions: bool) -> int:
    """Write the exercises into a folder; returns the exit status."""
    written = make_folder(folder, load_tasks(*tasks), solutions=solutions)
    print(f"Wrote {', '.join(path.name for path in written)} in {folder}. Begin with {folder / 'README.md'}")
    return 0


def check(folders: Sequence[Path], tasks: Sequence[Path], out: dict[str, Path | None]) -> int:
    """Check folders, and write the requested reports; returns 0 if every mandatory task of every folder is right.

    out: "json", "csv" and "report", each the file to write, or None.
    """
    for option, path in out.items():
        if path is not None and str(path) != "-":
            check_out_file(f"--{option}", path)
    found = load_tasks(*tasks)
    with ThreadPoolExecutor(min(PARALLEL, len(folders))) as pool:
        results = list(pool.map(lambda folder: check_folder(folder, found, curves=out["report"] is not None), folders))
    if out["json"] is not None and str(out["json"]) == "-":
        print(json_text(results))
    else:
        print_results(results)
    write_files(results, out)
    return 0 if all(result.is_complete for result in results) else 1


def write_files(results: Sequence[FolderResult], out: dict[str, Path | None]) -> None:
    """Write the files that are asked for, each whole or not at all."""
    for option, make in (("json", json_text), ("csv", csv_text), ("report", page_of)):
        path = out[option]
        if path is not None and str(path) != "-":
            with replacing(path) as draft:
                draft.write_text(make(results), "utf-8")


def print_results(results: Sequence[FolderResult]) -> None:
    """Print one table: the tasks of one folder, or a row for each folder of a class."""
    console = Console(file=sys.stdout)
    console.print(table_of_tasks(results[0]) if len(results) == 1 else table_of_class(results))
    if len(results) == 1:
        result = results[0]
        if result.answers.error:
            console.print(printable(result.answers.error), style="red")
        (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
        console.print(f"{right} of {count} tasks right, {more} of {optional} optional ones ({result.seconds:.1f} s)")


def printable(text: str) -> Text:
    """A text of a student for the terminal, with control characters written out."""
    return Text("".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text))


def whole_table(*names: str) -> Table:
    """A table that folds wide cells and cuts nothing off."""
    return Table(*(Column(name, overflow="fold") for name in names))


def table_of_tasks(result: FolderResult) -> Table:
    """Result of the check of one folder."""
    table = whole_table("Task", "What", "State", "Why")
    for entry in result.tasks:
        name = f"{entry.task.item}{' *' if entry.task.optional else ''}"
        why = printable("; ".join(entry.messages))
        table.add_row(name, printable(entry.task.title), Text(entry.state, STYLES[entry.state]), why)
    table.caption = "* optional"
    return table


def table_of_class(results: Sequence[FolderResult]) -> Table:
    """Result of the check of the folders of a class."""
    table = whole_table("Folder", "Name", "Right", "Optional", "Not right")
    for result in results:
        (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
        rest = [entry.task.item for entry in result.tasks if entry.state != "right" and not entry.task.optional]
        table.add_row(
            printable(result.folder.name), printable(result.answers.name), f"{right} of {count}",
            f"{more} of {optional}", printable(", ".join(dict.fromkeys(rest))),
        )  # fmt: skip
    return table
