"""Bodies: the description of each, and the arrays in which many of them move.

`Body` describes one body and where it starts; `make_fleet` packs many into a `Fleet` with state arrays that `step`
(motion.py) advances in place. A hull used by several bodies is packed once.

    >>> barge = Body(Hull.box(60.0, 16.0, 6.0), mass=2.952e6, center_of_gravity=(0.0, 0.0, 1.0))
    >>> round(barge.afloat().position[2], 6)  # the centre of gravity 4 m over the keel, the keel 3 m deep
    1.0
"""

import dataclasses
import functools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim.floating.hulls.closed_mesh import area_vectors, check_hull
from sim.floating.hulls.hull import Hull
from sim.floating.linear.hydrodynamics import POLES, afloat
from sim.floating.motion.rotation import rotation_matrix
from sim.floating.shapes.record import COLLISION_FORMS
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers, equilibrium_draft
from sim.floating.statics.stability import UPRIGHT, Loaded, rest_of, with_heading
from sim.records import equal_to_itself
from sim.validation import (
    argument_error,
    as_array,
    check_kind,
    check_number,
    check_positive,
    check_vector,
    is_whole_number,
)

UNIFORM_DENSITY = 500.0  # [kg/m3] of a body that is given neither density nor mass


@equal_to_itself
class Body(NamedTuple):
    """A body and how it starts, of uniform density, 500 kg/m3 where neither it nor a mass is given.

    A mass may come with a centre of gravity and an inertia.
    """

    hull: Hull
    density: float | None = None  # [kg/m3], uniform; None: 500, or by the mass
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m] of the centre of mass
    rotation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)  # quaternion (w, x, y, z) from body to world
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m/s]
    spin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [rad/s] in world axes
    mass: float | None = None  # [kg], in place of the density
    # [m] in the coordinates that the hull was given in: those of a file, or from the middle of a box; None: its middle
    center_of_gravity: tuple[float, float, float] | None = None
    inertia: np.ndarray | Sequence[float] | None = None  # (3,) or (3, 3) [kg m2] about it; None: as if uniform

    def loaded(self) -> tuple[Hull, float]:
        """The hull about the centre of gravity, with the inertia at unit density, and the mean density [kg/m3].

        Bodies of the same hull and load share one. Raises ValueError for a load that is not allowed.
        """
        check_hull("hull", self.hull)
        if self.mass is None:
            density = UNIFORM_DENSITY if self.density is None else check_positive("density", self.density, "kg/m3")
        elif self.density is not None:
            raise argument_error("density", self.density, "None if a mass is given")
        else:
            density = check_positive("mass", self.mass, "kg") / self.hull.volume
        if self.center_of_gravity is None and self.inertia is None:
            return self.hull, density
        at = self.hull.centre if self.center_of_gravity is None else self.center_of_gravity
        centre = check_vector("center_of_gravity", at, "m")
        inertia = density * self.hull.inertia if self.inertia is None else checked_inertia(self.inertia)
        return loaded_hull(self.hull, centre, (inertia / density).tobytes()), density

    def draft(self, layers: Layers = SEA_WATER) -> float:
        """Depth [m] of its lowest point below the surface, upright. Raises ValueError for a body that sinks."""
        hull, density = self.loaded()
        draft = equilibrium_draft(hull, density, layers)
        if math.isinf(draft):
            deepest = check_layers(layers)[-1][0]
            if self.mass is not None:
                raise argument_error("mass", self.mass, f"at most {deepest * hull.volume:g} kg, or it sinks")
            raise argument_error("density", density, f"at most {deepest:g} kg/m3, or it sinks")
        return draft

    def afloat(self, layers: Layers = SEA_WATER) -> "Body":
        """The body at rest in these fluids, the surface at z = 0: upright where no arm turns it, or with its trim.

        Its x, y and heading stay. A body that is not stable upright leans as far as it turns over. Raises ValueError
        for a body that sinks, and for one that finds no stable rest within 60 degrees, with its GM. Raises
        ConvergenceError if the search for rest does not end.
        """
        check_pose(self)
        draft = self.draft(layers)
        hull, density = self.loaded()
        rest = rest_of(Loaded(hull, density, check_layers(layers)))
        x, y, _ = self.position
        return self._replace(
            # the closed form where the shape is round, and its mesh is not quite
            position=(x, y, -draft - float(hull.extents[2, 0]) if rest.rotation == UPRIGHT else rest.height),
            rotation=with_heading(rest.rotation, self.rotation),
            velocity=(0.0, 0.0, 0.0),
            spin=(0.0, 0.0, 0.0),
        )


