"""Ropes and cloths at the ends of what there is: steps, stiffness, masses, and shapes that are hardly shapes."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, Net, Run, cloth, rope, simulate
from sim.springs.stability import critical_step, gauge
from sim.springs.state import DIVERGENCE_BOUND, State
from tests.stress.tally import Tally

STEPS = 10.0 ** np.arange(-6.0, 0.5)  # [s]
TWELVE_DECADES = 10.0 ** np.arange(-3.0, 9.5)  # [N/m]
MASSES = 10.0 ** np.arange(-6.0, 6.5)  # [kg]
FEW = 40  # steps of a run
UNDAMPED = [name for name, record in INTEGRATORS.items() if record.undamped_only]


def damping_of(integrator: str, damping: float) -> dict[str, Any]:
    """Damping where the method takes any, else none at all."""
    if integrator in UNDAMPED:
        return {"damping": 0.0, "drag": 0.0, "contact": Contact(damping=0.0)}
    return {"damping": damping}


def run_few(net: Net, integrator: str, step: float, steps: int = FEW) -> Run:
    """A short run; what must hold of any: numbers until it diverged, none after, and nothing in between."""
    run = simulate(net, duration=steps * step, frames=5, step=step, integrator=integrator)
    good = run.t < (math.inf if run.diverged_at is None else run.diverged_at)
    for rows in (run.x, run.v):
        assert np.isfinite(rows[good]).all()
        assert np.isnan(rows[~good]).all()
    assert np.abs(run.x[good]).max() < DIVERGENCE_BOUND
    return run


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_steps_from_a_microsecond_to_a_second(integrator: str, tally: Tally) -> None:
    for make in (rope, lambda **more: cloth(6, 6, **more)):
        for step in STEPS:
            with tally.fault("step size"):
                run_few(make(floor=-1.0, **damping_of(integrator, 0.1)), integrator, float(step))


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_stiffness_over_twelve_decades(integrator: str, tally: Tally) -> None:
    for stiffness in TWELVE_DECADES:
        net = rope(stiffness=float(stiffness), **damping_of(integrator, 7.0))
        with tally.fault("stiffness"):
            run_few(net, integrator, 1 / 60)
            holds = critical_step(net, integrator)
            if 0.0 < holds < math.inf:
                assert run_few(net, integrator, 0.5 * holds, 400).diverged_at is None


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_masses_from_a_milligram_to_a_thousand_tonnes(integrator: str, tally: Tally) -> None:
    for mass in MASSES:
        net = rope(mass=float(mass), floor=-1.0, **damping_of(integrator, 7.0))
        with tally.fault("mass"):
            run_few(net, integrator, 1 / 60)
            holds = critical_step(net, integrator)
            if 0.0 < holds < math.inf:
                assert run_few(net, integrator, min(0.4 * holds, 1.0), 100).diverged_at is None


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_shapes_that_are_hardly_shapes(integrator: str, tally: Tally) -> None:
    calm = damping_of(integrator, 7.0)
    with tally.fault("one point"):
        run = run_few(rope(points=1, **calm), integrator, 1 / 60)
        assert (run.x == run.x[0]).all()
    with tally.fault("zero gravity"):
        run = run_few(rope(gravity=0.0, **calm), integrator, 1 / 60)
        assert np.abs(run.x - run.x[0]).max() < 1e-12
    for make in (rope, lambda **more: cloth(5, 5, **more)):
        with tally.fault("coincident points"):
            net = make(**damping_of(integrator, 0.01))
            run_few(dataclasses.replace(net, x0=np.zeros_like(net.x0)), integrator, 1e-4)
    with tally.fault("sphere through the rope"):
        # Its centre on a point, and the point with no way out that is nearer than another.
        run_few(rope(sphere=(-1.0, 0.0, 0.0, 0.3), floor=-1.0, **calm), integrator, 1e-3)
    with tally.fault("sphere swallows the rope"):
        run_few(rope(sphere=(0.0, 0.0, 0.0, 50.0), **calm), integrator, 1e-3)
    with tally.fault("sphere swallows the cloth"):
        net = cloth(6, 6, sphere=(0.5, 0.5, 0.0, 9.0), floor=-1.0, **damping_of(integrator, 0.01))
        run_few(net, integrator, 1e-4)
    with tally.fault("everything in one place"):
        net = cloth(4, 4, sphere=(0.0, 0.0, 0.0, 1.0), floor=0.0, thickness=0.1, **damping_of(integrator, 0.01))
        net = dataclasses.replace(net, x0=np.zeros_like(net.x0), pinned=frozenset())
        run_few(net, integrator, 1e-4)
        assert np.isfinite(gauge(net, integrator, 1e-4, State.at_rest(net)).h_omega)
