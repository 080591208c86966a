"""A knot that is pulled tight, K(n), as a task of peers: the scene's rope of n points with a loose trefoil in it.

Without gravity and friction, its radius 0.02 m. One end is held, and a force draws the other away, see
`benchmarks.peers.knot`. In place of an error stands the largest depth of links in each other at any frame, in radii of
the rope: two whose middle lines meet are 2 deep. Our run is the quickest that is no deeper and keeps the knot.
"""

import dataclasses
import functools
import importlib
import statistics
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from app.formats.text_tables import Rows
from app.scenes.rope.parameters import PRESETS, RopeParams
from app.scenes.rope.scene import build
from benchmarks.knots import determinant, least_distance
from benchmarks.peers.knot import (
    DURATION,
    FRAMES_PER_SECOND,
    FREE_OF_CONTACT,
    PEERS,
    KnotRun,
    Setting,
    framed,
)
from benchmarks.peers.ladder import (
    DEEPEST,
    MAX_RUN_TIME,
    MAX_TURNS_TIME,
    QUICK_TURNS_TIME,
    RATIO,
    in_turns,
    rungs,
    stamp,
    undisturbed_time,
)
from benchmarks.peers.record import Peer
from benchmarks.timing import processor_time
from sim.parameters import check_record
from sim.springs import Contact, Grab, Net, State, advance

RADIUS = 0.02  # [m] below half a link, so that a link and the second after it do not touch where the rope is straight
POINTS = 80
KNOT = 3  # determinant of a trefoil
REPEATS = 3
FAR_AWAY, HAND = 1e3, 1e6  # [m] and [N/m] of a hand that pulls with its greatest force
# Our runs of leapfrog: steps a second, stiffness [N/m] and damping [N s/m] of contact.
LADDER = tuple(
    Setting(rate, contact)
    for rate, contact in (
        (330, (3e3, 10.0)), (330, (5e3, 10.0)), (330, (1e4, 10.0)), (480, (1e4, 10.0)), (480, (2e4, 20.0)),
        (480, (3e4, 30.0)), (720, (6e4, 30.0)), (960, (1e5, 30.0)), (1920, (1.5e5, 30.0)), (1920, (3e5, 60.0)),
        (1920, (6e5, 60.0)), (3840, (1e6, 100.0)), (7680, (3e6, 200.0)), (7680, (1e7, 1000.0)),
    )
)  # fmt: skip


class Outcome(NamedTuple):
    """The largest depth [radii] until the end or a divergence, and the words of a table for what the knot did."""

    deepest: float
    knot: str

    @property
    def holds(self) -> bool:
        """True if the knot stays to the end."""
        return self.knot == "stays"


def benchmark_knot(points: int, damping: str = "isotropic") -> Net:
    """The rope of K(points) by this damping model."""
    net = build(check_record(RopeParams, {**PRESETS["Knot"], "points": points}))
    return dataclasses.replace(
        net, gravity=(0.0, 0.0, 0.0), floor=None, pinned=frozenset({(0, 0)}), radius=RADIUS, thickness=2.0 * RADIUS,
        contact=Contact(1e4, 10.0), damping_model=damping,
    )  # fmt: skip


def own_run(net: Net, setting: Setting) -> KnotRun:
    """Our run."""
    net = dataclasses.replace(net, contact=Contact(*setting.contact))

    @functools.cache
    def pulled(force: float) -> Net:
        return dataclasses.replace(net, grab=Grab(0, net.shape[1] - 1, (-FAR_AWAY, 0.0, 0.0), HAND, 0.0, force))

    def run():
        state = State.at_rest(net)

        def step(force: float, steps: int) -> NDArray[np.float64] | None:
            advance(pulled(force), state, "leapfrog", 1.0 / setting.rate, steps)
            return state.x[:, 0].T.copy() if state.is_bounded else None

        return framed(step, setting)

    return run


