"""The record of a body shape."""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

from sim.floating.hulls.closed_mesh import ClosedMesh
from sim.floating.linear.linear_table import LinearTable
from sim.validation import check_choice

COLLISION_FORMS = ("ellipsoid", "box", "cylinder")
Color = tuple[int, int, int]


class Immersed(NamedTuple):
    """The part of an upright shape up to a height above its lowest point, in closed form."""

    volume: float  # [m3]
    centroid: float  # [m] of that volume above the lowest point
    area: float  # [m2] of the horizontal cut at that height
    second: tuple[float, float]  # [m4] int x^2 and int y^2 over the cut, about the vertical axis


class Appearance(NamedTuple):
    """One way to draw a shape. A shape with several appears as several kinds of body."""

    name: str  # no other appearance has it; lower case, with underscores
    title: str  # in tables
    model: str = ""  # GLB file in the assets without its ending, made for size 1; "": the hull's own mesh is drawn
    color: Color = (64, 132, 186)  # sRGB, of a hull without a model


@dataclasses.dataclass(frozen=True)
class Shape:
    """A shape of floating bodies. Raises ValueError for a collision form that does not exist.

    Only the first three fields are needed: the rest is computed from the mesh by default.
    """

    name: str
    build: Callable[..., ClosedMesh]  # takes the `lengths` [m]; raises ValueError for lengths that are not allowed
    lengths: tuple[float, ...]  # [m] at size 1, as bodies of a scene have them
    appearances: tuple[Appearance, ...] = ()  # () for one that is named as the shape, and has no model
    order: int = 100  # place in a scene's list of kinds of body; equal ones are sorted by name
    # the table of linear coefficients in sim/floating/tables that its wet part has; "": that of an equal box
    linear: str = ""
    table: LinearTable | None = None  # linear coefficients of a hull from a file
    # the part of the upright hull up to a height [m] from 0 to its own; None: exact integrals over the mesh
    immersed: Callable[[ClosedMesh, float], Immersed] | None = None
    collision: str = "ellipsoid"  # the form, of the same extents, that other bodies collide with
    is_round: bool = False  # a sphere: its lowest point is below its centre in every pose

    def __post_init__(self) -> None:
        check_choice("collision", self.collision, COLLISION_FORMS)
        if not self.appearances:
            title = self.name.replace("_", " ").capitalize()
            object.__setattr__(self, "appearances", (Appearance(self.name, title),))
