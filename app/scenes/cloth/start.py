"""How a cloth starts: hanging in pleats, level, or off a pole; and its grid changed under way."""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.cloth.parameters import Params
from sim.springs import Air, Contact, Net, cloth
from sim.springs.cloth import vertical_cloth

SKIN = 0.012  # [m] that the cloth keeps from sphere and floor, so that it is drawn outside them
PLEATS = 4


def corner(params: Params) -> Vector:
    """Where particle (0, 0) starts [m]."""
    if params.start == "flag":
        return -0.9, 0.0, 2.1
    if params.start == "hanging":
        return -0.5 * params.width * params.gather, 0.0, 2.1
    return -0.5 * params.width, -0.5 * params.length, 1.5


def sphere_home(params: Params) -> Vector:
    """Where the sphere starts: under a level cloth, before a hanging one."""
    if params.start == "level":
        below = 0.15 if params.bob > 0.0 else SKIN + 0.15
        return 0.0, 0.0, max(1.5 - params.sphere_radius - below, params.sphere_radius)
    return 0.0, -params.sphere_radius - 0.5, 1.2


def build(params: Params, sphere: Vector) -> Net:
    """The net that the parameters describe, as it starts."""
    net = cloth(
        params.rows,
        params.cols,
        params.width,
        params.length,
        params.density,
        params.stiffness,
        params.shear,
        params.bend,
        params.damping,
        gravity=params.gravity,
        origin=corner(params),
        pinned=params.pinned,
        floor=0.0 if params.floor else None,
        sphere=(*sphere, params.sphere_radius) if params.sphere else None,
        contact=Contact(params.contact_stiffness, params.contact_damping, params.friction),
        radius=SKIN,
        air=Air(density=params.air) if params.air > 0.0 else None,
        thickness=params.thickness,
    )
    if params.start == "hanging":
        return pleated(vertical_cloth(net), params.gather)
    if params.start == "flag":
        # Rows along the wind, columns down the pole, and a breath out of plane, as nothing flies quite straight.
        x, y, z = net.x0
        along, down = y - y[0, 0], x - x[0, 0]
        wave = 0.01 * np.sin(7.0 * along) * along
        return dataclasses.replace(net, x0=np.ascontiguousarray(np.stack([x[0, 0] + along, wave, z - down])))
    return net


def pleated(net: Net, gather: float) -> Net:
    """A hanging cloth on `gather` of its width, in waves as long as its width at rest."""
    x, y, z = net.x0
    width = float(x[0, -1] - x[0, 0])
    s = np.linspace(0.0, gather * width, 2001)
    phase = 2.0 * math.pi * PLEATS * s / s[-1]
    low, high, depth, along = 0.0, width, 0.0, s
    for _ in range(50):
        depth = 0.5 * (low + high)
        along = np.concatenate([[0.0], np.hypot(np.diff(s), np.diff(depth * np.sin(phase))).cumsum()])
        low, high = (depth, high) if along[-1] < width else (low, depth)
    # Particles at equal lengths along the wave
    at = np.interp(np.linspace(0.0, along[-1], x.shape[1]), along, s)
    out = depth * np.sin(2.0 * math.pi * PLEATS * at / s[-1])
    return dataclasses.replace(net, x0=np.ascontiguousarray(np.stack([x[0, 0] + at + 0.0 * y, y + out, z])))


def resample(values: NDArray[np.float64], rows: int, cols: int) -> NDArray[np.float64]:
    """(3, r, c) over the cloth, with other numbers of particles."""
    r, c = (np.linspace(0.0, 1.0, count) for count in values.shape[1:])
    i, j = np.linspace(0.0, 1.0, rows), np.linspace(0.0, 1.0, cols)
    across = np.array([[np.interp(j, c, row) for row in part] for part in values])
    return np.ascontiguousarray(
        np.moveaxis(np.array([[np.interp(i, r, col) for col in part.T] for part in across]), 1, 2)
    )
