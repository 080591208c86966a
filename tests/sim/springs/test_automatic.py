"""`auto`: which of the embedded methods runs."""

import numpy as np
import pytest

from sim.springs import INTEGRATORS, cloth, rope, simulate
from sim.springs.automatic import AUTO, WEAK, bounds, choose_for_step, choose_for_tolerance
from sim.springs.integrator_fallback import integrator_or_fallback
from sim.springs.stability import critical_step

ADAPTIVE = [name for name, record in INTEGRATORS.items() if record.adaptive]
NETS = {
    "undamped": rope(10, damping=0.0, drag=0.0),
    "the lab's": rope(10),
    "overdamped": rope(10, damping=28.0),
    "stiff": rope(10, stiffness=8e4),
    "stiff, damped": rope(10, stiffness=8e4, damping=30.0),
    "long": rope(40, damping=1.0, mass=0.1),
    "cloth": cloth(6, 6),
}


@pytest.mark.parametrize("damping", [0.05, 0.2])
def test_damping_counts_above_a_tolerance_that_goes_with_its_square(damping):
    soft = rope(10, stiffness=5.0, damping=damping, drag=0.0, gravity=9.81)
    border = 1e-6 * WEAK * bounds(soft)[1] ** 2
    assert choose_for_tolerance(soft, 0.5 * border, 1.0).integrator.name == "dop853"
    assert choose_for_tolerance(soft, 2.0 * border, 1.0).integrator.name == "rkn8"


@pytest.mark.parametrize("net", NETS.values(), ids=NETS)
def test_auto_takes_hardly_more_evaluations_than_the_best_of_the_embedded_methods(net):
    for rtol in (1e-4, 1e-7, 1e-10):
        taken = choose_for_tolerance(net, rtol, 1.0).integrator.name
        evals = {
            name: simulate(net, duration=1.0, frames=2, integrator=name, rtol=rtol, atol=0.01 * rtol)
            for name in ADAPTIVE
        }
        best = min(run.force_evals for run in evals.values())
        assert evals[taken].force_evals < 1.5 * best


def test_auto_knows_soft_damped_nets_and_close_frames():
    assert choose_for_tolerance(NETS["the lab's"], 1e-8, 1.0).integrator.name == "dop853"
    assert choose_for_tolerance(NETS["undamped"], 1e-8, 1.0).integrator.name == "rkn8"
    assert choose_for_tolerance(NETS["stiff, damped"], 1e-8, 1.0).integrator.name == "rkn8"
    assert choose_for_tolerance(NETS["the lab's"], 1e-6, 1e-3).integrator.name == "dopri5"
    assert choose_for_tolerance(rope(10, gravity=0.0), 1e-12, 1.0).integrator.name == "rkn8"


@pytest.mark.parametrize("net", NETS.values(), ids=NETS)
def test_auto_holds_at_a_given_step_wherever_an_embedded_method_does(net):
    most = max(critical_step(net, name) for name in ADAPTIVE)
    for share in (0.05, 0.3, 0.9):
        taken = choose_for_step(net, share * most).integrator
        assert critical_step(net, taken) > share * most
        others = [name for name in ADAPTIVE if INTEGRATORS[name].evals < taken.evals]
        assert all(critical_step(net, name) < 1.2 * share * most for name in others)
    assert choose_for_step(net, 2.0 * most).integrator.name in ("rkn8", "dop853")


def test_a_run_says_what_auto_took():
    run = simulate(rope(), duration=1.0, frames=2, integrator=AUTO, rtol=1e-8, atol=1e-10)
    assert run.integrator == "dop853"
    assert np.array_equal(run.x, simulate(rope(), duration=1.0, frames=2, integrator="dop853", rtol=1e-8, atol=1e-10).x)
    assert simulate(rope(), duration=0.1, frames=2, step=1e-3, integrator=AUTO).integrator == "dopri5"
    assert simulate(rope(), duration=0.1, frames=2, integrator="rk4").integrator == "rk4"
    record, note = integrator_or_fallback(AUTO, rope(), 1e-3)
    assert (record.name, note) == ("dopri5", "dopri5 runs: it is stable at this step with the fewest force evaluations")
    with pytest.raises(ValueError, match=r"rtol: .* the step is given"):
        simulate(rope(), step=1e-3, integrator=AUTO, rtol=1e-6)
