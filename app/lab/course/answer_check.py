"""Judges the answers to questions: choices and numbers; predictions and texts are kept for the teacher."""

import dataclasses

from app.lab.course.answers import Value
from app.lab.course.answers_text import Unread
from app.lab.course.task import Question
from sim.quantities import read_number

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


def check_answer(question: Question, answer: Value | None, unread: Unread | None = None) -> AnswerVerdict:
    """Judge one answer. unread: of the file, if it could not be read."""
    if unread is not None:
        sentence = unread.sentence
        return AnswerVerdict(question, unread.text, "wrong", sentence[0].upper() + sentence[1:] + ".")
    if answer is None:
        return AnswerVerdict(question, None, "not begun")
    if question.kind == "text":
        enough = len(str(answer).split()) >= MIN_WORDS
        return AnswerVerdict(question, answer, *(("given", "") if enough else ("wrong", "Write a whole sentence.")))
    if question.kind == "number" and isinstance(answer, str):
        try:
            answer = read_number(answer, question.unit)
        except ValueError as reason:
            text = f"“{answer}” is not read: {reason}. Write a number, such as {example_of(question)}."
            return AnswerVerdict(question, answer, "wrong", text)
    if question.kind == "choice" and isinstance(answer, str):
        answer = chosen(question, answer)
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


def example_of(question: Question) -> str:
    """A number as an answer may have it."""
    return f"0.5 or 0.5 {question.unit}" if question.unit else "0.5"


def chosen(question: Question, answer: str) -> str:
    """The choice that an answer means, whatever its capitals; the answer itself if it is none."""
    return next((one for one in question.choices if one.casefold() == answer.strip().casefold()), answer)


def is_right(question: Question, answer: Value) -> bool:
    """True if an answer is the right one."""
    if isinstance(answer, float) and isinstance(question.right, float):
        return question.is_near(answer, question.right)
    return answer == question.right
