"""Frames and readings of the radial sea for its view and the panel, immutable."""

import functools
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Pull
from app.scenes.packed_surface import SentSurface, pack_surface, unpack_surface
from app.scenes.radial_sea.bodies import BodyReading
from app.scenes.radial_sea.cutaway import Cutaway
from app.scenes.radial_sea.oil.well_blowout import OilBudget, Slick
from app.scenes.radial_sea.parameters import RadialSeaParams
from sim.floating import Hull
from sim.ocean.any_sea import RadialSurface
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.weathering import Weathering


class JetParcels(NamedTuple):
    """Parcels of a jet of oil that are in the air."""

    position: NDArray[np.float32]  # (n, 3) [m]
    velocity: NDArray[np.float32]  # (n, 3) [m/s]
    number: NDArray[np.intp]  # (n,) by which a parcel is known while it is in the air


class RadialFrame(NamedTuple):
    """Drawn state of the sea."""

    params: RadialSeaParams
    time: float  # [s]
    grid: RadialGrid
    grid_middle: tuple[float, float]  # x, y [m]
    surface: RadialSurface
    foam: NDArray[np.float32]  # (n,) 0 to 1
    slick: Slick | None  # only on clean water: on a layer of oil it would not be seen
    cutaway: Cutaway | None
    kinds: tuple[str, ...]  # of each body
    hulls: Mapping[str, Hull]  # kind -> its hull
    positions: NDArray[np.float32]  # (bodies, 3) [m]
    rotations: NDArray[np.float32]  # (bodies, 4) quaternions (w, x, y, z)
    stains: NDArray[np.float32]  # (bodies,) [m] above the lowest point of each to which oil has wetted it
    fairleads: NDArray[np.float32]  # (bodies, 3) [m] of the mooring lines; none where they are taken off
    anchors: NDArray[np.float64]  # (bodies, 4, 3) [m]
    grabs: tuple[Pull, ...]  # the pulls of bodies
    # (3, n) [m]; (4, n) heat, age over life, radius of the plume [m], age over the longest life
    fire: tuple[NDArray[np.float32], NDArray[np.float32]] | None
    jet: JetParcels | None  # in the air
    column: FluidColumn
    age: float  # [s] for which the waves have run under the oil
    sent: SentSurface


class PackedRadialFrame(NamedTuple):
    """A frame as a recording keeps it."""

    frame: RadialFrame  # without a surface and its foam
    surface: NDArray[np.float32]


def pack_frame(frame: RadialFrame) -> PackedRadialFrame:
    """A frame for the recording. Its Jacobian, which nothing draws, is left out."""
    surface, nothing = frame.surface, np.empty(0, np.float32)
    rest, spokes = resting_points(frame), frame.grid.spokes
    packed = pack_surface(surface.vertices, surface.slope, frame.foam, rest, spokes, frame.sent)
    empty = RadialSurface(nothing, nothing, nothing)
    return PackedRadialFrame(frame._replace(surface=empty, foam=nothing, sent=SentSurface()), packed)


def unpack_frame(packed: PackedRadialFrame) -> RadialFrame:
    """The frame, to draw it."""
    frame = packed.frame
    vertices, slope, foam = unpack_surface(packed.surface, resting_points(frame), (len(frame.grid),))
    surface = RadialSurface(vertices, slope, frame.surface.jacobian)
    return frame._replace(surface=surface, foam=foam, sent=SentSurface())


def resting_points(frame: RadialFrame) -> NDArray[np.float32]:
    """(2, n) [m]: where the points of the mesh are when the water rests."""
    return resting_grid(frame.grid)


@functools.lru_cache(maxsize=2)
def resting_grid(grid: RadialGrid) -> NDArray[np.float32]:
    """The same of a grid."""
    return np.stack([grid.x, grid.y]).astype(np.float32)


class SurfaceReading(NamedTuple):
    """One way to compute the surface at the vertices of the grid."""

    cost: float  # [s] a frame
    waves: int
    shortest: float  # [m] shortest wave at the viewer
    extent: float  # [m] across, before it repeats
    height: float  # Hs [m] expected of its waves
    slope: float  # mean square slope of its waves
    error: float  # of Hs, as a fraction of that of the whole spectrum on these fluids


class RadialReadings(NamedTuple):
    """Numbers for the panel."""

    bodies: tuple[BodyReading, ...]
    column: FluidColumn
    height: float  # Hs [m] of the waves as they are
    clean_height: float  # [m] without the oil
    slope: float  # mean square slope as it is
    clean_slope: float  # without the oil
    middle_period: float  # [s] above which half of the energy of the waves is
    oil_budget: OilBudget
    surfaces: dict[str, SurfaceReading]  # radial and square sea side by side; empty unless requested
    age: float  # [s] for which the waves have run under the oil
    past: Mapping[FluidColumn, float]  # fluids that the waves have run on -> [s]
    weathering: Weathering | None  # the spill over five days; None without one
