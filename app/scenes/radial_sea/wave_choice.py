"""Random waves of the radial sea, by the parameters that determine them."""

from typing import Any, NamedTuple

from app.scenes.radial_sea.parameters import RadialSeaParams, conditions_of, spectrum_of
from sim.ocean.radial.gerstner import draw_waves
from sim.ocean.spectra import Conditions, Spectrum
from sim.waves import Waves


class WaveChoice(NamedTuple):
    """Choices that determine the random waves; equal choices have equal waves."""

    spectrum: Spectrum[Any]
    conditions: Conditions
    wave_count: int


def wave_choice_of(params: RadialSeaParams) -> WaveChoice:
    """Waves of these parameters."""
    return WaveChoice(spectrum_of(params), conditions_of(params), params.wave_count)


def draw(choice: WaveChoice) -> Waves:
    """The waves of a choice."""
    return draw_waves(choice.spectrum, choice.conditions, choice.wave_count)