def check_body(name: str, body: object) -> None:
    """Raises ValueError if it is not a body."""
    check_kind(name, body, Body, "a Body")


def check_fleet(fleet: object) -> None:
    """Raises ValueError if it is not a fleet."""
    check_kind("fleet", fleet, Fleet, "a Fleet, as `make_fleet` makes it")


def check_pose(body: Body) -> None:
    """Raises ValueError for a start that is not finite, or a rotation of 0."""
    for name, length in (("position", 3), ("rotation", 4), ("velocity", 3), ("spin", 3)):
        value = as_array(name, getattr(body, name), f"{length} finite numbers")
        if value.shape != (length,) or not np.isfinite(value).all():
            raise argument_error(name, getattr(body, name), f"{length} finite numbers")
    if not np.linalg.norm(body.rotation) > 0:
        raise argument_error("rotation", body.rotation, "a quaternion that is not zero")


def checked_inertia(inertia: object) -> np.ndarray:
    """The inertia (3, 3) [kg m2] of a matrix, or of the moments about three axes. Raises ValueError for another."""
    allowed = "(3,) moments or a symmetric (3, 3) matrix [kg m2], all above 0, none above the sum of the other two"
    array = as_array("inertia", inertia, allowed)
    matrix = np.diag(array) if array.shape == (3,) else array
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or not np.allclose(matrix, matrix.T):
        raise argument_error("inertia", inertia, allowed)
    moments = np.linalg.eigvalsh(matrix)
    if not (moments[0] > 0.0 and 2.0 * moments[2] <= (1.0 + 1e-9) * moments.sum()):
        raise argument_error("inertia", inertia, allowed)
    return matrix


@functools.lru_cache(maxsize=256)
def loaded_hull(hull: Hull, centre: tuple[float, float, float], inertia: bytes) -> Hull:
    """The hull with vertices relative to another centre [m], and an inertia (3, 3) [m5] at unit density."""
    shift = np.array(centre) - hull.centre
    level = np.abs(shift[:2]).max() < 1e-12 * hull.size.max()
    shape = dataclasses.replace(hull.shape, immersed=hull.shape.immersed if level else None, is_round=False)
    return dataclasses.replace(
        hull,
        vertices=hull.vertices - shift,
        extents=hull.extents - shift[:, None],
        centre=np.array(centre),
        inertia=np.frombuffer(inertia).reshape(3, 3),
        shape=shape,
        axis=(hull.axis[0] - float(shift[0]), hull.axis[1] - float(shift[1])),
    )


class PackedHulls(NamedTuple):
    """q hulls, one after another. Vertices and faces of hull i are columns start[i] to start[i + 1]."""

    vertex_start: np.ndarray  # (q + 1,) int
    face_start: np.ndarray  # (q + 1,) int
    x: np.ndarray  # (3, vertices) [m]
    faces: np.ndarray  # (3, faces) int, columns of x
    area: np.ndarray  # (3, faces) [m2] outward
    collision: np.ndarray  # (q,) int, index in COLLISION_FORMS
    is_round: np.ndarray  # (q,) bool: a sphere
    half: np.ndarray  # (q, 3) [m] half extents of the true shape
    radius: np.ndarray  # (q,) [m] of the sphere about the centre of mass that holds the mesh
    inertia: np.ndarray  # (q, 3, 3) [m5] at unit density
    inverse_inertia: np.ndarray  # (q, 3, 3) [1/m5] its inverse
    waterplane_bound: np.ndarray  # (q,) [m2] of the area of any level cut
    radius_of_gyration: np.ndarray  # (q, 3) [m] of the surface: root mean square of x_i over it
    restoring_bound: np.ndarray  # (q, 3) [m4] bound of the moment about an axis per angle, over weight density


