"""What is not imported where it is not needed, as it takes time or need not be installed."""

import subprocess
import sys
from pathlib import Path

import pytest

from app.scenes import NAMES, warmup

ROOT = Path(__file__).parents[1]
# Where scipy is installed numba itself loads scipy.linalg for its BLAS; nothing of ours may need it.
CODE = "import sys; sys.modules['scipy'] = None; {code}; print('loaded:', *sys.modules)"
SPRINGS = "import sim.springs, sim.springs.stability, sim.springs.statics"
RUN = "from app.__main__ import main; main(['run', 'rope', '--seconds', '0.1', '--out', {out!r}])"
SERVE = "from app.server.viewer import Viewer; v = Viewer('127.0.0.1', 0); v.open('rope'); v.shut()"


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        (SPRINGS, {"pyfftw", "viser", "trimesh", "matplotlib", "rich", "app", "assets"}),
        ("import sim.ocean.dispersion", {"pyfftw", "numba"}),
        (RUN, {"viser", "trimesh", "pyfftw", "matplotlib"}),
        (SERVE, {"pyfftw", "matplotlib", "trimesh"}),
    ],
)
def test_a_part_imports_nothing_that_it_does_not_need(code: str, absent: set[str], tmp_path: Path) -> None:
    code = CODE.format(code=code.format(out=str(tmp_path / "a.npz")))
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.rpartition("loaded:")[2].split()}
    assert "sim" in loaded
    assert not loaded & absent


def test_a_served_rope_has_no_linear_algebra_of_scipy_which_can_still_be_had() -> None:
    code = (
        f"from app.commands.serve import load_numba; load_numba(); {SERVE}; import sys; "
        "assert 'scipy.linalg' not in sys.modules; "
        "import scipy.linalg; print(scipy.linalg.det([[2.0, 0.0], [0.0, 3.0]]))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert float(done.stdout) == 6.0


def test_scenes_that_are_compiled_are_not_imported_to_find_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warmup, "is_kept", lambda name: "-everything-" in name)
    monkeypatch.setattr(warmup, "scene_named", lambda name: pytest.fail(f"{name} is imported"))
    assert all(warmup.missing(name) == () for name in NAMES)
