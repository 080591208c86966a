"""A hull as a `MooredBody`, by linear theory: added mass and damping of one frequency, waves by the table."""

from typing import TYPE_CHECKING

import numpy as np

from sim import floating
from sim.floating.linear.hydrodynamics import check_water_depth, not_negative
from sim.floating.linear.response import upright_body
from sim.mooring.parts import MooredBody
from sim.validation import argument_error, check_positive
from sim.water import Water

if TYPE_CHECKING:
    from sim.waves import Waves

HELD = 1e-6  # of the stiffness of heave, for surge and sway, and of roll, for yaw: statics need a place without lines


def moored(
    id: int, body: floating.Body, frequency: float, waves: "Waves | None" = None, water: Water | None = None
) -> MooredBody:
    """The body at its rest position without lines, upright in water, its axes along x and y.

    frequency: [rad/s] of the added mass and the radiation damping, which are taken as constant; that of the highest
    waves is a good one. waves: those of the system, which push it by `linear_forces` of `sim.floating` [N, N m], by
    their length in their water. water: that of the waves by default, else sea water of the depth of the hull's dataset.
    Added mass and damping of a shape are those of deep water.

    Raises ValueError as `response_amplitude` does, for a hull with a dataset of another water, and for other waves.
    """
    if water is not None:
        check_water_depth("water", body.hull, water.depth)
    if waves is not None:
        check_water_depth("waves", body.hull, waves.water.depth)
        if water is not None and not waves.water.is_same(water):
            raise argument_error("waves", f"waves on {waves.water}", f"those on the body's {water}")
    body_water = waves.water if water is None and waves is not None else water
    own = upright_body(body, None, body_water)
    C = own.stiffness.copy()
    for e, of in ((0, 2), (1, 2), (5, 3)):
        C[e, e] += HELD * C[of, of]
    X = None if waves is None else own.excitation(waves.omega, np.arctan2(waves.ky, waves.kx))
    added, damping = own.radiation(np.array([check_positive("frequency", frequency, "rad/s")]))
    A, B = 0.5 * (added[0] + added[0].T), not_negative(damping)[0]
    return MooredBody(id, own.centre, own.mass + A, 0.5 * (C + C.T), B, X)
