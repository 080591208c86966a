"""The teacher's page: a row for each student, and common mistakes. All texts of students are escaped.

Students have the names of their folders, with the typed names below. The page fetches only its own rows, and runs no
other script.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from app.lab.check.mistakes import mistakes, present_mistake, present_task, standing
from app.lab.course.folder import folder_names
from app.lab.course.task import Task
from app.lab.report.classroom import Student
from app.lab.report.report import state_class
from app.lab.report.rope_picture import svg
from app.render.markup.html import Html, TableCell, fill, join, plain_table

SIGNS = {
    "right": "✓",
    "wrong": "✗",
    "failed": "✗",
    "incomplete": "●",
    "not begun": "·",
    "not checked": "…",
    "waits": "○",
}
MAX_TEXT = 220  # characters of a mistake
STYLE = """
body { font: 15px/1.4 system-ui, sans-serif; color: #1b2a3a; margin: 1em 1.5em 3em; }
h1 { font-size: 1.4em; margin: 0.2em 0; } h2 { font-size: 1.1em; margin: 1.2em 0 0.3em; } p { margin: 0.2em 0; }
table { border-collapse: collapse; } .class { width: 100%; }
td, th { border-bottom: 1px solid #ccd3da; padding: 0.3em 0.6em; text-align: left; vertical-align: middle; }
th { background: #f3f5f7; position: sticky; top: 0; font-weight: 600; }
td.name { font-weight: 600; } td.name .small { font-weight: 400; }
td.number, th.number { text-align: right; white-space: nowrap; }
td.text { overflow-wrap: anywhere; width: 50%; }
.strip { white-space: nowrap; } .gap { margin-left: 0.5em; }
.cell { display: inline-block; width: 0.72em; text-align: center; font-weight: 700; border-radius: 3px; }
.cell.at { outline: 2px solid #125488; }
.right { color: #1e6b2c; } .wrong, .failed { color: #b51d1d; } .incomplete { color: #9a4b00; }
.faint { color: #4d5560; }
.mistakes td { border: 0; padding: 0.1em 0.7em 0.1em 0; vertical-align: top; }
svg.rope { display: block; overflow: hidden; }
.small { font-size: 13px; } .away { color: #b51d1d; font-weight: 600; } .away:empty { display: none; }
@media (max-width: 70em) { .wide { display: none; } }
@media (max-width: 40em) {
  body { margin: 0.5em; } .class thead { display: none; } .strip { white-space: normal; }
  .class tr { display: block; border-bottom: 1px solid #ccd3da; }
  .class td:not(.wide) { display: block; width: auto; border: 0; padding: 0.1em 0; text-align: left; }
}
"""
SCRIPT = """
"use strict";
const rows = document.querySelector("main"), away = document.querySelector(".away");
async function follow() {
  let revision = rows.dataset.revision;
  for (;;) {
    try {
      const answer = await fetch(`rows?after=${revision}`);
      if (!answer.ok) throw new Error(answer.status);
      revision = answer.headers.get("X-Revision");
      const text = await answer.text();
      if (text) rows.innerHTML = text;
      away.textContent = "";
    } catch {
      away.textContent = "Not updating: Springtide has stopped or cannot be reached.";
      await new Promise((resolve) => setTimeout(resolve, 2000));
    }
  }
}
follow();
"""


def page(students: Sequence[Student], revision: int, nonce: str) -> str:
    """The whole page, which requests `rows` after each change. nonce: of the policy for scripts."""
    return fill(
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        "<title>Springtide: class</title><style>{}</style></head>\n"
        '<body><p class="away" role="alert"></p><main data-revision="{}">{}</main>'
        '<script nonce="{}">{}</script></body></html>\n',
        Html(STYLE), revision, rows(students), nonce, Html(SCRIPT),
    )  # fmt: skip


def policy(nonce: str) -> str:
    """The content security policy of the page."""
    return (
        f"default-src 'none'; style-src 'unsafe-inline'; script-src 'nonce-{nonce}'; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


def rows(students: Sequence[Student]) -> Html:
    """Everything that changes: a line about the class, its mistakes, and the table."""
    ready = [student for student in students if student.results]
    begun = sum(any(result.state != "not begun" for result in student.results) for student in ready)
    busy = f", {len(students) - len(ready)} being checked" if len(ready) < len(students) else ""
    names = folder_names(student.folder for student in students)
    head = ("Folder", "Current task and mistake", TableCell("Right", "number"), "Tasks", TableCell("Rope", "wide"))
    table = plain_table((student_row(student, names[student.folder]) for student in students), head, "class")
    return fill(
        '<h1>Class of {}</h1><p class="faint">{} have begun{}. The page updates as files are saved.</p>{}'
        "<h2>Students</h2>{}"
        '<p class="faint small">✓ right, ✗ wrong or does not run, ● not complete, · not begun. Ropes fall '
        "for one second from the horizontal; the reference's last shape is dashed.</p>",
        len(students), begun, busy, mistakes_table(ready, names), table,
    )  # fmt: skip


def mistakes_table(students: Sequence[Student], names: Mapping[Path, str]) -> Html:
    """The mistakes of the class, the most frequent first. names: of the folders."""
    class_mistakes = mistakes((names[student.folder], student.results) for student in students)
    rows = (
        (
            TableCell(fill("<b>{}</b>", len(mistake.folders)), "number"), mistake.place, shortened(mistake.text),
            TableCell(", ".join(mistake.folders), "faint"),
        )
        for mistake in class_mistakes
    )  # fmt: skip
    nothing = fill('<p class="faint">None.</p>')
    return fill("<h2>Mistakes now</h2>{}", plain_table(rows, name="mistakes") if class_mistakes else nothing)


def student_row(student: Student, name: str) -> tuple[TableCell, ...]:
    """Cells of one student: task and mistake, or the first mistake of any; number of right tasks, all tasks, the rope.

    name: of the folder.
    """
    if not student.results:
        return TableCell(name, "name"), TableCell(student.error or "being checked …", "faint", 4)
    at = present_task(student.results, student.at)
    count = sum(result.state == "right" for result in student.results if not result.task.optional)
    total = sum(not result.task.optional for result in student.results)
    text = student.error or present_mistake(student.results, student.at)
    where = " ".join(filter(None, [at.task.title if at else "nothing begun", student.changed_at]))
    said = '{} <span class="faint small">{}</span><br><span class="small">{}</span>'
    tasks = '<span class="strip">{}</span><br><span class="faint small">{}</span>'
    return (
        TableCell(fill('{}<br><span class="faint small">{}</span>', name, student.name), "name"),
        TableCell(fill(said, at.task.item if at else "–", where, shortened(text)), "text"),
        TableCell(f"{count} of {total}", "number"),
        TableCell(fill(tasks, strip(student), standing(student.results))),
        TableCell(rope(student), "wide"),
    )


def rope(student: Student) -> Html:
    """The picture, and its words."""
    picture = student.rope
    if not picture.text:
        return fill('<span class="faint small">no function yet</span>')
    return fill('{}<span class="faint small">{}</span>', svg(picture), shortened(picture.text))


def strip(student: Student) -> Html:
    """The state of every task, in the order of the lab, with a gap before each section."""
    parts, section = [], ""
    for result in student.results:
        new, section = result.task.item.partition("-")[0] != section, result.task.item.partition("-")[0]
        here = " at" if result.task.name == student.at else ""
        parts.append(
            fill(
                '<span class="cell {}{}{}" title="{}">{}</span>', state_class(result.state), here,
                " gap" if new and parts else "", title_of(result.task, result.state), SIGNS[result.state],
            )
        )  # fmt: skip
    return join(parts)


def title_of(task: Task, state: str) -> str:
    """A task and its state in words."""
    return f"{task.item} {task.title}: {state}"


def shortened(text: str) -> str:
    """The beginning of a text."""
    return text if len(text) <= MAX_TEXT else f"{text[:MAX_TEXT]} …"
