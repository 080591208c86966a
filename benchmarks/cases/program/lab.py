"""The course lab: time to check a finished folder and a class of folders, and of a call of a student's function."""

import contextlib
import io
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from app.commands.lab_folders import check
from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.process.rope_march import Segment
from app.lab.process.runner import Runner
from app.scenes.springs.student_net import forces_of
from sim.springs import rope

REPEATS = 7
CLASS = 20  # folders
CALLS = 2000
STEP = 1 / 60  # [s] of a student's rope: what takes less is faster than real time
HERE: dict[str, Path | None] = {"json": None, "csv": None, "report": None}


def timed(folders: list[Path], out: dict[str, Path | None]) -> float:
    """Time of a check in this process [s]."""
    start = time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()):
        status = check(folders, (), out)
    assert status == 0, "the reference solutions are right"
    return time.perf_counter() - start


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Times [s], medians of repeats but for the class and the call."""
    with tempfile.TemporaryDirectory(prefix="springtide-") as place:
        folders = [Path(place, f"student-{i}") for i in range(2 if quick else CLASS)]
        for folder in folders:
            make_folder(folder, load_tasks(), solutions=True)
        report = {**HERE, "report": Path(place, "report.html")}
        repeats = 1 if quick else REPEATS
        command = [sys.executable, "-m", "app", "lab", "check", str(folders[0])]
        whole = []
        for _ in range(repeats):
            start = time.perf_counter()
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            whole.append(time.perf_counter() - start)
        table = [
            {"what": "springtide lab check, finished folder", "time [s]": statistics.median(whole)},
            {"what": "check", "time [s]": statistics.median(timed(folders[:1], HERE) for _ in range(repeats))},
            {
                "what": "check and report",
                "time [s]": statistics.median(timed(folders[:1], report) for _ in range(repeats)),
            },
            {"what": f"class of {len(folders)}, with page", "time [s]": timed(folders, report)},
        ]
        x = np.zeros(3)
        with Runner(folders[0]) as runner:
            runner.call("rope.py", "spring_force", x, x + 1.0, x, x, 800.0, 7.0, 0.2)
            start = time.perf_counter()
            for _ in range(CALLS):
                runner.call("rope.py", "spring_force", x, x + 1.0, x, x, 800.0, 7.0, 0.2)
            table.append({"what": "one call of spring_force", "time [s]": (time.perf_counter() - start) / CALLS})
            table += rope_rows(runner, quick)
    return table


def rope_rows(runner: Runner, quick: bool) -> list[dict[str, Any]]:
    """Time of a step of a rope by a student's functions, plain and compiled, with all that a job of a scene costs."""
    net = rope(points=10)
    x, v = np.ascontiguousarray(net.x0[:, 0].T), np.zeros((10, 3))
    segments = [Segment(1, STEP, forces_of(net, 0.0), np.zeros((0, 6)))] * (60 if quick else 600)
    table = []
    for own in (["spring_force"], ["rope_acceleration"], ["spring_force", "step_rk4"]):
        for how in ("plain Python", "compiled"):
            with Runner(runner.folder, compiles=how == "compiled") as each:
                if how == "compiled" and not each.compile(own)[0]:
                    continue
                each.march(own, "step_rk4", x, v, segments[:1])
                start = time.perf_counter()
                for segment in segments:
                    each.march(own, "step_rk4", x, v, [segment])
                seconds = (time.perf_counter() - start) / len(segments)
            what = f"RK4 step of 10 points by {' and '.join(own)}, {how}"
            table.append({"what": what, "time [s]": seconds})
    return table
