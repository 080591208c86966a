"""The interchangeable laws of a link: one file each, discovered here. Nothing else knows how a link pulls.

To add one, write a module in this folder with

1. a NamedTuple class of the law's own numbers, if any. `Net.law` is one of these, and kernels know the law
   by its class: what runs is compiled for that law alone.
2. kernels of one line, `force_density`, `stiffness` and `energy`, as `Law` says. A tension is proportional to k, and at
   the same strain to the rest length.
3. `length`, the length at a tension, for the rope at rest.
4. `LAW = Law(...)`, from which the panel, the command line and the tests take it.
"""

import math
from typing import Any

import numpy as np

from sim.jit import chosen, kernel, modules_of
from sim.springs.laws.curve import OF_LINES
from sim.springs.laws.record import Law, always_whole
from sim.validation import check_choice, check_number

TAUT = 1e-9  # strain of a link that is just taut
FAR_APART = 1e-3  # difference of two lengths over their extensions, above which that of their energies is exact enough

LAWS: dict[str, Law] = {
    law.name: law
    for law in sorted(
        (module.LAW for module in modules_of(__name__) if hasattr(module, "LAW")),
        key=lambda law: (law.name != "spring", law.name),
    )
}
BY_NUMBERS: dict[type, Law] = {type(law.numbers): law for law in LAWS.values()}
# Those that kernels take: a link of a line under water has one of its own, which no net has.
OF_LINKS: dict[type, Law] = {**BY_NUMBERS, type(OF_LINES.numbers): OF_LINES}


def by_law(name: str) -> Any:
    """The kernel that stands for a function of the laws, by the class of its argument `law`."""
    return chosen({numbers: getattr(law, name) for numbers, law in OF_LINKS.items()})


force_density = by_law("force_density")
stiffness = by_law("stiffness")
energy = by_law("energy")
damping = by_law("damping")


@kernel(inline=True)
def tension(law, k, rest, length):
    """[N], negative if the link is compressed."""
    return length * force_density(law, k, rest, length)


@kernel(inline=True)
def mean_tension(law, k, rest, before, after):
    """The mean of the tension [N] over all lengths from `before` to `after` [m]: their energies' difference quotient.

    For nearby lengths, whose energies differ by little more than round-off, by Gauss's three points.
    """
    gap = after - before
    if abs(gap) > FAR_APART * (abs(before - rest) + abs(after - rest)):
        return (energy(law, k, rest, after) - energy(law, k, rest, before)) / gap
    mean, away = 0.5 * (before + after), 0.3872983346207417 * gap  # sqrt(3/5)/2
    beside = tension(law, k, rest, mean - away) + tension(law, k, rest, mean + away)
    return (8.0 * tension(law, k, rest, mean) + 5.0 * beside) / 18.0


@kernel(inline=True)
def general_over_step(law, k, rest, before, after):
    """`over_step` of any law."""
    mean, gap, pull = 0.5 * (before + after), after - before, mean_tension(law, k, rest, before, after)
    rise = 0.5 * stiffness(law, k, rest, after)
    if abs(gap) > FAR_APART * (abs(before - rest) + abs(after - rest)):
        rise = (tension(law, k, rest, after) - pull) / gap
    return pull / mean, (2.0 * rise - pull / mean) / mean


# Of a link that goes from one length to another: the mean of its tension over the mean length [N/m], and twice the
# derivative of that by the second length [N/m^2].
over_step = chosen({numbers: law.over_step or general_over_step for numbers, law in OF_LINKS.items()})


@kernel(inline=True)
def lost_share(b, acting, both, s):
    """Fraction of the relative velocity that a damping b [N s/m] removes in a time s [s], over `both` [1/kg].

    acting: the part of b that acts at first. If it is less than b, the force is that of the tension, constant until the
    velocity is so small that b takes no more; from then on the velocity decays exponentially. both: the sum of the
    inverse masses of both ends.
    """
    if both == 0.0 or acting == 0.0:
        return 0.0
    if acting == b:
        return -math.expm1(-b * both * s) / both
    whole_from = (1.0 / acting - 1.0 / b) / both  # [s]
    if s <= whole_from:
        return acting * s
    return (1.0 - acting / b * math.exp(-b * both * (s - whole_from))) / both


def by_damping(whole: Any, limited: Any) -> Any:
    """A kernel that stands for one of these, by whether damping always acts whole by its argument `law`."""
    return chosen({numbers: whole if law.damping is always_whole else limited for numbers, law in OF_LINKS.items()})


def law_of(numbers: Any) -> Law:
    """The law that these numbers are of."""
    return BY_NUMBERS[type(numbers)]


def check_law(law: Any) -> Any:
    """The numbers of a law, given as its name or as they are. Raises ValueError with the known names."""
    if type(law) not in BY_NUMBERS:
        return LAWS[check_choice("law", law, LAWS)].numbers
    for name, value in law._asdict().items():
        check_number(f"law.{name}", value, "", 0)
    return type(law)(*map(float, law))


def of_arrays(function: Any) -> Any:
    """A kernel of a law for numpy, not compiled."""
    return np.vectorize(getattr(function, "py_func", function), otypes=[float], excluded={0})


def largest_stiffness(law: Any, least: float, largest: float) -> float:
    """Largest stiffness over k of a link at these strains, at most 0 and at least 0, or nearly at its rest length."""
    strains = np.array([least, -TAUT, TAUT, max(largest, TAUT)])
    return float(of_arrays(law_of(law).stiffness)(law, 1.0, 1.0, 1.0 + strains).max())
