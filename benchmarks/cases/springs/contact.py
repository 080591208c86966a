"""Cost of the contact of a rope or a cloth with itself: steps of `leapfrog` over those without it."""

import dataclasses
import statistics
from collections.abc import Callable
from typing import Any

import numpy as np

from app.messages import Place
from app.scenes.cloth.parameters import PRESETS as CLOTHS
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.rope.parameters import PRESETS as ROPES
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene
from benchmarks.timing import processor_time
from sim.parameters import check_record
from sim.springs import Contact, Net, State, advance, rope
from sim.springs.forces.strand_contact import set_touching

CONTACT = Contact(1000.0, 1.0, 0.3)
RADIUS = 0.02  # [m]
Case = tuple[Net, State, float, int]  # at a state, steps of h [s], and their number


def loose() -> Case:
    """A rope that fell on the floor."""
    net = rope(
        100, 4.0, 0.1, 5000.0, 0.3, 0.05, root=(0.0, 0.0, 0.5), floor=0.0, contact=CONTACT, radius=RADIUS,
        self_contact=True,
    )  # fmt: skip
    state = State.at_rest(net)
    advance(net, state, "leapfrog", 1e-3, 4000)
    return net, state, 1e-3, 2000


def tight() -> Case:
    """The scene's knot, pulled tight by one end."""
    scene = RopeScene(check_record(RopeParams, ROPES["Knot"]))
    frame = round(1 / 60 / scene.step)
    scene.advance(60 * frame)
    scene.handle(Place("root", (1.4, 0.0, 3.0)))
    scene.advance(300 * frame)
    return scene.net, scene.state, scene.step, 500


def coil(points: int, turn: float) -> Case:
    """A rope that lies on the floor in turns of this radius [m], each on the one below."""
    rest = 2.0 * RADIUS
    angle = np.arange(points) * rest / turn
    x = np.array([turn * np.cos(angle), turn * np.sin(angle), RADIUS + 0.95 * 2.0 * RADIUS * angle / (2.0 * np.pi)])
    net = rope(
        points, rest * (points - 1), 0.05, 2000.0, 0.3, 0.05, floor=0.0, contact=CONTACT, radius=RADIUS,
        self_contact=True,
    )  # fmt: skip
    net = dataclasses.replace(net, x0=np.ascontiguousarray(x[:, None]), pinned=frozenset(), gravity=(0.0, 0.0, -1.0))
    state = State.at_rest(net)
    advance(net, state, "leapfrog", 1e-3, 100)
    return net, state, 1e-3, 100


def draped() -> Case:
    """The scene's cloth as it falls over its sphere, for its first second."""
    scene = ClothScene(check_record(ClothParams, CLOTHS["Drape over the sphere"]))
    return scene.net, scene.state, scene.step, round(1.0 / scene.step)


CASES: dict[str, Callable[[], Case]] = {
    "rope of 100 points, loose on the floor": loose,
    "tight knot": tight,
    "coil of 1000 points": lambda: coil(1000, 0.3),
    "coil of 10,000 points, as high": lambda: coil(10_000, 3.0),
    "coil of 10,000 points, ten times as high": lambda: coil(10_000, 0.3),
    "drape, 64 x 64": draped,
}


def row(name: str, case: Case, turns: int) -> dict[str, Any]:
    """Processor times of the three in turns, as ratios of each turn."""
    net, state, h, steps = case
    nets = [
        net,
        dataclasses.replace(net, contact=net.contact._replace(friction=0.0)),
        dataclasses.replace(net, thickness=0.0),
    ]

    def time_of(one: Net) -> float:
        start = state.copy()
        return processor_time(lambda: advance(one, start, "leapfrog", h, steps)) / steps

    for one in nets:
        advance(one, state.copy(), "leapfrog", h, 2)  # which compiles
    times = np.array([[time_of(one) for one in nets] for _ in range(turns)])
    ratios = times / times[:, 2:]
    touching = set_touching(state.x.reshape(-1).copy(), net.kernel_view(h)) if net.is_chain else None
    return {
        "what": name,
        "points": net.x0[0].size,
        **({} if touching is None else {"touching pairs": touching}),
        "step [us]": 1e6 * statistics.median(times[:, 0].tolist()),
        "a point [ns]": 1e9 * statistics.median(times[:, 0].tolist()) / net.x0[0].size,
        "over without contact": statistics.median(ratios[:, 0].tolist()),
        "smooth over without contact": statistics.median(ratios[:, 1].tolist()),
    }


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """A row for each; quick: without the coil of 10,000 points and the drape."""
    names = [name for name in CASES if not quick or not ("10,000" in name or "drape" in name)]
    return [row(name, CASES[name](), 3 if quick else 7) for name in names]
