"""A blowout of the well under the rig: it burns, and oil shoots into the sea and spreads there as a slick."""

import dataclasses
import functools
import math
from typing import NamedTuple

import numpy as np

from app.scenes.radial_sea.parameters import RadialSeaParams
from sim.interruption import raise_if_stopped
from sim.ocean.any_sea import AnySea
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.slick import SlickCover, slick_radius, slick_thickness, spreading_coefficient
from sim.ocean.weathering.laws import DRIFT
from sim.particles.fire import Fire
from sim.particles.jet import Jet

RIG = (48.0, 100.0)  # [m] position of the rig
FIRE = (RIG[0] + 3.0, RIG[1] + 3.0, 26.5)  # [m] at the foot of the derrick
FIRE_WIDTH = 9.0  # [m]
NOZZLE = (RIG[0] - 12.0, RIG[1] - 17.0, 20.0)  # [m] on the edge of the deck towards the buoys
JET_VELOCITY = (-9.0, -7.0, 9.5)  # [m/s] at the nozzle
# A drop flies freely, until its height is that of the level sea.
FALL_TIME = (JET_VELOCITY[2] + math.sqrt(JET_VELOCITY[2] ** 2 + 2 * 9.81 * NOZZLE[2])) / 9.81  # [s]
LANDING = NOZZLE[0] + JET_VELOCITY[0] * FALL_TIME, NOZZLE[1] + JET_VELOCITY[1] * FALL_TIME  # [m]
PARCEL_RADIUS = 0.05  # [m] of the oil
MAX_FLIGHT_TIME = 4.0  # [s] that a parcel of oil is in the air, about
MIN_JET_PARCELS = 50
SMOKE_LIFE = 20.0  # [s] of a parcel of fire and smoke on average
BURN_IN_TIME, BURN_IN_STEP = 60.0, 0.2  # [s] for which the fire burns before the scene begins, and the steps of that
CALMING_STEP = 1.05  # ratio of two thicknesses of the slick for which the decay of waves is found
CROSSING_WAVE = 1.0  # [m] length of the wave in what is said of how the slick calms waves
SAMPLE_GRID, SAMPLE_SPACING = 16, 3.0  # points a side and their distance [m], of the sea that parcels fall into


class Slick(NamedTuple):
    """The oil of the jet on the sea."""

    centre: tuple[float, float]  # [m]
    radius: float  # [m]
    thickness: float  # [m]


class OilBudget(NamedTuple):
    """Budget of the jet's oil."""

    ejected: float  # [m3]
    in_flight: float  # [m3]
    fed: float  # [m3] that has reached the sea
    hits: int  # parcels that have
    radius: float  # [m] of the slick
    thickness: float  # [m] of the slick
    # fraction of its height that a wave of `CROSSING_WAVE` keeps across the slick; NaN where none calms the sea
    wave_left: float = math.nan


class JetTotal(NamedTuple):
    """Oil that jets ejected."""

    ejected: float = 0.0  # [m3]
    fed: float = 0.0  # [m3]
    hits: int = 0


class FireSettings(NamedTuple):
    """Arguments of a fire."""

    power: float  # [W]
    parcels: int
    wind: tuple[float, float]  # [m/s]


class JetSettings(NamedTuple):
    """Arguments of a jet."""

    flow: float  # [m3/s]
    parcels: int


def fire_settings(params: RadialSeaParams) -> FireSettings | None:
    """Fire of these parameters; None if nothing burns."""
    if not (params.rig and params.fire):
        return None
    return FireSettings(params.fire_power * 1e6, params.particles, wind_of(params))


