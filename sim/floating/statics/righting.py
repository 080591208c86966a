"""GM and GZ of a body: its metacentric heights, and the arms that right it at any heel.

    >>> from sim.floating import Body, Hull
    >>> barge = Body(Hull.box(60.0, 16.0, 6.0), mass=2.952e6, center_of_gravity=(0.0, 0.0, 1.0))
    >>> round(metacentric_height(barge), 4)  # KB + BM - KG = 1.5 + 16^2/(12 x 3) - 4
    4.6111
    >>> righting_arm(barge, [0.0, 0.1]).round(4)
    array([0.    , 0.4639])

Heel is about x, and trim stays as it is at rest. Layers stay level.
"""

import math
import warnings

import numpy as np
from numpy.typing import ArrayLike

from sim.floating.motion.body import Body
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers
from sim.floating.statics.stability import Balance, Loaded, arms_of, is_stable, near_upright, rest_of
from sim.validation import argument_error, as_array, check_kind, is_whole_number


def metacentric_height(body: Body, layers: Layers = SEA_WATER, axis: int = 0) -> float:
    """GM [m] of the body at rest: transverse, for heel about x, or longitudinal with axis 1.

    The rise of the righting arm per radian. Of one fluid it is KB + I/V - KG (Newman 1977, section 6.16). A body that
    is not stable upright has its GM there, which is negative about one axis at least. Raises ValueError as
    `Body.afloat`, or for another axis.
    """
    if not is_whole_number(axis) or axis not in (0, 1):
        raise argument_error("axis", axis, "0 (heel) or 1 (trim)")
    _, rest = about_rest(body, layers)
    return float(rest.restoring[axis, axis])


def righting_arm(body: Body, heel: ArrayLike, layers: Layers = SEA_WATER) -> np.ndarray:
    """GZ [m] at angles of heel [rad] from rest, of the same shape: from the centre of gravity to the line of buoyancy.

    Positive where it rights the body. At each angle the weight of the displaced fluids is that of the body. The heel of
    a body that is not stable upright is from there, and a UserWarning gives its GM. Raises ValueError for an angle that
    is not within half a turn, and as `Body.afloat`.
    """
    allowed = "angles from -pi to pi rad"
    angles = as_array("heel", heel, allowed)
    bad = ~(np.abs(angles) <= math.pi)
    if bad.any():
        raise argument_error("heel", float(angles[bad].flat[0]), allowed)
    afloat, rest = about_rest(body, layers)
    if not is_stable(afloat.hull, rest):
        words = f"GM = {rest.least_height:.3g} m: the body is not stable upright, and the heel is from there"
        warnings.warn(words, UserWarning, stacklevel=2)
    return arms_of(afloat, rest, angles.ravel(), 0).reshape(angles.shape)


def about_rest(body: Body, layers: Layers) -> tuple[Loaded, Balance]:
    """The body, and the balance about which it heels: near upright if there is one, else where it is at rest."""
    check_kind("body", body, Body, "a Body")
    body.draft(layers)
    loaded = Loaded(*body.loaded(), check_layers(layers))
    return loaded, near_upright(loaded) or rest_of(loaded)
