"""Ropes, cloth and race on the dark floor."""

import numpy as np
import pytest

from app.render.brightness import LUMA
from app.render.colormap import ANCHORS, css_scale, lifted
from app.render.surroundings import DARK, DARK_SKY
from app.scenes.race.view import material_colour


def luminance(colour: np.ndarray) -> float:
    """Relative luminance of sRGB in 0..255 (WCAG 2.2)."""
    part = np.asarray(colour) / 255.0
    linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(a: np.ndarray, b: np.ndarray) -> float:
    """Contrast of two sRGB colours (WCAG 2.2)."""
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("behind", [DARK.plane_color, DARK_SKY.middle])
def test_every_colour_of_the_scale_and_of_the_race_stands_out_from_a_dark_floor(behind: tuple[int, int, int]) -> None:
    """3 is WCAG's for what is no text."""
    ropes = [np.array(material_colour(i, dark=True)) for i in range(6)]
    assert min(contrast(colour, behind) for colour in (*lifted(ANCHORS), *ropes)) > 3.0


def test_the_scale_on_a_dark_floor_still_rises() -> None:
    colours = lifted(np.linspace(ANCHORS[:-1], ANCHORS[1:], 20).transpose(1, 0, 2).reshape(-1, 3))
    assert (np.diff(colours @ np.array(LUMA)) >= 0.0).all()
    first = ",".join(f"{part:.0f}" for part in colours[0])
    assert css_scale(dark=True).startswith(f"linear-gradient(90deg, rgb({first}),")
