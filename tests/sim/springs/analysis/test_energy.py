import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Air, Contact, Grab, PinPath, cloth, rope, simulate
from sim.springs.net import Net
from sim.springs.state import State, advance, energy
from tests.sim.springs.nets import DAMPABLE, hairpin
from tests.sim.springs.reference import integrated, slope

OSCILLATOR = rope(2, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0)  # omega = 1 rad/s
PATH = PinPath(0.0, ((0.0, 0.0, 0.0), (0.5, 0.2, 0.3), (-0.5, 0.4, 1.0), (0.4, 0.5, -1.0)))
GRAB = Grab(0, 6, (-1.0, 0.5, 0.2), 300.0, 8.0, 60.0)
LEDGERS = {
    "damped": rope(8),
    "axial": rope(8, damping_model="axial"),
    "undamped": rope(8, damping=0.0, drag=0.0),
    "moving root": dataclasses.replace(rope(8), pin_paths=(((0, 0), PATH),)),
    "grabbed": dataclasses.replace(rope(8), grab=GRAB),
}

# Order: steps of the coarsest run, between runs, and slack. High orders need a window between where the residual still
# changes sign (order 5, undamped: at 16 steps) and round-off; the eighth, with a pull, is not yet asymptotic in it.
LADDERS = {1: (400, 2.0, 0.15), 5: (64, 1.3, 0.15), 8: (11, 1.25, 2.0)}


def stretched(x, v=0.0):
    state = State.at_rest(OSCILLATOR)
    state.x[0, 0, 1] -= x
    state.v[0, 0, 1] = -v
    return state


def residual(net, name, seconds, steps):
    """What the ledger does not account for [J]."""
    state = integrated(net, name, seconds, steps, with_account=True)
    gained = energy(net, state).total - energy(net, State.at_rest(net)).total
    return abs(gained + state.dissipated - state.work)


@pytest.mark.parametrize("case", LEDGERS)
@pytest.mark.parametrize("name", DAMPABLE)
def test_the_ledger_s_residual_falls_at_the_method_s_order(name, case):
    record = INTEGRATORS[name]
    order = record.order if case != "undamped" else record.undamped_order or record.order
    coarsest, ratio, slack = LADDERS.get(order, (50, 2.0, 0.15))
    counts = [round(coarsest * ratio**i) for i in range(6)]
    errors = [residual(LEDGERS[case], name, 0.4, steps) for steps in counts]
    # Some errors cancel in the sum: it may fall faster, never slower; of the midpoint method only round-off is left.
    assert max(errors) < 1e-9 or slope(counts[2:], errors[2:]) > order - slack


@pytest.mark.parametrize("law", ["clipped", "lab"])
@pytest.mark.parametrize("name", DAMPABLE)
def test_the_ledger_closes_through_contact_and_friction(name, law):
    sphere = (-0.9, 0.0, -0.6, 0.5)
    contact = Contact(2000.0, 10.0, 0.3, law)
    net = dataclasses.replace(rope(8, floor=-1.2, sphere=sphere, contact=contact), sphere_velocity=(0.2, 0.0, 0.3))
    errors = [residual(net, name, 1.0, steps) for steps in (2000, 8000, 32_000)]
    spent = integrated(net, name, 1.0, 2000, with_account=True).dissipated
    # Of first order through contact, so that a sixteenth of the step leaves about a sixteenth.
    assert errors[2] < 0.1 * errors[0] or errors[2] < 1e-6 * spent
    assert errors[2] < 1e-3 * spent


def leaning(angle: float) -> tuple[Net, np.ndarray]:
    """An undamped straight rope at an angle [rad] to the vertical, where it swings without chaos, and its points."""
    net = rope(10, damping=0.0, drag=0.0, gravity=10.0)
    along = np.linalg.norm(net.x0 - net.x0[:, :, :1], axis=0)[0]
    return net, np.outer(along, (np.sin(angle), 0.0, -np.cos(angle)))


def test_undamped_leapfrog_keeps_its_energy_over_a_hundred_thousand_steps():
    net, x = leaning(0.2)
    run = simulate(net, duration=100.0, frames=1001, step=1e-3, integrator="leapfrog", x=x)
    total = run.energy.total
    off = np.abs(total - total[0]).max()
    assert run.force_evals >= 100_000
    assert off < 3e-4 * run.energy.kinetic.max()
    # No drift, once the motion has spread over all modes: each quarter's mean is the last one's.
    assert abs(total[501:751].mean() - total[751:].mean()) < 0.1 * off


