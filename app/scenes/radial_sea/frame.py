"""What the radial scene hands to the viewer: its picture and its numbers, immutable."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.radial_sea.bodies import BodyReading
from app.scenes.radial_sea.cutaway import Section
from app.scenes.radial_sea.parameters import Params
from app.scenes.radial_sea.well_blowout import OilBudget, Slick
from sim.floating import Hull
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.radial import RadialSurface
from sim.ocean.radial_grid import RadialGrid


class RadialFrame(NamedTuple):
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
    column: FluidColumn
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


class RadialReadings(NamedTuple):
    """Numbers for the panel."""

    readings: tuple[BodyReading, ...]
    column: FluidColumn
    height: float  # Hs [m] of the waves as they are
    height_clean: float  # without the oil
    slope: float  # mean square slope as it is
    slope_clean: float
    peak_period: float  # [s] of the wave in the middle of the energy
    tally: OilBudget
    compared: dict[str, Compared]
    age: float  # [s] that the waves have run under the oil
