"""Start of a cloth: hanging in pleats, horizontal, or from a pole."""

import dataclasses

import numpy as np

from app.messages import Vector
from app.scenes.cloth.parameters import ClothParams
from sim.springs import Air, Contact, Net, cloth
from sim.springs.cloth import pleated_cloth, vertical_cloth

CONTACT_DISTANCE = 0.012  # [m] between the cloth and sphere or floor, so that it is drawn outside them


def corner(params: ClothParams) -> Vector:
    """Initial position of particle (0, 0) [m]."""
    if params.start == "flag":
        return -0.9, 0.0, 2.1
    if params.start == "hanging":
        return -0.5 * params.width * params.gather, 0.0, 2.1
    return -0.5 * params.width, -0.5 * params.length, 1.5


def sphere_home(params: ClothParams) -> Vector:
    """Initial position of the sphere [m]: under a level cloth, in front of a hanging one."""
    if params.start == "level":
        below = 0.15 if params.bob > 0.0 else CONTACT_DISTANCE + 0.15
        return 0.0, 0.0, max(1.5 - params.sphere_radius - below, params.sphere_radius)
    return 0.0, -params.sphere_radius - 0.5, 1.2


def build(params: ClothParams, sphere: Vector, *, of_tasks: bool = False) -> Net:
    """The net that the parameters describe, at its start. sphere: centre [m].

    of_tasks: only points touch the sphere, as in the tasks' functions.
    """
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
        contact=Contact(params.contact_stiffness, params.contact_damping, params.friction, links=not of_tasks),
        radius=CONTACT_DISTANCE,
        law=params.law,
        air=Air(density=params.air) if params.air > 0.0 else None,
        thickness=params.thickness,
    )
    if params.start == "hanging":
        return pleated_cloth(vertical_cloth(net), params.gather)
    if params.start == "flag":
        # Rows along the wind, columns down the pole, and a small wave out of plane: no real flag starts exactly flat.
        x, y, z = net.x0
        along, down = y - y[0, 0], x - x[0, 0]
        wave = 0.01 * np.sin(7.0 * along) * along
        return dataclasses.replace(net, x0=np.ascontiguousarray(np.stack([x[0, 0] + along, wave, z - down])))
    return net
