"""The parameters of all spectra as the panels of both seas hold them: angles in degrees, which the library takes in
radians."""

import math
from typing import Any

from sim.ocean.spectra import PARAMETERS
from sim.parameters import Parameter


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
