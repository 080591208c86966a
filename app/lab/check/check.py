"""Checks a student's folder: every function, every answer."""

import dataclasses
import time
from collections.abc import Sequence
from pathlib import Path

from app.lab.check.program_check import Points, Verdict, check_program, draw, settled
from app.lab.course.answer_check import AnswerVerdict, check_answer
from app.lab.course.answers import FILE, Answers, read_answers, strangers
from app.lab.course.folder import check_is_folder
from app.lab.course.task import Task
from app.lab.process.runners import Runners


@dataclasses.dataclass(frozen=True)
class TaskResult:
    """One task of one student."""

    task: Task
    program: Verdict | None  # None without a function to write
    answers: tuple[AnswerVerdict, ...]
    points: Points | None = None  # a curve of the function, if requested

    @property
    def state(self) -> str:
        """The first of these states among the parts of the task.

        "failed", "wrong", "waits", "not checked", "not begun", "incomplete", "right".
        """
        states = [*([self.program.state] if self.program else []), *(answer.state for answer in self.answers)]
        for state in ("failed", "wrong", "waits", "not checked"):
            if state in states:
                return state
        open_parts = states.count("not begun")
        return "right" if not open_parts else "not begun" if open_parts == len(states) else "incomplete"

    @property
    def problems(self) -> tuple[str, ...]:
        """The parts that are not right, each with its place and advice."""
        texts, program = [], self.program
        if program is not None and program.file:
            texts.append(program.sentence)
        elif program is not None and program.state in ("wrong", "failed", "waits", "not checked"):
            texts.append(f"{program.place or self.task.file} {self.task.name}: {program.sentence}")
        texts += [f"{FILE} {self.task.name}.{a.question.key}: {a.text}" for a in self.answers if a.state == "wrong"]
        return tuple(texts)

    @property
    def missing(self) -> tuple[str, ...]:
        """The open parts of a task under way: its function, its questions."""
        if self.state == "not begun":
            return ()
        program = self.program is not None and self.program.state == "not begun"
        questions = [answer.question.ask for answer in self.answers if answer.state == "not begun"]
        return (*([f"Write {self.task.name} in {self.task.file}."] if program else []), *questions)


@dataclasses.dataclass(frozen=True)
class FolderResult:
    """All tasks of one student."""

    folder: Path
    answers: Answers
    tasks: tuple[TaskResult, ...]
    seconds: float

    @property
    def is_complete(self) -> bool:
        """True if every task that is not optional is right."""
        return all(result.state == "right" for result in self.tasks if not result.task.optional)

    def count(self, *, optional: bool) -> tuple[int, int]:
        """Numbers of right tasks and of all tasks, mandatory or optional."""
        chosen = [result for result in self.tasks if result.task.optional == optional]
        return sum(result.state == "right" for result in chosen), len(chosen)


def check_folder(folder: Path, tasks: Sequence[Task], *, curves: bool, runners: Runners) -> FolderResult:
    """Check all tasks of a student's folder; with the report's curves, if `curves`. runners: those that may be aborted.

    Raises ValueError if it is no folder.
    """
    check_is_folder(folder)
    began = time.monotonic()
    answers = read_answers(folder)
    if not answers.error and (others := strangers(answers, tasks)):
        answers = answers._replace(error=others[0])
    results = []
    with runners.runner(folder) as runner:
        programs = {task.name: check_program(folder, runner, task, tasks) for task in tasks if task.check is not None}
        for task in tasks:
            program = settled(task.name, programs) if task.name in programs else None
            judged = tuple(
                check_answer(question, answers.of(task, question), answers.unread_of(task, question))
                for question in task.questions
            )
            begun = program is not None and program.state in ("right", "wrong", "waits")
            results.append(TaskResult(task, program, judged, draw(runner, task) if curves and begun else None))
    return FolderResult(folder, answers, tuple(results), time.monotonic() - began)
