"""`springtide sweep` as a user types it: what is in the file, and what survives Ctrl-C, kills and errors."""

import contextlib
import functools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
import xarray as xr

from app.__main__ import main
from app.study.sweep import workers
from app.study.sweep.case import FAILED, FINISHED, run_case
from app.study.sweep.figure import is_log
from app.study.sweep.spec import read_spec
from app.study.sweep.store import Store
from app.study.sweep.workers import on_cores
from tests.app.study.sweep.cases import FATAL, counted
from tests.full_disk import full_disk
from tests.wine import needs_pools

needs_signals = pytest.mark.skipif(os.name != "posix", reason="Ctrl-C for another process alone is POSIX")
GRID = """
scene = "rope"
seconds = 1.0
frames = 3
[set]
floor = false
[parameters]
integrator = ["explicit_euler", "leapfrog"]
time_step = [0.002, 0.1]
sphere = [false, true]
"""
# Four short cases, and two that take seconds whatever the machine: what is stopped is stopped in the midst of them.
LONG = """
scene = "rope"
seconds = 10.0
[set]
points = 200
[parameters]
time_step = [4e-3, 2e-3, 1.5e-3, 1e-3, 2e-4, 2.1e-4]
"""


@pytest.fixture
def here(monkeypatch):
    """Run the cases in this process, where processes are not the point."""
    monkeypatch.setattr(workers, "on_cores", lambda jobs: ((i, run_case(*job)) for i, job in jobs.items()))


def sweep(spec: str, folder: Path, *more: str) -> int:
    pytest.importorskip("netCDF4", reason="the extra sweep is not installed")
    (folder / "s.toml").write_text(spec, "utf-8")
    return main(["sweep", str(folder / "s.toml"), "--out", str(folder / "out.nc"), *more])


def alone(spec_path: Path) -> list:
    """Every case, run here one after the other."""
    spec = read_spec(spec_path)
    return [run_case(spec.scene, {**spec.fixed, **case}, spec.times) for case in spec.cases]


@pytest.mark.parametrize(
    ("values", "log"),
    [([1.0, 10.0, 100.0], True), ([1.0, 2.0, 3.0], False), ([0.0, 1.0, 100.0], False), ([5.0], False)],
)
def test_an_axis_is_logarithmic_where_its_values_span_decades(values, log):
    assert is_log(xr.DataArray(values)) is log


@needs_pools
def test_a_grid_is_one_labelled_file_with_all_that_made_it(tmp_path, capsys):
    assert sweep(GRID, tmp_path) == 0
    assert "8 cases" in capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.nc", "out.png", "out.svg", "s.toml"]
    assert (tmp_path / "out.nc").stat().st_mode & 0o777 == (tmp_path / "s.toml").stat().st_mode & 0o777
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert dict(data.sizes) == {"integrator": 2, "time_step": 2, "sphere": 2, "time": 3}
        assert data.tip_height.dims == ("integrator", "time_step", "sphere", "time")
        assert data.tip_height.attrs == {"long_name": "Height of the tip", "units": "m"}
        assert data.time_step.attrs["units"] == "s"
        assert list(data.sphere.values) == [False, True]
        assert "units" not in data.sphere.attrs
        assert "units" not in data.integrator.attrs
        assert data.attrs["spec"] == GRID
        assert json.loads(data.attrs["parameters"])["gravity"] == 10.0
        assert "numpy" in data.attrs["versions"]
        assert "sources" in data.attrs["program"]
        for expected, index in zip(alone(tmp_path / "s.toml"), np.ndindex(2, 2, 2), strict=True):
            for name, values in expected.measures.items():
                assert np.array_equal(data[name].values[index], values, equal_nan=True), name
            assert data.end.attrs["flag_meanings"].split()[int(data.end.values[index])] == expected.end
            assert str(data.message.values[index]) == expected.message
            assert np.array_equal(data.diverged_at.values[index], expected.diverged_at, equal_nan=True)
        assert (data.end == 1).any()
        assert (data.end == 0).any()


