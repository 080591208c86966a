"""What the radial scene hands to the viewer: its picture and its numbers, immutable."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.blowout import Slick, Tally
from app.crowd import Reading
from app.messages import Vector
from app.radial_knobs import Params
from app.section import Section
from sim.floating import Hull
from sim.ocean.radial import RadialSurface
from sim.ocean.radial_grid import RadialGrid
from sim.ocean.spill import Spill


class RadialPicture(NamedTuple):
    """What the viewer draws."""

    params: Params
    time: float  # [s]
    grid: RadialGrid
    surface: RadialSurface
    foam: NDArray[np.float32]  # (n,)
    slick: Slick | None  # drawn on clean water only: on a layer it would not show
    section: Section | None
    kinds: tuple[str, ...]  # of the bodies
    own: Hull | None  # the hull of the one from a file
    positions: NDArray[np.float32]  # (bodies, 3) [m]
    rotations: NDArray[np.float32]  # (bodies, 4) quaternions (w, x, y, z)
    pull: tuple[Vector, Vector] | None  # from a held body to where it is pulled [m]
    fire: tuple[NDArray[np.float32], NDArray[np.float32]] | None  # (3, n) [m], (2, n) heat and age over life
    jet: NDArray[np.float32] | None  # (n, 3) [m] parcels in the air
    spill: Spill
    age: float  # [s] that the waves have run under the oil


class Compared(NamedTuple):
    """One way to make the surface, for the same vertices."""

    cost: float  # [s] a frame
    waves: int
    smallest: float  # [m] shortest wave at the viewer
    extent: float  # [m] across, before it repeats
    height: float  # Hs [m] of its waves
    slope: float  # mean square slope of its waves
    error: float  # of Hs, against the spectrum's, as a share


class RadialGauge(NamedTuple):
    """Numbers for the panel."""

    readings: tuple[Reading, ...]
    spill: Spill
    height: float  # Hs [m] of the waves as they are
    height_clean: float  # without the oil
    slope: float  # mean square slope as it is
    slope_clean: float
    peak_period: float  # [s] of the wave in the middle of the energy
    tally: Tally
    compared: dict[str, Compared]
    age: float  # [s] that the waves have run under the oil
