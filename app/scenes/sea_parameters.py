"""Parameters that both seas have: skies, and those of all spectra, with angles in degrees, which the library takes in
radians."""

import math
from typing import Any

from sim.ocean.spectra import PARAMETERS, SPECTRA
from sim.parameters import Parameter

SPECTRUM_TITLES = {
    name: SPECTRA[name].title for name in sorted(SPECTRA, key=["pierson_moskowitz", "phillips", *SPECTRA].index)
}
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
