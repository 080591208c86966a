"""A real Dask cluster on the loopback: three workers, two killed, nothing lost."""

import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray as xr

from app.__main__ import main
from app.study.sweep import case, workers
from app.study.sweep.case import FINISHED, program, run_case
from app.study.sweep.workers import check_workers, connected, on_cluster
from tests.app.study.sweep.cases import rope_jobs
from tests.wine import needs_pools

ROOT = Path(__file__).parents[4]
FILE = "scheduler.json"


@pytest.fixture
def start(tmp_path):
    """Starts a scheduler on the loopback, or a worker of it, in a process each."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "DASK_DISTRIBUTED__DASHBOARD__LINK": ""}
    started = []

    def start(*arguments: str) -> subprocess.Popen:
        command = [sys.executable, "-m", "dask", *arguments, "--scheduler-file", str(tmp_path / FILE), "--no-dashboard"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        command += ["--host", "127.0.0.1"]
        started.append(subprocess.Popen(command, cwd=tmp_path, env=environment, **quiet))
        return started[-1]

    yield start
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


@pytest.mark.long
@needs_pools
def test_what_runs_on_a_cluster_outlives_workers_and_ends_with_the_scheduler(start, tmp_path, capsys, monkeypatch):
    from distributed import Client

    scheduler = start("scheduler", "--port", "0")
    with Client(scheduler_file=str(tmp_path / FILE), timeout=60, set_as_default=False) as client:
        address = client.scheduler.address
        (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2, 3]\n', "utf-8")
        command = ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc"), "--scheduler", address]
        with monkeypatch.context() as patch:
            patch.setattr(workers, "MAX_ANSWER_TIME", 2.0)
            assert main(command) == 2
            assert "at least one worker" in capsys.readouterr().err
        three = [start("worker", "--nthreads", "1", "--no-nanny") for _ in range(3)]
        client.wait_for_workers(3, timeout=60)

    def kill(number: int) -> None:
        three[number].kill()
        three[number].wait(30)

    # One that is killed in the midst of its work.
    jobs, outcomes = rope_jobs(8), {}
    with connected(address) as client:
        for number, outcome in on_cluster(client, jobs):
            outcomes[number] = outcome
            if len(outcomes) == 1:
                kill(0)
    assert sorted(outcomes) == sorted(jobs)
    assert {outcome.end for outcome in outcomes.values()} == {FINISHED}
    for number in (0, 7):
        assert outcomes[number].measures["tip_height"] == run_case(*jobs[number]).measures["tip_height"]

    # One that is killed once all are computed, but still on the workers: these are computed again.
    jobs = rope_jobs(8, seconds=1.0)
    with connected(address) as client:
        results = on_cluster(client, jobs)
        outcomes = dict([next(results)])
        wait_for_scheduler(
            address, lambda dask_scheduler: all(t.state == "memory" for t in dask_scheduler.tasks.values())
        )
        kill(1)
        wait_for_scheduler(address, lambda dask_scheduler: len(dask_scheduler.workers) == 1)
        outcomes.update(results)
    assert sorted(outcomes) == sorted(jobs)
    assert {outcome.end for outcome in outcomes.values()} == {FINISHED}

    # The command, on the worker that is left. One that runs another program is refused.
    assert main(command) == 0
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert (data.end == 0).all()
    with monkeypatch.context() as patch:
        patch.setattr(case, "sources_hash", lambda root: "anything")
        assert main([*command, "--fresh"]) == 2
        assert "anything" in capsys.readouterr().err

    with connected(address) as client:
        results = on_cluster(client, rope_jobs(30))
        next(results)
        scheduler.kill()
        begun = time.monotonic()
        with pytest.raises(OSError, match="has gone"):
            list(results)
    assert time.monotonic() - begun < 120


def test_an_address_where_nothing_answers_is_refused(tmp_path, capsys, monkeypatch):
    pytest.importorskip("netCDF4", reason="the extra sweep is not installed")
    monkeypatch.setattr(workers, "MAX_ANSWER_TIME", 2.0)
    (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2, 3]\n', "utf-8")
    for address in ("tcp://127.0.0.1:9", "nonsense", "", "127.0.0.1:99999"):
        command = ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc"), "--scheduler", address]
        assert main(command) == 2
        lines = capsys.readouterr().err.strip().splitlines()
        assert len(lines) == 1
        assert "--scheduler" in lines[0]
        assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_workers_are_refused_that_run_another_program():
    runs = {"tcp://first": program()}
    client = SimpleNamespace(wait_for_workers=lambda count, timeout: None, run=lambda function: runs)
    check_workers(client, "here")
    runs["tcp://second"] = "springtide 0.1"
    with pytest.raises(ValueError, match=r"tcp://second runs springtide 0\.1"):
        check_workers(client, "here")


def test_a_refused_scheduler_does_not_cost_what_is_finished(tmp_path, capsys):
    pytest.importorskip("netCDF4", reason="the extra sweep is not installed")
    (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2, 3]\n', "utf-8")
    (tmp_path / "out.nc.cases").write_text("finished cases", "utf-8")
    command = ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc"), "--fresh", "--scheduler", "x"]
    assert main(command) == 2
    assert (tmp_path / "out.nc.cases").read_text("utf-8") == "finished cases"
