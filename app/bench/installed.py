"""Which peers there are to compare with."""

import importlib.util


def is_installed(package: str) -> bool:
    """Whether a package can be imported, without importing it."""
    return importlib.util.find_spec(package) is not None


def why_left_out(package: str, size: int, largest: int) -> str:
    """Why a peer is not timed on a task of a size, or ""."""
    if not is_installed(package):
        return "not installed"
    return "left out: minutes a run" if size > largest else ""
