"""Whole files of answers, as tests need them."""

from collections.abc import Sequence
from pathlib import Path

from app.lab.course.answers import FILE, Answers, answers_text
from app.lab.course.task import Task


def write_answers(folder: Path, tasks: Sequence[Task], answers: Answers) -> None:
    """Write answers.toml."""
    (folder / FILE).write_text(answers_text(tasks, answers), "utf-8")
