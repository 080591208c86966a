"""Oceans: dispersion, spectra, the FFT sea, rings, fluids, planets. `k` is the wavenumber [rad/m] in this package.

Conventions: SI units, radians, z up. Directions are where waves and wind go to, from +x towards +y. A wave is
Re[2 h0 exp(i(k.x - omega t))] with omega >= 0; Hs = 4 sqrt(m0), m0 the variance of the height.

`Sea` and `SPECTRA` are imported on first use, so that the closed forms of `sim.ocean.dispersion` cost neither numba nor
pyfftw.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.ocean.sea import Sea
    from sim.ocean.spectra import SPECTRA

__all__ = ["SPECTRA", "Sea"]


def __getattr__(name: str) -> Any:
    if name == "Sea":
        from sim.ocean.sea import Sea

        return Sea
    if name == "SPECTRA":
        from sim.ocean.spectra import SPECTRA

        return SPECTRA
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
