"""Response amplitude operators: the small motion of a body in a regular wave of unit height, of linear theory.

>>> from sim.floating import Body, Hull
>>> barge = Body(Hull.box(30.0, 10.0, 6.0), density=512.5)
>>> xi = response_amplitude(barge, [0.01], heading=0.0)  # a wave of 600 km
>>> abs(xi[0, 2]).round(3)  # heaves with the water
np.float64(1.0)
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.floating.linear.hydrodynamics import (
    DIRECTIONS,
    LEVEL_MOTIONS,
    check_water_density,
    lagrange,
    linear_hull,
    plane_force,
)
from sim.floating.motion.body import Body, check_body, check_pose
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers, density_steps
from sim.floating.statics.righting import about_rest
from sim.floating.statics.stability import is_stable
from sim.numerics.angles import within_half_turn, within_turn
from sim.validation import argument_error, as_array, check_angle, check_positive
from sim.water import EARTH_GRAVITY

MAX_TRIM = 1e-3  # [rad] of a body that counts as upright: a hull from a file is never quite symmetric
MAX_MISS = 1e-6  # [rad] from the only heading of a dataset


class LinearForces(NamedTuple):
    """Linear forces of a body about its centre of gravity: (-w^2 (M + A) - i w B + C) xi = X in waves of amplitude 1 m.

    ...: the shape of the frequencies, () for a single one.
    """

    mass: np.ndarray  # M (6, 6) [kg, kg m, kg m2]
    stiffness: np.ndarray  # C (6, 6) [N/m, N, N m], that of the waterline
    added: np.ndarray  # A (..., 6, 6)
    damping: np.ndarray  # B (..., 6, 6)
    excitation: np.ndarray  # X (..., 6) complex [N/m, N]
    centre: tuple[float, float, float]  # [m] of the centre of gravity at rest


def response_amplitude(
    body: Body, frequency: ArrayLike, heading: float = 0.0, layers: Layers = SEA_WATER, gravity: float = EARTH_GRAVITY
) -> np.ndarray:
    """Motion (..., 6) of the body's centre of gravity at frequencies (...) [rad/s], for waves of amplitude 1 m.

    Complex: surge, sway, heave [m/m], roll, pitch, yaw [rad/m] along and about the body's axes, x = Re(xi e^(-i w t))
    in the wave cos(k.x - w t), x from the centre of gravity. heading [rad]: where the waves go to, from the body's x.
    It solves (C - w^2 (M + A) - i w B) xi = X (Newman 1977, section 6.20), upright, without drag, on deep water, or
    that of the hull's dataset. C is computed from the hull even if the dataset contains one; A and B are symmetrised.
    Above the table's frequencies A and B are those of its end and X fades. Below them A is that of its first frequency,
    and X tends to the force of long waves, so that the body moves with the water and leans as the wave is steep. In
    layers the coefficients have the mean density of what is displaced, and the interface follows the surface.

    Raises ValueError for a value that is not allowed, a heading or a density of the water that the hull's dataset does
    not have, and for a body that sinks, has a trim, or is not stable upright.
    """
    f = linear_forces(body, frequency, heading, layers, gravity)
    w = np.asarray(frequency, dtype=float)[..., None, None]
    D = f.stiffness - w * w * (f.mass + f.added) - 1j * w * f.damping
    # motions without a restoring force in units of 1/w, or their rows would be lost in long waves beside the stiffness
    unit = np.ones((*w.shape[:-2], 6, 1))
    unit[..., LEVEL_MOTIONS, :] = 1.0 / w
    scaled = np.linalg.solve(unit * D * unit.swapaxes(-1, -2), unit * f.excitation[..., None])
    return (unit * scaled)[..., 0]


def linear_forces(
    body: Body, frequency: ArrayLike, heading: float = 0.0, layers: Layers = SEA_WATER, gravity: float = EARTH_GRAVITY
) -> LinearForces:
    """The terms of the equation that `response_amplitude` solves, with the same arguments and errors."""
    check_body("body", body)
    check_pose(body)
    given = as_array("frequency", frequency, "finite numbers above 0 rad/s")
    if not ((given > 0.0) & (given < math.inf)).all():
        raise argument_error("frequency", given.tolist(), "finite numbers above 0 rad/s")
    w = given.ravel()
    heading, gravity = check_angle("heading", heading), check_positive("gravity", gravity, "m/s2")
    layers = check_layers(layers)
    hull, density = body.loaded()
    check_water_density(hull, layers)
    draft = body.draft(layers)
    _, rest = about_rest(body, layers)
    if not is_stable(hull, rest):
        raise argument_error("body", f"GM = {rest.least_height:.3g} m", "a body that is stable upright: GM above 0")
    if rest.tilt > MAX_TRIM:
        raise argument_error("center_of_gravity", body.center_of_gravity, "one over the centre of buoyancy")
    planes = [(change, plane_force(hull, draft - top)) for change, top in density_steps(layers) if draft > top]
    linear, C = linear_hull(hull, draft), np.zeros((6, 6))
    for change, plane in planes:  # water that is higher towards +y, or +x, is a hull that leans there
        forces = np.stack([plane.rise, plane.slope[1], -plane.slope[0]], axis=1)
        C[2:5, 2:5] += gravity * change * forces[2:5]
    fluid = density * hull.volume / linear.volume  # [kg/m3] mean density of the displaced fluids
    mass = density * np.block([[hull.volume * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), hull.inertia]])
    if abs(within_half_turn(heading - linear.heading)) > MAX_MISS:  # False for nan: all headings
        raise argument_error("heading", heading, f"{linear.heading:g} rad, the only one that the hull's dataset has")
    index, weights = lagrange(np.append(DIRECTIONS, 2.0 * math.pi), float(within_turn(heading)))
    k = linear.wavenumber(w / math.sqrt(gravity))
    beyond, is_long = linear.beyond_long_waves(k)
    X = np.einsum("d,ndm->nm", weights, beyond[:, index % len(DIRECTIONS)])
    X = fluid * (X + is_long[:, None] * linear.long.at(k * math.cos(heading), k * math.sin(heading), linear.depth))
    # the pressure under a plane that follows the wave, in each fluid instead of the mean one
    for density_step, plane in [*planes, (-fluid, linear.plane)]:
        slope = math.cos(heading) * plane.slope[0] + math.sin(heading) * plane.slope[1]
        X += density_step * (plane.rise + 1j * k[:, None] * slope)
    root = math.sqrt(gravity)
    centre = (float(body.position[0]), float(body.position[1]), -draft - float(hull.extents[2, 0]))
    at = [linear.at(one / root) for one in w]
    added, damping = (fluid * np.reshape([one[i] for one in at], (*given.shape, 6, 6)) for i in range(2))
    return LinearForces(mass, C, added, root * damping, gravity * X.reshape(*given.shape, 6), centre)