class PackedLinear(NamedTuple):
    """Linear coefficients of s hulls at their drafts, at unit density and gravity: see hydrodynamics.py."""

    added_factor: np.ndarray  # (s, 6, 6) lower Cholesky factor of the added mass at infinite frequency
    poles: np.ndarray  # (s, p) complex
    coupled: np.ndarray  # (s, 36, 2) int: motions c, d that the memory couples, the first coupled_count[s] of them
    coupled_count: np.ndarray  # (s,) int
    residues: np.ndarray  # (s, 36, p) complex, of these
    wet_area: np.ndarray  # (s, 3) [m2] wet at rest across each axis
    added_bound: np.ndarray  # (s, 6) added mass along and about each axis that any coupling leaves
    decay_length: np.ndarray  # (s,) [m] of depth over which a body under water ceases to make waves


@equal_to_itself
class Fleet(NamedTuple):
    """n bodies. `step` changes the first nine arrays, `pull` the next three; the rest is fixed."""

    position: np.ndarray  # (n, 3) [m]
    rotation: np.ndarray  # (n, 4) quaternion (w, x, y, z)
    velocity: np.ndarray  # (n, 3) [m/s]
    spin: np.ndarray  # (n, 3) [rad/s] in world axes
    # (n, 6) [kg/m3] fluid density times the wet fraction of each motion, in the axes of the heading, at the last step;
    # -1 before the first
    carried: np.ndarray
    buoyancy: np.ndarray  # (n,) [N] weight of the displaced fluids at the last step
    # (n, 4) [N] upward, mean over the last step: buoyancy, waves, drag, and the reaction to the motion (added mass, the
    # waves that the body made, a pull). With the weight they are mass times acceleration.
    lift: np.ndarray
    wet_volume: np.ndarray  # (n, 2) [m3] in the upper and in the lower fluid at the last step
    memory: np.ndarray  # (n, p, 6) complex: state of the radiated waves, one for each pole and motion
    pull_point: np.ndarray  # (n, 3) [m] where each is pulled, in body axes
    pull_target: np.ndarray  # (n, 3) [m] where to, in world axes
    pull_limit: np.ndarray  # (n,) [N] greatest pull; 0 for none
    pull_force: np.ndarray  # (n,) [N] size of the pull at the last step with one
    mooring: np.ndarray  # (n, 6) [N, N m] force and moment of lines about the centre of mass, in world axes
    hull: np.ndarray  # (n,) int, index in hulls
    density: np.ndarray  # (n,) [kg/m3]
    mass: np.ndarray  # (n,) [kg]
    vertex_start: np.ndarray  # (n + 1,) int: where each body's vertices begin in arrays of all vertices
    hulls: PackedHulls
    linear_hull: np.ndarray  # (n,) int, index in linear
    linear: PackedLinear

    def __deepcopy__(self, memo: object) -> "Fleet":
        """An independent copy; it shares the arrays that never change."""
        changing = {name: getattr(self, name).copy() for name in self._fields[: self._fields.index("vertex_start")]}
        return self._replace(**changing)


def make_fleet(bodies: Sequence[Body], layers: Layers = SEA_WATER) -> Fleet:
    """The arrays of many bodies.

    layers: (density [kg/m3], thickness [m]) from the top. The bodies take their linear coefficients at the
    drafts that they have in these fluids. Raises ValueError, naming the body, unless all is finite and it has a mass.
    """
    loaded = []
    if isinstance(bodies, Body):  # which is a tuple
        raise argument_error("bodies", bodies, "a list of bodies")
    for i, body in enumerate(check_kind("bodies", bodies, list | tuple, "a list of bodies")):
        check_body(f"bodies[{i}]", body)
        try:
            loaded.append(body.loaded())
            check_pose(body)
        except ValueError as error:
            raise ValueError(f"bodies[{i}].{error}") from None
    n = len(bodies)
    own, densities = [hull for hull, _ in loaded], [density for _, density in loaded]
    hulls = list({id(hull): hull for hull in own}.values())
    number = {id(hull): i for i, hull in enumerate(hulls)}
    rotation = np.array([body.rotation for body in bodies], dtype=float).reshape(n, 4)
    counts = [len(hull.vertices) for hull in own]
    linear_hull, linear = pack_linear(own, densities, layers)
    return Fleet(
        position=np.array([body.position for body in bodies], dtype=float).reshape(n, 3),
        rotation=rotation / np.linalg.norm(rotation, axis=1, keepdims=True),
        velocity=np.array([body.velocity for body in bodies], dtype=float).reshape(n, 3),
        spin=np.array([body.spin for body in bodies], dtype=float).reshape(n, 3),
        carried=np.full((n, 6), -1.0),
        buoyancy=np.zeros(n),
        lift=np.zeros((n, 4)),
        wet_volume=np.zeros((n, 2)),
        memory=np.zeros((n, len(POLES), 6), dtype=complex),
        pull_point=np.zeros((n, 3)),
        pull_target=np.zeros((n, 3)),
        pull_limit=np.zeros(n),
        pull_force=np.zeros(n),
        mooring=np.zeros((n, 6)),
        hull=np.array([number[id(hull)] for hull in own], dtype=np.int64),
        density=np.array(densities, dtype=float),
        mass=np.array([density * hull.volume for hull, density in loaded], dtype=float),
        vertex_start=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        hulls=pack_hulls(hulls),
        linear_hull=linear_hull,
        linear=linear,
    )


