"""A film of oil on water against all beams and all wavelengths, and against the appearance code."""

import numpy as np
import pytest

from sim.ocean.fluids.oil_film import (
    APPEARANCES,
    BAND_WIDTH,
    BANDS,
    EXTINCTION_SLOPE,
    OPAQUE_THICKNESS,
    appearance,
    light_through,
    mirrored_light,
)

OIL, WATER = 1.48, 1.34
CLEAN = ((1.0 - WATER) / (1.0 + WATER)) ** 2


def airy(thickness: float) -> np.ndarray:
    """(3,) mirrored share with all beams (Born and Wolf 7.6, Airy's sum), integrated over each band."""
    found = []
    for band in BANDS:
        wavelength = band * (1.0 + BAND_WIDTH * np.linspace(-5.0, 5.0, 4001))
        weight = np.exp(-0.5 * ((wavelength / band - 1.0) / BAND_WIDTH) ** 2)
        extinction = np.exp(-EXTINCTION_SLOPE * (wavelength - BANDS[1])) / OPAQUE_THICKNESS
        first, second = (1.0 - OIL) / (1.0 + OIL), (OIL - WATER) / (OIL + WATER)
        turn = np.exp(4j * np.pi * OIL * thickness / wavelength - 0.5 * extinction * thickness)
        share = np.abs((first + second * turn) / (1.0 + first * second * turn)) ** 2
        found.append(float((share * weight).sum() / weight.sum()))
    return np.array(found)


@pytest.mark.parametrize("thickness", [1e-9, 4e-8, 1e-7, 2e-7, 3e-7, 5e-7, 8e-7, 1.2e-6, 2e-6, 5e-6, 5e-5, 2e-4, 1e-3])
def test_two_beams_in_three_bands_are_all_beams_and_wavelengths(thickness: float) -> None:
    assert np.abs(mirrored_light(thickness, OIL, WATER) - airy(thickness)).max() < 0.03 * CLEAN


def test_no_film_mirrors_as_water_and_a_thick_one_as_oil() -> None:
    assert mirrored_light(0.0, OIL, WATER) == pytest.approx(np.full(3, CLEAN), rel=0.02)
    assert mirrored_light(0.1, OIL, WATER) == pytest.approx(np.full(3, ((1 - OIL) / (1 + OIL)) ** 2), rel=1e-9)


def test_each_class_begins_where_the_appearance_code_has_it() -> None:
    """Brighter than water from 0.04 um, no colours of interference in the metallic class, true colour from 0.2 mm."""
    mirrored = {name: mirrored_light(least, OIL, WATER) for name, least in APPEARANCES.items()}
    assert mirrored["sheen"].max() > 1.9 * CLEAN > mirrored_light(0.02e-6, OIL, WATER).max()
    rainbow = mirrored_light(np.linspace(0.3e-6, 1.2e-6, 50), OIL, WATER)
    assert (np.ptp(rainbow, axis=-1) / rainbow.mean(axis=-1)).mean() > 0.3
    metallic = mirrored_light(np.geomspace(5e-6, 50e-6, 50), OIL, WATER)
    assert (np.ptp(metallic, axis=-1) / metallic.mean(axis=-1)).max() < 0.05
    green = light_through([5e-6, 50e-6, 200e-6])[:, 1]
    assert green[0] > 0.9
    assert 0.4 < green[1] < 0.6
    assert green[2] < 0.06


def test_a_film_lets_red_through_longest() -> None:
    red, green, blue = light_through(1e-4)
    assert 1.0 > red > green > blue > 0.0
    assert light_through(0.0) == pytest.approx(np.ones(3))
    assert light_through([1e-5, 2e-5])[1] == pytest.approx(light_through(1e-5) ** 2)


@pytest.mark.parametrize(("thickness", "name"), [
    (0.0, "clean water"), (3.9e-8, "clean water"), (4e-8, "sheen"), (1e-6, "rainbow"), (1e-5, "metallic"),
    (1e-4, "discontinuous true colour"), (0.2, "continuous true colour"),
])  # fmt: skip
def test_the_name_of_a_film(thickness: float, name: str) -> None:
    assert appearance(thickness) == name
