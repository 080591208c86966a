"""Folders of kernels that are only read, and processors that share their kernels."""

import os
import shutil
from pathlib import Path

import pytest

from sim import cache
from sim.cache import LEVELS, host_levels, level_environment
from tests.fresh import noted, python

# Prints how many of two kernels, of which one calls the other, were loaded and how many compiled, and what they give.
TWICE = """
import numpy as np, twice
x = np.ones(3)
twice.add_twice(x)
print(sum(twice.add_twice.stats.cache_hits.values()), sum(twice.add_twice.stats.cache_misses.values()), x[0])
"""
SOURCE = '''
from sim.jit import kernel
{}
@kernel
def add_one(x):
    """Docstring."""
    for j in range(x.shape[0]):
        x[j] += 1.0

@kernel
def add_twice(x):
    add_one(x)
    add_one(x)
'''
LOADED, COMPILED = "1 0 3.0", "0 1 3.0"
# Python takes byte code for new if the time of the source in whole seconds, and its size, are the same.
NO_BYTE_CODE = {"PYTHONDONTWRITEBYTECODE": "1"}


class Place:
    """A module with kernels, a folder of the user and one that is only read."""

    def __init__(self, folder: Path) -> None:
        self.module, self.own, self.shared = folder / "twice.py", folder / "own", folder / "shared"
        self.module.write_text(SOURCE.format(""), "utf-8")

    def run(self, own: Path | None = None, shared: Path | None = None, level: str = "", **environment: str) -> str:
        """What two kernels do with these folders."""
        environment = {
            "SPRINGTIDE_CACHE": str(own or self.own),
            "SPRINGTIDE_KERNELS": os.pathsep.join([*([str(shared)] if shared else []), noted()]),
            "PYTHONPATH": str(self.module.parent),
            **NO_BYTE_CODE,
            **environment,
        }
        return python(TWICE, **environment, **(level_environment(level) if level else {}))

    def files(self, folder: Path) -> dict[str, tuple[int, bytes]]:
        """Time and content of each file of a folder."""
        return {str(p): (p.stat().st_mtime_ns, p.read_bytes()) for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture
def place(tmp_path: Path) -> Place:
    return Place(tmp_path)


def test_a_folder_of_another_is_read_and_not_written(place: Place) -> None:
    assert place.run(own=place.shared) == COMPILED
    before = place.files(place.shared)
    assert place.run(shared=place.shared) == LOADED
    place.module.write_text(
        SOURCE.format("# A comment that moves the kernels.\n\n").replace("Docstring", "Another"), "utf-8"
    )
    assert place.run(shared=place.shared) == LOADED
    nowhere = place.module  # a file: no folder can be made there
    assert place.run(own=nowhere, shared=place.shared) == LOADED
    assert not list(place.own.rglob("*.nb?"))
    place.module.write_text(SOURCE.format("").replace("1.0", "2.0"), "utf-8")
    assert place.run(shared=place.shared) == "0 1 5.0"
    assert list(place.own.rglob("*.nbc"))
    assert place.files(place.shared) == before


def test_what_is_broken_in_such_a_folder_is_compiled_anew(place: Place) -> None:
    place.run(own=place.shared)
    kept = list(place.shared.rglob("*.nbc"))
    assert len(kept) == 2  # the caller, and its callee as it was linked into it
    for path in kept:
        path.write_bytes(path.read_bytes()[:40])
    before = place.files(place.shared)
    assert place.run(shared=place.shared) == COMPILED
    assert place.run(shared=place.shared) == LOADED
    assert place.files(place.shared) == before
    for path in place.shared.rglob("*.nbi"):
        path.write_text("no index", "utf-8")
    shutil.rmtree(place.own)
    assert place.run(shared=place.shared) == COMPILED


def test_one_changed_bit_in_machine_code_is_noticed(place: Place) -> None:
    place.run(own=place.shared)
    (path,) = (path for path in place.shared.rglob("*.nbc") if "-part" not in path.name)
    content = bytearray(path.read_bytes())
    content[content.index(b".text") - 9] ^= 1  # in the middle of the object file
    path.write_bytes(content)
    assert place.run(shared=place.shared) == COMPILED


def test_kernels_of_the_distribution_are_found_where_it_is_installed(place: Place, tmp_path: Path) -> None:
    package = tmp_path / "site" / cache.PACKAGE
    assert place.run(own=package) == COMPILED
    for part in package.rglob("*-part*"):
        part.unlink()  # callers from Python need none
    before = place.files(package)
    paths = os.pathsep.join([str(place.module.parent), str(package.parent)])
    surroundings = {"SPRINGTIDE_CACHE": str(place.own), "PYTHONPATH": paths, **NO_BYTE_CODE}
    assert python(TWICE, **surroundings) == LOADED
    assert not list(place.own.rglob("*.nb?"))
    place.module.write_text(SOURCE.format("").replace("1.0", "2.0"), "utf-8")
    assert not (place.module.parent / "__pycache__").exists()
    assert python(TWICE, **surroundings) == "0 1 5.0"
    assert place.files(package) == before


@pytest.mark.parametrize("named", ["", "STEP"])
def test_a_kernel_of_old_byte_code_is_not_kept_for_the_new_source(place: Place, named: str) -> None:
    """Python runs the old byte code; the next one, which reads the source, does not get that kernel."""
    source = SOURCE.format("STEP = 1.0").replace("+= 1.0", f"+= {named or 1.0}")
    place.module.write_text(source, "utf-8")
    second = place.module.stat().st_mtime_ns // 10**9 * 10**9
    os.utime(place.module, ns=(second, second))
    byte_code = {"PYTHONDONTWRITEBYTECODE": ""}
    assert place.run(**byte_code) == COMPILED
    place.module.write_text(source.replace("1.0", "2.0"), "utf-8")
    os.utime(place.module, ns=(second, second))
    assert place.run(**byte_code) == COMPILED
    shutil.rmtree(place.module.parent / "__pycache__")
    assert place.run() == "0 1 5.0"
    assert place.run() == "1 0 5.0"


def test_kernels_of_another_processor_are_left_alone(place: Place) -> None:
    place.run(own=place.shared)
    (folder,) = (place.shared / "kernels").iterdir()
    folder.rename(folder.with_name("another-processor"))
    assert place.run(shared=place.shared) == COMPILED


@pytest.mark.parametrize("level", host_levels())
def test_kernels_of_a_level_serve_a_processor_that_has_it(level: str, place: Place) -> None:
    assert place.run(own=place.shared, level=level) == COMPILED
    name = f"{level}{cache.VECTOR_LIBRARY}"
    assert [folder.name.partition("-")[2] for folder in (place.shared / "kernels").iterdir()] == [name]
    assert place.run(shared=place.shared) == LOADED


def test_a_processor_has_the_levels_of_which_it_has_all_features(monkeypatch: pytest.MonkeyPatch) -> None:
    v3, v4 = (set(LEVELS[f"x86-64-v{number}"].features) for number in (3, 4))
    assert v3 < v4
    cases = (
        ("x86_64", v4, ("x86-64-v4", "x86-64-v3")),
        ("AMD64", v3 | {"avx512f"}, ("x86-64-v3",)),
        ("x86_64", v3 - {"fma"}, ()),
        ("aarch64", {"neon"}, ("arm64",)),
        ("riscv64", v4, ()),
    )
    for machine, features, levels in cases:
        monkeypatch.setattr(cache.platform, "machine", lambda machine=machine: machine)
        monkeypatch.setattr(cache, "host_features", lambda features=features: dict.fromkeys(features, True))
        assert host_levels() == levels
    with pytest.raises(ValueError, match=r"--processor: 'arm64' is not allowed; allowed: .*none"):
        level_environment("arm64")


def test_shared_folders_are_those_of_the_variable_and_of_the_installation(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("SPRINGTIDE_CACHE", str(tmp_path / "own"))
    monkeypatch.delenv("SPRINGTIDE_KERNELS", raising=False)
    assert cache.shared_folders() == (cache.INSTALLED,)
    folders = tmp_path / "a", tmp_path / "own", tmp_path / "b"
    monkeypatch.setenv("SPRINGTIDE_KERNELS", os.pathsep.join(map(str, folders)))
    assert cache.shared_folders() == (tmp_path / "a", tmp_path / "b", cache.INSTALLED)
    monkeypatch.setenv("SPRINGTIDE_KERNELS", "")
    assert cache.shared_folders() == ()


NOWHERE = """
import warnings
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("default")
    import numpy as np, twice
    twice.add_twice(np.ones(3))
print([str(warning.message) for warning in said])
"""


def test_where_nothing_can_be_kept_one_line_says_so(place: Place) -> None:
    environment = {"SPRINGTIDE_CACHE": str(place.module), "PYTHONPATH": str(place.module.parent)}
    said = "['no folder for kernels is writable: missing kernels are compiled at each start']"
    assert python(NOWHERE, **environment) == said


HOMELESS = """
import os, pwd
def unknown(number):
    raise KeyError(number)
pwd.getpwuid = unknown
for name in ("HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "SPRINGTIDE_CACHE", "SPRINGTIDE_DATA"):
    os.environ.pop(name, None)
from app.scenes.own_setups import data_folder
from sim.cache import own_folder
for folder in (own_folder(), data_folder()):
    try:
        folder.mkdir(parents=True)
    except OSError:
        print("not made")
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows knows the folder of each user")
def test_a_user_without_a_home_folder_has_folders_that_cannot_be_made(place: Place) -> None:
    """As in a container that is run by a number without an entry in the list of users."""
    assert python(HOMELESS).split("\n") == ["not made", "not made"]
    environment = {"PYTHONPATH": str(place.module.parent)}
    said = "['no folder for kernels is writable: missing kernels are compiled at each start']"
    assert python(HOMELESS.partition("from app")[0] + NOWHERE, **environment) == said


def test_kernels_that_call_a_vector_library_lie_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = cache.target_name()
    for library in ("", "-svml"):
        monkeypatch.setattr(cache, "VECTOR_LIBRARY", library)
        assert cache.processor() == f"{plain}{library}"
