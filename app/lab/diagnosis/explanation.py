"""An explanation of a wrong function: words, and its equations beside the right ones."""

from collections.abc import Callable
from typing import Any, NamedTuple


class Piece(NamedTuple):
    """A part of an equation. wrong: it differs from the right one."""

    text: str
    wrong: bool = False


class Equation(NamedTuple):
    """One equation of a function.

    name: its left side, as "x3" or "new x". pieces: of the student's right side. right: the right one; "" if
    both agree.
    """

    name: str
    pieces: tuple[Piece, ...]
    right: str = ""

    @property
    def text(self) -> str:
        """The student's right side."""
        return "".join(piece.text for piece in self.pieces)


class Explanation(NamedTuple):
    """mistake: its name in a few words. text: the sentence for the student. form: the function that it states.

    line: in the student's file, 0 if unknown.
    """

    mistake: str
    text: str
    equations: tuple[Equation, ...] = ()
    form: Callable[..., Any] | None = None
    is_vague: bool = False  # it says little about the correction
    line: int = 0


def says_repair(cause: str) -> bool:
    """True if the sentence of a cause says the repair, too."""
    return cause.endswith("it is right.")
