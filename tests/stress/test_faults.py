"""Machines that do not play along: homes that cannot be written, full disks, busy ports, rubbish in every file."""

import json
import os
import random
import resource
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.__main__ import main
from app.scenes import NAMES, scene_named
from app.study import tables
from sim.parameters import parameters_of
from tests.full_disk import full_disk
from tests.stress.clients import clients_of, until
from tests.stress.tally import Tally

ROOT = Path(__file__).parents[2]
READ_ONLY = "/proc"  # a folder in which not even root can write
RUN = ("run", "rope", "--seconds", "0.1", "--out")


def springtide(*arguments: str, limit: int | None = None, **changes: str | None) -> subprocess.CompletedProcess[str]:
    """The program in a process of its own, with these environment variables (None: without them).

    limit: no file may become longer [bytes], as on a disk that fills up. No byte code is written, as a cut file stays.
    """
    env = {**os.environ, **{name: value for name, value in changes.items() if value is not None}}
    if limit is not None:
        env["PYTHONDONTWRITEBYTECODE"] = "1"
    for name in [name for name, value in changes.items() if value is None]:
        env.pop(name, None)

    def fill_up() -> None:
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return subprocess.run(
        [sys.executable, "-m", "app", *arguments], cwd=ROOT, env=env, preexec_fn=fill_up, capture_output=True,
        encoding="locale", timeout=280, check=False,
    )  # fmt: skip


def test_a_home_that_cannot_be_written_and_no_cache(tmp_path: Path, tally: Tally) -> None:
    with tally.fault("read-only home, no cache"):
        done = springtide(*RUN, str(tmp_path / "a.npz"), HOME=READ_ONLY, XDG_CACHE_HOME=None, SPRINGTIDE_CACHE=None)
        assert done.returncode == 0, done.stderr
        assert np.isfinite(np.load(tmp_path / "a.npz")["x"]).all()


def test_a_cache_that_fills_up_and_then_holds_rubbish(tmp_path: Path, tally: Tally) -> None:
    cache = tmp_path / "cache"
    with tally.fault("disk full while kernels are cached"):
        done = springtide(*RUN, str(tmp_path / "a.npz"), limit=20_000, SPRINGTIDE_CACHE=str(cache))
        assert done.returncode == 0, done.stderr
    files = [path for path in cache.rglob("*") if path.is_file()]
    for path in files:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2] + b"rubbish")
    with tally.fault("rubbish in the cache", max(len(files), 1)):
        done = springtide(*RUN, str(tmp_path / "b.npz"), SPRINGTIDE_CACHE=str(cache))
        assert done.returncode == 0, done.stderr
    kept = list(cache.rglob("*.nbc"))
    assert kept
    for path in kept:
        path.write_bytes(path.read_bytes()[:100])
    with tally.fault("rubbish in the cache", len(kept)):
        done = springtide(*RUN, str(tmp_path / "c.npz"), SPRINGTIDE_CACHE=str(cache))
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", NAMES)
def test_a_disk_that_is_full_while_a_run_is_written(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture, tally: Tally
) -> None:
    out = tmp_path / "out.npz"
    for old in (None, b"precious"):
        for limit in (0, 1, 500, 2000):
            if old is not None:
                out.write_bytes(old)
            with tally.fault("disk full while exporting"):
                with full_disk(limit):
                    assert main(["run", name, "--seconds", "0.1", "--rate", "100", "--out", str(out)]) == 1
                lines = capsys.readouterr().err.strip().splitlines()
                assert len(lines) == 1
                assert "large" in lines[0] or "space" in lines[0]
                assert [path.read_bytes() for path in tmp_path.iterdir()] == ([] if old is None else [old])


def test_a_disk_that_is_full_while_tables_and_figures_are_written(tmp_path: Path, tally: Tally) -> None:
    figure = pytest.importorskip("matplotlib.figure").Figure()
    figure.subplots().plot(np.random.default_rng(0).standard_normal((2000, 2)))
    rows = [{"n": n, "time [ms]": n / 3} for n in range(2000)]
    for limit in (0, 500, 3000):
        with tally.fault("disk full while exporting", 2):
            with full_disk(limit), pytest.raises(OSError, match=r"large|space"):
                tables.save_table(rows, tmp_path / "table.csv")
            with full_disk(limit), pytest.raises(OSError, match=r"large|space"):
                tables.save_figures({"figure": figure}, tmp_path)
            assert list(tmp_path.iterdir()) == []


def test_a_port_in_use(tally: Tally) -> None:
    with socket.socket() as taken, tally.fault("port in use"):
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        done = springtide("--port", str(port), "--no-open")
        assert done.returncode == 1
        lines = done.stderr.strip().splitlines()
        assert len(lines) == 1
        assert str(port) in lines[0]
        assert "--port 0" in lines[0]


@pytest.mark.parametrize("end", [signal.SIGTERM, signal.SIGINT])
def test_a_server_that_is_told_to_end_under_load(end: signal.Signals, tally: Tally) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "--port", "0", "--no-open"], cwd=ROOT, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, encoding="locale",
    )  # fmt: skip
    try:
        assert process.stdout is not None
        address = process.stdout.readline()
        port = int(address.split("localhost:")[1].split()[0])
        with clients_of(port) as clients, tally.fault(f"server gets {end.name} under load"):
            for number in range(8):
                clients.join(reads=number != 3)
            until(lambda: sum(clients.received.values()) > 1_000_000, "traffic")
            process.send_signal(end)
            assert process.wait(60.0) == 0
            _, errors = process.communicate()
            assert "Traceback" not in errors, errors
    finally:
        process.kill()
        process.wait()


def rubbish(rng: random.Random, scene: Any) -> bytes:
    """The text of a preset file that is none, in one of many ways."""
    good = {name: k.default for name, k in parameters_of(scene.params).items()}
    name = rng.choice(list(good))
    bad = rng.choice([None, "x", [], {}, 1e400, float("nan"), -1e9, 10**400, "9" * 5000, [[[[]]]], "\0"])
    text = json.dumps(rng.choice([
        {"parameters": {**good, name: bad}}, {"parameters": {name + "_": 1}}, {"parameters": bad},
        {"scene": bad, "parameters": good}, bad, [good], {"scene": "moon", "parameters": {}},
    ])).encode()  # fmt: skip
    return rng.choice([text, text, text[: rng.randrange(len(text))], bytes(rng.randrange(256) for _ in range(50)), b""])


@pytest.mark.parametrize("name", NAMES)
def test_rubbish_for_a_preset(name: str, tmp_path: Path, capsys: pytest.CaptureFixture, tally: Tally) -> None:
    rng = random.Random(f"rubbish {name}")
    scene = scene_named(name)
    preset, out = tmp_path / "preset.json", tmp_path / "never.npz"
    for _ in range(250):
        preset.write_bytes(rubbish(rng, scene))
        with tally.fault("rubbish for a preset"):
            status = main(["run", name, "--seconds", "0.02", "--out", str(out), "--preset", str(preset)])
            lines = capsys.readouterr().err.strip().splitlines()
            # What has the right type by luck, a text for a choice of that name or a number in range, may pass.
            assert (status, len(lines), out.exists()) in ((2, 1, False), (0, 0, True)), preset.read_bytes()
            out.unlink(missing_ok=True)
