"""Building blocks of the check of a programming task; the Python file of a task uses these names.

Beside the reference solution, such a file has
- `inputs(rng)`, required: one set of arguments, drawn from a numpy generator. Functions may be among them.
- `EXAMPLES`, a tuple of further arguments: the numbers of the scenes, and inputs at which the task's text draws a line.
- `MISTAKES`, a tuple of `Mistake`: wrong solutions that are recognised by what they return.
- `ALTERNATIVES`, a tuple of functions that are right as well, though they return something else.
- `behaviour(student)`: calls the student's function and raises `Wrong` where it does not behave as it must.
- `CURVE`, a `Curve` that the report draws.
- `METHOD`, a `Method`: the function is a step, and what it does is compared with right ones, equation by equation.
- `TERMS` and `GROUPS`, tuples of `Term` and `Group` (`diagnosis/terms.py`): what the result adds up.
- `adds_up(student, *arguments)`: whether it does so for these arguments; without it, for all.
- `within(form)`: the functions that a form of what the result adds up may be part of.
- `contrast(result, right, *arguments)`: a sentence on the difference of two results, or "".
- `CONSTANT`: a sentence for a result that is right except for a constant that is slightly off.
- `CASES`, a tuple of `Case` (`diagnosis/differences.py`): special cases, in which alone a function may be wrong.
- `normalise(result)`: brings results that mean the same to one form, for example a list in any order.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.diagnosis.explanation import Equation


class Mistake(NamedTuple):
    """A typical mistake: its name, a hint for the student, and a function that makes it."""

    name: str
    hint: str
    function: Callable[..., Any]


class Method(NamedTuple):
    """An integration method. steps: right solutions, the usual one first.

    with_velocity: whether the acceleration that a step gets may depend on the velocity.
    """

    steps: tuple[Callable[..., Any], ...]
    with_velocity: bool = True


class Curve(NamedTuple):
    """A curve for the report. values(function, x): the function's values over x, of the student's or the reference."""

    x_label: str
    y_label: str
    x: Sequence[float] | np.ndarray
    values: Callable[[Callable[..., Any], Any], Any]


class Wrong(Exception):  # noqa: N818 - a judgement on a solution, not an error of the program
    """The student's function does not behave as it must.

    mistake: its name where it is a known one. equations: what the function does, beside the right ones. form: the
    function that the text says there is, or None. line: in the student's file; 0: that of the function.
    """

    def __init__(
        self, text: str, mistake: str = "", equations: tuple[Equation, ...] = (),
        form: Callable[..., Any] | None = None, line: int = 0,
    ) -> None:  # fmt: skip
        super().__init__(text)
        self.mistake = mistake
        self.equations = equations
        self.form = form
        self.line = line


class Counted:
    """A function that counts its calls and keeps the arguments of each."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.calls: list[tuple[Any, ...]] = []

    def __call__(self, *arguments: Any) -> Any:
        """The function's value."""
        self.calls.append(arguments)
        return self.function(*arguments)


def require(condition: object, text: str, mistake: str = "") -> None:
    """Raises `Wrong` unless the condition holds."""
    if not condition:
        raise Wrong(text, mistake)
