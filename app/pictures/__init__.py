"""How each scene is drawn: one module each, named as in `app/scenes`. Handles are made once and then assigned to."""

import importlib
from types import ModuleType


def picture_named(name: str) -> ModuleType:
    return importlib.import_module(f"{__name__}.{name}")
