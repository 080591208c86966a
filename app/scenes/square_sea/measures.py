"""Numbers of the square sea: readings for the panel, and measures for sweeps."""

from typing import TYPE_CHECKING

from app.scenes.contract import Measure
from app.scenes.square_sea.frame import SeaReadings
from app.scenes.square_sea.statistics import measure, theory
from sim.ocean.high_crests import moments_of

if TYPE_CHECKING:
    from app.scenes.square_sea.scene import SquareSeaScene


def measures(scene: "SquareSeaScene") -> dict[str, Measure]:
    """Measures of the sea at its present time; no frame is drawn for them."""
    sea, t, p = scene.sea, scene.time, scene.params
    height = scene.fields().height
    skewness, kurtosis = moments_of(height)
    energy = None if scene.marching is None else scene.marching.sea.energy
    found, expected = measure(sea, height, None, p), theory(sea, t, p)
    stated = expected.statistics
    length, speed = expected.wave
    return {
        "significant_height": Measure(found.significant_height, "m", "Significant wave height of the drawn sea"),
        "peak_period": Measure(found.peak_period, "s", "Peak period of the drawn sea"),
        "mean_square_slope": Measure(found.mean_square_slope, "1", "Mean square slope of the drawn sea"),
        "crest_height": Measure(p.amplitude * float(height.max()), "m", "Highest crest of the drawn sea"),
        "skewness": Measure(skewness, "1", "Skewness of the heights of the drawn sea"),
        "kurtosis": Measure(kurtosis, "1", "Kurtosis of the heights of the drawn sea"),
        "breaking_loss": Measure(
            0.0 if energy is None else energy.breaking, "J/m²", "Energy that breaking has taken since the start"
        ),
        "expected_height": Measure(stated.significant_height, "m", "Significant wave height by theory, of this tile"),
        "expected_period": Measure(stated.peak_period, "s", "Peak period by theory, of this tile"),
        "expected_slope": Measure(stated.mean_square_slope, "1", "Mean square slope by theory, of this tile"),
        "height_scatter": Measure(expected.scatter, "1", "Relative standard deviation of one tile's height"),
        "endless_height": Measure(expected.whole, "m", "Significant wave height of an endless sea"),
        "wave_length": Measure(length, "m", "Length of the dominant waves"),
        "wave_speed": Measure(speed, "m/s", "Phase speed of the dominant waves"),
    }


def readings_of(scene: "SquareSeaScene") -> SeaReadings:
    """Numbers for the panel at the time of the last frame."""
    p = scene.params
    return SeaReadings(
        foam_cover=scene.foam_cover,
        expected_foam_cover=scene.expected_foam_cover(scene.time),
        slope_left=scene.slope_left,
        foam_limit=scene.foam_limit.value,
        is_choppy=scene.marching is not None or scene.sea.choppiness > 0.0,
        viscous_area=scene.viscous_area + p.viscosity * (scene.time - scene.changed_at),
        rain=None if scene.rainfall is None else scene.rainfall.readings(),
        report=scene.statistics.report if p.statistics else None,
    )
