"""Oceans: dispersion, spectra, the FFT sea, rings, fluids, planets. `k` is the wavenumber [rad/m] in this package.

Conventions: SI units, radians, z up. Directions are where waves and wind go to, from +x towards +y. A wave is
Re[2 h0 exp(i(k.x - omega t))] with omega >= 0; Hs = 4 sqrt(m0), m0 the variance of the height.

The names of `__all__` are imported from here: seas and their waves, spectra and records, dispersion, statistics. All
seas have one interface, `AnySea`. The other modules are imported by their own paths.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.ocean.any_sea import AnySea
    from sim.ocean.crest_heights import HighCrests, forristall_crest, high_crests, narrow_band_moments
    from sim.ocean.dispersion import (
        group_speed,
        mode_ratios,
        omega,
        phase_speed,
        two_layer,
        viscous_root,
        viscous_two_layer,
        wavenumber,
    )
    from sim.ocean.gerstner import draw_waves
    from sim.ocean.measured import measured_spectrum
    from sim.ocean.nonlinear.energy import SeaEnergy
    from sim.ocean.nonlinear.packets import breather, modulated_waves
    from sim.ocean.nonlinear.sea import NonlinearSea
    from sim.ocean.nonlinear.stokes import StokesWave, stokes_wave
    from sim.ocean.radial import RadialSea
    from sim.ocean.recorded import recorded_waves
    from sim.ocean.ripples import Ripples, gaussian_volume
    from sim.ocean.sea import Sea
    from sim.ocean.spectra import SPECTRA
    from sim.ocean.spectra.moments import Moments
    from sim.ocean.spectrum_files import read_spectrum
    from sim.ocean.statistics import beaufort, expected, theory
    from sim.ocean.surface import Surface
    from sim.ocean.wave_record import zero_crossings
    from sim.water import Water
    from sim.waves import Waves

__all__ = [
    "SPECTRA",
    "AnySea",
    "HighCrests",
    "Moments",
    "NonlinearSea",
    "RadialSea",
    "Ripples",
    "Sea",
    "SeaEnergy",
    "StokesWave",
    "Surface",
    "Water",
    "Waves",
    "beaufort",
    "breather",
    "draw_waves",
    "expected",
    "forristall_crest",
    "gaussian_volume",
    "group_speed",
    "high_crests",
    "measured_spectrum",
    "mode_ratios",
    "modulated_waves",
    "narrow_band_moments",
    "omega",
    "phase_speed",
    "read_spectrum",
    "recorded_waves",
    "stokes_wave",
    "theory",
    "two_layer",
    "viscous_root",
    "viscous_two_layer",
    "wavenumber",
    "zero_crossings",
]  # fmt: skip

# Imported on first use, so that the closed forms of `sim.ocean.dispersion` cost neither numba nor pyfftw.
HOMES = {
    "AnySea": "sim.ocean.any_sea",
    "HighCrests": "sim.ocean.crest_heights",
    "Moments": "sim.ocean.spectra.moments",
    "NonlinearSea": "sim.ocean.nonlinear.sea",
    "RadialSea": "sim.ocean.radial",
    "Ripples": "sim.ocean.ripples",
    "SPECTRA": "sim.ocean.spectra",
    "Sea": "sim.ocean.sea",
    "SeaEnergy": "sim.ocean.nonlinear.energy",
    "StokesWave": "sim.ocean.nonlinear.stokes",
    "Surface": "sim.ocean.surface",
    "Water": "sim.water",
    "Waves": "sim.waves",
    "beaufort": "sim.ocean.statistics",
    "breather": "sim.ocean.nonlinear.packets",
    "draw_waves": "sim.ocean.gerstner",
    "expected": "sim.ocean.statistics",
    "forristall_crest": "sim.ocean.crest_heights",
    "gaussian_volume": "sim.ocean.ripples",
    "group_speed": "sim.ocean.dispersion",
    "high_crests": "sim.ocean.crest_heights",
    "measured_spectrum": "sim.ocean.measured",
    "mode_ratios": "sim.ocean.dispersion",
    "modulated_waves": "sim.ocean.nonlinear.packets",
    "narrow_band_moments": "sim.ocean.crest_heights",
    "omega": "sim.ocean.dispersion",
    "phase_speed": "sim.ocean.dispersion",
    "read_spectrum": "sim.ocean.spectrum_files",
    "recorded_waves": "sim.ocean.recorded",
    "stokes_wave": "sim.ocean.nonlinear.stokes",
    "theory": "sim.ocean.statistics",
    "two_layer": "sim.ocean.dispersion",
    "viscous_root": "sim.ocean.dispersion",
    "viscous_two_layer": "sim.ocean.dispersion",
    "wavenumber": "sim.ocean.dispersion",
    "zero_crossings": "sim.ocean.wave_record",
}


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(HOMES[name]), name)
