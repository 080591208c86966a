"""A real Dask cluster on the loopback: two workers, one killed in mid-run, nothing lost."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

from app.__main__ import main
from app.sweep import case, workers
from app.sweep.case import FINISHED, run_case
from app.sweep.workers import connected, on_cluster
from tests.app.sweep.cases import rope_jobs

ROOT = Path(__file__).parents[3]


@pytest.fixture
def dask(tmp_path):
    """(address, workers) of a scheduler and two worker processes."""
    file = tmp_path / "scheduler.json"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "DASK_DISTRIBUTED__DASHBOARD__LINK": ""}
    started = []

    def start(*arguments: str) -> subprocess.Popen:
        command = [sys.executable, "-m", "dask", *arguments, "--scheduler-file", str(file), "--no-dashboard"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        started.append(subprocess.Popen(command, cwd=tmp_path, env=environment, **quiet))
        return started[-1]

    scheduler = start("scheduler", "--host", "127.0.0.1", "--port", "0")
    two = [start("worker", "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1") for _ in range(2)]
    from distributed import Client

    with Client(scheduler_file=str(file), timeout=60, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
        address = client.scheduler.address
    yield address, two, scheduler
    for process in reversed(started):
        process.kill()
        process.wait(30)


def wait_for_scheduler(address, condition) -> None:
    from distributed import Client

    end = time.monotonic() + 60
    with Client(address, set_as_default=False) as client:
        while not client.run_on_scheduler(condition):
            assert time.monotonic() < end
            time.sleep(0.02)


def test_a_worker_is_killed_in_mid_run_and_nothing_is_lost(dask, tmp_path, capsys, monkeypatch):
    address, two, _ = dask
    jobs = rope_jobs(8)
    outcomes = {}
    with connected(address) as client:
        for number, outcome in on_cluster(client, jobs):
            outcomes[number] = outcome
            if len(outcomes) == 1:
                two[0].kill()
                two[0].wait(30)
    assert sorted(outcomes) == sorted(jobs)
    assert {outcome.end for outcome in outcomes.values()} == {FINISHED}
    for number in (0, 7):
        assert outcomes[number].measures["tip_height"] == run_case(*jobs[number]).measures["tip_height"]

    # The same by the command, on the worker that is left.
    (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2, 3]\n')
    command = ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc"), "--scheduler", address]
    assert main(command) == 0
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert (data.end == 0).all()

    # A worker that runs another program is refused, and so is a scheduler that has none.
    with monkeypatch.context() as patch:
        patch.setattr(case, "sources_hash", lambda root: "anything")
        assert main([*command, "--fresh"]) == 2
        assert "anything" in capsys.readouterr().err
    two[1].kill()
    two[1].wait(30)
    monkeypatch.setattr(workers, "MAX_ANSWER_TIME", 2.0)
    assert main([*command, "--fresh"]) == 2
    assert "at least one worker" in capsys.readouterr().err


def test_outcomes_that_die_with_their_worker_are_computed_again(dask):
    address, two, _ = dask
    jobs = rope_jobs(8, seconds=1.0)
    with connected(address) as client:
        results = on_cluster(client, jobs)
        outcomes = dict([next(results)])
        # All the others are computed, but still on the workers, when one of these goes.
        wait_for_scheduler(
            address, lambda dask_scheduler: all(t.state == "memory" for t in dask_scheduler.tasks.values())
        )
        two[0].kill()
        wait_for_scheduler(address, lambda dask_scheduler: len(dask_scheduler.workers) == 1)
        outcomes.update(results)
    assert sorted(outcomes) == sorted(jobs)
    assert {outcome.end for outcome in outcomes.values()} == {FINISHED}


def test_a_scheduler_that_goes_away_ends_the_run_with_what_there_is(dask):
    address, _, scheduler = dask
    with connected(address) as client:
        outcomes = on_cluster(client, rope_jobs(30))
        next(outcomes)
        scheduler.kill()
        start = time.monotonic()
        with pytest.raises(OSError, match="has gone"):
            list(outcomes)
    assert time.monotonic() - start < 120


def test_an_address_where_nothing_answers_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(workers, "MAX_ANSWER_TIME", 2.0)
    (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2, 3]\n')
    for address in ("tcp://127.0.0.1:9", "nonsense", "", "127.0.0.1:99999"):
        command = ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc"), "--scheduler", address]
        assert main(command) == 2
        lines = capsys.readouterr().err.strip().splitlines()
        assert len(lines) == 1
        assert "--scheduler" in lines[0]
        assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_a_refused_scheduler_does_not_cost_what_is_finished(tmp_path, capsys):
    (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2, 3]\n')
    (tmp_path / "out.nc.cases").write_text("finished cases")
    command = ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc"), "--fresh", "--scheduler", "x"]
    assert main(command) == 2
    assert (tmp_path / "out.nc.cases").read_text() == "finished cases"
