"""Both wheels, installed in an empty environment: no scene compiles a kernel."""

import os
import runpy
import subprocess
from pathlib import Path

import pytest

from app.scenes import NAMES

ROOT = Path(__file__).parents[2]


@pytest.mark.timeout(3000)
def test_with_both_wheels_no_scene_compiles_a_kernel(tmp_path: Path) -> None:
    """It compiles everything, for each level of this processor, and installs all dependencies twice."""
    done = subprocess.run(
        ["bash", str(ROOT / ".ci" / "build"), str(tmp_path)],
        env={name: value for name, value in os.environ.items() if not name.startswith("SPRINGTIDE_")},
        capture_output=True,
        encoding="locale",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert [line.strip() for line in done.stdout.splitlines() if "kernels compiled" in line] == [
        f"{name}: 0 kernels compiled" for name in NAMES
    ]
    assert len(list(tmp_path.glob("springtide-*.whl"))) == len(list(tmp_path.glob("springtide_kernels-*.whl"))) == 1


def test_kernels_that_are_compiled_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPRINGTIDE_KERNELS", "")
    assert runpy.run_path(str(ROOT / ".ci" / "kernels.py"))["compiled"]("rope")
