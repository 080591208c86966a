"""The limit on tests that pass only when they are tried again."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.reruns import MAX_RERUNS

SECOND_TRY = """
import pytest
tried = []
@pytest.mark.flaky(reruns=1)
@pytest.mark.parametrize("name", range({number}))
def test_it(name):
    tried.append(name)
    assert tried.count(name) == 2
"""


@pytest.mark.parametrize(("processes", "reruns"), [("0", MAX_RERUNS), ("2", MAX_RERUNS + 1)])
def test_more_than_three_reruns_fail_the_suite(tmp_path, processes, reruns):
    (tmp_path / "test_second_try.py").write_text(SECOND_TRY.format(number=reruns), "utf-8")
    command = [sys.executable, "-m", "pytest", "-p", "tests.reruns", "-n", processes, "--rootdir", str(tmp_path), "."]
    paths = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    run = subprocess.run(
        command, cwd=tmp_path, env=paths, capture_output=True, encoding="locale", timeout=100, check=False
    )
    assert f"{reruns} passed, {reruns} rerun" in run.stdout
    assert run.returncode == (reruns > MAX_RERUNS), run.stdout
    assert ("allowed: at most 3" in run.stdout) == (reruns > MAX_RERUNS)
    assert f"tried again: test_second_try.py::test_it[{reruns - 1}]: assert 1 == 2" in run.stdout
