"""A hull as a `MooredBody`, by linear theory: added mass and damping of one frequency, waves by the table."""

import math
from typing import TYPE_CHECKING

import numpy as np

from sim import floating
from sim.floating.linear.hydrodynamics import check_water_depth, not_negative
from sim.floating.linear.response import linear_forces
from sim.mooring.parts import MooredBody
from sim.validation import argument_error
from sim.water import Water

if TYPE_CHECKING:
    from sim.waves import Waves

HELD = 1e-6  # of the stiffness of heave, for surge and sway, and of roll, for yaw: statics need a place without lines


def moored(
    id: int, body: floating.Body, frequency: float, waves: "Waves | None" = None, water: Water | None = None
) -> MooredBody:
    """The body at its rest position without lines, upright in water, its axes along x and y.

    frequency: [rad/s] of the added mass and the radiation damping, which are taken as constant; that of the highest
    waves is a good one. waves: those of the system, which push it by `linear_forces` of `sim.floating` [N, N m].
    water: that of the waves by default, else sea water of the depth of the hull's dataset. Coefficients are those of
    deep water, or of the dataset's.

    Raises ValueError as `response_amplitude` does, for a hull with a dataset of another water, and for other waves.
    """
    if water is not None:
        check_water_depth("water", body.hull, water.depth)
    if waves is not None:
        check_water_depth("waves", body.hull, waves.water.depth)
        if water is not None and not waves.water.is_same(water):
            raise argument_error("waves", f"waves on {waves.water}", f"those on the body's {water}")
    water = water or (Water() if waves is None else waves.water)
    layers, gravity = ((water.density, math.inf),), water.gravity
    table = body.hull.shape.table
    heading = 0.0 if table is None or math.isnan(table.heading) else table.heading  # whichever: only X depends on it
    own = linear_forces(body, [frequency], heading, layers, gravity)
    C = own.stiffness.copy()
    for e, of in ((0, 2), (1, 2), (5, 3)):
        C[e, e] += HELD * C[of, of]
    X = None if waves is None else excitation(body, waves)
    A, B = 0.5 * (own.added[0] + own.added[0].T), not_negative(own.damping)[0]
    return MooredBody(id, own.centre, own.mass + A, 0.5 * (C + C.T), B, X)


def excitation(body: floating.Body, waves: "Waves") -> np.ndarray:
    """Force and moment (waves, 6) by each wave of amplitude 1 m, a Re(X exp(i theta)) at the body."""
    found = np.zeros((len(waves.omega), 6), complex)
    headings, layers = np.arctan2(waves.ky, waves.kx), ((waves.water.density, math.inf),)
    for heading in np.unique(headings):
        some = headings == heading
        own = linear_forces(body, waves.omega[some], float(heading), layers, waves.water.gravity)
        found[some] = own.excitation
    return found
