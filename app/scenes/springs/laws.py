"""The choice of a link's law, and the compiled pieces that are of one law only."""

from collections.abc import Callable
from typing import Any

from app.scenes.contract import Pieces
from sim.parameters import parameter
from sim.springs import LAWS

SPRING = next(iter(LAWS))  # the law whose kernels are compiled ahead


def law_parameter(group: str) -> Any:
    """The parameter of the links' law."""
    doc = "Law of a link: a spring, a line that never pushes, or a spring that stiffens with its stretch"
    choices = {name: law.title for name, law in LAWS.items()}
    return parameter(SPRING, choices=choices, doc=doc, group=group, title="Link")


def pieces_of_law(names: tuple[str, ...], law: str) -> tuple[str, ...]:
    """The names of pieces as they are compiled for a law."""
    return names if law == SPRING else tuple(f"{name}, {law}" for name in names)


def pieces_on_use(pieces: Callable[[str], Pieces]) -> Pieces:
    """The pieces of all laws but the spring. pieces: those of one law."""
    all_pieces: dict[str, Callable[[], object]] = {}
    for law in LAWS:
        if law != SPRING:
            own = pieces(law)
            all_pieces |= zip(pieces_of_law(tuple(own), law), own.values(), strict=True)
    return all_pieces
