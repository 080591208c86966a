"""Kernels as plain Python, where an index beyond its array is an error, come to the numbers of the compiled ones."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.sim.models import results

ROOT = Path(__file__).parents[2]


def test_compiled_kernels_do_what_their_python_does_within_their_arrays(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.sim.models", str(tmp_path / "plain.npz")]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, encoding="locale", timeout=300)
    assert done.returncode == 0, done.stderr
    compiled = results()
    with np.load(tmp_path / "plain.npz") as plain:
        assert set(plain) == set(compiled)
        for name, value in compiled.items():
            assert plain[name] == pytest.approx(value, rel=1e-6, abs=1e-9 * max(np.abs(value).max(), 1e-9)), name
            assert np.isfinite(value).all()
            assert np.any(value), name
