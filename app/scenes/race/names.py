"""Names of the ropes of a race in charts, labels and tables."""

from typing import Protocol

from app.formats.formatting import number, time_step
from app.scenes.springs.methods import method_name


class Named(Protocol):
    """Parts of a name; entrants and results have them."""

    @property
    def number(self) -> int:
        """From 1."""
        ...

    @property
    def integrator(self) -> str:
        """Name of the method."""
        ...

    @property
    def step(self) -> float:
        """[s]."""
        ...

    @property
    def stiffness(self) -> float:
        """[N/m] of a link."""
        ...

    @property
    def failure(self) -> str:
        """Why the rope has stopped, or ""."""
        ...


def rope_name(rope: Named, stiffness_differs: bool) -> str:
    """A rope by number, method and step, and by its stiffness where the ropes differ in it."""
    words = f"{rope.number} {method_name(rope.integrator)}, {time_step(rope.step)}"
    return f"{words}, {number(rope.stiffness)} N/m" if stiffness_differs else words


def rope_label(rope: Named, stiffness_differs: bool) -> str:
    """The label at its root, short enough to stay in view: of a rope that has stopped, its number and why."""
    return f"{rope.number} {rope.failure.partition(':')[0]}" if rope.failure else rope_name(rope, stiffness_differs)
