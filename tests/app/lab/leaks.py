"""Texts that may give an answer away before it is given, listed for reading: `python -m tests.app.lab.leaks`.

For each question: every text that a student meets before answering, and that has the right number, the right choice,
or most words of the explanation. A person decides; `ALLOWED` holds what was read and is no leak.
"""

import ast
import inspect
import re
from collections.abc import Iterator
from typing import NamedTuple

from app.lab.course.task import Question, Task, load_tasks

SHARED = 0.6  # of the words of an explanation, from which on a text may give it away
LONG = 5  # letters of a word that counts
# Question -> why a text with its answer gives nothing away.
ALLOWED = {
    "top_fluid.on_top": "both fluids are in every text",
    "spectrum.measure": "4 is the factor of a rate of decay",
    "step_leapfrog.limit": "2 is a weight of Runge-Kutta",
    "grids.scales": "both grids are in every text",
    "surface_colour.explain": "the docstring gives the law; asked is what it looks like",
    "rope_acceleration.explain": "the docstring names all forces, and not what they do to the energy",
}


class Leak(NamedTuple):
    """A text that may give an answer away. place: where it stands."""

    question: str
    answer: str
    place: str
    text: str


def texts_of(task: Task) -> Iterator[tuple[str, str]]:
    """The texts of a task that a student meets before answering its questions, each with its place."""
    yield f"{task.name}: statement", task.statement
    if task.setup is not None:
        yield f"{task.name}: look", task.setup.look
    for number, step in enumerate(task.steps, 1):
        yield f"{task.name}: step {number}", step.text
    if task.check is None:
        return
    yield f"{task.name}: docstring", inspect.getdoc(task.function) or ""
    for mistake in getattr(task.check, "MISTAKES", ()):
        yield f"{task.name}: hint of “{mistake.name}”", mistake.hint
    behaviour = getattr(task.check, "behaviour", None)
    if behaviour is not None:
        tree = ast.parse(inspect.getsource(behaviour)).body[0]
        assert isinstance(tree, ast.FunctionDef)
        for node in ast.walk(ast.Module(tree.body[1:], [])):  # its docstring is shown once the questions are answered
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield f"{task.name}: behaviour", node.value


def gives_away(question: Question, text: str) -> bool:
    """True if a text may have the answer to a question."""
    if question.kind == "number" and isinstance(question.right, int | float):
        return any(question.is_near(float(number), float(question.right)) for number in numbers_in(text))
    if question.kind == "choice" and question.right is not None:
        return re.search(rf"\b{re.escape(str(question.right))}\b", text) is not None
    wanted = words_in(question.why)
    return bool(wanted) and len(wanted & words_in(text)) >= SHARED * len(wanted)


def numbers_in(text: str) -> list[str]:
    """The numbers in a text, without those of names and exponents."""
    return re.findall(r"(?<![\w.^*/-])\d+(?:\.\d+)?(?![\w.])", text)


def words_in(text: str) -> set[str]:
    """The long words of a text, without their endings."""
    return {word[:LONG] for word in re.findall(r"[a-z]+", text.lower()) if len(word) >= LONG}


def leaks() -> list[Leak]:
    """All texts that may give an answer away, but for the questions of `ALLOWED`."""
    tasks = load_tasks()
    found = []
    for task in tasks:
        near = [other for other in tasks if other is task or (task.file and other.file == task.file)]
        for question in task.questions:
            key = f"{task.name}.{question.key}"
            texts = [entry for other in near for entry in texts_of(other)]
            if question.kind != "choice":  # a prediction asks for the same choice
                texts += [(f"{task.name}: question {q.key}", q.ask) for q in task.questions if q is not question]
            answer = question.why if question.right is None else str(question.right)
            if key not in ALLOWED:
                found += [Leak(key, answer, place, text) for place, text in texts if gives_away(question, text)]
    return found


if __name__ == "__main__":
    for leak in leaks():
        print(f"{leak.question} ({leak.answer})\n    {leak.place}: {' '.join(leak.text.split())}\n")
