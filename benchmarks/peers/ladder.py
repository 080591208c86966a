"""A peer's ladder: the task at several steps, tolerances or precisions, each beside our quickest run at its error."""

import csv
import datetime
import functools
import importlib
import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from rich.progress import track

from app.formats.text_tables import Rows
from app.scenes.timer import process_effort_clock
from benchmarks.peers.own_runs import OwnRuns
from benchmarks.peers.record import Peer
from benchmarks.reference import RESOLUTION, largest_distances
from benchmarks.timing import load
from sim.springs.stability import critical_step

FRACTIONS = (0.8, 0.4, 0.2, 0.1)  # over leapfrog's critical step, for peers that take steps
OWN_FRACTIONS = (1.0, 0.5, 0.25)  # over the peer's own step, where it has one
MAX_RUN_TIME = 10.0  # [s] a ladder of steps ends before longer runs; one of tolerances leaves out every second rung
TURNS, LEAST_TURNS = 61, 3  # of each run; fewer where those of a peer add up to:
MAX_TURNS_TIME, QUICK_TURNS_TIME = 1.5, 0.5  # [s]
MAX_ERROR = 1.0  # [m] a larger one means that the run diverged
RATIO = "times as long as ours"
DEEPEST = "deepest [radii]"  # of links in each other, which stands for an error in a knot


class Rung(NamedTuple):
    """What a peer is given, and how the table says it."""

    label: str
    value: Any  # step [s], relative tolerance, or precision


class Task(NamedTuple):
    """What peers are given, the times [s] at which errors count, and our own runs of it."""

    subject: Any  # a net or a sea
    times: tuple[float, ...]
    ours: OwnRuns


def rungs(peer: Peer, subject: Any, quick: bool) -> list[Rung]:
    """The rungs of a peer, from coarse to fine; quick: every second one."""
    if peer.precisions:
        return [Rung(f"{precision} precision", precision) for precision in peer.precisions]
    if peer.settings:
        found = [Rung(*setting) for setting in peer.settings]
    elif peer.tolerances:
        found = [Rung(f"rtol {rtol:.0e}", rtol) for rtol in peer.tolerances]
    else:
        step, fractions = (peer.step, OWN_FRACTIONS) if peer.step else (critical_step(subject, "leapfrog"), FRACTIONS)
        found = [Rung(f"step {1e6 * fraction * step:.3g} µs", fraction * step) for fraction in fractions]
    return found[:: 2 if quick else 1]


def undisturbed_time(call: Callable[[], Any]) -> float:
    """The lesser of wall time and processor time of all threads in a call [s].

    On a busy machine a long call waits for a core, and one shorter than a slice of the scheduler does not: wall times
    would favour the short one. Several threads at once make the wall time the lesser.
    """
    start, used = time.perf_counter(), process_effort_clock()
    call()
    return min(process_effort_clock() - used, time.perf_counter() - start)


def in_turns(calls: Sequence[Callable[[], Any]], max_time: float) -> list[list[float]]:
    """Undisturbed times [s] of each call, taken in turns.

    Until there are `TURNS` of each, or at least `LEAST_TURNS` and those of the first call add up to `max_time` [s].
    """
    times: list[list[float]] = [[] for _ in calls]
    while len(times[0]) < TURNS and (len(times[0]) < LEAST_TURNS or sum(times[0]) < max_time):
        for own, call in zip(times, calls, strict=True):
            own.append(undisturbed_time(call))
    return times


def stamp(turns: int) -> dict[str, Any]:
    """Columns that say how a row was measured."""
    return {"turns": turns, "load": load(), "date": datetime.date.today().isoformat()}


