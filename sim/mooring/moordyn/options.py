"""The OPTIONS of a MoorDyn file."""

from typing import Any, NamedTuple

from sim.mooring.moordyn.sections import OPTIONS, check_columns, number_in
from sim.tables import Row, number_of
from sim.validation import Refusals, argument_error

# Options of a System and of its Water, by MoorDyn's names in small letters.
FIELDS = {
    "g": "gravity", "gravity": "gravity", "rhow": "density", "rho": "density", "wtrdnsty": "density",
    "wtrdens": "density", "wtrdpth": "depth", "depth": "depth", "kbot": "bed_stiffness", "kb": "bed_stiffness",
    "cbot": "bed_damping", "cb": "bed_damping", "frictioncoefficient": "friction", "mu_kt": "friction",
}  # fmt: skip
# They steer how MoorDyn steps, starts and writes.
STEERING = {"dtm", "dt", "cfl", "dtic", "tmaxic", "cdscaleic", "cddampscaleic", "threshic", "writelog", "tscheme",
            "writeunits", "dtout", "disableoutput", "disableouttime", "fricdamp", "statdynfricscale",
            "staticdynamicfrictionscale", "mu_ka", "mc", "icdfac", "icdt", "ictmax", "icthresh", "inertialf",
            "inertialf_rampt", "outswitch", "ic_gen", "startic", "cv", "icgendynamic", "gendynamicic", "fileic",
            "icfile", "dtwave", "unifycurrentgrid", "wavegrid", "echo"}  # fmt: skip
# Files of water and bed, which are not read: option -> what the user sets instead.
WATER = {"wavekin": "waves", "waves": "waves", "waterkin": "waves` and `current", "waterkinfile": "waves` and `current",
         "currents": "current", "currentmod": "current"}  # fmt: skip
BED = ("seafloorfile", "bathymetryfile")


class Options(NamedTuple):
    """The options of a file."""

    fields: dict[str, Any]  # of a System and of its Water
    steering: list[str]  # left out, without meaning here
    warnings: list[str]  # on those that are left out and may change forces


def read_options(rows: list[Row], wrong: Refusals) -> Options:
    """The options; refusals go to `wrong`."""
    options = Options({}, [], [])
    for row in rows:
        with wrong:
            add_option(options, row)
    return options


def add_option(options: Options, row: Row) -> None:
    """Add the option of a row: VALUE NAME, and text."""
    where = f"{OPTIONS}, line {row.number}"
    value, name = check_columns(where, row.words, 2, max(len(row.words), 2))[:2]
    key, where = name.lower(), f"{where}: {name}"
    if key in STEERING:
        options.steering.append(name)
    elif key in WATER:
        if value.strip("\"'").lower() not in ("", "none") and (
            number_of(value) is None or number_in(where, value) != 0.0
        ):
            options.warnings.append(
                f"{name} {value}: waves and currents of files are not read; set `{WATER[key]}` of the System"
            )
    elif key in BED or (key == "wtrdpth" and number_of(value) is None and "." in value):
        options.warnings.append(
            f"{name} {value}: the bed is level here, at the depth of the lowest anchor; set `water` of the System"
        )
    elif key in FIELDS:
        field = FIELDS[key]
        number = number_in(where, value)
        if options.fields.get(field, number) != number:
            raise argument_error(where, number, f"the number of its synonym in this file, {options.fields[field]:g}")
        options.fields[field] = number
    else:
        options.warnings.append(f"{name} {value}: an unknown option, left out")
