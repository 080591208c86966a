"""Periods of small heave, roll and pitch of a hull afloat upright, with the added mass of linear theory there."""

import math

from sim.floating.hulls.hull import Hull
from sim.floating.linear.hydrodynamics import check_box, linear_hull, natural_frequency
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers, density_steps, equilibrium_draft, upright
from sim.validation import argument_error, check_number, is_whole_number
from sim.water import EARTH_GRAVITY


def heave_period(
    hull: Hull, density: float, layers: Layers = SEA_WATER, gravity: float = EARTH_GRAVITY, added: float = 1.0
) -> float:
    """Period [s] of small heave of the upright hull about its equilibrium: 2 pi sqrt((m + A33)/C33).

    A33 is that of linear theory at this period. C33 = g sum (rho_i - rho_{i-1}) A_i over the waterplanes at surface and
    interfaces, which are taken to stay level (Newman 1977, section 6.16). added scales the added mass. inf where no
    force restores: the hull sinks, or is wholly submerged in one fluid. Raises ValueError as `equilibrium_draft`, and
    for a hull from a mesh that no box stands for.

    >>> from sim.floating import Hull
    >>> round(heave_period(Hull.box(4.0, 2.0, 1.0), 512.5), 2)  # [s]
    2.17
    """
    check_number("added", added, "", 0.0)
    layers = check_layers(layers)
    draft = equilibrium_draft(hull, density, layers, gravity)
    if not math.isinf(draft):
        check_box("hull", hull, draft)
    return heave_period_at(hull, density, layers, draft, gravity, added)


def heave_period_at(
    hull: Hull, density: float, layers: Layers, draft: float, gravity: float = EARTH_GRAVITY, added: float = 1.0
) -> float:
    """`heave_period` of a hull with a known equilibrium draft [m]."""
    if math.isinf(draft):
        return math.inf
    cuts = [(change, upright(hull, draft - top)) for change, top in density_steps(layers)]
    fluid = density * hull.volume / cuts[0][1].volume  # [kg/m3] mean density of the displaced fluids
    stiffness = sum(change * cut.area for change, cut in cuts) / fluid
    return period(natural_frequency(linear_hull(hull, draft), 2, cuts[0][1].volume, stiffness, added), gravity)


def roll_period(
    hull: Hull,
    density: float,
    layers: Layers = SEA_WATER,
    gravity: float = EARTH_GRAVITY,
    added: float = 1.0,
    axis: int = 0,
) -> float:
    """Period [s] of small roll (axis 0, about x) or pitch (axis 1, about y) of the upright hull, free to sway.

    2 pi sqrt((I + A44)/(rho g V GM)) with rho g V GM = g sum (rho_i - rho_{i-1}) (I_i + V_i (z_B - z_G)) over the
    interfaces (Newman 1977, section 6.16), and A44 that of linear theory at this period, with the sway that comes with
    it. inf where the upright pose is not stable, or the hull sinks. added scales the added inertia. Raises ValueError
    as `equilibrium_draft`, and for another axis.

    >>> from sim.floating import Hull
    >>> round(roll_period(Hull.box(4.0, 2.0, 1.0), 512.5), 2)  # [s]; of a loaded body: roll_period(*body.loaded())
    2.49
    """
    if not is_whole_number(axis) or axis not in (0, 1):
        raise argument_error("axis", axis, "0 (roll) or 1 (pitch)")
    check_number("added", added, "", 0.0)
    layers = check_layers(layers)
    draft = equilibrium_draft(hull, density, layers, gravity)
    if math.isinf(draft):
        return math.inf
    check_box("hull", hull, draft)
    stiffness = 0.0
    for change, top in density_steps(layers):
        cut = upright(hull, draft - top)
        if cut.volume > 0:
            stiffness += change * (cut.second[1 - axis] + cut.volume * cut.centre[2])
    fluid = density * hull.volume / upright(hull, draft).volume
    inertia = density / fluid * float(hull.inertia[axis, axis])
    linear = linear_hull(hull, draft)
    return period(natural_frequency(linear, 3 + int(axis), inertia, stiffness / fluid, added), gravity)


def period(frequency: float, gravity: float) -> float:
    """Period [s] of a frequency [1/sqrt(m)]; inf where no force restores."""
    return 2 * math.pi / (frequency * math.sqrt(gravity)) if frequency > 0 else math.inf