def pack_linear(
    hulls: Sequence[Hull], densities: Sequence[float], layers: Layers = SEA_WATER
) -> tuple[np.ndarray, PackedLinear]:
    """Linear coefficients of hulls of given densities [kg/m3], each set once, and the index (n,) of each hull's."""
    fluids = check_layers(layers)
    coefficients = [afloat(hull, float(density), fluids) for hull, density in zip(hulls, densities, strict=True)]
    unique = list({id(one): one for one in coefficients}.values())
    number = {id(one): i for i, one in enumerate(unique)}
    s = len(unique)
    added = np.array([one.linear.infinite for one in unique]).reshape(s, 6, 6)
    # 1 over the diagonal of the inverse is the added mass of a motion while all others are free.
    steady = np.array([1e-9 * np.trace(one) * np.eye(6) for one in added]).reshape(s, 6, 6)
    coupled, coupled_count = np.zeros((s, 36, 2), np.int64), np.zeros(s, np.int64)
    residues = np.zeros((s, 36, len(POLES)), complex)
    for i, one in enumerate(unique):
        pairs = np.argwhere(one.memory.residues.any(axis=0))
        coupled_count[i] = len(pairs)
        coupled[i, : len(pairs)] = pairs
        residues[i, : len(pairs)] = one.memory.residues[:, pairs[:, 0], pairs[:, 1]].T
    return np.array([number[id(one)] for one in coefficients], dtype=np.int64), PackedLinear(
        added_factor=np.array([lower_factor(one) for one in added]).reshape(s, 6, 6),
        poles=np.array([one.memory.poles for one in unique], dtype=complex).reshape(s, len(POLES)),
        coupled=coupled,
        coupled_count=coupled_count,
        residues=residues,
        wet_area=np.array([one.wet_area for one in unique]).reshape(s, 3),
        added_bound=1 / np.einsum("sii->si", np.linalg.inv(added + steady)) if s else np.zeros((0, 6)),
        decay_length=np.array([one.linear.draft for one in unique], dtype=float),
    )


def lower_factor(added: np.ndarray) -> np.ndarray:
    """Lower L (6, 6) of L L^T, the nearest matrix to `added` that gives energy to no motion.

    That of a sphere, which the water does not turn, has no inverse, and interpolation may miss 0 by a little.
    """
    size = np.sqrt(np.abs(np.diag(added))) + 1e-12
    values, vectors = np.linalg.eigh(added / np.outer(size, size))
    root = size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    return np.linalg.qr(root.T).R.T


