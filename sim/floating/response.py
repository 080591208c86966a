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

from sim.floating.body import Body, check_body
from sim.floating.equilibrium import SEA_WATER, Layers, check_layers, density_steps, equilibrium_draft
from sim.floating.excitation import HullExcitation, plane_force
from sim.floating.hydrodynamics import DIRECTIONS, lagrange, linear_hull
from sim.validation import argument_error, as_array, check_angle, check_positive


class LinearForces(NamedTuple):
    """Of a body about its centre of gravity: (-w^2 (M + A) - i w B + C) xi = X in waves of amplitude 1 m."""

    mass: np.ndarray  # M (6, 6) [kg, kg m, kg m2]
    stiffness: np.ndarray  # C (6, 6) [N/m, N, N m], that of the waterline
    added: np.ndarray  # A (n, 6, 6)
    damping: np.ndarray  # B (n, 6, 6)
    excitation: np.ndarray  # X (n, 6) complex [N/m, N]
    centre: tuple[float, float, float]  # [m] of the centre of gravity at rest


def response_amplitude(
    body: Body, frequency: ArrayLike, heading: float = 0.0, layers: Layers = SEA_WATER, gravity: float = 9.81
) -> np.ndarray:
    """Motion (n, 6) of the body's centre of gravity at frequencies (n,) [rad/s], for waves of amplitude 1 m.

    Complex: surge, sway, heave [m/m], roll, pitch, yaw [rad/m] along and about the body's axes, x = Re(xi e^(-i w t))
    in the wave cos(k.x - w t), x from the centre of gravity. heading [rad]: where the waves go to, from the body's x.
    It solves (C - w^2 (M + A) - i w B) xi = X (Newman 1977, section 6.20), upright, on deep water, without drag. Beyond
    the table's frequencies A and B are those of its end and X fades; far below them roll and pitch are rough. In layers
    the coefficients have the mean density of what is displaced, and the interface follows the surface.

    Raises ValueError for a value that is not allowed, a body that sinks, or one with a trim.
    """
    f = linear_forces(body, frequency, heading, layers, gravity)
    w = np.asarray(frequency, dtype=float)[:, None, None]
    D = f.stiffness - w * w * (f.mass + f.added) - 1j * w * f.damping
    return np.linalg.solve(D, f.excitation[..., None])[..., 0]


def linear_forces(
    body: Body, frequency: ArrayLike, heading: float = 0.0, layers: Layers = SEA_WATER, gravity: float = 9.81
) -> LinearForces:
    """The terms of the equation that `response_amplitude` solves, with the same arguments and errors."""
    check_body("body", body)
    w = as_array("frequency", frequency, "finite numbers above 0 rad/s, shape (n,)")
    if w.ndim != 1 or not ((w > 0.0) & (w < math.inf)).all():
        raise argument_error("frequency", w.tolist(), "finite numbers above 0 rad/s, shape (n,)")
    heading, gravity = check_angle("heading", heading), check_positive("gravity", gravity, "m/s2")
    layers = check_layers(layers)
    hull, density = body.loaded()
    rest = body._replace(rotation=(1.0, 0.0, 0.0, 0.0)).afloat(layers)
    if rest.rotation != (1.0, 0.0, 0.0, 0.0):
        raise argument_error("center_of_gravity", body.center_of_gravity, "one over the centre of buoyancy")
    draft = equilibrium_draft(hull, density, layers)
    planes = [(change, plane_force(hull, draft - top)) for change, top in density_steps(layers) if draft > top]
    linear, C = linear_hull(hull, draft), np.zeros((6, 6))
    for change, plane in planes:  # water that is higher towards +y, or +x, is a hull that leans there
        forces = np.stack([plane.rise, plane.slope[1], -plane.slope[0]], axis=1)
        C[2:5, 2:5] += gravity * change * forces[2:5]
    fluid = density * hull.volume / linear.volume  # [kg/m3] mean density of the displaced fluids
    mass = density * np.block([[hull.volume * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), hull.inertia]])
    index, weights = lagrange(np.append(DIRECTIONS, 2.0 * math.pi), heading % (2.0 * math.pi))
    k = w**2 / gravity
    tables = HullExcitation(hull, linear, 0.0).tabulate(k)
    X = fluid * np.einsum("d,ndm->nm", weights, tables[:, index % len(DIRECTIONS)])
    # the pressure under a plane that follows the wave, in each fluid instead of the mean one
    for density_step, plane in [*planes, (-fluid, planes[0][1])]:
        slope = math.cos(heading) * plane.slope[0] + math.sin(heading) * plane.slope[1]
        X += density_step * (plane.rise + 1j * k[:, None] * slope)
    root = math.sqrt(gravity)
    added, damping = (fluid * np.array(part) for part in zip(*(linear.at(one / root) for one in w), strict=True))
    return LinearForces(mass, C, added, root * damping, gravity * X, rest.position)
