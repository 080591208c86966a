"""Numbers of an opened MoorDyn file that the panel changes, and the file with them."""

import dataclasses
import re
from collections.abc import Mapping
from pathlib import PureWindowsPath

from app.scenes.contract import FileEditing
from app.scenes.mooring.files.from_file import content_of, opened
from app.scenes.mooring.parameters import MooringParams
from sim.mooring import Line

LENGTH, DIAMETER = "Length [m]", "Diameter of its type [m]"
OF_ROD = re.compile(r"rod\d+")  # the line type that `read_moordyn` makes of a rod: no row of lines has it


def title(line: Line) -> str:
    """A line as it is chosen."""
    return f"{line.id}, {line.type.name}"


def lines_of(params: MooringParams) -> dict[str, Line]:
    """The lines of the file by their titles; none without a file."""
    lines = opened(params).system.lines if params.moordyn_file else ()
    return {title(line): line for line in lines if not OF_ROD.fullmatch(line.type.name)}


def numbers(params: MooringParams) -> dict[str, dict[str, float]]:
    """The numbers of each line that can be changed."""
    return {name: {LENGTH: one.length, DIAMETER: one.type.diameter} for name, one in lines_of(params).items()}


def changed(params: MooringParams, thing: str, values: Mapping[str, float]) -> MooringParams:
    """The parameters with other numbers of a line. Raises ValueError if the file cannot have them.

    A number that the file has itself is no change.
    """
    line = lines_of(dataclasses.replace(params, file_changes=()))[thing]
    changes = {(what, of): value for what, of, value in params.file_changes}
    changes["length", str(line.id)] = values[LENGTH]
    changes["diameter", line.type.name] = values[DIAMETER]
    own = {("length", str(line.id), line.length), ("diameter", line.type.name, line.type.diameter)}
    new_params = dataclasses.replace(
        params,
        file_changes=tuple(
            (what, of, value) for (what, of), value in sorted(changes.items()) if (what, of, value) not in own
        ),
    )
    opened(new_params)
    return new_params


def content(params: MooringParams) -> tuple[str, bytes]:
    """Name and content of the file with the changes."""
    path = PureWindowsPath(params.moordyn_file)
    name = f"{path.stem}-changed{path.suffix}" if params.file_changes else path.name
    return name, content_of(params.moordyn_file, params.file_changes)


EDITING = FileEditing("Lines of the file", "Line", numbers, changed, content)
