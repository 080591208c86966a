"""What goes wrong on the rig: it burns, and oil gushes into the sea and spreads there."""

import math
from typing import NamedTuple

import numpy as np

from app.scenes.radial_sea.parameters import Params
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.radial import RadialSea
from sim.ocean.slick import slick_radius, slick_thickness
from sim.ocean.tile_sea import TileSea
from sim.particles.fire import Fire
from sim.particles.jet import Jet

RIG = (48.0, 100.0)  # [m] where the rig stands
FIRE = (RIG[0] + 3.0, RIG[1] + 3.0, 26.5)  # [m] at the foot of the derrick
FIRE_WIDTH = 9.0  # [m]
NOZZLE = (RIG[0] - 12.0, RIG[1] - 17.0, 20.0)  # [m] on the edge of the deck towards the buoys
GUSH = (-9.0, -7.0, 9.5)  # [m/s]
UPDRAFT = 3.0  # [m/s] of the air that the fire draws up
SMOKE = 24.0  # [s] that a parcel lives
FLIGHT = 4.0  # [s] about as long as a parcel is in the air
PATCH, PATCH_CELL = 16, 3.0  # points a side, and their distance [m], of the sea that parcels are compared with


class Slick(NamedTuple):
    """The oil that came from the jet, on the sea."""

    centre: tuple[float, float]  # [m]
    radius: float  # [m]
    thickness: float  # [m]


class OilBudget(NamedTuple):
    """Where the oil of the jet is."""

    ejected: float  # [m3]
    in_flight: float  # [m3]
    fed: float  # [m3] that has reached the sea
    hits: int
    radius: float  # [m] of the slick
    thickness: float  # [m]
    parcels: int  # of fire alive


class WellBlowout:
    """Fire, jet and slick on the simulation thread."""

    def __init__(self, params: Params) -> None:
        self.fire: Fire | None = None
        self.jet: Jet | None = None
        self.since = 0.0  # [s] that oil has been on the sea
        self.gone = (0.0, 0.0, 0)  # [m3] ejected and fed, hits, by jets before this one
        fall = (GUSH[2] + math.sqrt(GUSH[2] ** 2 + 2 * 9.81 * NOZZLE[2])) / 9.81
        self.landing = (NOZZLE[0] + GUSH[0] * fall, NOZZLE[1] + GUSH[1] * fall)
        half = 0.5 * (PATCH - 1) * PATCH_CELL
        self.origin = (self.landing[0] - half, self.landing[1] - half)
        i, j = np.meshgrid(np.arange(PATCH), np.arange(PATCH), indexing="ij")
        self.points = np.column_stack([i.ravel(), j.ravel()]) * PATCH_CELL + self.origin
        self.set_params(params, params)
        if self.fire is not None:  # it has burnt for long when the scene begins
            for _ in range(int(SMOKE / 0.1)):
                self.fire.step(0.1)

    def set_params(self, params: Params, old: Params) -> None:
        """Light or put out, open or close, as the parameters say; oil on the sea stays."""
        wind = wind_of(params)
        burning, gushing = params.rig and params.fire, params.rig and params.jet
        fire = (params.fire_power, params.particles, wind)
        if not burning:
            self.fire = None
        elif self.fire is None or fire != (old.fire_power, old.particles, wind_of(old)):
            self.fire = Fire(FIRE, params.fire_power * 1e6, FIRE_WIDTH, params.particles, SMOKE, wind, updraft=UPDRAFT)
        if not gushing:
            self.close()
        elif self.jet is None or (params.jet_flow, params.particles) != (old.jet_flow, old.particles):
            self.close()
            self.jet = Jet(NOZZLE, GUSH, params.jet_flow, 0.05, max(params.particles // 2, 50), flight=FLIGHT)

    def close(self) -> None:
        """Shut the jet; what was in the air counts as fallen."""
        if self.jet is not None:
            ejected, fed, hits = self.gone
            self.gone = ejected + self.jet.ejected, fed + self.jet.fed + self.jet.in_flight, hits + self.jet.hits
            self.jet = None

    def step(self, sea: RadialSea | TileSea, t: float, duration: float) -> None:
        """Let `duration` [s] pass, up to time t [s]."""
        if self.fire is not None:
            self.fire.step(duration)
        if self.jet is not None:
            height = sea.at(self.points, t).height.reshape(PATCH, PATCH)
            self.jet.step(duration, height, self.origin, PATCH_CELL)
        if self.volume > 0.0:
            self.since += duration

    @property
    def volume(self) -> float:
        """Oil on the sea from the jet [m3]."""
        return self.gone[1] + (self.jet.fed if self.jet is not None else 0.0)

    def slick(self, column: FluidColumn) -> Slick | None:
        """The slick, spread as Fay says, or None where there is none."""
        if self.volume <= 0.0 or self.since <= 0.0:
            return None
        viscosity = column.water.kinematic_viscosity
        radius = slick_radius(self.volume, self.since, column.oil.density, column.water.density, viscosity)
        return Slick(self.landing, radius, slick_thickness(self.volume, radius))

    def tally(self, column: FluidColumn) -> OilBudget:
        """Where the oil is."""
        slick, jet = self.slick(column), self.jet
        ejected, _, hits = self.gone
        return OilBudget(
            ejected + (jet.ejected if jet is not None else 0.0),
            jet.in_flight if jet is not None else 0.0,
            self.volume,
            hits + (jet.hits if jet is not None else 0),
            slick.radius if slick is not None else 0.0,
            slick.thickness if slick is not None else 0.0,
            int(self.fire.burning.sum()) if self.fire is not None else 0,
        )


def wind_of(params: Params) -> tuple[float, float]:
    """The wind at the rig (x, y) [m/s]."""
    angle = math.radians(params.wind_direction)
    return params.wind_speed * math.cos(angle), params.wind_speed * math.sin(angle)


def slick_reach(slick: Slick, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """How far inside the slick points are [m], negative outside. It is round; drawn, its edge is torn."""
    return slick.radius - np.hypot(x - slick.centre[0], y - slick.centre[1])
