"""Parameters that both seas have: skies, and those of all spectra, with angles in degrees, which the library takes in
radians."""

import functools
import math
from typing import Any

from sim.ocean.radial.gerstner import peak_wavenumber
from sim.ocean.spectra import PARAMETERS, SPECTRA, Spectrum
from sim.parameters import Parameter, parameters_of
from sim.quantities import read_number
from sim.validation import argument_error

SPECTRUM_TITLES = {
    name: SPECTRA[name].title for name in sorted(SPECTRA, key=["pierson_moskowitz", "phillips", *SPECTRA].index)
}
TILE_WAVELENGTHS = 10.0  # of the peak, along the side of a tile: it then holds Hs within 1 %
SKY_TITLES = {"park": "Day", "sunset": "Sunset", "dawn": "Dawn", "night": "Night"}


def in_degrees(declared: Parameter) -> Parameter:
    """The same parameter in degrees, where it is an angle [rad]."""
    if declared.unit != "rad":
        return declared
    default, low, high = (math.degrees(float(value)) for value in (declared.default, declared.low, declared.high))
    return declared._replace(default=default, low=low, high=high, unit="°")


SPECTRUM_PARAMETERS = {name: in_degrees(declared) for name, declared in PARAMETERS.items()}


def spectrum_values(params: object) -> dict[str, Any]:
    """The values of the parameters of all spectra, as the library takes them."""
    values = {name: getattr(params, name) for name in PARAMETERS}
    return {name: math.radians(v) if PARAMETERS[name].unit == "rad" else v for name, v in values.items()}


def missing_values(text: str) -> tuple[float, ...] | None:
    """The numbers that stand for a missing value in a file, by `--spectrum-missing`; None by the file's own rule.

    text: numbers and commas, "none", or "" for the file's rule. Raises ValueError.
    """
    if not text:
        return None
    try:
        return () if text == "none" else tuple(map(read_number, text.split(",")))
    except ValueError:
        allowed = 'numbers and commas, such as 99,999, or "none"'
        raise argument_error("--spectrum-missing", text, allowed) from None


@functools.lru_cache(maxsize=8)
def spectrum_in_file(path: str, time: str, missing: str) -> Spectrum[Any]:
    """The measured spectrum in a file, read once. Raises as `read_spectrum`.

    time: of its record, "" for the last. missing: see `missing_values`.
    """
    from sim.ocean import read_spectrum  # a start without a file does without the formats of files

    return read_spectrum(path, time or None, missing=missing_values(missing))


def measured_spectrum(params: Any) -> Spectrum[Any]:
    """The spectrum of a sea's file."""
    return spectrum_in_file(params.spectrum_file, params.spectrum_time, params.spectrum_missing)


def chosen_spectrum(params: Any) -> Spectrum[Any]:
    """The spectrum of a sea's parameters: that of a file, if there is one."""
    return measured_spectrum(params) if params.spectrum_file else SPECTRA[params.spectrum]


def notes_on_file(params: Any) -> tuple[str, ...]:
    """Lines on the file of a measured spectrum, none without one."""
    return chosen_spectrum(params).notes if params.spectrum_file else ()


def unused_waves(params: Any) -> set[str]:
    """Names of the parameters of waves that have no effect on the chosen spectrum."""
    unused = chosen_spectrum(params).unused(spectrum_values(params))
    return unused | {"spectrum"} if params.spectrum_file else unused


def follows_wind(params: Any) -> bool:
    """True if the waves run about the wind's direction: all but those of a file with directions of its own."""
    return not params.spectrum_file or chosen_spectrum(params).uses("spreading")


def tile_length(spectrum: Spectrum[Any], params: Any) -> float:
    """Side [m] of a tile that holds the waves of a measured spectrum, within the limits of the parameter."""
    length = TILE_WAVELENGTHS * 2.0 * math.pi / peak_wavenumber(spectrum, spectrum.conditions())
    allowed = parameters_of(params)["length"]
    return min(max(float(f"{length:.2g}"), allowed.low), allowed.high)
