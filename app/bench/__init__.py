"""`springtide bench`. benchmarks/, which is not installed, measures parts of the program, C and other programs."""

import pkgutil
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]


def in_checkout() -> bool:
    """True if benchmarks/ lies beside the package; an installed one is somebody else's."""
    return (CHECKOUT / "benchmarks" / "command.py").is_file()


def places() -> dict[str, str]:
    """Name of each benchmark -> its module, in alphabetical order; imports none of them."""
    packages = ["app.bench.cases", *(["benchmarks.cases"] if in_checkout() else [])]
    folders = {package: str(CHECKOUT.joinpath(*package.split("."))) for package in packages}
    found = {info.name: package for package in packages for info in pkgutil.iter_modules([folders[package]])}
    return {name.rstrip("_"): f"{found[name]}.{name}" for name in sorted(found)}  # `class_` for the word `class`