def test_a_random_design_has_a_dimension_of_cases_and_its_seed(here, tmp_path):
    spec = """scene = "rope"\nseconds = 0.2\ndesign = "random"\ncases = 5\nseed = 7\n[parameters]
    mass = { from = 0.5, to = 2.0, log = true }\nintegrator = ["rk4", "leapfrog"]\n"""
    assert sweep(spec, tmp_path) == 0
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert dict(data.sizes) == {"case": 5}
        assert data.mass.dims == data.integrator.dims == data.tip_height.dims == ("case",)
        assert data.attrs["seed"] == 7
        assert [float(m) for m in data.mass] == [case["mass"] for case in read_spec(tmp_path / "s.toml").cases]
        assert np.isfinite(data.tip_height).all()


@pytest.mark.long
@needs_signals
@pytest.mark.parametrize(
    "how",
    [
        pytest.param(signal.SIGINT, id="Ctrl-C"),
        pytest.param(getattr(signal, "SIGKILL", None), id="kill", marks=pytest.mark.stress),
    ],
)
def test_a_sweep_that_is_stopped_goes_on_where_it_was(how, here, tmp_path, capsys):
    (tmp_path / "s.toml").write_text(LONG, "utf-8")
    kept, out = tmp_path / "out.nc.cases", tmp_path / "out.nc"
    command = [sys.executable, "-m", "app", "sweep", str(tmp_path / "s.toml"), "--out", str(out)]
    # A shell's background job ignores SIGINT, and so would what it starts.
    default_sigint = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, stdout=subprocess.PIPE, encoding="locale", preexec_fn=default_sigint) as process:
        changes, last = 0, 0
        deadline = time.monotonic() + 200
        # Its making, and then at least two cases.
        while changes < 5 and process.poll() is None and time.monotonic() < deadline:
            now = kept.stat().st_mtime_ns if kept.exists() else 0
            changes, last = changes + (now != last), now
            time.sleep(0.005)
        family = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(how)
        said = process.communicate(timeout=60)[0]
    if how == signal.SIGINT:
        assert process.returncode == 130
        assert "stopped" in said
    _, alive = psutil.wait_procs(family, timeout=20)
    assert alive == []
    assert not out.exists()
    assert main(command[3:]) == 0
    done = int(capsys.readouterr().out.partition(" of 6 cases were finished")[0])
    assert 1 <= done < 6
    assert not kept.exists()
    with xr.open_dataset(out) as data:
        found = [
            run_case("rope", {"points": 200, "plot_energy": True, "plot_tip": True, "time_step": float(h)}, (10,))
            for h in data.time_step.values[[0, 3]]
        ]
        assert data.tip_height.values[[0, 3]].tolist() == [f.measures["tip_height"][0] for f in found]
        assert (data.end == 0).all()


def test_a_changed_spec_is_refused_and_fresh_starts_over(here, tmp_path, capsys):
    spec = 'scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2]\n'
    assert sweep(spec, tmp_path) == 0
    before = (tmp_path / "out.nc").read_bytes()
    assert sweep(spec, tmp_path) == 0
    assert "are finished" in capsys.readouterr().out
    assert sweep(spec.replace("0.1", "0.2"), tmp_path) == 2
    assert "seconds" in capsys.readouterr().err
    assert (tmp_path / "out.nc").read_bytes() == before
    assert sweep(spec.replace("0.1", "0.2"), tmp_path, "--fresh") == 0
    (tmp_path / "out.nc").write_text("my notes", "utf-8")
    assert sweep(spec, tmp_path) == 2
    assert (tmp_path / "out.nc").read_text("utf-8") == "my notes"


def test_a_store_of_another_sweep_or_in_use_is_refused(tmp_path, capsys):
    spec = 'scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2]\n'
    kept = tmp_path / "out.nc.cases"
    other = Store(kept, {"spec": {"seconds": 3}, "program": "x"})
    assert sweep(spec, tmp_path) == 2
    assert "another sweep is writing" in capsys.readouterr().err
    other.close()
    assert sweep(spec, tmp_path) == 2
    assert "--fresh" in capsys.readouterr().err
    kept.write_bytes(b"no store at all, but something that somebody keeps" * 20)
    assert sweep(spec, tmp_path) == 2
    assert "--fresh" in capsys.readouterr().err


