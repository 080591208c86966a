"""What is not imported where it is not needed, as it takes time or need not be installed."""

import subprocess
import sys
from pathlib import Path

import pytest

from app.scenes import NAMES
from app.scenes.ahead import compiling

ROOT = Path(__file__).parents[2]
# Each part and packages that are not there once it has run, after those before it in the same process. Where scipy is
# installed numba itself loads scipy.linalg for its BLAS; nothing of ours may need it.
DRAWING = {"pyfftw", "matplotlib", "trimesh"}
SEAS = {"sim.ocean", "sim.floating", "sim.particles"}
RUN = "from app.__main__ import main; main(['run', 'rope', '--seconds', '0.1', '--out', sys.argv[1]])"
SERVE = "from app.server.viewer import Viewer; v = Viewer('127.0.0.1', 0); v.open('rope'); v.shut()"
PARTS = (
    ("import sim.springs, sim.springs.stability, sim.springs.statics", {*DRAWING, "viser", "rich", "app", "assets"}),
    ("from app.scenes import scene_named; scene_named('rope')", DRAWING | SEAS),
    (RUN, {*DRAWING, "viser"}),
    (SERVE, DRAWING),
)
WAVES = (("import sim.ocean.dispersion", {"pyfftw", "numba"}),)


def python(code: str, *arguments: str) -> list[str]:
    """The lines that a fresh interpreter prints."""
    command = [sys.executable, "-c", f"import sys\n{code}", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, encoding="locale", check=True).stdout.splitlines()


@pytest.mark.parametrize("parts", [PARTS, WAVES], ids=["springs", "waves"])
def test_a_part_imports_nothing_that_it_does_not_need(parts: tuple[tuple[str, set[str]], ...], tmp_path: Path) -> None:
    code = "".join(f"{part}\nprint('loaded:', *sys.modules)\n" for part, _ in parts)
    said = python(f"sys.modules['scipy'] = None\n{code}", str(tmp_path / "a.npz"))
    loaded = [set(line.split()) for line in said if line.startswith("loaded:")]
    for (part, absent), names in zip(parts, loaded, strict=True):
        assert "sim" in names
        assert not names & absent, part


def test_kept_kernels_need_nothing_that_compiles() -> None:
    code = f"{SERVE}; print(*sys.modules)"
    python(code)  # compiles what is missing
    assert not set(python(code)[-1].split()) & {"numba.np.arraymath", "numba.np.linalg", "scipy.linalg"}


LISTENING = """
from app.commands import serve
from app.__main__ import main
serve.Opening.start = lambda opening: print("loaded:", *sys.modules)
serve.wait_until = lambda *_: None
main(["--scene", "cloth", "--no-open", "--port", "0"])
"""


def test_the_page_is_served_before_what_compiles_is_imported() -> None:
    loaded = next(line.split() for line in python(LISTENING) if line.startswith("loaded:"))
    assert "viser" in loaded
    assert {name.split(".")[0] for name in loaded} & {"numba", "llvmlite", "trimesh", "scipy", "pyfftw"} <= {"trimesh"}
    assert not {"sim.jit", "sim.cache", "app.server.viewer", "app.scenes.cloth.scene"} & {*loaded}


def test_a_headless_run_imports_no_viewer(tmp_path: Path) -> None:
    """Every scene, one after the other: what one of them imported would still be there."""
    code = (
        f"from app.__main__ import main; status = [main(['run', name, '--seconds', '0.02', '--out', sys.argv[1]]) "
        f"for name in {NAMES}]\nimport app.study.sweep.case; "
        "drawing = ('viser', 'app.render', 'app.panel', 'app.server');"
        "print(status, sorted(n for n in sys.modules if n.startswith(drawing) or n.endswith('view')))"
    )
    assert python(code, str(tmp_path / "x.npz"))[-1] == f"{[0] * len(NAMES)} []"


def test_scenes_that_are_compiled_are_not_imported_to_find_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiling, "is_kept", lambda name: "-everything-" in name)
    monkeypatch.setattr(compiling, "scene_named", lambda name: pytest.fail(f"{name} is imported"))
    assert all(compiling.uncompiled(name) == [] for name in NAMES)


def test_the_process_of_a_student_s_functions_imports_little() -> None:
    code = "import sys; import app.lab.process.worker; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, encoding="locale", check=True)
    loaded = done.stdout.split()
    assert {name.split(".")[0] for name in loaded} & {"numba", "scipy", "viser", "asyncio", "ssl"} == set()
    assert {name for name in loaded if name.split(".")[0] == "sim"} == {"sim", "sim.point_laws"}
    assert "numpy.random" not in loaded
    assert len(loaded) < 258  # numpy, and what a process that forks others needs


READERS_OF_FILES = ("pint", "xarray", "tomllib", "sim.inputs.kinds", "sim.ocean.spectrum_files")


def test_a_start_without_a_file_imports_no_reader_of_files() -> None:
    """All scenes with their first set-ups, as the page shows them."""
    scenes = "from app.scenes import NAMES, scene_named\nfrom app.scenes.setups import make_setup\n"
    made = "for name in NAMES: make_setup(scene_named(name))\nprint(*sys.modules)"
    loaded = python(f"from app.commands import serve\n{scenes}{made}")[-1].split()
    assert "app.scenes.square_sea.scene" in loaded
    assert [name for name in loaded if name.startswith(READERS_OF_FILES)] == []
    assert len([name for name in loaded if name.startswith(("sim.", "app."))]) <= MAX_MODULES


MAX_MODULES = 382  # of the project in a start, whose time they make
