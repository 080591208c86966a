"""`springtide lab new` and `springtide lab check`."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rich import get_console
from rich.console import Console
from rich.text import Text

from app.files import check_out_file
from app.formats import text_tables
from app.lab.check.check import FolderResult, TaskResult, check_folder
from app.lab.check.mistakes import mistakes, present_mistake, standing
from app.lab.course.folder import folder_names, make_folder
from app.lab.course.task import load_tasks
from app.lab.process.runners import Runners
from app.lab.report.report import page_of
from app.lab.report.results_file import csv_text, json_text
from sim.files import replacing

STYLES = {
    "right": "green",
    "wrong": "red",
    "failed": "red",
    "waits": "yellow",
    "not checked": "yellow",
    "incomplete": "yellow",
    "not begun": "dim",
}
ENDINGS = {"json": (".json",), "csv": (".csv",), "report": (".html", ".htm")}
ITEM_WIDTH = 7  # [characters]
STATE_WIDTH = 2 + max(map(len, STYLES))  # [characters]
FREQUENT = 3  # mistakes of a class that are printed
PARALLEL = 2  # folders of a class that are checked at the same time


def new(folder: Path, tasks: Sequence[Path], *, solutions: bool) -> int:
    """Write the exercises into a folder; returns the exit status."""
    written = make_folder(folder, load_tasks(*tasks), solutions=solutions)
    text_tables.say(f"wrote {', '.join(path.name for path in written)}. Begin with README.md.", folder)
    return 0


def check(
    folders: Sequence[Path], tasks: Sequence[Path], out: dict[str, Path | None], *, everything: bool = False
) -> int:
    """Check folders, and write the requested reports; returns 0 if every mandatory task of every folder is right.

    out: "json", "csv" and "report", each the file to write, or None. everything: print tasks not begun too.
    """
    for option, path in out.items():
        if path is not None and str(path) != "-":
            check_out_file(f"--{option}", path, endings=ENDINGS[option])
    all_tasks = load_tasks(*tasks)
    curves, runners = out["report"] is not None, Runners()
    with ThreadPoolExecutor(min(PARALLEL, len(folders))) as pool:
        try:
            results = list(pool.map(lambda one: check_folder(one, all_tasks, curves=curves, runners=runners), folders))
        except BaseException:  # Ctrl-C does not wait for endless functions
            runners.abort()
            raise
    if out["json"] is not None and str(out["json"]) == "-":
        print(json_text(results))
    else:
        print_results(results, everything=everything)
    write_files(results, out)
    return 0 if all(result.is_complete for result in results) else 1


def write_files(results: Sequence[FolderResult], out: dict[str, Path | None]) -> None:
    """Write the requested files, each completely or not at all."""
    for option, make in (("json", json_text), ("csv", csv_text), ("report", page_of)):
        path = out[option]
        if path is not None and str(path) != "-":
            with replacing(path) as draft:
                draft.write_text(make(results), "utf-8-sig" if option == "csv" else "utf-8")  # the mark is for Excel


def print_results(results: Sequence[FolderResult], *, everything: bool = False) -> None:
    """Print the result of one folder, or a row for each folder of a class.

    everything: list the tasks that are not begun too.
    """
    if len(results) > 1:
        names = folder_names(result.folder for result in results)
        text_tables.print_table("", [class_row(result, names[result.folder]) for result in results])
        print_frequent((names[result.folder], result.tasks) for result in results)
        return
    result, console = results[0], get_console()
    for entry in result.tasks:
        if everything or entry.state != "not begun":
            print_task(entry, console)
    problems = dict.fromkeys(text for entry in result.tasks for text in entry.problems)  # of a broken file one
    for text in [result.answers.error, *problems]:
        if text:
            console.print()
            text_tables.say(plain(text))
    for entry in result.tasks:
        for text in entry.missing:
            console.print()
            text_tables.say(f"{entry.task.item} {entry.task.name}, still to do: {text}")
    rest = () if everything else [entry.task.optional for entry in result.tasks if entry.state == "not begun"]
    (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
    console.print()
    if rest:
        text_tables.say(f"Not begun: {rest.count(False)} tasks, {rest.count(True)} optional ones; --all lists them.")
    said = f"{right} of {count} tasks right, {more} of {optional} optional ones ({result.seconds:.1f} s)."
    text_tables.say(said)


def print_task(entry: TaskResult, console: Console) -> None:
    """Print one line: item, state and title."""
    head = f"{entry.task.item:<{ITEM_WIDTH}}{entry.state:<{STATE_WIDTH}}"
    line = Text(f"{head}{plain(entry.task.title)}{' (optional)' if entry.task.optional else ''}")
    line.stylize(STYLES[entry.state], ITEM_WIDTH, len(head))
    console.print(line, soft_wrap=True)


def plain(text: str) -> str:
    """A text of a student for the terminal, with control characters written out."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def class_row(result: FolderResult, name: str) -> dict[str, str]:
    """Result of the check of one folder of a class. name: of the folder."""
    (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
    return {
        "Folder": plain(name),
        "Name": plain(result.answers.name),
        "Right": f"{right} of {count}, {more} of {optional} optional",
        "Tasks": standing(result.tasks),
        "Mistake": plain(result.answers.error or present_mistake(result.tasks)),
    }


def print_frequent(students: Iterable[tuple[str, Sequence[TaskResult]]]) -> None:
    """Print the mistakes that most students of a class have. students: name of the folder and results of each."""
    frequent_mistakes = [mistake for mistake in mistakes(students) if len(mistake.folders) > 1][:FREQUENT]
    for mistake in frequent_mistakes:
        get_console().print()
        names = ", ".join(mistake.folders)
        text_tables.say(plain(f"{len(mistake.folders)} students, {mistake.place}: {mistake.text} ({names})"))
