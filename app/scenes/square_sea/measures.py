"""Measures of the square sea for sweeps: its statistics as drawn, and theory of the same tile."""

from typing import TYPE_CHECKING

from app.scenes.contract import Measure
from app.scenes.square_sea.statistics import measure, theory

if TYPE_CHECKING:
    from app.scenes.square_sea.scene import SquareSeaScene


def measures(scene: "SquareSeaScene") -> dict[str, Measure]:
    """Measures of the sea at its present time; no frame is drawn for them."""
    sea, t, p = scene.sea, scene.time, scene.params
    height = sea.surface(t).height
    found, expected = measure(sea, height, None, p), theory(sea, t, p)
    stated = expected.statistics
    length, speed = expected.wave
    return {
        "significant_height": Measure(found.significant_height, "m", "Significant wave height of the drawn sea"),
        "peak_period": Measure(found.peak_period, "s", "Peak period of the drawn sea"),
        "mean_square_slope": Measure(found.mean_square_slope, "1", "Mean square slope of the drawn sea"),
        "crest_height": Measure(p.amplitude * float(height.max()), "m", "Highest crest of the drawn sea"),
        "expected_height": Measure(stated.significant_height, "m", "Significant wave height by theory, of this tile"),
        "expected_period": Measure(stated.peak_period, "s", "Peak period by theory, of this tile"),
        "expected_slope": Measure(stated.mean_square_slope, "1", "Mean square slope by theory, of this tile"),
        "height_scatter": Measure(expected.scatter, "1", "Relative standard deviation of one tile's height"),
        "endless_height": Measure(expected.whole, "m", "Significant wave height of an endless sea"),
        "wave_length": Measure(length, "m", "Length of the dominant waves"),
        "wave_speed": Measure(speed, "m/s", "Phase speed of the dominant waves"),
    }
