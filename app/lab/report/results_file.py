"""Results of checks as JSON and as a table for a class (CSV)."""

import csv
import io
import json
from collections.abc import Sequence

from app.lab.check.check import FolderResult, TaskResult
from app.lab.course.folder import folder_names

FORMULA_SIGNS = ("=", "+", "-", "@", "\t", "\r")  # first characters of a cell that a spreadsheet would run


def json_text(results: Sequence[FolderResult]) -> str:
    """All results of all folders."""
    return json.dumps([folder_record(result) for result in results], indent=2, ensure_ascii=False)


def folder_record(result: FolderResult) -> dict[str, object]:
    """One student's results."""
    return {
        "folder": str(result.folder),
        "name": result.answers.name,
        "complete": result.is_complete,
        "seconds": round(result.seconds, 3),
        "error": result.answers.error,
        "tasks": [task_record(entry) for entry in result.tasks],
    }


def task_record(entry: TaskResult) -> dict[str, object]:
    """One task's results."""
    program = entry.program
    return {
        "task": entry.task.name,
        "item": entry.task.item,
        "optional": entry.task.optional,
        "state": entry.state,
        "program": None
        if program is None
        else {"state": program.state, "mistake": program.mistake, "text": program.text, "place": program.place},
        "answers": {
            verdict.question.key: {"answer": verdict.answer, "state": verdict.state, "text": verdict.text}
            for verdict in entry.answers
        },
    }


def csv_text(results: Sequence[FolderResult]) -> str:
    """A row for each student, a column for each task."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    tasks = [entry.task.name for entry in results[0].tasks]
    writer.writerow(["folder", "name", "complete", "right", "optional_right", *tasks])
    folders = folder_names(result.folder for result in results)
    for result in results:
        right, more = result.count(optional=False)[0], result.count(optional=True)[0]
        states = [entry.state for entry in result.tasks]
        names = cell(folders[result.folder]), cell(result.answers.name)
        writer.writerow([*names, "yes" if result.is_complete else "no", right, more, *states])
    return out.getvalue()


def cell(text: str) -> str:
    """A student's text as a cell that no spreadsheet reads as a formula."""
    return "'" + text if text.startswith(FORMULA_SIGNS) else text
