"""Response amplitude operators: the small motion of a body in a regular wave of unit height, of linear theory.

>>> from sim.floating import Body, Hull
>>> barge = Body(Hull.box(30.0, 10.0, 6.0), density=512.5)
>>> xi = response_amplitude(barge, [0.01], heading=0.0)  # a wave of 600 km
>>> abs(xi[0, 2]).round(3)  # heaves with the water
np.float64(1.0)
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.floating.linear.hydrodynamics import (
    DIRECTIONS,
    LEVEL_MOTIONS,
    LinearHull,
    PlaneForce,
    check_bed,
    check_box,
    check_water_depth,
    lagrange,
    linear_hull,
    plane_force,
)
from sim.floating.motion.body import Body, check_body, check_pose
from sim.floating.statics.equilibrium import Layers, check_layers, density_steps
from sim.floating.statics.righting import about_rest
from sim.floating.statics.stability import is_stable
from sim.numerics.angles import within_half_turn, within_turn
from sim.records import equal_to_itself
from sim.validation import argument_error, as_array, check_kind, check_positive
from sim.water import Water

MAX_TRIM = 1e-3  # [rad] of a body that counts as upright: a hull from a file is never quite symmetric
MAX_MISS = 1e-6  # [rad] from the only heading of a dataset


@equal_to_itself
class LinearForces(NamedTuple):
    """Linear forces of a body about its centre of gravity: (-w^2 (M + A) - i w B + C) xi = X in waves of amplitude 1 m.

    ...: the shape of the frequencies, () for a single one; of X the common shape of frequencies and headings.
    """

    mass: np.ndarray  # M (6, 6) [kg, kg m, kg m2]
    stiffness: np.ndarray  # C (6, 6) [N/m, N, N m], that of the waterline
    added: np.ndarray  # A (..., 6, 6)
    damping: np.ndarray  # B (..., 6, 6)
    excitation: np.ndarray  # X (..., 6) complex [N/m, N]
    centre: tuple[float, float, float]  # [m] of the centre of gravity at rest


def response_amplitude(
    body: Body, frequency: ArrayLike, heading: ArrayLike = 0.0, layers: Layers | None = None, water: Water | None = None
) -> np.ndarray:
    """Motion (..., 6) of the body's centre of gravity at frequencies [rad/s] and headings [rad], in waves of 1 m.

    frequency and heading are numbers or arrays, (...) their common shape: frequencies[:, None] and headings (m,) give
    (n, m, 6).

    Complex: surge, sway, heave [m/m], roll, pitch, yaw [rad/m] along and about the body's axes, x = Re(xi e^(-i w t))
    in the wave cos(k.x - w t), x from the centre of gravity. heading [rad]: where the waves go to, from the body's x.
    It solves (C - w^2 (M + A) - i w B) xi = X (Newman 1977, section 6.20), upright, without drag. water: that of the
    waves, by default sea water of the depth of the hull's dataset, else deep; A and B of a shape are those of deep
    water. layers: what the body floats in, by default this water. A sea has both, as `water` and `layers`.

    C is computed from the hull even if the dataset contains one; A and B are symmetrised. Above the table's frequencies
    A and B are those of its end and X fades. Below them A is that of its first frequency, and X tends to the force of
    long waves, so that the body moves with the water and leans as the wave is steep. In layers the coefficients have
    the mean density of what is displaced, and the interface follows the surface.

    Raises ValueError for a value that is not allowed, a heading or a depth of the water that the hull's dataset does
    not have, and for a body that sinks, has a trim, or is not stable upright.
    """
    f = linear_forces(body, frequency, heading, layers, water)
    w = np.asarray(frequency, dtype=float)[..., None, None]
    D = f.stiffness - w * w * (f.mass + f.added) - 1j * w * f.damping
    # motions without a restoring force in units of 1/w, or their rows would be lost in long waves beside the stiffness
    unit = np.ones((*w.shape[:-2], 6, 1))
    unit[..., LEVEL_MOTIONS, :] = 1.0 / w
    scaled = np.linalg.solve(unit * D * unit.swapaxes(-1, -2), unit * f.excitation[..., None])
    return (unit * scaled)[..., 0]


def linear_forces(
    body: Body, frequency: ArrayLike, heading: ArrayLike = 0.0, layers: Layers | None = None, water: Water | None = None
) -> LinearForces:
    """The terms of the equation that `response_amplitude` solves, with the same arguments and errors."""
    omega = as_array("frequency", frequency, "finite numbers above 0 rad/s")
    if not ((omega > 0.0) & (omega < math.inf)).all():
        raise argument_error("frequency", omega.tolist(), "finite numbers above 0 rad/s")
    headings = as_array("heading", heading, "angles from -2 pi to 2 pi rad")
    if not (np.abs(headings) <= 2.0 * math.pi).all():
        raise argument_error("heading", headings.tolist(), "angles from -2 pi to 2 pi rad")
    try:
        np.broadcast_shapes(omega.shape, headings.shape)
    except ValueError:
        allowed = f"a shape that goes with that of frequency, {omega.shape}"
        raise argument_error("heading", headings.shape, allowed) from None
    if water is not None:
        check_body("body", body)
        check_kind("water", water, Water, "a Water, or None")
        check_water_depth("water", body.hull, water.depth)
    own = upright_body(body, layers, water)
    return LinearForces(
        own.mass, own.stiffness, *own.radiation(omega), own.excitation(omega, headings), own.centre
    )  # fmt: skip


class UprightBody(NamedTuple):
    """A body at rest upright, with its linear coefficients: the terms of `LinearForces`."""

    linear: LinearHull
    planes: list[tuple[float, PlaneForce]]  # steps of the density [kg/m3] from the top, and the force of a plane there
    mass: np.ndarray  # (6, 6) [kg, kg m, kg m2]
    stiffness: np.ndarray  # (6, 6) [N/m, N, N m]
    fluid: float  # [kg/m3] mean density of the displaced fluids
    water: Water  # of the waves
    centre: tuple[float, float, float]  # [m] of the centre of gravity

    def radiation(self, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A and B (..., 6, 6) at frequencies (...) [rad/s]."""
        root = math.sqrt(self.water.gravity)
        at = [self.linear.at(one / root) for one in frequency.ravel()]
        A, B = (np.reshape([one[i] for one in at], (*frequency.shape, 6, 6)) for i in range(2))
        return self.fluid * A, self.fluid * root * B

    def excitation(self, frequency: np.ndarray, heading: np.ndarray) -> np.ndarray:
        """X (..., 6) of the common shape of frequencies [rad/s] and headings [rad].

        It follows from the wavenumber. In other water than that of the coefficients, waves of the same length are
        slower, and so is the vertical acceleration of their water. Raises ValueError for a heading that the hull's
        dataset does not have.
        """
        linear = self.linear
        away = np.abs(within_half_turn(heading - linear.heading)) > MAX_MISS  # False for nan: all headings
        if away.any():
            allowed = f"{linear.heading:g} rad, the only one that the hull's dataset has"
            raise argument_error("heading", float(heading[away].flat[0]), allowed)
        k = self.water.wavenumber(frequency)
        index, weights = lagrange(np.append(DIRECTIONS, 2.0 * math.pi), within_turn(heading))
        beyond, is_long = linear.beyond_long_waves(k.ravel())
        which, _ = np.broadcast_arrays(np.arange(k.size).reshape(k.shape), heading)
        X = np.einsum("...d,...dm->...m", weights, beyond[which[..., None], index % len(DIRECTIONS)])
        kx, ky = k * np.cos(heading), k * np.sin(heading)
        long = linear.long.at(kx, ky, linear.depth)
        X = X + is_long[which][..., None] * long + (linear.long.at(kx, ky, self.water.depth) - long)
        # the pressure under a plane that follows the wave, in each fluid instead of the mean one
        for density_step, plane in [*self.planes, (-self.fluid, linear.plane)]:
            slope = kx[..., None] * plane.slope[0] + ky[..., None] * plane.slope[1]
            X = X + density_step / self.fluid * (plane.rise + 1j * slope)
        return self.fluid * self.water.gravity * X


