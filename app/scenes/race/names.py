"""What the ropes of a race are called, in charts, labels and tables."""

from typing import Protocol


class Named(Protocol):
    """What a name is made of; entrants and results have it."""

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


def step_text(step: float) -> str:
    """A step [s] in a few characters: 1/240 s where it is nearly one over a whole number, else in ms."""
    whole = round(1.0 / step)
    if whole >= 10 and abs(whole * step - 1.0) < 1e-4 and whole <= 10_000:
        return f"1/{whole} s"
    return f"{1e3 * step:.3g} ms"


def rope_name(rope: Named, stiffness_differs: bool) -> str:
    """A rope by number, method and step, and by its stiffness where the ropes differ in it."""
    words = f"{rope.number} {rope.integrator}, {step_text(rope.step)}"
    return f"{words}, k {rope.stiffness:g}" if stiffness_differs else words


def rope_label(rope: Named, stiffness_differs: bool) -> str:
    """The label at its root. A failure comes first, as a label may reach out of view."""
    words = rope_name(rope, stiffness_differs)
    return f"{rope.number} {rope.failure.partition(':')[0]}: {words.partition(' ')[2]}" if rope.failure else words