def test_a_failing_case_is_recorded_and_does_not_end_the_sweep(here, tmp_path, capsys):
    # pefrl takes no damping, and the rope has some.
    spec = 'scene = "rope"\nseconds = 0.1\n[parameters]\nintegrator = ["leapfrog", "pefrl"]\n'
    assert sweep(spec, tmp_path) == 1
    assert "The first that failed" in capsys.readouterr().out
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert data.end.values.tolist() == [0, 2]
        assert "damping" in str(data.message.values[1])
        assert np.isfinite(data.tip_height.values).tolist() == [True, False]


@pytest.mark.long
@needs_pools
def test_a_case_that_kills_its_process_fails_and_all_others_are_finished(monkeypatch):
    monkeypatch.setattr(workers, "run_case", counted)
    outcomes = dict(on_cores({i: ("", {"number": i}, ()) for i in range(12)}))
    assert sorted(outcomes) == list(range(12))
    assert "killed" in outcomes[FATAL].message
    assert [i for i in outcomes if outcomes[i].end == FAILED] == [FATAL]
    assert all(outcomes[i].measures == {"number": [i]} for i in outcomes if i != FATAL)
    assert {outcome.end for outcome in outcomes.values()} == {FAILED, FINISHED}


@pytest.mark.long
@needs_signals
@pytest.mark.parametrize(
    ("command", "delays"),
    [
        ("sweep", (0.2,)),
        pytest.param("sweep", (0.0, 0.1, 0.4), marks=pytest.mark.stress),
        pytest.param("stability", (0.0, 0.1, 0.2, 0.4), marks=pytest.mark.stress),
    ],
)
def test_ctrl_c_while_workers_start_is_quiet(command, delays, tmp_path):
    """delays: [s] after the first worker is there, all along its imports."""
    (tmp_path / "s.toml").write_text(LONG, "utf-8")
    arguments = {"sweep": ["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc")]}
    given = arguments.get(command, [command, "--quick"])
    for delay in delays:
        with subprocess.Popen(
            [sys.executable, "-m", "app", *given], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="locale",
            start_new_session=True, preexec_fn=functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
        ) as process:  # fmt: skip
            parent = psutil.Process(process.pid)
            deadline = time.monotonic() + 100
            while not workers_of(parent) and time.monotonic() < deadline:
                time.sleep(0.002)
            time.sleep(delay)
            family = parent.children(recursive=True)
            os.killpg(process.pid, signal.SIGINT)  # as a terminal does
            _, errors = process.communicate(timeout=60)
        assert (process.returncode, errors) == (130, "")
        _, alive = psutil.wait_procs(family, timeout=20)
        assert alive == []


def workers_of(parent: psutil.Process) -> list[psutil.Process]:
    """The processes that were spawned to work."""
    with contextlib.suppress(psutil.Error):
        return [child for child in parent.children() if "spawn_main" in " ".join(child.cmdline())]
    return []


def test_a_sweep_without_matplotlib_has_no_figure_and_says_so(here, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert sweep('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2]\n', tmp_path) == 0
    assert "no figure: matplotlib" in capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.nc", "s.toml"]


def test_an_out_whose_store_would_have_too_long_a_name_is_refused(here, tmp_path, capsys):
    pytest.importorskip("netCDF4", reason="the extra sweep is not installed")
    (tmp_path / "s.toml").write_text('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2]\n', "utf-8")
    for length in range(231, 256, 8):
        name = "x" * (length - 3) + ".nc"
        if main(["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / name)]) != 0:
            assert "--out" in capsys.readouterr().err
            assert [path.name for path in tmp_path.iterdir() if path.name.endswith((".cases", "-journal"))] == []
            assert not (tmp_path / name).exists()


def test_a_full_disk_ends_it_with_a_line_and_nothing_is_written_half(here, tmp_path, capsys):
    with full_disk(40_000):  # enough to keep the cases, not for the results
        assert sweep('scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2]\n', tmp_path) == 1
    said = capsys.readouterr().err
    assert len(said.strip().splitlines()) == 1, said
    assert "springtide: " in said
    assert not (tmp_path / "out.nc").exists()
