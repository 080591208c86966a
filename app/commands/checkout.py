"""Commands of a checkout of the repository, where benchmarks/ lies beside the package."""

import importlib
from pathlib import Path
from types import ModuleType

ELSEWHERE = "works only in a checkout of the repository, which has benchmarks/"
CHECKOUT = Path(__file__).resolve().parents[2]


def in_checkout() -> bool:
    """True if benchmarks/ lies beside the package; an installed one is somebody else's."""
    return (CHECKOUT / "benchmarks" / "command.py").is_file()


def of_checkout(command: str, module: str) -> ModuleType:
    """A module of benchmarks/. Raises ValueError, naming the command or option, outside a checkout."""
    if not in_checkout():
        raise ValueError(f"{command}: {ELSEWHERE}")
    return importlib.import_module(f"benchmarks.{module}")
