"""The page to hand in: one HTML file that needs no network. All texts of a student are escaped."""

import ast
import base64
import inspect
import re
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from app.lab.check.check import FolderResult, TaskResult
from app.lab.course.answer_check import AnswerVerdict
from app.lab.course.answers import Answers, Value
from app.lab.course.folder import MAX_PICTURES, PICTURES, folder_names
from app.lab.course.source import is_empty
from app.lab.course.task import Task
from app.lab.diagnosis.equation_html import equation_lines
from app.lab.report.chart import chart
from app.render.markup.formula import formula
from app.render.markup.html import Html, TableCell, fill, join, plain_table, table_row

MAX_CODE = 20_000  # characters of a student's file, shown at most
MAX_PICTURE = 4 * 2**20  # [bytes]
# The first bytes of a picture -> its type; other files are left out, whatever their names.
SIGNATURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
BEGINNING = re.compile(r"\w+")  # of a picture's name, which may be that of a task
PARTS = {"Predict": "Predicted", "Measure": "Measured", "Explain": "Explained"}
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1b2a3a; max-width: 60em; margin: 2em auto; padding: 0 1em; }
h1, h2, h3 { line-height: 1.25; } h3 { margin: 2em 0 0.3em; }
table { border-collapse: collapse; margin: 0.5em 0; } td, th { border: 1px solid #ccd3da; padding: 0.25em 0.6em;
text-align: left; vertical-align: top; overflow-wrap: break-word; }
.answers { table-layout: fixed; width: 100%; } .answers th { background: #f3f5f7; }
.question + .question { border-top: 1px solid #ccd3da; margin-top: 0.5em; padding-top: 0.3em; }
.question p { margin: 0.2em 0; }
.answer { white-space: pre-wrap; font-weight: 600; } .steps { padding-left: 1.2em; }
math { margin: 0.6em 0; font-size: 115%; }
h3 { border-top: 2px solid #ccd3da; padding-top: 0.8em; }
@media print { h3, figure, .question { break-inside: avoid; } }
pre { background: #f3f5f7; padding: 0.7em; overflow-x: auto; font-size: 13px; } img, svg { max-width: 100%; }
.right { color: #1e6b2c; } .wrong, .failed { color: #b51d1d; } .incomplete { color: #9a4b00; }
.faint { color: #4d5560; }
.springtide-equations { border-left: 3px solid #ccd3da; padding-left: 1em; }
.springtide-equations .right { padding-left: 1.5em; }
.overview td { padding: 0.1em 0.5em; } .overview td:first-child { white-space: nowrap; }
figure { margin: 1em 0; } figcaption { color: #4d5560; font-size: 14px; }
"""


def page_of(results: Sequence[FolderResult]) -> str:
    """The page of one student, or of a class with an overview first."""
    names = folder_names(result.folder for result in results)
    headings = [heading(result, names[result.folder]) for result in results]
    title = headings[0] if len(results) == 1 else f"Lab reports of {len(results)} folders"
    overview = class_overview(results, names) if len(results) > 1 else Html()
    body = join(student_section(result, number, headings[number]) for number, result in enumerate(results))
    return fill(
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        # Nothing is fetched and no script runs, whatever the page holds.
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; img-src data:; style-src '
        "'unsafe-inline'\">\n"
        '<meta name="viewport" content="width=device-width"><title>{0}</title><style>{1}</style></head>\n'
        "<body>{2}{3}</body></html>\n",
        title, Html(STYLE), overview, body,
    )  # fmt: skip


def class_overview(results: Sequence[FolderResult], names: Mapping[Path, str]) -> Html:
    """One row for each student, with a link to the section. names: of the folders."""
    rows = []
    for number, result in enumerate(results):
        (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
        name = result.answers.name or "no name given"
        rows.append(
            (
                fill('<a href="#student-{}">{}</a>', number, names[result.folder]), name,
                f"{right} of {count}", f"{more} of {optional}",
            )
        )  # fmt: skip
    return fill("<h1>Overview</h1>{}", plain_table(rows, ("folder", "name", "right", "optional")))


def student_section(result: FolderResult, number: int, title: str) -> Html:
    """Everything of one student."""
    (right, count), (more, optional) = result.count(optional=False), result.count(optional=True)
    error = fill('<p class="failed">{}</p>', result.answers.error) if result.answers.error else Html()
    figures = pictures(result)
    tasks = join(
        task_section(result, entry, f"student-{number}-{entry.task.name}", of_task(figures, entry.task.name))
        for entry in result.tasks
        if entry.state != "not begun"
    )
    rest, written = of_task(figures, ""), code(result)
    return fill(
        '<section id="student-{0}"><h1>{1}</h1><p>Checked on {2}.</p>'
        "<p>{3} of {4} mandatory tasks are right, and {5} of {6} optional ones.</p>{7}{8}{9}{10}{11}{12}</section>",
        number, title, time.strftime("%Y-%m-%d %H:%M"), right, count, more, optional, error,
        overview(result, number), tasks, fill("<h2>More pictures</h2>{}", rest) if rest else Html(),
        fill("<h2>Code</h2>{}", written) if written else Html(), not_begun(result),
    )  # fmt: skip


def heading(result: FolderResult, folder: str) -> str:
    """The subject and the name of the student, or that of the folder."""
    return f"Lab report: Springs and waves – {result.answers.name or f'folder {folder}'}"


def not_begun(result: FolderResult) -> Html:
    """A folded list of the tasks that are not begun; nothing if all are."""
    titles = [f"{entry.task.item} {entry.task.title}" for entry in result.tasks if entry.state == "not begun"]
    rows = join(fill("<li>{}</li>", title) for title in titles)
    return fill("<details><summary>Not begun: {}</summary><ul>{}</ul></details>", len(titles), rows) if rows else Html()


def overview(result: FolderResult, number: int) -> Html:
    """The state of each task under way, with a link to its section."""
    rows = (
        (
            entry.task.item,
            fill(
                '<a href="#student-{}-{}">{}</a>{}', number, entry.task.name, entry.task.title,
                " (optional)" if entry.task.optional else "",
            ),
            TableCell(entry.state, state_class(entry.state)),
        )
        for entry in result.tasks
        if entry.state != "not begun"
    )  # fmt: skip
    return plain_table(rows, name="overview")


def state_class(state: str) -> str:
    """The class of the style sheet for a state."""
    return {"not begun": "faint", "given": "faint", "not checked": "incomplete", "waits": "incomplete"}.get(
        state, state
    )


def task_section(result: FolderResult, entry: TaskResult, anchor: str, task_pictures: Html) -> Html:
    """One task: its statement, law, steps done, check and answers, with `task_pictures`."""
    task = entry.task
    # A law may be the answer to a question that is still open.
    is_open = any(answer.state == "not begun" for answer in entry.answers)
    laws = Html() if task.guide is None or is_open else join(formula(law) for law in task.guide.law)
    return fill(
        '<h3 id="{}">{} {}{}: <span class="{}">{}</span></h3><p class="faint">{}</p>{}{}{}{}{}{}',
        anchor, task.item, task.title, " (optional)" if task.optional else "", state_class(entry.state), entry.state,
        task.statement, laws, steps(result.answers, task), program_text(entry), answers_of(result.answers, entry),
        Html() if entry.points is None else chart(entry.points), task_pictures,
    )  # fmt: skip


def steps(answers: Answers, task: Task) -> Html:
    """Steps to do in the scene, with those completed in the workbook."""
    done = answers.done(task)
    rows = join(
        fill(
            "<li>{} {}</li>",
            fill('<b class="right">✓ seen:</b>') if number in done else fill('<span class="faint">not seen:</span>'),
            step.text,
        )
        for number, step in enumerate(task.steps, 1)
    )
    return fill('<ul class="steps">{}</ul>', rows) if rows else Html()


def program_text(entry: TaskResult) -> Html:
    """The check's result for the function, and the aspects that it covers."""
    program = entry.program
    if program is None:
        return Html()
    text = program.located
    if program.state == "not begun":
        text = ""
    if program.state == "right":
        behaviour = inspect.getdoc(getattr(entry.task.check, "behaviour", None)) or ""
        told = behaviour if is_answered(entry) else ""
        text = f"Matches the reference at all inputs of the check. {told and 'Behaviour: '}{told}"
    return fill(
        '<p>Function <code>{}</code>: <b class="{}">{}</b>. {}</p>{}',
        entry.task.name, state_class(program.state), program.state, text,
        equation_lines(program.equations) if program.equations else Html(),
    )  # fmt: skip


def is_answered(entry: TaskResult) -> bool:
    """True if the questions of a task have answers: the text of its check may reveal one."""
    return all(answer.state != "not begun" for answer in entry.answers)


def answers_of(answers: Answers, entry: TaskResult) -> Html:
    """The answers of a task: predictions beside measurements, and explanations below."""
    if not entry.answers:
        return Html()
    cells = {part: [answer for answer in entry.answers if answer.question.part == part] for part in PARTS}
    above = [part for part in ("Predict", "Measure") if cells[part]]
    explained = join(answer_text(answer) for answer in cells["Explain"])
    looked_at = "The program's answer was viewed in the panel."
    width = 3 - len(above)
    rows = [
        table_row((TableCell(PARTS[part], columns=width) for part in above), "th"),
        table_row(TableCell(join(answer_text(answer) for answer in cells[part]), columns=width) for part in above),
    ]
    if explained:
        rows += [
            table_row([TableCell(PARTS["Explain"], columns=2)], "th"),
            table_row([TableCell(explained, columns=2)]),
        ]
    return fill(
        '<table class="answers">{}</table>{}',
        join(rows),
        fill('<p class="faint">{}</p>', looked_at) if answers.is_shown(entry.task) else Html(),
    )  # fmt: skip


def answer_text(verdict: AnswerVerdict) -> Html:
    """One question with its answer and the check's result."""
    state = {"given": "", "not begun": "not answered"}.get(verdict.state, verdict.state)
    said = fill('<p><span class="{}">{}</span> {}</p>', state_class(verdict.state), state, verdict.text)
    return fill(
        '<div class="question"><p class="faint">{}</p><p class="answer">{}</p>{}</div>',
        verdict.question.ask, value_text(verdict.answer, verdict.question.unit), said if state else Html(),
    )  # fmt: skip


def value_text(answer: Value | None, unit: str) -> str:
    """An answer with its unit."""
    if answer is None:
        return ""
    return answer if isinstance(answer, str) else f"{answer:g} {unit}".strip()


def pictures(result: FolderResult) -> list[tuple[str, Html]]:
    """The student's pictures as parts of the page, each with the task at the start of its name, or ""."""
    names = {entry.task.name for entry in result.tasks}
    figures: list[tuple[str, Html]] = []
    for path in sorted((result.folder / PICTURES).glob("*"))[:MAX_PICTURES]:
        data = path.read_bytes() if path.is_file() and path.stat().st_size <= MAX_PICTURE else b""
        kind = next((kind for head, kind in SIGNATURES.items() if data.startswith(head)), None)
        if kind is not None:
            source = f"data:{kind};base64,{base64.b64encode(data).decode()}"
            first = BEGINNING.match(path.stem)
            figure = fill(
                '<figure><img src="{}" alt="{}"><figcaption>{}</figcaption></figure>', source, path.stem, path.name
            )
            figures.append((first[0] if first and first[0] in names else "", figure))
    return figures


def of_task(named_pictures: Sequence[tuple[str, Html]], task: str) -> Html:
    """The pictures of one task."""
    return join(picture for name, picture in named_pictures if name == task)


def code(result: FolderResult) -> Html:
    """The student's files as checked, without empty functions."""
    names = dict.fromkeys(
        entry.task.file for entry in result.tasks if entry.program and entry.program.state != "not begun"
    )
    return join(
        fill("<h3>{}</h3><pre>{}</pre>", name, written((result.folder / name).read_text("utf-8", "replace"))[:MAX_CODE])
        for name in names
        if (result.folder / name).is_file()
    )


def written(source: str) -> str:
    """A Python file without empty functions and their headings; unchanged if it cannot be parsed."""
    try:
        nodes = ast.parse(source).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return source
    lines = source.splitlines()
    for node in reversed(nodes):
        if isinstance(node, ast.FunctionDef) and all(is_empty(line) for line in node.body):
            first = node.lineno - 1
            while first and lines[first - 1].startswith("#"):
                first -= 1
            del lines[first : node.end_lineno]
    return re.sub(r"\n{4,}", "\n\n\n", "\n".join(lines)).strip() + "\n"
