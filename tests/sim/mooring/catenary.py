"""The elastic catenary between two points, part of which may lie on a bed without friction (Jonkman 2007,
NREL/TP-500-41958, eq. 2-35 to 2-38)."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.validation import argument_error, check_number, check_positive

MOST = 200  # corrections
CLOSE = 1e-10  # gap over the length
USABLE = 1e-7  # the same, where round-off ends the search


class Catenary(NamedTuple):
    """A hanging line: its tension at the upper end, and where it is."""

    horizontal: float  # H [N], the same all along
    vertical: float  # V [N] at the upper end, upwards
    lying: float  # [m] of unstretched length on the bed
    length: float  # [m]
    weight: float  # [N/m] in water
    stiffness: float  # EA [N]

    def tension(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Tension [N] at unstretched lengths s [m] from the lower end."""
        upward = self.vertical - self.weight * (self.length - s)
        return np.hypot(self.horizontal, np.maximum(upward, 0.0) if self.lying > 0.0 else upward)

    def shape(self, s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Distance along and height [m] from the lower end at unstretched lengths s [m] from there."""
        H, w, ea = self.horizontal, self.weight, self.stiffness
        begin = self.vertical - w * self.length if self.lying == 0.0 else 0.0  # vertical force where it hangs from
        hanging = np.maximum(s - self.lying, 0.0)
        end = begin + w * hanging
        along = np.minimum(s, self.lying) + H * s / ea + H / w * (np.arcsinh(end / H) - math.asinh(begin / H))
        height = (np.hypot(H, end) - math.hypot(H, begin)) / w + hanging * (begin + end) / (2.0 * ea)
        return along, height


def first_forces(length: float, weight: float, span: float, rise: float, on_bed: bool) -> tuple[float, float]:
    """log H and V [N] to start from: of the line that does not stretch, where part of it lies, else Jonkman's guess."""
    chord = math.hypot(span, rise)
    if on_bed and chord < length:
        # With a = H/w the hanging part s = sqrt(rise^2 + 2 rise a) has s - a asinh(s/a) = length - span.
        low, high, a, hanging = -40.0, 40.0, length, length
        for _ in range(80):
            middle = 0.5 * (low + high)
            a = math.exp(middle) * length
            hanging = math.sqrt(rise * rise + 2.0 * rise * a)
            longer = hanging - a * math.asinh(hanging / a) > length - span
            low, high = (middle, high) if longer else (low, middle)
        if hanging < length:
            return math.log(weight * a), weight * hanging
    sag = 0.2 if chord >= length else math.sqrt(3.0 * ((length**2 - rise**2) / span**2 - 1.0))
    return math.log(weight * span / (2.0 * sag)), 0.5 * weight * (rise / math.tanh(sag) + length)


def catenary(
    length: float, stiffness: float, weight: float, span: float, rise: float, *, on_bed: bool = True
) -> Catenary:
    """The line of unstretched `length` [m], EA `stiffness` [N] and `weight` [N/m] in water over `span` and `rise` [m].

    on_bed: whether the lower end lies on a bed; else the line may hang below it.

    Raises ValueError, naming the argument, its value and what is allowed; for a line too long to be pulled at all, too.
    """
    check_positive("length", length, "m")
    check_positive("stiffness", stiffness, "N")
    check_positive("weight", weight, "N/m")
    check_positive("span", span, "m")
    check_number("rise", rise, "m", 0)
    if on_bed and length >= span + rise:
        raise argument_error("length", length, f"less than span + rise = {span + rise:g} m: a longer line lies slack")
    # Unknown is log H, as H stays above 0.
    state: NDArray[Any] = np.array(first_forces(length, weight, span, rise, on_bed))

    def found(state: NDArray[Any]) -> Catenary:
        H, V = math.exp(min(state[0], 300.0)), float(state[1])
        return Catenary(H, V, max(0.0, length - V / weight) if on_bed else 0.0, length, weight, stiffness)

    def gap(state: NDArray[Any]) -> NDArray[Any]:
        along, height = found(state).shape(np.array([length]))
        return np.array([along[0] - span, height[0] - rise])

    here: NDArray[Any] = gap(state)
    for _ in range(MOST):
        if np.abs(here).max() <= CLOSE * length:
            return found(state)
        steps = np.array([1e-7, 1e-7 * weight * length])
        jacobian = np.stack([(gap(state + d) - gap(state - d)) / (2.0 * d.max()) for d in np.diag(steps)], axis=1)
        try:
            step = -np.linalg.solve(jacobian, here)
        except np.linalg.LinAlgError:
            break
        share = min(1.0, 2.0 / max(abs(float(step[0])), 1e-300))
        while share > 1e-10 and not np.hypot(*gap(state + share * step)) < np.hypot(*here):
            share *= 0.5
        if share <= 1e-10:
            break
        state = state + share * step
        here = gap(state)
    if np.abs(here).max() <= USABLE * length:
        return found(state)
    raise argument_error("length", length, "a line that some tension holds at this span and rise")
