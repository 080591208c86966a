"""The teacher's page: a row for each student, and the mistakes that several have. Whatever a student wrote is escaped.

Students are named as their folders are. The page fetches nothing but its own rows, and runs no other script.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from app.lab.check import TaskResult
from app.lab.classroom import Student
from app.lab.folder import folder_names
from app.lab.report import state_class
from app.lab.rope_picture import svg
from app.lab.task import Task
from app.render.html import Html, fill, join
from sim.parameters import in_words

SIGNS = {"right": "✓", "wrong": "✗", "failed": "✗", "incomplete": "●", "not begun": "·", "not checked": "…"}
MAX_TEXT = 220  # characters of a mistake
STYLE = """
body { font: 15px/1.4 system-ui, sans-serif; color: #1b2a3a; margin: 1em 1.5em 3em; }
h1 { font-size: 1.4em; margin: 0.2em 0; } h2 { font-size: 1.1em; margin: 1.2em 0 0.3em; } p { margin: 0.2em 0; }
table { border-collapse: collapse; } .class { width: 100%; }
td, th { border-bottom: 1px solid #ccd3da; padding: 0.3em 0.6em; text-align: left; vertical-align: middle; }
th { background: #f3f5f7; position: sticky; top: 0; font-weight: 600; }
td.name { font-weight: 600; white-space: nowrap; }
td.number, th.number { text-align: right; white-space: nowrap; }
th.at { min-width: 13em; } td.text { overflow-wrap: anywhere; min-width: 14em; }
.strip { white-space: nowrap; } .gap { margin-left: 0.5em; }
.cell { display: inline-block; width: 1em; text-align: center; font-weight: 700; border-radius: 3px; }
.cell.at { outline: 2px solid #125488; }
.right { color: #1e6b2c; } .wrong, .failed { color: #b51d1d; } .incomplete { color: #9a4b00; }
.faint { color: #4d5560; }
.mistakes td { border: 0; padding: 0.1em 0.7em 0.1em 0; vertical-align: top; }
svg.rope { display: block; overflow: hidden; }
.small { font-size: 13px; } .away { color: #b51d1d; font-weight: 600; } .away:empty { display: none; }
@media (max-width: 70em) { .wide { display: none; } }
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
      away.textContent = "The page is not followed any more: springtide has ended, or cannot be reached.";
      await new Promise((resolve) => setTimeout(resolve, 2000));
    }
  }
}
follow();
"""


class Mistake(NamedTuple):
    """A mistake, and the folders that have it."""

    place: str
    text: str
    folders: tuple[str, ...]


def page(students: Sequence[Student], revision: int, nonce: str) -> str:
    """The whole page, which asks for `rows` again as they change. nonce: that the policy allows scripts with."""
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
    body = join(student_row(student, names[student.folder]) for student in students)
    return fill(
        '<h1>Class of {}</h1><p class="faint">{} have begun{}. The page follows as files are saved.</p>{}'
        '<h2>Students</h2><table class="class"><thead><tr><th>Folder</th><th class="at">At</th>'
        '<th class="number">Right</th><th>Tasks</th><th class="wide">Rope</th><th>Mistake</th></tr></thead>'
        "<tbody>{}</tbody></table>"
        '<p class="faint small">✓ right, ✗ wrong or does not run, ● not complete, · not begun. Ropes fall for one '
        "for one second from the level; the reference's last shape is dashed.</p>",
        len(students), begun, busy, mistakes_table(ready, names), body,
    )  # fmt: skip


def mistakes_table(students: Sequence[Student], names: Mapping[Path, str]) -> Html:
    """The mistakes of the class, the most frequent first. names: of the folders."""
    found = mistakes(students, names)
    lines = join(
        fill(
            '<tr><td class="number"><b>{}</b></td><td>{}</td><td>{}</td><td class="faint">{}</td></tr>',
            len(mistake.folders), mistake.place, shortened(mistake.text), ", ".join(mistake.folders),
        )
        for mistake in found
    )  # fmt: skip
    nothing = fill('<p class="faint">None.</p>')
    return fill("<h2>Mistakes now</h2>{}", fill('<table class="mistakes">{}</table>', lines) if found else nothing)


def mistakes(students: Sequence[Student], names: Mapping[Path, str]) -> list[Mistake]:
    """Mistakes of all students, the most frequent first: of a function, a file that does not run, an answer.

    names: of the folders.
    """
    folders: dict[tuple[str, str], list[str]] = {}
    for student in students:
        own = dict.fromkeys(key for result in student.results for key in mistakes_of(result))
        for key in own:
            folders.setdefault(key, []).append(names[student.folder])
    found = [Mistake(*key, tuple(own)) for key, own in folders.items()]
    return sorted(found, key=lambda mistake: -len(mistake.folders))


def mistakes_of(result: TaskResult) -> list[tuple[str, str]]:
    """Place and name of each mistake in a task."""
    task, program = result.task, result.program
    found = []
    if program is not None and program.state == "failed":
        found.append((program.file or f"{task.item} {task.name}", "does not run"))
    elif program is not None and program.state == "wrong":
        found.append((f"{task.item} {task.name}", program.mistake or program.text))
    return found + [
        (f"{task.item} {in_words(answer.question.key)}", f"{answer_text(answer.answer)}: {answer.text}")
        for answer in result.answers
        if answer.state == "wrong" and answer.question.right is not None
    ]


def answer_text(answer: object) -> str:
    """An answer in few words."""
    return f"{answer:g}" if isinstance(answer, float) else f"“{answer}”"


def student_row(student: Student, name: str) -> Html:
    """One student: the task, right ones, all tasks, rope, and the first mistake of the present task, or of any.

    name: of the folder.
    """
    if not student.results:
        return fill(
            '<tr><td class="name">{}</td><td colspan="5" class="faint">{}</td></tr>',
            name, student.error or "being checked …",
        )  # fmt: skip
    at = next((result for result in student.results if result.task.name == student.at), None)
    count = sum(result.state == "right" for result in student.results if not result.task.optional)
    total = sum(not result.task.optional for result in student.results)
    problems = [text for result in (*([at] if at else []), *student.results) for text in result.problems]
    text = student.error or (problems[0] if problems else "")
    return fill(
        '<tr data-student="{}"><td class="name">{}</td><td>{}<br><span class="faint small">{}</span></td>'
        '<td class="number">{} of {}</td><td class="strip">{}</td><td class="wide">{}</td>'
        '<td class="text small">{}</td></tr>',
        name, name, at.task.item if at else "–",
        " ".join(filter(None, [at.task.title if at else "nothing begun", student.changed_at])), count, total,
        strip(student), rope(student), shortened(text),
    )  # fmt: skip


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
