"""Wave spectra S(kx, ky) [m4]: one file each, found by looking. The integral over the wavenumber plane is m0.

To add one: write a file here with a `SPECTRUM = Spectrum(...)` (see record.py). Its `density` takes kx, ky [rad/m]
and its conditions and returns S; a spectrum known by frequency goes through `from_frequency`. Declare Hs and the peak
in closed form where they exist: the tests hold every declared one against the integral. A spectrum with parameters of
its own declares them in a class that extends `Conditions`.
"""

import importlib
import pkgutil
from typing import Any

from sim.ocean.spectra.record import SPECTRA, Conditions, Spectrum
from sim.parameters import Parameter, parameters_of

__all__ = ["PARAMETERS", "SPECTRA", "Conditions", "Spectrum"]


def _discover() -> dict[str, Spectrum[Any]]:
    spectra: dict[str, Spectrum[Any]] = {}
    for module in pkgutil.iter_modules(__path__):
        spectrum = getattr(importlib.import_module(f"{__name__}.{module.name}"), "SPECTRUM", None)
        if isinstance(spectrum, Spectrum):
            spectra[spectrum.name] = spectrum
    return spectra


def _declared() -> dict[str, Parameter]:
    """Raises ValueError if two spectra declare one name differently."""
    parameters: dict[str, Parameter] = {}
    for spectrum in SPECTRA.values():
        for name, declared in parameters_of(spectrum.conditions).items():
            if parameters.setdefault(name, declared) != declared:
                raise ValueError(f"{name}: declared differently by {spectrum.name} and by another spectrum")
    return parameters


SPECTRA.update(_discover())
PARAMETERS = _declared()  # of all spectra, by name