def outcome(frames: NDArray[np.float64]) -> Outcome:
    """The `Outcome` of frames (frames, points, 3)."""
    depth = max((2.0 - least_distance(points, FREE_OF_CONTACT + 1) / RADIUS for points in frames), default=0.0)
    lost = next((i for i, points in enumerate(frames, 1) if determinant(points) != KNOT), None)
    if lost is not None:
        return Outcome(depth, f"lost at {lost / FRAMES_PER_SECOND:.1f} s")
    if len(frames) < round(DURATION * FRAMES_PER_SECOND):
        return Outcome(depth, f"diverges at {len(frames) / FRAMES_PER_SECOND:.1f} s")
    return Outcome(depth, "stays")


class OwnKnots:
    """Our runs, each made once when it is asked for."""

    def __init__(self, net: Net) -> None:
        self.net = net

    @functools.cached_property
    def results(self) -> list[tuple[float, Setting, Outcome]]:
        """Least processor time [s] of REPEATS, setting and outcome of each."""
        found = []
        own_run(self.net, LADDER[0])()  # which compiles
        for setting in LADDER:
            frames: list[NDArray[np.float64]] = []
            run = own_run(self.net, setting)
            times = [processor_time(lambda run=run, frames=frames: frames.append(run())) for _ in range(REPEATS)]
            found.append((min(times), setting, outcome(frames[0])))
        return found

    def quickest(self, deepest: float) -> tuple[Setting, Outcome] | None:
        """The quickest that keeps the knot and is at most so deep [radii]; None if none is."""
        fit = [result for result in self.results if result[2].holds and result[2].deepest <= deepest]
        return min(fit, key=lambda result: result[0])[1:] if fit else None


def compared(peer: Peer, ours: OwnKnots, quick: bool) -> Rows:
    """A row for each rung of a peer: its depth, what the knot did, its time, and our quickest run that is no deeper.

    Of a run that takes longer than MAX_RUN_TIME the first call is the only one, with what it compiles.
    """
    importlib.import_module(peer.package)
    table: Rows = []
    for rung in rungs(peer, ours.net, quick):
        row: dict[str, Any] = {"peer": peer.name, "damping": peer.damping, "its setting": rung.label}
        table.append(row)
        start = time.perf_counter()
        theirs = peer.make(ours.net, rung.value)
        frames: list[NDArray[np.float64]] = []
        first = undisturbed_time(lambda run=theirs, frames=frames: frames.append(run()))
        result = outcome(frames[0])
        row |= {"first call [ms]": 1e3 * (time.perf_counter() - start)}
        row |= {DEEPEST: result.deepest, "knot": result.knot}
        if not result.holds:
            row["note"] = "its knot fails"
            continue
        best = ours.quickest(result.deepest)
        calls = [theirs, *([] if best is None else [own_run(ours.net, best[0])])]
        if first > MAX_RUN_TIME:
            peer_times, our_times = [first], [[undisturbed_time(call)] for call in calls[1:]]
        else:
            peer_times, *our_times = in_turns(calls, QUICK_TURNS_TIME if quick else MAX_TURNS_TIME)
        row["peer [ms]"] = 1e3 * statistics.median(peer_times)
        if best is None:
            row["note"] = "no run of ours is as shallow"
        else:
            row |= {
                "with": best[0].label,
                "ours [ms]": 1e3 * statistics.median(our_times[0]),
                "our " + DEEPEST: best[1].deepest,
                RATIO: statistics.median(peer_times) / statistics.median(our_times[0]),
            }
        row |= stamp(len(peer_times))
    return table


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of peers; quick: every second rung."""
    task, table = f"K({POINTS})", []
    ours = functools.cache(lambda damping: OwnKnots(benchmark_knot(POINTS, damping)))
    chosen = [
        peer for peer in PEERS if not words or any(word.lower() in f"{task} {peer.name}".lower() for word in words)
    ]
    for peer in track(chosen, f"{task} peers", transient=True):
        if reason := peer.reason_left_out(POINTS):
            table.append({"task": task, "peer": peer.name, "damping": peer.damping, "note": reason})
        else:
            table += [{"task": task} | row for row in compared(peer, ours(peer.damping), quick)]
    return table
