"""Names of the ropes of a race in charts, labels and tables."""

import itertools
from collections.abc import Sequence

from app.formats.formatting import number, short_step
from app.scenes.race.entrants import Entrant, Result
from app.scenes.springs.methods import method_name


def rope_name(rope: Entrant | Result, stiffness_differs: bool) -> str:
    """A rope by number, method and step, and by its stiffness where the ropes differ in it."""
    words = f"{rope.number} {method_name(rope.integrator)}, {short_step(rope.step)}"
    return f"{words}, {number(rope.stiffness)} N/m" if stiffness_differs else words


def rope_labels(ropes: Sequence[Entrant]) -> tuple[str, ...]:
    """The labels at the roots, short enough for small windows: numbers with all that differs, or why a rope stopped."""
    parts = [(method_name(rope.integrator), short_step(rope.step), f"{number(rope.stiffness)} N/m") for rope in ropes]
    differs = [len(set(column)) > 1 for column in zip(*parts, strict=True)]
    if not any(differs):
        differs[0] = True
    return tuple(
        f"{rope.number}: " + (rope.failure.partition(":")[0] or ", ".join(itertools.compress(part, differs)))
        for rope, part in zip(ropes, parts, strict=True)
    )