def upright_body(body: Body, layers: Layers | None, water: Water | None) -> UprightBody:
    """A body at rest in its water; arguments and errors as of `linear_forces`."""
    check_body("body", body)
    check_pose(body)
    known = Water() if water is None else water
    check_positive("water: gravity", known.gravity, "m/s2")
    layers = check_layers(((known.density, math.inf),) if layers is None else layers)
    hull, density = body.loaded()
    draft = body.draft(layers)
    _, rest = about_rest(body, layers)
    if not is_stable(hull, rest):
        raise argument_error("body", f"GM = {rest.least_height:.3g} m", "a body that is stable upright: GM above 0")
    if rest.tilt > MAX_TRIM:
        raise argument_error("center_of_gravity", body.center_of_gravity, "one over the centre of buoyancy")
    planes = [(change, plane_force(hull, draft - top)) for change, top in density_steps(layers) if draft > top]
    check_box("body", hull, draft)
    linear, C = linear_hull(hull, draft), np.zeros((6, 6))
    water = dataclasses.replace(known, depth=linear.depth) if water is None else water
    check_bed("water", hull, draft, water.depth)
    for change, plane in planes:  # water that is higher towards +y, or +x, is a hull that leans there
        forces = np.stack([plane.rise, plane.slope[1], -plane.slope[0]], axis=1)
        C[2:5, 2:5] += water.gravity * change * forces[2:5]
    mass = density * np.block([[hull.volume * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), hull.inertia]])
    centre = (float(body.position[0]), float(body.position[1]), -draft - float(hull.extents[2, 0]))
    return UprightBody(linear, planes, mass, C, density * hull.volume / linear.volume, water, centre)
