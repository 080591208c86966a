"""The mistakes of a class, and the progress of each student, for the teacher's page and the terminal."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from app.lab.check.check import TaskResult
from sim.parameters import in_words

# States of a task, and the words for how many tasks have it.
STATES = {
    "right": "right", "wrong": "wrong", "failed": "does not run", "waits": "waits for another",
    "incomplete": "not complete", "not checked": "not checked", "not begun": "not begun",
}  # fmt: skip


EXAMPLE = re.compile(r"(With .* it|It) returns |Right at \d+")


class ClassMistake(NamedTuple):
    """A mistake, and the folders that have it."""

    place: str
    text: str
    folders: tuple[str, ...]


def mistakes(students: Iterable[tuple[str, Sequence[TaskResult]]]) -> list[ClassMistake]:
    """The mistakes of all students, the most frequent first: of a function, a file that does not run, an answer.

    students: name of the folder and results of each.
    """
    folders: dict[tuple[str, str], list[str]] = {}
    for name, results in students:
        for key in dict.fromkeys(key for result in results for key in mistakes_of(result)):
            folders.setdefault(key, []).append(name)
    class_mistakes = [ClassMistake(*key, tuple(own)) for key, own in folders.items()]
    return sorted(class_mistakes, key=lambda mistake: -len(mistake.folders))


def mistakes_of(result: TaskResult) -> list[tuple[str, str]]:
    """Place and name of each mistake in a task."""
    task, program = result.task, result.program
    pairs = []
    if program is not None and program.state == "failed":
        pairs.append((program.file or f"{task.item} {task.name}", "does not run"))
    elif program is not None and program.state == "wrong":
        pairs.append((f"{task.item} {task.name}", program.mistake or kind_of(program.text)))
    return pairs + [
        (f"{task.item} {in_words(answer.question.key)}", f"{answer_text(answer.answer)}: {answer.text}")
        for answer in result.answers
        if answer.state == "wrong" and answer.question.right is not None
    ]


def kind_of(text: str) -> str:
    """The first sentence about a function, without the numbers of one student's case."""
    first = text.partition(". ")[0]
    return "another result" if EXAMPLE.match(first) else first


def answer_text(answer: object) -> str:
    """An answer in few words."""
    return f"{answer:g}" if isinstance(answer, float) else f"“{answer}”"


def standing(results: Sequence[TaskResult]) -> str:
    """Number of tasks in each state: "right 3, wrong 1, not begun 22"."""
    numbers = Counter(result.state for result in results)
    return ", ".join(f"{words} {numbers[state]}" for state, words in STATES.items() if numbers[state])


def present_task(results: Sequence[TaskResult], at: str = "") -> TaskResult | None:
    """A student's current task: the one named `at`, otherwise the last that is begun and not right."""
    open_tasks = [result for result in results if result.state not in ("right", "not begun")]
    return next((result for result in results if result.task.name == at), open_tasks[-1] if open_tasks else None)


def present_mistake(results: Sequence[TaskResult], at: str = "") -> str:
    """The first mistake in a student's present task, or in any task; "" without a mistake."""
    present = present_task(results, at)
    return next((text for result in (*([present] if present else []), *results) for text in result.problems), "")