def compared(peer: Peer, task: Task, quick: bool) -> Rows:
    """A row for each rung of a peer's ladder: its error and time, and our quickest run with errors no larger, in turns.

    Run times are medians of repeats, of the whole task, without waits for a core. That of the first call includes what
    the peer builds and compiles, without the import of its package.
    """
    importlib.import_module(peer.package)
    subject, times, ours = task
    table: Rows = []
    left = rungs(peer, subject, quick)
    max_time = QUICK_TURNS_TIME if quick else MAX_TURNS_TIME
    while left:
        rung = left.pop(0)
        row: dict[str, Any] = {"peer": peer.name, "damping": peer.damping, "its setting": rung.label}
        table.append(row)
        start = time.perf_counter()
        theirs = peer.make(subject, rung.value)
        end = theirs(times[-1])
        row["first call [ms]"] = 1e3 * (time.perf_counter() - start)
        limits = (math.inf,) * len(times)
        if end is None:
            row["note"] = "another sea, timed only"
        else:
            limits = largest_distances((*map(theirs, times[:-1]), end), ours.reference)
            row |= {f"error at {t:g} s [m]": error for t, error in zip(times, limits, strict=True)}
            if not all(error < MAX_ERROR for error in limits):
                row["note"] = "diverged"
                continue
        best = ours.quickest(limits)
        calls = [functools.partial(theirs, times[-1]), *([] if best is None else [best.run])]
        peer_times, *our_times = in_turns(calls, max_time)
        row["peer [ms]"] = 1e3 * statistics.median(peer_times)
        if best is None:
            beyond = min(limits) < RESOLUTION * ours.reference.uncertainty
            row["note"] = "beyond what the reference can tell" if beyond else "no run of ours is as exact"
        else:
            row |= {
                "ours": best.method,
                "with": best.setting,
                "ours [ms]": 1e3 * statistics.median(our_times[0]),
                "our error at the end [m]": ours.result(best).errors[-1],
                RATIO: statistics.median(peer_times) / statistics.median(our_times[0]),
            }
        row |= stamp(len(peer_times))
        if 2.0 * statistics.median(peer_times) > MAX_RUN_TIME:
            left = (left if quick else left[1:]) if peer.tolerances else []
    return table


def tables(
    name: str,
    sizes: Sequence[int],
    peers: Sequence[Peer],
    make_task: Callable[[int, str], Task],
    words: Sequence[str],
    quick: bool,
) -> Rows:
    """The ladders of all installed peers in the task of each size, and a row with the reason for each that is left out.

    make_task: takes the size and the damping model. words: if any, only ladders with one of them in the
    names of their task and peer, as "R(16) scipy DOP853". quick: without words the last size is left out.
    """
    table: Rows = []
    make_once = functools.cache(make_task)
    pairs = [
        (size, peer)
        for size in (sizes[:-1] if quick and not words else sizes)
        for peer in peers
        if not words or any(word.lower() in f"{name}({size}) {peer.name}".lower() for word in words)
    ]
    for size, peer in track(pairs, f"{name}(n) peers", transient=True):
        task = {"task": f"{name}({size})"}
        if reason := peer.reason_left_out(size):
            table.append(task | {"peer": peer.name, "damping": peer.damping, "note": reason})
        else:
            table += [task | row for row in compared(peer, make_once(size, peer.damping), quick)]
    return table


def merged(path: Path, table: Rows) -> Rows:
    """The table with those rows of an earlier one in a CSV file whose task and peer it has not, task by task."""
    if not path.exists():
        return table
    measured = {(row["task"], row["peer"]) for row in table}
    with path.open(newline="", encoding="utf-8") as file:
        earlier: Rows = [{name: read(text) for name, text in row.items() if text} for row in csv.DictReader(file)]
    both = [*(row for row in earlier if (row["task"], row["peer"]) not in measured), *table]
    order = list(dict.fromkeys(row["task"] for row in both))
    return sorted(both, key=lambda row: (len(row["task"]), order.index(row["task"])))