def test_undamped_rk4_loses_energy_steadily_where_leapfrog_does_not():
    net, x = leaning(0.5)
    kept = simulate(net, duration=20.0, frames=201, step=1 / 60, integrator="leapfrog", x=x).energy.total
    lost = simulate(net, duration=20.0, frames=201, step=1 / 60, integrator="rk4", x=x).energy.total
    assert (np.diff(lost) < 0.0).all()
    assert lost[0] - lost[-1] > 30.0 * abs(kept[101:].mean() - kept[:101].mean())


@pytest.mark.parametrize("z", [0.01, 0.1, 0.93, 1.9])
def test_leapfrog_s_energy_swings_by_exactly_a_quarter_of_z_squared(z):
    """It keeps v^2/2 + (1 - z^2/4) x^2/2: from rest, the true energy falls by the share z^2/4 of itself at most."""
    state = stretched(0.4)
    total, kept = [], []
    for _ in range(20_000):
        x, v = state.x[0, 0, 1] + 1.0, state.v[0, 0, 1]
        total.append(0.5 * (v * v + x * x))
        kept.append(0.5 * (v * v + (1.0 - z * z / 4.0) * x * x))
        advance(OSCILLATOR, state, INTEGRATORS["leapfrog"], z, 1)
    assert np.ptp(kept) < 1e-11 * kept[0]
    assert (max(total) - min(total)) / max(total) == pytest.approx(z * z / 4.0, rel=2e-3)


def test_symplectic_euler_keeps_its_own_energy():
    """v^2/2 + x^2/2 - z x v/2, of kick then drift."""
    z = 0.5
    state = stretched(0.4, 0.2)
    kept = []
    for _ in range(1000):
        x, v = state.x[0, 0, 1] + 1.0, state.v[0, 0, 1]
        kept.append(0.5 * (v * v + x * x - z * x * v))
        advance(OSCILLATOR, state, INTEGRATORS["symplectic_euler"], z, 1)
    assert np.ptp(kept) < 1e-11 * kept[0]


@pytest.mark.parametrize("z", [0.05, 0.3, 0.93, 1.5])
@pytest.mark.parametrize(
    ("name", "factor"), [("explicit_euler", lambda z: 1.0 + z**2), ("rk4", lambda z: 1.0 - z**6 / 72.0 + z**8 / 576.0)]
)
def test_a_step_multiplies_the_energy_by_the_closed_form(name, factor, z):
    state = stretched(3e-4, 7e-4)
    before = energy(OSCILLATOR, state).total
    advance(OSCILLATOR, state, INTEGRATORS[name], z, 1)
    assert energy(OSCILLATOR, state).total / before == pytest.approx(factor(z), rel=1e-11)


def test_rk4_is_late_by_z_to_the_fifth_over_120():
    z = 0.1
    state = stretched(1e-3)
    advance(OSCILLATOR, state, INTEGRATORS["rk4"], z, 1)
    phase = math.atan2(-state.v[0, 0, 1] * -1.0, -(state.x[0, 0, 1] + 1.0))
    assert z - phase == pytest.approx(z**5 / 120.0, rel=2e-2)


@pytest.mark.parametrize("name", ["rk4", "leapfrog", "symplectic_euler", "leapfrog_lagged"])
def test_the_damped_oscillator_is_the_closed_form(name):
    """m = 1, k = 800, b = 7 from 0.1 m: x(1) = -0.00287743369951258."""
    net = rope(2, 1.0, 1.0, 800.0, 7.0, 0.0, 0.0)
    found = []
    for steps in (10_000, 20_000):
        state = State.at_rest(net)
        state.x[0, 0, 1] -= 0.1
        advance(net, state, INTEGRATORS[name], 1.0 / steps, steps)
        found.append(abs(-(state.x[0, 0, 1] + 1.0) - -0.00287743369951258))
    order = INTEGRATORS[name].order
    if order == 4:
        assert found[0] < 1e-13
    else:
        assert found[0] / found[1] == pytest.approx(2**order, rel=0.02)
        assert found[1] < 1e-5


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", DAMPABLE)
def test_what_damping_took_never_falls(name, model):
    net = rope(8, damping_model=model)
    run = simulate(net, duration=1.0, frames=101, step=1e-4, integrator=name, with_account=True)
    assert np.diff(run.energy.dissipated).min() >= 0.0
    assert run.energy.work[-1] == 0.0


