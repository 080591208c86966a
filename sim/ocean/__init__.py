"""Oceans: dispersion, spectra, the FFT sea, rings, fluids, planets. `k` is the wavenumber [rad/m] in this package.

Conventions: SI units, radians, z up. Directions are where waves and wind go to, from +x towards +y. A wave is
Re[2 h0 exp(i(k.x - omega t))] with omega >= 0; Hs = 4 sqrt(m0), m0 the variance of the height.

`SPECTRA`, `Sea`, `RadialSea`, `draw_waves`, `measured_spectrum`, `read_record`, `read_spectrum`, `recorded_waves` and
`zero_crossings` are imported from here. Waves of `draw_waves`, `recorded_waves` and `Sea.waves_at` are
`sim.waves.Waves`.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.ocean.gerstner import draw_waves
    from sim.ocean.measured import measured_spectrum
    from sim.ocean.radial import RadialSea
    from sim.ocean.recorded import recorded_waves
    from sim.ocean.sea import Sea
    from sim.ocean.spectra import SPECTRA
    from sim.ocean.spectrum_files import read_spectrum
    from sim.ocean.spectrum_files.records import read_record
    from sim.ocean.wave_record import zero_crossings

__all__ = [
    "SPECTRA", "RadialSea", "Sea", "draw_waves", "measured_spectrum", "read_record", "read_spectrum", "recorded_waves",
    "zero_crossings",
]  # fmt: skip

# Imported on first use, so that the closed forms of `sim.ocean.dispersion` cost neither numba nor pyfftw.
HOMES = {
    "SPECTRA": "sim.ocean.spectra",
    "RadialSea": "sim.ocean.radial",
    "Sea": "sim.ocean.sea",
    "draw_waves": "sim.ocean.gerstner",
    "measured_spectrum": "sim.ocean.measured",
    "read_record": "sim.ocean.spectrum_files.records",
    "read_spectrum": "sim.ocean.spectrum_files",
    "recorded_waves": "sim.ocean.recorded",
    "zero_crossings": "sim.ocean.wave_record",
}


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(HOMES[name]), name)