def jet_settings(params: RadialSeaParams) -> JetSettings | None:
    """Jet of these parameters; None if it is shut."""
    if not (params.rig and params.jet):
        return None
    return JetSettings(params.jet_flow, max(params.particles // 2, MIN_JET_PARCELS))


class WellBlowout:
    """Fire, jet and slick; used on the simulation thread."""

    def __init__(self, params: RadialSeaParams) -> None:
        self.fire: Fire | None = None
        self.jet: Jet | None = None
        self.fire_settings: FireSettings | None = None
        self.jet_settings: JetSettings | None = None
        self.slick_age = 0.0  # [s] for which oil has been on the sea
        self.drifted = 0.0  # [m3] of oil that has drifted so far
        self.drift = (0.0, 0.0)  # [m] of the middle of its volume from where the jet lands
        self.closed_jets_total = JetTotal()
        half = 0.5 * (SAMPLE_GRID - 1) * SAMPLE_SPACING
        self.origin = (LANDING[0] - half, LANDING[1] - half)
        i, j = np.meshgrid(np.arange(SAMPLE_GRID), np.arange(SAMPLE_GRID), indexing="ij")
        self.points = np.column_stack([i.ravel(), j.ravel()]) * SAMPLE_SPACING + self.origin
        self.change(params)
        if self.fire is not None:  # smoke has risen for some time when the scene begins
            for _ in range(int(BURN_IN_TIME / BURN_IN_STEP)):
                raise_if_stopped()
                self.fire.step(BURN_IN_STEP)

    def change(self, params: RadialSeaParams) -> None:
        """Light or put out the fire, open or shut the jet, as the parameters say; oil on the sea stays."""
        self.wind = wind_of(params)
        fire, jet = fire_settings(params), jet_settings(params)
        if fire != self.fire_settings:
            self.fire_settings = fire
            self.fire = None
            if fire is not None:
                self.fire = Fire(FIRE, fire.power, FIRE_WIDTH, fire.parcels, SMOKE_LIFE, fire.wind)
        if jet != self.jet_settings:
            self.jet_settings = jet
            self.close_jet()
            if jet is not None:
                self.jet = Jet(NOZZLE, JET_VELOCITY, jet.flow, PARCEL_RADIUS, jet.parcels, flight=MAX_FLIGHT_TIME)

    def close_jet(self) -> None:
        """Shut the jet; the oil in the air counts as fallen into the sea."""
        if self.jet is not None:
            total, jet = self.closed_jets_total, self.jet
            fed = total.fed + jet.fed + jet.in_flight
            self.closed_jets_total = JetTotal(total.ejected + jet.ejected, fed, total.hits + jet.hits)
            self.jet = None

    def step(self, sea: AnySea, t: float, duration: float) -> None:
        """Let `duration` [s] pass, up to time t [s]."""
        if self.fire is not None:
            self.fire.step(duration)
        if self.jet is not None:
            height = sea.at(self.points, t).height.reshape(SAMPLE_GRID, SAMPLE_GRID)
            self.jet.step(duration, height, self.origin, SAMPLE_SPACING)
        if self.volume > 0.0:
            self.slick_age += duration
            # Oil that has just fallen is where the jet lands, and pulls the middle of the volume back.
            share = self.drifted / self.volume
            x, y = (d + DRIFT * u * duration for d, u in zip(self.drift, self.wind, strict=True))
            self.drift, self.drifted = (share * x, share * y), self.volume

    @property
    def volume(self) -> float:
        """Oil of the jets on the sea [m3]."""
        return self.closed_jets_total.fed + (self.jet.fed if self.jet is not None else 0.0)

    def slick(self, column: FluidColumn) -> Slick | None:
        """The slick, spread by Fay's laws and drifting with the wind, or None."""
        volume, age = self.volume, self.slick_age
        if volume <= 0.0 or age <= 0.0:
            return None
        x, y = LANDING[0] + self.drift[0], LANDING[1] + self.drift[1]
        radius = spread_radius(volume, age, column)
        return Slick((x, y), radius, slick_thickness(volume, radius))

    def cover(self, column: FluidColumn) -> SlickCover | None:
        """The slick as the waves meet it; None without one, or where oil and water are mixed anyway."""
        slick = self.slick(column)
        if slick is None or column.kind == "mixed":
            return None
        # Rounded, as the decay of all waves is found again with each thickness.
        steps = round(math.log(slick.thickness) / math.log(CALMING_STEP))
        thickness = column.thickness + CALMING_STEP**steps
        return SlickCover(slick.centre, slick.radius, dataclasses.replace(column, thickness=thickness))

    def oil_budget(self, column: FluidColumn) -> OilBudget:
        """Budget of the oil."""
        slick, jet, closed = self.slick(column), self.jet, self.closed_jets_total
        return OilBudget(
            ejected=closed.ejected + (jet.ejected if jet is not None else 0.0),
            in_flight=jet.in_flight if jet is not None else 0.0,
            fed=self.volume,
            hits=closed.hits + (jet.hits if jet is not None else 0),
            radius=slick.radius if slick is not None else 0.0,
            thickness=slick.thickness if slick is not None else 0.0,
        )


@functools.lru_cache(maxsize=2)
def spread_radius(volume: float, age: float, column: FluidColumn) -> float:
    """Radius [m] of the slick of this much oil [m3] after `age` [s]; cached, as a frame needs it several times."""
    oil, water = column.oil, column.water
    return slick_radius(
        volume,
        age,
        oil.density,
        water.density,
        water.kinematic_viscosity,
        column.gravity,
        spreading_coefficient(oil, water),
    )


def wind_of(params: RadialSeaParams) -> tuple[float, float]:
    """The wind at the rig (x, y) [m/s]."""
    angle = math.radians(params.wind_direction)
    return params.wind_speed * math.cos(angle), params.wind_speed * math.sin(angle)


def slick_reach(slick: Slick, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance (n,) [m] of points inside the slick from its round border (drawn ragged), negative outside."""
    return slick.radius - np.hypot(x - slick.centre[0], y - slick.centre[1])


@functools.lru_cache(maxsize=4)
def crossing_loss(inside: FluidColumn, outside: FluidColumn) -> float:
    """Loss [1/m] of a wave of `CROSSING_WAVE` under a slick; kept, as over thin oil it takes 30 ms to find."""
    k = np.array([2.0 * math.pi / CROSSING_WAVE])
    return float(SlickCover((0.0, 0.0), 0.0, inside).attenuation(k, outside)[0])


def wave_left(cover: SlickCover | None, outside: FluidColumn) -> float:
    """Fraction of its height that a wave of `CROSSING_WAVE` keeps across a slick; NaN without one."""
    return math.nan if cover is None else math.exp(-2.0 * cover.radius * crossing_loss(cover.column, outside))
