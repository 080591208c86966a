"""Wrong forms of the force of a damped spring, for all tasks with springs.

A law gives the force on the first end of each link, (..., 3), from r (..., 3), from the first end to the second, its
length s (..., 1), dv = v1 - v2 (..., 3), k, b and the rest length d.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from app.lab.diagnosis.terms import Form, Group, Term

Law = Callable[..., Any]


def spring(r: Any, s: Any, dv: Any, k: float, b: float, d: Any) -> Any:
    """The right force of the spring."""
    return k * (s - d) * r / s


def damping(r: Any, s: Any, dv: Any, k: float, b: float, d: Any) -> Any:
    """The right force of the damping."""
    return -b * dv


SPRING = "k (|r| - d) r/|r|"
DAMPING = "-b (v1 - v2)"
SPRING_FORMS: tuple[tuple[str, str, Law], ...] = (
    ("k |r| r/|r|", "The rest length is missing.", lambda r, s, dv, k, b, d: k * r),
    ("k (|r| - d) r", "The direction r does not have unit length.", lambda r, s, dv, k, b, d: k * (s - d) * r),
    ("k (r - d)", "The rest length is subtracted from each component.", lambda r, s, dv, k, b, d: k * (r - d)),
    ("k (|r|/d - 1) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (s / d - 1.0) * r / s),
    ("k (1 - d/|r|) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (1.0 - d / s) * r / s),
    ("k (|r|² - d²) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (s**2 - d**2) * r / s),
    ("k (|r|² - d) r/|r|", "The length is squared.", lambda r, s, dv, k, b, d: k * (s**2 - d) * r / s),
    ("k (|r| - d)² r/|r|", "The stretch is squared.", lambda r, s, dv, k, b, d: k * (s - d) ** 2 * r / s),
    ("k ||r| - d| r/|r|", "A compressed spring must push.", lambda r, s, dv, k, b, d: k * abs(s - d) * r / s),
    ("k max(|r| - d, 0) r/|r|", "It only pulls; a compressed spring must push.",
     lambda r, s, dv, k, b, d: k * np.maximum(s - d, 0.0) * r / s),
    ("k min(|r| - d, 0) r/|r|", "It only pushes; a stretched spring must pull.",
     lambda r, s, dv, k, b, d: k * np.minimum(s - d, 0.0) * r / s),
    ("k (|r| - d)", "It has no direction.", lambda r, s, dv, k, b, d: k * (s - d) * np.ones_like(r)),
    ("k (|r| - d) r/|r|²", "It is divided by the length twice.", lambda r, s, dv, k, b, d: k * (s - d) * r / s**2),
    ("a spring for each component", "The length |r| is that of the whole vector, not of one component.",
     lambda r, s, dv, k, b, d: k * (abs(r) - d) * r / abs(r)),
    ("k (|r| + d) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (s + d) * r / s),
)  # fmt: skip
DAMPING_FORMS: tuple[tuple[str, str, Law], ...] = (
    ("-b ((v1 - v2) . r/|r|) r/|r|", "It acts along the link only.",
     lambda r, s, dv, k, b, d: -b * (dv * r).sum(axis=-1, keepdims=True) / s**2 * r),
    ("-b |v1 - v2| r/|r|", "It acts along the link, by the size of v1 - v2.",
     lambda r, s, dv, k, b, d: -b * size(dv) * r / s),
    ("-b |v1 - v2| (v1 - v2)", "It is multiplied by the speed.", lambda r, s, dv, k, b, d: -b * size(dv) * dv),
    ("-b (v1 - v2)/|v1 - v2|", "The speed does not count.", lambda r, s, dv, k, b, d: -b * dv / size(dv)),
    ("-b |v1 - v2|", "It has no direction.", lambda r, s, dv, k, b, d: -b * size(dv) * np.ones_like(r)),
    ("-b (v1 - v2) (|r| - d)", "It is multiplied by the stretch.", lambda r, s, dv, k, b, d: -b * dv * (s - d)),
    ("-b |v1 - v2|, by components", "It never changes its sign.", lambda r, s, dv, k, b, d: -b * abs(dv)),
)  # fmt: skip


def size(vectors: Any) -> Any:
    """The lengths of vectors, (..., 1)."""
    return np.linalg.norm(vectors, axis=-1, keepdims=True)


def both(*arguments: Any) -> Any:
    """The whole force of a link."""
    return spring(*arguments) + damping(*arguments)


def terms_of_net(of_law: Callable[..., Any], per: str = "") -> tuple[Term, ...]:
    """The terms of a net of links: spring and damping on both ends of each.

    of_law(law, first=1.0, second=-1.0): a law as a function of the task's arguments, with factors of the
    force on the two ends. per: divisor of forces, such as " / m".
    """
    return (
        Term("the spring on the first end", f"{SPRING}{per}", of_law(spring, second=0.0)),
        Term("the spring on the second end", f"-{SPRING}{per}", of_law(spring, first=0.0)),
        Term("the damping on the first end", f"{DAMPING}{per}", of_law(damping, second=0.0)),
        Term("the damping on the second end", f"b (v1 - v2){per}", of_law(damping, first=0.0)),
    )


def groups_of_net(of_law: Callable[..., Any], per: str = "", forms: tuple[Form, ...] = ()) -> tuple[Group, ...]:
    """The terms of `terms_of_net` that one line of a program computes.

    of_law: as there, with `chosen`, a slice of the links. forms: more wrong forms of the force of all links.
    """
    names = tuple(term.name for term in terms_of_net(of_law))

    def of_kind(name: str, formula: str, members: tuple[str, ...], laws: tuple[tuple[str, str, Law], ...]) -> Group:
        whole = f"{formula}{per} on the first end, and the opposite on the second"
        return Group(name, whole, members, tuple(Form(text, why, of_law(law)) for text, why, law in laws))

    return (
        of_kind("the spring", SPRING, names[:2], SPRING_FORMS),
        of_kind("the damping", DAMPING, names[2:], DAMPING_FORMS),
        Group("the force on the first end", "added to the first point", names[::2]),
        Group("the force on the second end", "the opposite of that on the first", names[1::2]),
        Group(
            "the force of the links", "the sum over all links, each once", names,
            (
                Form("that of all links but the last", "One link is left out.", of_law(both, chosen=slice(None, -1))),
                Form("that of all links but the first", "One link is left out.", of_law(both, chosen=slice(1, None))),
                *forms,
            ),
        ),
    )  # fmt: skip