def pack_hulls(hulls: Sequence[Hull]) -> PackedHulls:
    """Pack the hulls one after another, with the properties that a step needs of each."""
    q = len(hulls)
    vertex_start = np.concatenate([[0], np.cumsum([len(hull.vertices) for hull in hulls])]).astype(np.int64)
    face_start = np.concatenate([[0], np.cumsum([len(hull.faces) for hull in hulls])]).astype(np.int64)
    areas = [area_vectors(hull.vertices, hull.faces) for hull in hulls]
    surfaces = [surface_moments(hull, area) for hull, area in zip(hulls, areas, strict=True)]
    return PackedHulls(
        vertex_start=vertex_start,
        face_start=face_start,
        x=columns([hull.vertices for hull in hulls], float),
        faces=columns([hull.faces + start for hull, start in zip(hulls, vertex_start, strict=False)], np.int64),
        area=columns(areas, float),
        collision=np.array([COLLISION_FORMS.index(hull.shape.collision) for hull in hulls], dtype=np.int64),
        is_round=np.array([hull.shape.is_round for hull in hulls], dtype=bool),
        half=np.array([np.abs(hull.extents).max(axis=1) for hull in hulls]).reshape(q, 3),
        radius=np.array([np.linalg.norm(hull.vertices, axis=1).max() for hull in hulls], dtype=float),
        inertia=np.array([hull.inertia for hull in hulls]).reshape(q, 3, 3),
        inverse_inertia=np.array([np.linalg.inv(hull.inertia) for hull in hulls]).reshape(q, 3, 3),
        waterplane_bound=np.array([np.linalg.norm(np.abs(area).sum(axis=0)) / 2 for area in areas], dtype=float),
        radius_of_gyration=np.array([radius for radius, _ in surfaces]).reshape(q, 3),
        restoring_bound=np.array([bound for _, bound in surfaces]).reshape(q, 3),
    )


def columns(arrays: Sequence[np.ndarray], dtype: type) -> np.ndarray:
    """(3, total) from many (m, 3)."""
    return np.ascontiguousarray(np.concatenate([np.zeros((0, 3)), *arrays]).T.astype(dtype))


def surface_moments(hull: Hull, area: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Radius of gyration of the surface (3,) [m], and bound of the restoring moment (3,) [m4]; area (m, 3) [m2].

    A rotation by a small angle about axis i changes the depth of a point by at most its distance r_i from the axis
    times the angle, so the moment changes by at most int |(x cross n)_i| r_i dA times the weight density; a floating
    hull wets about half of that. Both by the rule of the mid-edge points, exact to second order.
    """
    corners = hull.vertices[hull.faces]
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    size = np.linalg.norm(area, axis=1)
    radius = np.sqrt(np.einsum("f,fei->i", size, middles**2) / 3 / size.sum())
    squares = (middles**2).sum(axis=2, keepdims=True) - middles**2
    bound = np.abs(np.cross(middles, area[:, None, :])) * np.sqrt(squares)
    return radius, bound.sum(axis=(0, 1)) / 3 / 2


def vertices(fleet: Fleet) -> np.ndarray:
    """Vertices of all bodies where they are now, one body after another, (vertices, 3) [m]."""
    check_fleet(fleet)
    places = []
    for i, q in enumerate(fleet.hull):
        x = fleet.hulls.x[:, fleet.hulls.vertex_start[q] : fleet.hulls.vertex_start[q + 1]]
        places.append((rotation_matrix(fleet.rotation[i]) @ x).T + fleet.position[i])
    return np.concatenate([np.zeros((0, 3)), *places])


def lowest(fleet: Fleet) -> np.ndarray:
    """Height of the lowest point of each body, (n,) [m]; of the true shape for spheres, else of the mesh."""
    check_fleet(fleet)
    result = np.empty(len(fleet.mass))
    for i, q in enumerate(fleet.hull):
        if fleet.hulls.is_round[q]:
            result[i] = fleet.position[i, 2] - fleet.hulls.half[q, 2]
        else:
            x = fleet.hulls.x[:, fleet.hulls.vertex_start[q] : fleet.hulls.vertex_start[q + 1]]
            result[i] = fleet.position[i, 2] + (rotation_matrix(fleet.rotation[i])[2] @ x).min()
    return result


def pull(fleet: Fleet, body: int, point: Sequence[float], target: Sequence[float], limit: float) -> None:
    """Pull a point of a body (3,) [m], in body axes, towards a target (3,) [m] with at most `limit` [N]; 0 lets go.

    Raises ValueError for a body that does not exist and for numbers that are not finite.
    """
    check_fleet(fleet)
    if not is_whole_number(body) or not 0 <= body < len(fleet.mass):
        raise argument_error("body", body, f"0 to {len(fleet.mass) - 1}")
    for name, value in (("point", point), ("target", target)):
        array = as_array(name, value, "three finite numbers [m]")
        if array.shape != (3,) or not np.isfinite(array).all():
            raise argument_error(name, value, "three finite numbers [m]")
    check_number("limit", limit, "N", 0.0)
    fleet.pull_point[body] = point
    fleet.pull_target[body] = target
    fleet.pull_limit[body] = limit
