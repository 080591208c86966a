"""A chain on the bed, shaken at its fairlead, as a task for MoorDyn: processor time at equal error.

A(N): N segments, 160 m of chain (0.09 m, 80 kg/m, EA 5e7 N) from 40 m of depth to a fairlead that moves 1.5 m in 7 s.
The two programs differ in what a slack segment does, so that each is compared with its own finest run: the error is the
largest distance of a node from there. MoorDyn's search for its state of rest is not timed, nor is ours.
"""

import datetime
import functools
import importlib
import math
import os
import statistics
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.formats.text_tables import Rows
from app.scenes.timer import process_effort_clock
from benchmarks.peers.ladder import RATIO
from benchmarks.peers.record import is_installed
from benchmarks.timing import load
from sim.mooring import Line, LineType, Point, System, critical_step, simulate, write_moordyn
from sim.mooring.rest.statics import Rest
from sim.springs import State
from sim.water import Water

CHAIN = LineType("chain", 0.09, 80.0, 5e7, -0.8, 1.0, 1.6, 0.0, 0.1)
END = 20.0  # [s]
FINEST = 1e-4  # [s] step of each program's own reference
THEIR_STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)  # [s] of MoorDyn's RK4
OUR_FRACTIONS = (0.9, 0.7, 0.5, 0.35, 0.25, 0.12, 0.06)  # over the critical step
OUR_METHODS = ("leapfrog", "rk4")
TURNS = 5
ERRORS = 3  # the level of what MoorDyn prints


class Measured(NamedTuple):
    """Places (nodes, 3) [m] at the end, and processor time [s]."""

    x: NDArray[np.float64]
    time: float


def chain(segments: int) -> System:
    """The line of A(segments)."""
    points = Point(1, "fixed", (-140.0, 0.0, -40.0)), Point(2, "coupled", (0.0, 0.0, 0.0))
    return System((Line(1, CHAIN, 1, 2, 160.0, segments),), points, Water(40.0))


def fairlead(t: float) -> tuple[float, float, float]:
    """Its place [m]: a sine that fades in over 10 s."""
    return 1.5 * math.sin(2.0 * math.pi * t / 7.0) * min(1.0, max(t, 0.0) / 10.0), 0.0, 0.0


def our_run(system: System, start: Rest, method: str, step: float) -> Measured:
    """A run of ours."""
    begin = process_effort_clock()
    run = simulate(
        system,
        duration=END,
        frames=2,
        step=step,
        integrator=method,
        start=State.still(start.nodes),
        motion={2: fairlead},
    )
    return Measured(run.x[1][-1], process_effort_clock() - begin)


def their_run(system: System, step: float) -> Measured:
    """A run of MoorDyn, in its own state of rest at the start."""
    moordyn = importlib.import_module("moordyn")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "line.txt"
        write_moordyn(system, path)
        options = f"rk4 tScheme\n{step} dtM\n2 dtIC\n40 TmaxIC\n1e-4 threshIC\n0 writeLog\n1 disableOutTime\n"
        text = path.read_text(encoding="utf-8")
        mark = next(line for line in text.splitlines() if "OPTIONS" in line)
        path.write_text(text.replace(mark + "\n", mark + "\n" + options), encoding="utf-8")
        here = Path.cwd()
        os.chdir(folder)  # it writes beside its input
        try:
            mooring = moordyn.Create(str(path))
            moordyn.SetVerbosity(mooring, ERRORS)
            moordyn.Init(mooring, list(fairlead(0.0)), [0.0, 0.0, 0.0])
            line = moordyn.GetLine(mooring, 1)
            every = max(step, 1e-3)  # [s] at which it is told where the fairlead is
            begin = process_effort_clock()
            for i in range(round(END / every)):
                t = i * every
                ahead, behind = fairlead(t + every), fairlead(t)
                speed = [(a - b) / every for a, b in zip(ahead, behind, strict=True)]
                moordyn.Step(mooring, list(behind), speed, t, every)
            taken = process_effort_clock() - begin
            x = [moordyn.GetLineNodePos(line, i) for i in range(system.lines[0].segments + 1)]
            moordyn.Close(mooring)
        finally:
            os.chdir(here)
    return Measured(np.array(x), taken)


def error(run: Measured, reference: Measured) -> float:
    """Largest distance [m] of a node."""
    return float(np.linalg.norm(run.x - reference.x, axis=1).max())


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """A row for each step of MoorDyn: its error and time, and our quickest run with no larger error, in turns."""
    table: Rows = []
    for segments in (20,) if quick and not words else (20, 40):
        task = f"A({segments})"
        if words and not any(word.lower() in f"{task} moordyn".lower() for word in words):
            continue
        if not is_installed("moordyn"):
            table.append({"task": task, "peer": "MoorDyn", "note": "not installed"})
            continue
        head = {"task": task, "peer": "MoorDyn", "damping": "axial"}
        table += [head | row for row in compared(chain(segments), quick)]
    return table


def compared(system: System, quick: bool) -> Rows:
    """The rows of one size."""
    rest = system.at_rest()
    finest, theirs = our_run(system, rest, "rk4", FINEST), their_run(system, FINEST)
    runs = []
    for method in OUR_METHODS:
        limit = critical_step(system, method, State.still(rest.nodes))
        for fraction in OUR_FRACTIONS:
            run = functools.partial(our_run, system, rest, method, fraction * limit)
            found = run()
            runs.append((found.time, error(found, finest), method, f"{1e3 * fraction * limit:.3g} ms", run))
    table: Rows = []
    for step in THEIR_STEPS[:: 2 if quick else 1]:
        row = {
            "its setting": f"step {1e3 * step:g} ms",
            f"error at {END:g} s [m]": (off := error(their_run(system, step), theirs)),
        }
        table.append(row)
        if not off < 1.0:
            row["note"] = "diverged"
            continue
        exact = [run for run in runs if run[1] <= off]
        if not exact:
            row["note"] = "no run of ours is as exact"
            continue
        _, own, method, setting, run = min(exact, key=lambda one: one[0])
        times = [(their_run(system, step).time, run().time) for _ in range(2 if quick else TURNS)]
        peer, ours = (statistics.median(column) for column in zip(*times, strict=True))
        row |= {
            "peer [ms]": 1e3 * peer, "ours": method, "with": setting, "ours [ms]": 1e3 * ours,
            "our error at the end [m]": own, RATIO: peer / ours, "first call [ms]": 1e3 * peer, "turns": len(times),
            "load": load(), "date": datetime.date.today().isoformat(),
        }  # fmt: skip
    return table