@pytest.mark.parametrize("case", ["moving root", "moving sphere", "wind"])
@pytest.mark.parametrize("name", ["rk4", "leapfrog"])
def test_what_damping_took_never_falls_where_something_moves(name, case):
    run = simulate(driven(case), duration=0.5, frames=51, step=5e-4, integrator=name, with_account=True)
    assert np.diff(run.energy.dissipated).min() >= -1e-9


def driven(case):
    """Nets on which something that moves does work through damping forces."""
    if case == "moving root":
        return LEDGERS["moving root"]
    if case == "wind":
        return cloth(4, 4, density=0.3, stiffness=100.0, shear=50.0, bend=5.0, damping=0.05, air=Air((3.0, 4.0, 2.0)))
    sphere = rope(8, sphere=(-0.9, 0.0, -0.6, 0.5), contact=Contact(2000.0, 10.0, 0.3))
    return dataclasses.replace(sphere, sphere_velocity=(0.2, 0.0, 0.3))


@pytest.mark.parametrize("case", ["moving root", "moving sphere", "wind"])
def test_the_leapfrog_splits_damping_off_and_books_what_it_took_and_what_was_put_in_as_the_others_do(case):
    net = driven(case)
    truth = integrated(net, "rk4", 0.5, 4000, with_account=True)
    coarse, fine = (integrated(net, "leapfrog", 0.5, steps, with_account=True) for steps in (1000, 4000))
    for state, bound in ((coarse, 0.02), (fine, 0.006)):
        assert state.dissipated == pytest.approx(truth.dissipated, rel=bound)
        assert state.work == pytest.approx(truth.work, rel=bound)
    assert truth.dissipated > 0.0


def test_still_air_only_takes_energy_and_wind_puts_it_in():
    still = driven("wind")
    still = dataclasses.replace(still, air=Air())
    for name in ("rk4", "leapfrog"):
        state = integrated(still, name, 0.5, 1000, with_account=True)
        assert state.work == 0.0
        assert state.dissipated > 0.0
    assert integrated(driven("wind"), "rk4", 0.5, 1000, with_account=True).work > 0.0


COUNTS = [200, 400, 800]
LONG_TO_COMPILE = ("rk4", "implicit_midpoint", "symplectic_euler")  # half a minute of the forces of contact


@pytest.mark.parametrize(
    "name", ["leapfrog", *(pytest.param(name, marks=pytest.mark.stress) for name in LONG_TO_COMPILE)]
)
def test_the_ledger_closes_through_a_net_s_contact_with_itself(name):
    for net in (hairpin(3.0), hairpin(3.0, moving=(((0, 0), PATH),))):
        errors = [residual(net, name, 0.3, steps) for steps in (200, 3200)]
        spent = integrated(net, name, 0.3, 3200, with_account=True)
        assert spent.dissipated > 0.1
        assert (spent.work != 0.0) is bool(net.pin_paths)
        assert errors[1] < 0.1 * errors[0]
        assert errors[1] < 0.05 * spent.dissipated


def test_contact_of_a_net_with_itself_takes_nothing_without_damping():
    assert integrated(hairpin(0.0), "leapfrog", 0.3, 200, with_account=True).dissipated == 0.0


def test_a_cloth_in_the_wind_and_its_account_converge_at_the_leapfrog_s_order():
    """The leapfrog splits the air off, as it does the damping."""
    net = driven("wind")
    truth = integrated(net, "rk4", 0.2, 3200).x
    runs = [integrated(net, "leapfrog", 0.2, steps, with_account=True) for steps in COUNTS]
    start = energy(net, State.at_rest(net)).total
    left = [abs(energy(net, run).total - start + run.dissipated - run.work) for run in runs]
    assert slope(COUNTS, [np.abs(run.x - truth).max() for run in runs]) == pytest.approx(2, abs=0.15)
    assert slope(COUNTS, left) > 2 - 0.15
