"""The page to hand in: one HTML file that needs no network. Everything that a student wrote is escaped."""

import base64
from collections.abc import Sequence
from pathlib import Path

from app.lab.answer_check import AnswerVerdict
from app.lab.answers import Value
from app.lab.chart import chart
from app.lab.check import FolderResult, TaskResult
from app.lab.folder import PICTURES
from app.render.html import Html, fill, join

MAX_CODE = 20_000  # characters of a student's file that are shown
MAX_PICTURES = 30
MAX_PICTURE = 4 * 2**20  # [bytes]
# The first bytes of a picture -> its type; other files are left out, whatever their names.
SIGNATURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1b2a3a; max-width: 60em; margin: 2em auto; padding: 0 1em; }
h1, h2, h3 { line-height: 1.25; } h3 { margin: 2em 0 0.3em; }
table { border-collapse: collapse; margin: 0.5em 0; } td, th { border: 1px solid #ccd3da; padding: 0.25em 0.6em;
text-align: left; vertical-align: top; overflow-wrap: break-word; }
.answers { table-layout: fixed; width: 100%; } .answers :is(td, th):first-child { width: 6.5em; }
pre { background: #f3f5f7; padding: 0.7em; overflow-x: auto; font-size: 13px; } img, svg { max-width: 100%; }
.right { color: #1e6b2c; } .wrong, .failed { color: #b51d1d; } .incomplete { color: #9a4b00; }
.faint { color: #4d5560; }
.overview td { padding: 0.1em 0.5em; } figure { margin: 1em 0; } figcaption { color: #4d5560; font-size: 14px; }
"""


def page_of(results: Sequence[FolderResult]) -> str:
    """The page of one student, or of a class with an overview first."""
    title = "Lab report" if len(results) == 1 else f"Lab reports of {len(results)} folders"
    overview = class_overview(results) if len(results) > 1 else Html()
    body = join(student_section(result, number) for number, result in enumerate(results))
    return fill(
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        # Nothing is fetched and no script runs, whatever the page holds.
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; img-src data:; style-src '
        "'unsafe-inline'\">\n"
        '<meta name="viewport" content="width=device-width"><title>{0}</title><style>{1}</style></head>\n'
        "<body>{2}{3}</body></html>\n",
        title, Html(STYLE), overview, body,
    )  # fmt: skip


def class_overview(results: Sequence[FolderResult]) -> Html:
    """One row for each student, with a link to the section."""
    rows = []
    for number, result in enumerate(results):
        (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
        name = result.answers.name or "no name given"
        rows.append(
            fill(
                '<tr><td><a href="#student-{}">{}</a></td><td>{}</td><td>{} of {}</td><td>{} of {}</td></tr>',
                number, result.folder.name, name, right, count, more, optional,
            )
        )  # fmt: skip
    return fill(
        "<h1>Overview</h1><table><tr><th>folder</th><th>name</th><th>right</th><th>optional</th></tr>{}</table>",
        join(rows),
    )


def student_section(result: FolderResult, number: int) -> Html:
    """Everything of one student."""
    (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
    name = result.answers.name or f"Folder {result.folder.name}"
    error = fill('<p class="failed">{}</p>', result.answers.error) if result.answers.error else Html()
    return fill(
        '<section id="student-{}"><h1>{}</h1><p>{} of {} mandatory tasks are right, and {} of {} optional ones.</p>{}'
        "{}{}{}<h2>Code</h2>{}</section>",
        number, name, right, count, more, optional, error, overview(result),
        join(task_section(entry) for entry in result.tasks), pictures(result.folder), code(result),
    )  # fmt: skip


def overview(result: FolderResult) -> Html:
    """The state of every task."""
    rows = join(
        fill(
            '<tr><td>{}</td><td>{}{}</td><td class="{}">{}</td></tr>',
            entry.task.item, entry.task.title, " (optional)" if entry.task.optional else "",
            state_class(entry.state), entry.state,
        )
        for entry in result.tasks
    )  # fmt: skip
    return fill('<table class="overview">{}</table>', rows)


def state_class(state: str) -> str:
    """The class of the style sheet for a state."""
    return {"not begun": "faint", "given": "faint"}.get(state, state)


def task_section(entry: TaskResult) -> Html:
    """One task: its statement, what the program says to the function, answers beside predictions."""
    task, program = entry.task, entry.program
    said = Html()
    if program is not None:
        mistake = f" ({program.mistake})" if program.mistake and program.state == "wrong" else ""
        said = fill(
            '<p>Function <code>{}</code>: <b class="{}">{}</b>{}. {}</p>',
            task.name, state_class(program.state), program.state, mistake, program.text,
        )  # fmt: skip
    table = Html()
    if entry.answers:
        table = fill(
            '<table class="answers"><tr><th></th><th>question</th><th>answer</th><th>check</th></tr>{}</table>',
            join(answer_row(verdict) for verdict in entry.answers),
        )
    return fill(
        '<h3>{} {}{}: <span class="{}">{}</span></h3><p class="faint">{}</p>{}{}{}',
        task.item, task.title, " (optional)" if task.optional else "", state_class(entry.state), entry.state,
        task.statement, said, table, Html() if entry.points is None else chart(entry.points),
    )  # fmt: skip


def answer_row(verdict: AnswerVerdict) -> Html:
    """One question with its answer and what the check says."""
    state = "kept for the teacher" if verdict.state == "given" else verdict.state
    return fill(
        '<tr><td>{}</td><td>{}</td><td>{}</td><td><span class="{}">{}</span> {}</td></tr>',
        verdict.question.key,
        verdict.question.ask, answer_text(verdict.answer, verdict.question.unit), state_class(verdict.state), state,
        verdict.text,
    )  # fmt: skip


def answer_text(answer: Value | None, unit: str) -> str:
    """An answer with its unit."""
    if answer is None:
        return ""
    return answer if isinstance(answer, str) else f"{answer:g} {unit}".strip()


def pictures(folder: Path) -> Html:
    """The pictures that the student took, as part of the page."""
    found = []
    for path in sorted((folder / PICTURES).glob("*"))[:MAX_PICTURES]:
        data = path.read_bytes() if path.is_file() and path.stat().st_size <= MAX_PICTURE else b""
        kind = next((kind for head, kind in SIGNATURES.items() if data.startswith(head)), None)
        if kind is not None:
            source = f"data:{kind};base64,{base64.b64encode(data).decode()}"
            found.append(fill('<figure><img src="{}" alt=""><figcaption>{}</figcaption></figure>', source, path.name))
    return fill("<h2>Pictures</h2>{}", join(found)) if found else Html()


def code(result: FolderResult) -> Html:
    """The student's files, as they were checked."""
    names = dict.fromkeys(entry.task.file for entry in result.tasks if entry.task.file)
    return join(
        fill("<h3>{}</h3><pre>{}</pre>", name, (result.folder / name).read_text("utf-8", "replace")[:MAX_CODE])
        for name in names
        if (result.folder / name).is_file()
    )
