"""Cost of the gate: what the simulation thread does with each record of a slider before the scene takes it."""

import dataclasses
import statistics
from typing import Any

from app.messages import Change
from app.scenes import NAMES, scene_named
from app.scenes.ahead.compiling import Compiling
from app.scenes.timer import effort_clock
from app.server.loop.commands import CompileGate, Record

EVENTS, QUICK_EVENTS = 200, 5  # records of a slider that moves
LARGE: dict[str, dict[str, Any]] = {"rope": {"points": 1000}, "cloth": {"rows": 128, "cols": 128}}


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Each scene, with large nets: the median of processor time."""
    return [cost(name, QUICK_EVENTS if quick else EVENTS) for name in NAMES]


def cost(name: str, events: int) -> dict[str, Any]:
    """Move one slider of a scene so often."""
    kind = scene_named(name)
    params = dataclasses.replace(kind.params(), **LARGE.get(name, {}))
    gate = CompileGate(Compiling(1), kind, Record(params, 1))
    spent: list[float] = []
    for number in range(events):
        moved = dataclasses.replace(params, speed=1.0 + 1e-4 * number)
        start = effort_clock()
        gate.admit([Change(moved, "look")])
        spent.append(effort_clock() - start)
    size = " x ".join(map(str, LARGE.get(name, {}).values()))
    return {"scene": f"{name} {size}".strip(), "a slider event [ms]": 1e3 * statistics.median(spent)}
