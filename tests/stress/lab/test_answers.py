"""How long the simulation takes to answer a control, with its own threads and clock."""

import math
import os
import random
import time
from collections.abc import Iterator

import pytest

from app.messages import Play, Reset
from app.scenes import NAMES
from app.scenes.ahead.compiling import prepare
from app.server.viewer import Viewer
from sim.parameters import parameters_of
from tests.stress.hammer import anywhere, ends
from tests.stress.tally import Tally

CHANGES = int(os.environ.get("SPRINGTIDE_STRESS_CHANGES", "10000")) // 10  # of each scene
AT_ONCE = 6  # most parameters turned between two answers
PAUSE = 0.15  # [s] in which a solve gets under way, at most
MAX_SILENCE = 1.0  # [s] on a machine with much other work; with none, all waits are below 0.1 s (docs/measured.md)
# [s] of processor time of the simulation's thread in one wait. Up to 0.13 s was seen where others use the same caches.
MAX_WORK = 0.2


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    made = Viewer("127.0.0.1", 0)
    yield made
    made.shut()


@pytest.mark.parametrize("name", NAMES)
def test_a_control_is_answered_while_a_solve_runs(name: str, viewer: Viewer, tally: Tally) -> None:
    """The answer is a snapshot of the parameters as set, or of a later reset.

    What the machine does besides makes a wait longer, but not the simulation's own processor time in it.
    """
    prepare(name)
    viewer.open(name)
    loop, panel = viewer.loop, viewer.panel
    loop.run.audience = lambda: 1
    rng = random.Random(f"answers {name}")
    thread = next(thread for thread in viewer.served.threads if thread.name == "simulation")
    assert thread.ident is not None
    processor = time.pthread_getcpuclockid(thread.ident)
    waits: list[tuple[float, float, dict[str, object]]] = []

    def answered(since: float, worked: float, number: int) -> None:
        while not (loop.latest.params == panel.settings.params and loop.latest.status.run.number >= number):
            assert time.monotonic() - since < 60.0, "no answer"
            time.sleep(0.001)
        unusual = {n: getattr(panel.settings.params, n) for n, k in parameters_of(panel.settings.params).items()
                   if getattr(panel.settings.params, n) != k.default}  # fmt: skip
        waits.append((time.monotonic() - since, time.clock_gettime(processor) - worked, unusual))

    changes = 0
    while changes < CHANGES:
        time.sleep(rng.uniform(0.0, PAUSE))
        number = loop.run.identity.number
        since, worked = time.monotonic(), time.clock_gettime(processor)
        for _ in range(rng.randint(1, AT_ONCE)):
            chosen = rng.choice(list(panel.controls))
            parameter = parameters_of(panel.settings.params)[chosen]
            panel.settings.set(chosen, rng.choice(ends(parameter)) if rng.random() < 0.4 else anywhere(parameter, rng))
            changes += 1
        if rng.random() < 0.2 or loop.run.halted:
            loop.commands.put(Reset())
            loop.commands.put(Play())
            number += 1
        answered(since, worked, number)
    longest, _, unusual = max(waits, key=lambda wait: wait[0])
    share = sorted(wait for wait, *_ in waits)[math.ceil(0.99 * len(waits)) - 1]
    work = max(work for _, work, _ in waits)
    early = loop.run.counts["solves ended early"]
    tally.notes.append(
        f"{name}: {changes} changes, longest wait for an answer {longest:.3f} s, 99 of 100 below {share:.3f} s; most "
        f"own work in a wait {work:.3f} s; {early} solves ended; longest with {unusual}"
    )
    assert longest < MAX_SILENCE
    assert work < MAX_WORK
