"""Wave spectra S(kx, ky) [m4]: one file each, found by looking. The integral over the wavenumber plane is m0.

To add one: write a file here with a `SPECTRUM = Spectrum(...)` (see record.py). Its `density` takes kx, ky [rad/m]
and `Conditions` and returns S; a spectrum known by frequency goes through `from_frequency`. Declare Hs and the peak
in closed form where they exist: the tests hold every declared one against the integral.
"""

import importlib
import pkgutil

from sim.ocean.spectra.record import Conditions, Spectrum

__all__ = ["SPECTRA", "Conditions", "Spectrum"]


def _discover() -> dict[str, Spectrum]:
    found: dict[str, Spectrum] = {}
    for module in pkgutil.iter_modules(__path__):
        spectrum = getattr(importlib.import_module(f"{__name__}.{module.name}"), "SPECTRUM", None)
        if isinstance(spectrum, Spectrum):
            found[spectrum.name] = spectrum
    return found


SPECTRA = _discover()
