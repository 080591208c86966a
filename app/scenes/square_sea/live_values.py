"""Values of the square sea for the tasks of the lab: heights, lengths and speeds here, in other winds, on the Earth."""

import math

import numpy as np

from app.messages import Snapshot
from app.scenes.contract import Measure
from app.scenes.sea_parameters import chosen_spectrum
from app.scenes.square_sea.frame import SeaReadings
from app.scenes.square_sea.parameters import SquareSeaParams, conditions, gravity
from sim.ocean.gerstner import peak_wavenumber
from sim.ocean.planets import EARTH_GRAVITY, gravity_of
from sim.ocean.spectra import Conditions, Spectrum
from sim.ocean.statistics import open_sea_height

LIGHT, HEAVY = 0.01, 100.0  # [Earth masses] of the planets of the lab


def spectrum_conditions(params: SquareSeaParams, wind_speed: float, g: float) -> Conditions:
    """The conditions of the parameters' spectrum in another wind [m/s], 10 m above the sea, or gravity [m/s2]."""
    values = conditions(params, wind_speed) | {"gravity": g}
    return chosen_spectrum(params).conditions_from(values)


def peak_speed(spectrum: Spectrum, c: Conditions) -> float:
    """Phase speed [m/s] of the waves at the spectrum's peak."""
    k = peak_wavenumber(spectrum, c)
    return float(c.omega(np.asarray(k))) / k


def open_sea(params: SquareSeaParams, wind_speed: float, g: float) -> tuple[float, float]:
    """Significant height [m] of an open sea, and speed [m/s] of its peak waves; NaN for the speed of a level one."""
    spectrum, c = chosen_spectrum(params), spectrum_conditions(params, wind_speed, g)
    if spectrum.is_level(c):
        return 0.0, math.nan
    return open_sea_height(spectrum, c), peak_speed(spectrum, c)


def live_values(snapshot: Snapshot) -> dict[str, Measure]:
    """The numbers of a snapshot. Measured values are there once the sea has been measured."""
    p: SquareSeaParams = snapshot.frame.params
    readings: SeaReadings = snapshot.readings
    g = gravity(p)
    height, speed = open_sea(p, p.wind_speed, g)
    twice_height, twice_speed = open_sea(p, 2.0 * p.wind_speed, g)
    earth_height, earth_speed = open_sea(p, p.wind_speed, EARTH_GRAVITY)
    ratio = height / earth_height if earth_height else math.nan
    by_wind = twice_height / height if height else math.nan
    found = {
        "gravity_here": Measure(g, "m/s²", "Gravity"),
        "gravity_light": Measure(gravity_of(LIGHT, "same_density"), "m/s²", "Gravity of 1/100 Earth mass"),
        "gravity_heavy": Measure(gravity_of(HEAVY, "same_density"), "m/s²", "Gravity of 100 Earth masses"),
        "open_height": Measure(height, "m", "Significant height of an open sea"),
        "open_speed": Measure(speed, "m/s", "Speed of its peak waves"),
        "twice_wind": Measure(2.0 * p.wind_speed, "m/s", "Twice the wind"),
        "twice_height": Measure(twice_height, "m", "Significant height in twice the wind"),
        "twice_speed": Measure(twice_speed, "m/s", "Speed of the peak waves in twice the wind"),
        "earth_height": Measure(earth_height, "m", "Significant height on the Earth, same wind"),
        "earth_speed": Measure(earth_speed, "m/s", "Speed of the peak waves on the Earth, same wind"),
        "height_over_earth": Measure(ratio, "1", "Height over that on the Earth"),
        "height_by_wind": Measure(by_wind, "1", "Height in twice the wind over this one"),
        "damping_so_far": Measure(
            2.0 * math.sqrt(readings.viscous_area), "m", "Length l of the decay by viscosity so far"
        ),
        "minute_length": Measure(2.0 * math.sqrt(60.0 * p.viscosity), "m", "Length l of a minute of this viscosity"),
        "square_grid_points": Measure(int(p.size) ** 2, "1", "Points of the square grid"),
        "square_spacing": Measure(p.length / int(p.size), "m", "Spacing of the square grid"),
    }
    if readings.report is not None:
        measured, theory = readings.report.measured, readings.report.theory
        length, phase_speed = theory.wave
        found |= {
            "measured_over_earth": Measure(
                measured.significant_height / earth_height if earth_height else math.nan,
                "1",
                "Height as drawn over that on the Earth",
            ),
            "significant_height": Measure(measured.significant_height, "m", "Significant height"),
            "peak_period": Measure(measured.peak_period, "s", "Peak period"),
            "mean_square_slope": Measure(measured.mean_square_slope, "1", "Mean square slope"),
            "wave_length": Measure(length, "m", "Length of the dominant waves"),
            "wave_speed": Measure(phase_speed, "m/s", "Speed of the dominant waves"),
        }
    if readings.rain is not None:
        rain = readings.rain
        found |= {
            "drops_shown": Measure(rain.drawn, "1", "Drops that are drawn in the air"),
            "drops_falling": Measure(rain.drawn * rain.weight, "1", "Drops in the air"),
            "drops_fallen": Measure(rain.fallen, "1", "Drops that have met the sea"),
        }
    return found