def read(text: str) -> float | str:
    """A cell of a table: a number where it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def shown(table: Rows) -> Rows:
    """The columns that a screen has room for."""
    names = ("task", "peer", "its setting", "error [m]", DEEPEST, "knot", "peer [ms]", "ours [ms]", RATIO, "note")
    rows = [row if "knot" in row else row | {"error [m]": last_error(row)} for row in table]
    return [{name: row[name] for name in names if name in row} for row in rows]


def last_error(row: dict[str, Any]) -> float:
    """Error at the end of the task [m] of a row of `compared`; NaN where there is none."""
    return next((value for name, value in reversed(row.items()) if name.startswith("error at")), math.nan)


def of_each(table: Rows, *names: str) -> Iterator[tuple[Any, Rows]]:
    """The values of these columns that occur, and the rows with them."""
    for values in dict.fromkeys(tuple(row[name] for name in names) for row in table):
        yield values, [row for row in table if tuple(row[name] for name in names) == values]


def summary(table: Rows) -> Rows:
    """A row for each ladder: the least, median and greatest of how many times as long the peer takes as we do."""
    found = []
    for (task, peer), rows in of_each(table, "task", "peer"):
        own = [row for row in rows if RATIO in row]
        if not own:
            continue
        ratios = [row[RATIO] for row in own]
        least = own[ratios.index(min(ratios))]
        found.append(
            {
                "task": task,
                "peer": peer,
                "rungs": len(own),
                "least times as long": min(ratios),
                "there with": least["its setting"],
                **(
                    {"and a depth of [radii]": least[DEEPEST]}
                    if DEEPEST in least
                    else {"and an error of [m]": last_error(least)}
                ),
                "median": statistics.median(ratios),
                "greatest": max(ratios),
                "rungs that are faster": sum(ratio < 1.0 for ratio in ratios),
                "first call over later ones": statistics.median(
                    row["first call [ms]"] / row["peer [ms]"] for row in own
                ),
            }
        )
    return sorted(found, key=lambda row: (len(row["task"]), row["task"], row["least times as long"]))


def figures(name: str, table: Rows) -> dict[str, Any]:
    """A figure of each task by file name: `name`, and the size of the task."""
    measured = [row for row in table if "peer [ms]" in row and math.isfinite(last_error(row))]
    return {
        f"{name}_{task.split('(')[1].rstrip(')')}": figure(rows, task) for (task,), rows in of_each(measured, "task")
    }


def figure(rows: Rows, title: str) -> Any:
    """Error against run time of every peer's ladder in one task, and of our quickest runs, in logarithmic axes."""
    from matplotlib.figure import Figure

    from app.scenes.charts import PALETTE
    from app.study.tables import MARKERS

    drawn = Figure(figsize=(8.0, 5.6), layout="constrained")
    drawn.suptitle(f"{title}: the ladders of other programs, and our quickest run at each of their errors")
    axes = drawn.subplots()
    colours = [colour for colour in PALETTE if colour != "#000000"]  # black is ours
    for index, ((peer,), own) in enumerate(of_each(rows, "peer")):
        axes.loglog(
            [row["peer [ms]"] for row in own], [last_error(row) for row in own], label=peer,
            color=colours[index % 7], marker=MARKERS[index % 13], markersize=5, linestyle="-" if index < 7 else "--",
        )  # fmt: skip
    dampings = list(of_each([row for row in rows if RATIO in row], "damping"))
    for (damping,), own in dampings:
        ours = sorted({(row["ours [ms]"], row["our error at the end [m]"]) for row in own})
        axes.loglog(
            *zip(*ours, strict=True), label=f"Springtide, {damping} damping" if len(dampings) > 1 else "Springtide",
            color="black", linestyle="none",
            marker="o" if damping == "isotropic" else "x", markersize=6,
        )  # fmt: skip
    axes.set_xlabel("run time, median of repeats [ms]")
    axes.set_ylabel("error at the end [m]")
    axes.grid(visible=True, which="major", color="0.9")
    axes.spines[["top", "right"]].set_visible(False)
    drawn.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return drawn
