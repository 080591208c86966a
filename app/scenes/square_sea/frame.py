"""Frames and readings of the square sea for its view and the panel, immutable."""

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.packed_surface import SentSurface, pack_surface, unpack_surface
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.rainfall import RainFrame, RainReadings
from app.scenes.square_sea.statistics import Report
from app.scenes.square_sea.tile_mesh import Highest


class SeaFrame(NamedTuple):
    """Drawn state of a sea."""

    params: SquareSeaParams
    time: float  # [s]
    vertices: NDArray[np.float32]  # (n, n, 3) [m]
    slopes: NDArray[np.float32]  # (n, n, 2)
    foam: NDArray[np.float32]  # (n, n), 0 to 1
    slope_resolved: float  # mean square slope of the solved waves
    rain: RainFrame | None
    gauge: Vector | None  # [m] position of the wave gauge; None while it is not shown
    sent: SentSurface
    highest: Highest | None = None  # wave since the start, of a sea that is solved step by step


class PackedSeaFrame(NamedTuple):
    """A frame as a recording keeps it."""

    frame: SeaFrame  # without a surface
    side: int  # points along a side
    surface: NDArray[np.float32]


@functools.lru_cache(maxsize=2)
def resting_points(length: float, side: int) -> NDArray[np.float32]:
    """(2, side side) [m]: where the points of the mesh are when the water rests."""
    along = np.arange(side) * (length / side)
    return np.stack(np.meshgrid(along, along, indexing="ij")).reshape(2, -1).astype(np.float32)


def pack_frame(frame: SeaFrame) -> PackedSeaFrame:
    """A frame for the recording."""
    side, nothing = len(frame.vertices), np.empty(0, np.float32)
    rest = resting_points(frame.params.length, side)
    surface = pack_surface(frame.vertices, frame.slopes, frame.foam, rest, side, frame.sent)
    return PackedSeaFrame(
        frame._replace(vertices=nothing, slopes=nothing, foam=nothing, sent=SentSurface()), side, surface
    )


def unpack_frame(packed: PackedSeaFrame) -> SeaFrame:
    """The frame, to draw it."""
    frame, side, surface = packed
    vertices, slopes, foam = unpack_surface(surface, resting_points(frame.params.length, side), (side, side))
    return frame._replace(vertices=vertices, slopes=slopes, foam=foam, sent=SentSurface())


class SeaReadings(NamedTuple):
    """The numbers of the sea for the panel."""

    foam_cover: float  # fraction of the drawn sea that is foam
    expected_foam_cover: float  # by Monahan's law, times the fraction of the slope that is left
    slope_left: float  # fraction of the mean square slope that damping and a small height factor leave
    foam_limit: float  # Jacobian below which there is foam; -inf without foam
    is_choppy: bool  # True if water moves horizontally, which compresses the surface
    viscous_area: float  # [m2] sum of viscosity times time, since the start
    rain: RainReadings | None
    report: Report | None
