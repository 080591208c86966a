"""The scenes: one folder each, found by being here, imported on first use. `contract.py` is their contract."""

import importlib
import pkgutil
from pathlib import Path
from typing import TYPE_CHECKING

from sim.parameters import choice_error
from sim.validation import argument_error

if TYPE_CHECKING:
    from app.scenes.contract import AnyKind, AnyView

NAMES = tuple(
    module.name
    for module in pkgutil.iter_modules(__path__)
    if module.ispkg and any((Path(folder) / module.name / "scene.py").exists() for folder in __path__)
)
FORMER_NAMES = {"phillips": "square_sea", "radial": "radial_sea"}


def check_name(name: str) -> str:
    """The name of a scene. Raises ValueError with the names there are; for a former name, with its new one."""
    if name in FORMER_NAMES:
        raise argument_error("scene", name, f"{FORMER_NAMES[name]}, its new name")
    if name not in NAMES:
        raise choice_error("scene", name, NAMES)
    return name


def scene_named(name: str) -> "AnyKind":
    """The scene of a folder. Raises ValueError for an unknown name."""
    return importlib.import_module(f"{__name__}.{check_name(name)}").SCENE


def view_named(name: str) -> "type[AnyView]":
    """The class that draws a scene; imports viser."""
    return importlib.import_module(f"{__name__}.{check_name(name)}.view").VIEW
