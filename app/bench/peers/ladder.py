"""A peer's ladder: the task at several steps or tolerances, each compared with our quickest run at its error."""

import functools
import math
import statistics
import time
from typing import Any, NamedTuple

from app.bench.own_runs import OwnRuns, largest_distances
from app.bench.peers.record import Peer
from app.bench.timing import in_turns
from sim.springs import Net
from sim.springs.stability import critical_step

FRACTIONS = (0.8, 0.4, 0.2, 0.1)  # over leapfrog's critical step, for peers that take steps
OWN_FRACTIONS = (1.0, 0.5, 0.25)  # over the peer's own step, where it has one
MAX_RUN_TIME = 10.0  # [s] a ladder ends before runs that would take longer
MAX_TURNS_TIME = 4.0  # [s] for the repeats of a peer
MAX_ERROR = 1.0  # [m] a larger one means that the run diverged


class Rung(NamedTuple):
    """What a peer is given, and how the table says it."""

    label: str
    value: float  # step [s], or relative tolerance


def rungs(peer: Peer, net: Net, quick: bool) -> list[Rung]:
    """The rungs of a peer, from coarse to fine; quick: every second one."""
    if peer.tolerances:
        found = [Rung(f"rtol {rtol:.0e}", rtol) for rtol in peer.tolerances]
    else:
        step, fractions = (peer.step, OWN_FRACTIONS) if peer.step else (critical_step(net, "leapfrog"), FRACTIONS)
        found = [Rung(f"step {1e6 * fraction * step:.3g} µs", fraction * step) for fraction in fractions]
    return found[:: 2 if quick else 1]


def compared(peer: Peer, net: Net, ours: OwnRuns, times: tuple[float, ...], quick: bool) -> list[dict[str, Any]]:
    """A row for each rung of a peer's ladder: its error and time, and our quickest run with errors no larger, in turns.

    times: of the task [s], at which errors count. Run times are medians of repeats, of the whole task. That of the
    first call includes what the peer compiles.
    """
    table: list[dict[str, Any]] = []
    for rung in rungs(peer, net, quick):
        row: dict[str, Any] = {"peer": peer.name, "damping": peer.damping, "its setting": rung.label}
        table.append(row)
        theirs = peer.make(net, rung.value)
        start = time.perf_counter()
        theirs(times[-1])
        row["first call [ms]"] = 1e3 * (time.perf_counter() - start)
        limits = largest_distances(tuple(theirs(t) for t in times), ours.reference)
        row |= {f"error at {t:g} s [m]": error for t, error in zip(times, limits, strict=True)}
        if not max(limits) < MAX_ERROR:
            row["note"] = "diverged"
            continue
        best = ours.quickest(limits)
        whole = functools.partial(theirs, times[-1])
        repeats = 3 if quick else 9
        peer_times, *our_times = in_turns([whole, *([] if best is None else [best.run])], repeats, MAX_TURNS_TIME)
        row["peer [ms]"] = 1e3 * statistics.median(peer_times)
        if best is None:
            row["note"] = f"no run of ours is as exact; the reference is good to {ours.reference.uncertainty:.1e} m"
        else:
            row |= {
                "ours": best.method,
                "with": best.setting,
                "ours [ms]": 1e3 * statistics.median(our_times[0]),
                "our error at the end [m]": ours.result(best).errors[-1],
                "times as long as ours": statistics.median(peer_times) / statistics.median(our_times[0]),
            }
        if 2.0 * statistics.median(peer_times) > MAX_RUN_TIME:
            break
    return table


def last_error(row: dict[str, Any]) -> float:
    """Error at the end of the task [m] of a row of `compared`; NaN where there is none."""
    return next((value for name, value in reversed(row.items()) if name.startswith("error at")), math.nan)


def summary(table: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The ladder of each peer in each task in one row: how many times as long it takes, and its error where least."""
    found = []
    for task, peer in dict.fromkeys((row["task"], row["peer"]) for row in table):
        own = [row for row in table if (row["task"], row["peer"]) == (task, peer) and "times as long as ours" in row]
        if not own:
            continue
        ratios = [row["times as long as ours"] for row in own]
        least = own[ratios.index(min(ratios))]
        found.append(
            {
                "task": task,
                "peer": peer,
                "rungs": len(own),
                "least times as long": min(ratios),
                "there with": least["its setting"],
                "and an error of [m]": last_error(least),
                "median times as long": statistics.median(ratios),
                "greatest times as long": max(ratios),
            }
        )
    return sorted(found, key=lambda row: (row["task"], row["least times as long"]))


def figure(table: list[dict[str, Any]], title: str) -> Any:
    """Error against run time of every peer's ladder in one task, and of our quickest runs, in logarithmic axes."""
    from matplotlib.figure import Figure

    from app.experiments.tables import MARKERS
    from app.scenes.charts import PALETTE

    drawn = Figure(figsize=(8.0, 5.6), layout="constrained")
    drawn.suptitle(title)
    axes = drawn.subplots()
    rows = [row for row in table if "peer [ms]" in row]
    for index, peer in enumerate(dict.fromkeys(row["peer"] for row in rows)):
        own = [row for row in rows if row["peer"] == peer]
        axes.loglog(
            [row["peer [ms]"] for row in own], [last_error(row) for row in own], label=peer,
            color=PALETTE[index % 8], marker=MARKERS[index % 13], markersize=5, linestyle="-" if index < 8 else "--",
        )  # fmt: skip
    ours = sorted({(row["ours [ms]"], row["our error at the end [m]"]) for row in rows if "ours [ms]" in row})
    axes.loglog(*zip(*ours, strict=True), label="Springtide", color="black", marker=".", linestyle="none", markersize=9)
    axes.set_xlabel("run time, median of repeats [ms]")
    axes.set_ylabel("error at the end [m]")
    axes.grid(visible=True, which="major", color="0.9")
    axes.spines[["top", "right"]].set_visible(False)
    drawn.legend(loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    return drawn
