"""Whatever the pages name of the library is imported from the package that it belongs to."""

import importlib
import re

import pytest

from tests.docs.pages import ROOT, TODAY

PACKAGES = ("sim.floating", "sim.mooring", "sim.ocean", "sim.springs")
MEMBERS = re.compile(r"^\.\. automodule:: (sim[\w.]*)\n   :members: (\w.*)$", re.MULTILINE)
IMPORT = re.compile(r"^from (sim\.(?:floating|mooring|ocean|springs)) import ([\w, ]+)$", re.MULTILINE)


def named() -> set[tuple[str, str]]:
    """(package, name) of what the table of the library names, and what programs of the pages import."""
    library = (ROOT / "docs" / "library.rst").read_text("utf-8")
    found = {
        (package, name)
        for module, names in MEMBERS.findall(library)
        for package in PACKAGES
        if f"{module}.".startswith(f"{package}.")
        for name in names.split(", ")
    }
    for page in TODAY:
        for package, names in IMPORT.findall(page.read_text("utf-8")):
            found |= {(package, name.strip()) for name in names.split(",")}
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_exports_what_the_pages_name(package: str) -> None:
    module = importlib.import_module(package)
    wanted = {name for owner, name in named() if owner == package}
    assert wanted
    assert wanted - set(module.__all__) == set()
    for name in module.__all__:
        assert getattr(module, name) is not None
