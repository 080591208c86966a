"""`springtide run SCENE --list`: parameters, presets and measures of a scene, in the width of the terminal.

Without SCENE, the scenes.
"""

import shutil
from collections.abc import Iterable
from typing import Any

from app.formats.text_tables import fold
from app.scenes import NAMES, scene_named
from app.scenes.contract import SceneKind
from app.scenes.quantities import Quantities, recorded_quantities
from app.scenes.setups import write_value
from sim.parameters import Parameter, parameters_of

INDENT = 4  # [characters] of the lines below a name


def list_scenes() -> int:
    """Print the name and the title of each scene; returns the exit status."""
    print("Scenes (springtide run SCENE)")
    print_entries((name, scene_named(name).title) for name in NAMES)
    return 0


def list_scene(kind: SceneKind[Any, Any, Any]) -> int:
    """Print all that a run of the scene can be given and measures; returns the exit status."""
    recorded = recorded_quantities(kind)
    sections = {
        "Presets (--preset NAME)": [(name, kind.about.get(name, "")) for name in kind.presets],
        "Parameters (--set NAME=VALUE)": [
            (f"{name} = {setting_text(p)}", meaning_text(p)) for name, p in parameters_of(kind.params).items()
        ],
        "Measures (in a sweep)": quantity_entries(recorded),
        "Further numbers (in tasks of the lab)": quantity_entries(
            {name: q for name, q in kind.quantities.items() if name not in recorded}
        ),
    }
    print(f"{kind.title} ({kind.name})")
    for heading, entries in sections.items():
        if entries:
            print(f"\n{heading}")
            print_entries(entries)
    return 0


def print_entries(entries: Iterable[tuple[str, str]]) -> None:
    """Print names, each with its meaning below, folded between words."""
    width, margin = shutil.get_terminal_size().columns, " " * INDENT
    for name, meaning in entries:
        print(f"  {name}")
        if meaning:
            print("\n".join(fold(margin + meaning, width)))


def quantity_entries(table: Quantities) -> list[tuple[str, str]]:
    """The names of quantities with their units, each with its meaning, and whether tasks lack it."""
    return [(f"{name} [{q.unit}]", q.meaning + ("" if q.shown else "; not in tasks")) for name, q in table.items()]


def setting_text(parameter: Parameter) -> str:
    """The default with its unit."""
    default = write_value(parameter.default)
    return (f'"{default}"' if " " in default else default) + (f" {parameter.unit}" if parameter.unit else "")


def meaning_text(parameter: Parameter) -> str:
    """The meaning, and the allowed values."""
    return f"{parameter.doc}. Allowed: {parameter.allowed}."
