"""Judges the answers to questions: choices and numbers; predictions and texts are kept for the teacher."""

import dataclasses

from app.lab.course.answers import Value
from app.lab.course.task import Question

MIN_WORDS = 3  # of a text that counts as an answer


@dataclasses.dataclass(frozen=True)
class AnswerVerdict:
    """Result of the check of one answer.

    state: "not begun", "right", "wrong", or "given" for neither. text: for the student.
    """

    question: Question
    answer: Value | None
    state: str
    text: str = ""


def check_answer(question: Question, answer: Value | None) -> AnswerVerdict:
    """Judge one answer."""
    if answer is None:
        return AnswerVerdict(question, None, "not begun")
    if question.kind == "text":
        enough = len(str(answer).split()) >= MIN_WORDS
        return AnswerVerdict(question, answer, *(("given", "") if enough else ("wrong", "Write a whole sentence.")))
    if question.kind == "number" and not isinstance(answer, float):
        return AnswerVerdict(question, answer, "wrong", "This is not a number.")
    if question.kind == "choice" and answer not in question.choices:
        return AnswerVerdict(question, answer, "wrong", "Not one of the choices: " + ", ".join(question.choices))
    if question.right is None:
        return AnswerVerdict(question, answer, "given")
    if is_right(question, answer):
        return AnswerVerdict(question, answer, "right", question.why)
    for error in question.typical_errors:
        near = isinstance(answer, float) and isinstance(error.answer, int | float)
        if question.is_near(answer, float(error.answer)) if near else answer == error.answer:  # type: ignore[arg-type]
            return AnswerVerdict(question, answer, "wrong", error.text)
    return AnswerVerdict(question, answer, "wrong", "Set up the task and measure again.")


def is_right(question: Question, answer: Value) -> bool:
    """True if an answer is the right one."""
    if isinstance(answer, float) and isinstance(question.right, float):
        return question.is_near(answer, question.right)
    return answer == question.right
