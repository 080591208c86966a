"""A few steps of each kind of model, for `test_plain.py`: `python -m tests.sim.models FILE` keeps what they come to."""

import dataclasses
import math
import sys
from collections.abc import Iterator

import numpy as np

from sim.floating import Body, Hull, MotionCoefficients, make_fleet, make_water, step
from sim.floating.motion.body import pull
from sim.ocean import Sea
from sim.ocean.radial.radial import RadialSea
from sim.springs import INTEGRATORS, Air, Contact, Grab, cloth, rope
from sim.springs.state import State, advance
from sim.waves import Waves


def nets() -> Iterator[tuple[str, np.ndarray]]:
    """Ropes by every method and a cloth, on floor and sphere, pulled, damped, in wind and folded onto itself."""
    contact = Contact(300.0, 2.0, 0.4)
    line = rope(6, gravity=10.0, floor=2.4, sphere=(0.5, 0.05, 2.7, 0.3), contact=contact)
    for name, record in INTEGRATORS.items():
        net = dataclasses.replace(line, grab=Grab(0, 4, (1.0, 0.5, 2.5), 50.0, 3.0, 20.0))
        if record.undamped_only:
            net = rope(6, gravity=10.0, damping=0.0, drag=0.0)
        state = State.at_rest(net)
        advance(net, state, record, 1e-3, 3)
        yield f"rope {name}", state.x
        yield f"rope {name} speed", state.v
    sheet = cloth(4, 5, air=Air((3.0, -2.0, 5.0)), thickness=0.2, contact=contact)
    x0 = sheet.x0 + np.random.default_rng(1).normal(0.0, 0.03, sheet.x0.shape)
    for name in ("leapfrog", "implicit_euler"):
        net = dataclasses.replace(sheet, x0=x0)
        state = State.at_rest(net)
        advance(net, state, INTEGRATORS[name], 1e-3, 3)
        yield f"cloth {name}", state.v


def bodies() -> Iterator[tuple[str, np.ndarray]]:
    """Three hulls in two fluids that move, one pulled."""
    layers = ((850.0, 0.4), (1025.0, math.inf))
    hulls = Hull.box(1.0, 0.8, 0.6), Hull.cylinder(0.4, 0.7), Hull.sphere(0.4, frequency=2)
    fleet = make_fleet([Body(hull, 500.0, (2.0 * i, 0.1, 0.05)) for i, hull in enumerate(hulls)], layers)
    fleet.spin[:] = 0.1, 0.2, -0.3
    pull(fleet, 1, (0.2, 0.1, 0.3), (3.0, 0.0, 2.0), 300.0)
    n = len(hulls)
    water = make_water(
        fleet, layers, np.full(n, 0.05), slope=np.full((n, 2), 0.05), velocity=np.full((n, 3), 0.2),
        acceleration=np.full(n, 0.3), lead=0.01,
    )  # fmt: skip
    for _ in range(2):
        step(fleet, water, 0.02, MotionCoefficients())
    for name in ("position", "velocity", "rotation", "spin", "lift"):
        yield f"bodies {name}", getattr(fleet, name)


def seas() -> Iterator[tuple[str, np.ndarray]]:
    """A square sea with a ring, and a sum of waves."""
    sea = Sea(16, 40.0, "jonswap", wind_speed=9.0, precision="double")
    sea.ripples.add(0.0, [[20.0, 18.0]], 3.0, volume=0.5)
    surface = sea.surface(2.0)
    yield "sea", surface.height
    yield "sea along", surface.displacement
    k = np.array([0.1, 0.3, 0.6])
    waves = RadialSea(Waves(k, 0.5 * k, 0.1 / k, np.arange(3.0)))
    found = waves.at(np.array([[1.0, 2.0], [-30.0, 8.0]]), 3.0, np.ones(2))
    for name in ("height", "slope", "velocity", "acceleration"):
        yield f"waves {name}", getattr(found, name)


def results() -> dict[str, np.ndarray]:
    """All of them, by name."""
    return {name: np.array(value) for part in (nets, bodies, seas) for name, value in part()}


if __name__ == "__main__":
    np.savez(sys.argv[1], **results())
