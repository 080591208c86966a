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
    from sim.ocean.fluids.fluid_column import FluidColumn
    from sim.ocean.nonlinear.energy import SeaEnergy
    from sim.ocean.nonlinear.sea import NonlinearSea
    from sim.ocean.nonlinear.starts.packets import breather, modulated_waves
    from sim.ocean.nonlinear.starts.stokes import StokesWave, stokes_wave
    from sim.ocean.radial.gerstner import draw_waves
    from sim.ocean.radial.radial import RadialSea
    from sim.ocean.records.measured import measured_spectrum
    from sim.ocean.records.recorded import recorded_waves
    from sim.ocean.records.wave_record import zero_crossings
    from sim.ocean.spectra import SPECTRA, Conditions
    from sim.ocean.spectra.moments import Moments
    from sim.ocean.spectrum_files import SpectrumSeries, read_spectra, read_spectrum
    from sim.ocean.spectrum_files.records import read_record
    from sim.ocean.statistics.crest_heights import HighCrests, forristall_crest, high_crests, narrow_band_moments
    from sim.ocean.statistics.statistics import beaufort, expected, theory
    from sim.ocean.tile.ripples import Ripples, gaussian_volume
    from sim.ocean.tile.sea import Sea
    from sim.ocean.tile.surface import Surface
    from sim.water import Water
    from sim.waves import Waves

__all__ = [
    "SPECTRA", "AnySea", "Conditions", "FluidColumn", "HighCrests", "Moments", "NonlinearSea", "RadialSea", "Ripples",
    "Sea", "SeaEnergy", "SpectrumSeries", "StokesWave", "Surface", "Water", "Waves", "beaufort", "breather",
    "draw_waves", "expected", "forristall_crest", "gaussian_volume", "group_speed", "high_crests", "measured_spectrum",
    "mode_ratios", "modulated_waves", "narrow_band_moments", "omega", "phase_speed", "read_record", "read_spectra",
    "read_spectrum", "recorded_waves", "stokes_wave", "theory", "two_layer", "viscous_root", "viscous_two_layer",
    "wavenumber", "zero_crossings",
]  # fmt: skip

# Imported on first use, so that the closed forms of `sim.ocean.dispersion` cost neither numba nor pyfftw.
HOMES = {
    "sim.ocean.any_sea": "AnySea",
    "sim.ocean.dispersion": "group_speed mode_ratios omega phase_speed two_layer viscous_root "
    "viscous_two_layer wavenumber",
    "sim.ocean.nonlinear.energy": "SeaEnergy",
    "sim.ocean.nonlinear.starts.packets": "breather modulated_waves",
    "sim.ocean.nonlinear.sea": "NonlinearSea",
    "sim.ocean.nonlinear.starts.stokes": "StokesWave stokes_wave",
    "sim.ocean.radial.gerstner": "draw_waves",
    "sim.ocean.radial.radial": "RadialSea",
    "sim.ocean.records.measured": "measured_spectrum",
    "sim.ocean.records.recorded": "recorded_waves",
    "sim.ocean.records.wave_record": "zero_crossings",
    "sim.ocean.fluids.fluid_column": "FluidColumn",
    "sim.ocean.spectra": "SPECTRA Conditions",
    "sim.ocean.spectra.moments": "Moments",
    "sim.ocean.spectrum_files": "SpectrumSeries read_spectra read_spectrum",
    "sim.ocean.spectrum_files.records": "read_record",
    "sim.ocean.statistics.crest_heights": "HighCrests forristall_crest high_crests narrow_band_moments",
    "sim.ocean.statistics.statistics": "beaufort expected theory",
    "sim.ocean.tile.ripples": "Ripples gaussian_volume",
    "sim.ocean.tile.sea": "Sea",
    "sim.ocean.tile.surface": "Surface",
    "sim.water": "Water",
    "sim.waves": "Waves",
}
HOME_OF = {name: home for home, names in HOMES.items() for name in names.split()}


def __getattr__(name: str) -> Any:
    if name not in HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(HOME_OF[name]), name)
