"""The laws of a link, in all that asks them: forces, energies, damping, tangents, implicit steps, gauge and statics."""

import dataclasses
import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from sim.jit import kernel
from sim.springs import INTEGRATORS, LAWS, State, advance, cloth, critical_step, rope, simulate
from sim.springs.analysis.growth import STABLE, outcome
from sim.springs.analysis.settling import find_rest_positions
from sim.springs.analysis.strain import strain_range
from sim.springs.analysis.tension import rope_tension
from sim.springs.forces.matrices import DAMPING, STIFFNESS
from sim.springs.laws import energy as link_energy
from sim.springs.laws import largest_stiffness, lost_share, over_step, stiffness, tension
from sim.springs.laws.stiffening import Stiffening
from sim.springs.net import Family
from sim.springs.stability import gershgorin
from sim.springs.state import acceleration, energy, velocities
from sim.springs.statics import equilibrium, hanging_chain
from tests import naive
from tests.sim.springs.analysis.test_energy import PATH, residual
from tests.sim.springs.forces.test_forces import agrees, own_power, shaken
from tests.sim.springs.nets import DAMPABLE
from tests.sim.springs.reference import exact, integrated, slope
from tests.sim.springs.test_stability import tangent_matrix

K, REST = 700.0, 0.4
STRAINS = np.array([-0.7, -0.2, -1e-3, 1e-3, 0.05, 0.3, 1.5])
KNOWN = ["spring", "slack", "stiffening"]  # laws that `tests.naive` has as well
OTHERS = KNOWN[1:]


@kernel
def set_laws(law, k, rest, lengths, found):
    """found (5, n): tension, stiffness and energy at each length, and the mean tension from each to the last, twice."""
    n = lengths.shape[0]
    for j in range(n):
        found[0, j] = tension(law, k, rest, lengths[j])
        found[1, j] = stiffness(law, k, rest, lengths[j])
        found[2, j] = link_energy(law, k, rest, lengths[j])
        s, rise = over_step(law, k, rest, lengths[j], lengths[n - 1])
        found[3, j] = s * 0.5 * (lengths[j] + lengths[n - 1])
        found[4, j] = rise


def laws_at(name, lengths):
    found = np.empty((5, len(lengths)))
    set_laws(LAWS[name].numbers, K, REST, np.ascontiguousarray(lengths), found)
    return found


@pytest.mark.parametrize("name", LAWS)
def test_the_tension_is_the_energy_s_slope_and_the_stiffness_the_tension_s(name):
    lengths, e = REST * (1.0 + STRAINS), 1e-6 * REST
    own, longer, shorter = (laws_at(name, lengths + d) for d in (0.0, e, -e))
    assert (longer[2] - shorter[2]) / (2 * e) == pytest.approx(own[0], rel=1e-8, abs=1e-6)
    assert (longer[0] - shorter[0]) / (2 * e) == pytest.approx(own[1], rel=1e-8, abs=1e-6)
    at_rest = laws_at(name, np.array([REST, REST]))
    assert at_rest[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert at_rest[2, 0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_the_mean_tension_of_a_step_does_the_work_of_the_energy(name):
    for strains in itertools.product(STRAINS, (0.2, -0.1, 1e-3 + 1e-12)):
        lengths = REST * (1.0 + np.array(strains))
        found = laws_at(name, lengths)
        gained = found[2, 1] - found[2, 0]
        assert found[3, 0] * (lengths[1] - lengths[0]) == pytest.approx(gained, rel=1e-9, abs=1e-13)
        e = 1e-5 * REST
        longer, shorter = (laws_at(name, lengths + (0.0, d)) for d in (e, -e))
        density = (longer[3, 0] / (lengths.sum() + e) - shorter[3, 0] / (lengths.sum() - e)) * 2.0 / e
        if min(abs(lengths - REST)) > 1e-2 * REST:
            assert density == pytest.approx(found[4, 0], rel=1e-5, abs=1e-3 * K)


@pytest.mark.parametrize("name", KNOWN)
def test_the_laws_are_their_formulas(name):
    net = rope(2, REST, stiffness=K, law=name)
    lengths = REST * (1.0 + STRAINS)
    expected = [naive.tension(net, net.families[0], length) for length in lengths]
    assert laws_at(name, lengths)[0] == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("strain", [0.3, 1.5])
@pytest.mark.parametrize("name", LAWS)
def test_the_largest_stiffness_is_that_of_all_lengths_within_a_strain(name, strain):
    least = max(-strain, -0.999)
    expected = laws_at(name, REST * (1.0 + np.linspace(least, strain, 401)))[1].max()
    assert largest_stiffness(LAWS[name].numbers, least, strain) * K == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("name", LAWS)
def test_a_length_has_the_tension_it_was_asked_for(name):
    tensions = np.array([1e-3, 1.0, 50.0, 1e4])
    law = LAWS[name]
    assert laws_at(name, law.length(law.numbers, K, REST, tensions))[0] == pytest.approx(tensions, rel=1e-9)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize(
    ("make", "shape", "name"), [*((rope, (9,), name) for name in OTHERS), *((cloth, (3, 4), name) for name in OTHERS)]
)
def test_forces_are_the_formulas(make, shape, name, model):
    net = make(*shape, damping_model=model, law=name)
    for seed in range(3):
        x, v = shaken(net, seed)
        agrees(net, x, v)
        agrees(net, x, 30.0 * v)  # many links that shorten so fast that their damping takes all of their tension


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", OTHERS)
def test_tangents_are_the_derivatives_of_the_forces(name, model):
    net = rope(9, damping_model=model, law=name)
    x, _ = shaken(net)
    stiff, damping = naive.tangent(net, x)
    assert tangent_matrix(net, x, STIFFNESS) == pytest.approx(stiff, rel=1e-5, abs=1e-5 * np.abs(stiff).max())
    assert tangent_matrix(net, x, DAMPING) == pytest.approx(damping, rel=1e-6, abs=1e-6 * np.abs(damping).max())


@pytest.mark.parametrize(("name", "method"), [("slack", "leapfrog"), ("stiffening", "leapfrog"), ("stiffening", "rk4")])
def test_a_short_step_books_the_powers_of_the_formulas(name, method):
    """Of links of which some are slack, whose damping comes and goes; and of a root that moves."""
    h, net = 1e-6, dataclasses.replace(rope(9, law=name), pin_paths=(((0, 0), PATH),))
    state = State(*shaken(net))
    state.v[:, 0, 0] = PATH.coefficients[1]
    state.x[:, 0, 0] = PATH.coefficients[0]
    dissipated, work = own_power(net, state.x, state.v, 0.0, h)
    before = energy(net, state)
    advance(net, state, INTEGRATORS[method], h, 1, with_account=True)
    assert state.dissipated / h == pytest.approx(dissipated, rel=3e-3)
    assert state.work / h == pytest.approx(work, rel=3e-3)
    assert (energy(net, state).total - before.total) / h == pytest.approx(work - dissipated, rel=3e-3, abs=1e-3)


@pytest.mark.parametrize("name", LAWS)
def test_a_hanging_rope_is_at_rest(name):
    net = rope(12, stiffness=60.0, law=name)
    still = hanging_chain(net)
    x = np.ascontiguousarray(still.x.T[:, None, :])
    assert rope_tension(net, x) == pytest.approx(still.tension, rel=1e-10)
    assert np.abs(acceleration(net, State(x, np.zeros_like(x)), 0.5)).max() < 1e-9


@pytest.mark.parametrize(
    ("law", "end"), [*itertools.product(LAWS, [(1.2, 0.0, 0.3), (3.0, 0.0, 0.0)]), (Stiffening(1e6), (1.2, 0.0, 0.3))]
)
def test_a_rope_between_two_pins_is_at_rest(law, end):
    net = rope(9, stiffness=150.0, end=end, law=law)
    x = np.ascontiguousarray(equilibrium(net).x.T[:, None, :])
    assert np.abs(acceleration(net, State(x, np.zeros_like(x)), 0.5)).max() < 1e-8
    assert np.linalg.norm(find_rest_positions(net) - x, axis=0).max() < 2e-8


@pytest.mark.parametrize("method", ["leapfrog", pytest.param("implicit_midpoint", marks=pytest.mark.long)])
@pytest.mark.parametrize("stretch", [0.05, 0.4])
def test_a_mass_on_a_stiffening_link_has_duffing_s_period(stretch, method):
    """4 K(m)/(omega sqrt(1 + c A^2)) with m = c A^2/2/(1 + c A^2), of DLMF 22.19(ii) and 19.2.8."""
    net = rope(2, 1.0, 1.0, 30.0, 0.0, 0.0, 0.0, law=Stiffening(20.0))
    push = 20.0 * stretch**2
    period = 4.0 * ellipk(0.5 * push / (1.0 + push)) / np.sqrt(30.0 * (1.0 + push))
    start = State.at_rest(net)
    start.x[0, 0, 1] -= stretch
    ends = []
    for steps in (500, 2000):
        state = start.copy()
        advance(net, state, method, period / steps, steps)
        ends.append(abs(state.v[0, 0, 1]) / np.sqrt(30.0) / stretch)
    assert ends[1] < 1e-3
    assert ends[1] == pytest.approx(ends[0] / 16.0, rel=0.05)


def bouncing(steps, method):
    """How far a mass on a line that only pulls is from its start after one period, part of which it flies freely."""
    net, v0 = rope(2, 2.0, 1.0, 400.0, 0.0, 0.0, 10.0, law="slack"), 4.0
    state = State.at_rest(net)
    state.x[:, 0, 1] = 0.0, 0.0, -2.0
    state.v[2, 0, 1] = v0
    period = 2.0 * v0 / 10.0 + 2.0 * (np.pi - np.arctan(v0 * 20.0 / 10.0)) / 20.0
    advance(net, state, method, period / steps, steps)
    return np.hypot(state.x[2, 0, 1] + 2.0, (state.v[2, 0, 1] - v0) / 20.0)


def on_damped_line(x, v, model="isotropic", omega=20.0, ratio=0.3):
    """1 kg on a line of 1 m without gravity, x beyond its rest length and moving outwards at v, and the net."""
    net = rope(2, 1.0, 1.0, omega**2, 2.0 * ratio * omega, 0.0, 0.0, damping_model=model, law="slack")
    state = State.at_rest(net)
    state.x[0, 0, 1], state.v[0, 0, 1] = -1.0 - x, -v
    return net, state


@pytest.mark.parametrize(
    ("method", "model"),
    [
        # half a minute of compilation for one more pair
        pytest.param(*pair, marks=pytest.mark.long if pair == ("implicit_euler", "isotropic") else ())
        for pair in itertools.product(DAMPABLE, ("isotropic", "axial"))
    ],
)
def test_a_taut_line_that_shortens_fast_neither_pulls_nor_pushes(method, model):
    """Its tension would hold 0.3 m/s back; at 2 m/s its damping takes all of it, and the mass moves uniformly."""
    net, state = on_damped_line(0.01, -2.0, model)
    advance(net, state, method, 1e-3, 100, with_account=True)
    assert state.x[:, 0, 1] == pytest.approx([-1.01 + 0.2, 0.0, 0.0], abs=1e-12)
    assert velocities(net, state)[:, 0, 1] == pytest.approx([2.0, 0.0, 0.0], abs=1e-11)
    # It takes what the line had stored.
    record = INTEGRATORS[method]
    assert state.dissipated == pytest.approx(0.5 * 400.0 * 0.01**2, rel=0.02 if record.order > 1 else 0.25)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("method", DAMPABLE)
def test_a_mass_comes_back_from_a_damped_line_at_the_closed_form_s_speed(method, model):
    """x = (u/w) exp(-g t) sin(w t) until x'' = 0, at w t = 2 acos(z): from then on the speed is u exp(-g t)."""
    omega, ratio, u = 20.0, 0.3, 3.0
    decay, turn = ratio * omega, omega * np.sqrt(1.0 - ratio**2)
    leaves, start, end = 2.0 * np.arccos(ratio) / turn, 0.02, 0.2
    still, speed = np.exp(-decay * start) * u, np.exp(-decay * leaves) * u
    x = still * np.sin(turn * start) / turn
    v = still * (np.cos(turn * start) - decay / turn * np.sin(turn * start))
    place = speed * np.sin(turn * leaves) / turn - speed * (end - leaves)
    errors = []
    for steps in (250, 1000):
        net, state = on_damped_line(x, v, model, omega, ratio)
        advance(net, state, method, (end - start) / steps, steps)
        errors.append(np.hypot(-1.0 - state.x[0, 0, 1] - place, (velocities(net, state)[0, 0, 1] - speed) / omega))
    # A quarter of the step leaves a quarter of the error at first order, a sixteenth at second.
    assert errors[1] < (3e-3 if INTEGRATORS[method].order == 1 else 2e-5)
    assert errors[1] < (0.3 if INTEGRATORS[method].order == 1 else 0.13) * errors[0] + 1e-7


@kernel
def set_lost_shares(b, acting, both, times, out):
    for j in range(times.shape[0]):
        out[j] = lost_share(b, acting, both, times[j])


def test_the_share_that_limited_damping_takes_is_the_solution_of_its_equation():
    b, pull, both, rate = 12.0, 30.0, 1.5, -9.0
    times = np.array([0.01, 0.1, 0.14, 0.15, 0.2, 1.0])
    shares = np.empty_like(times)
    set_lost_shares(b, pull / -rate, both, times, shares)
    found = solve_ivp(
        lambda t, r: both * np.minimum(pull, -b * r), (0.0, 1.0), [rate], rtol=1e-10, atol=1e-13, max_step=1e-3,
        t_eval=times,
    )  # fmt: skip
    assert (1.0 - shares * both) * rate == pytest.approx(found.y[0], rel=1e-6)
    set_lost_shares(b, b, both, times, shares)
    assert shares * both == pytest.approx(1.0 - np.exp(-b * both * times))
    for acting, sum_of_both in ((0.0, both), (b, 0.0), (2.0, 0.0)):
        set_lost_shares(b, acting, sum_of_both, times, shares)
        assert not shares.any()


@pytest.mark.parametrize("method", ["leapfrog", "implicit_midpoint"])
def test_a_mass_on_a_line_flies_free_and_bounces_at_the_closed_form_s_period(method):
    assert bouncing(4000, method) < 0.1 * bouncing(1000, method)
    assert bouncing(16_000, method) < 1e-6


@pytest.mark.parametrize("name", LAWS)
def test_the_midpoint_method_keeps_the_energy_of_any_law(name):
    net = rope(20, stiffness=1e5, damping=0.0, drag=0.0, law=name)
    run = simulate(net, duration=1.0, frames=61, step=1 / 120, integrator="implicit_midpoint")
    total = run.energy.total
    assert run.energy.kinetic.max() > 100.0
    assert np.abs(total - total[0]).max() < 1e-8
    assert run.force_evals < 120 * 25


def totals(name, step):
    """Energies [J] of 100 s of an undamped rope by leapfrog, and its largest kinetic energy."""
    run = simulate(
        rope(10, damping=0.0, drag=0.0, law=name), duration=100.0, frames=1001, step=step, integrator="leapfrog"
    )
    return run.energy.total, run.energy.kinetic.max()


def test_undamped_leapfrog_keeps_the_energy_of_a_stiffening_rope():
    total, kinetic = totals("stiffening", 5e-4)
    off = np.abs(total - total[0]).max()
    assert off < 1e-3 * kinetic
    # No drift, once the motion has spread over all modes: each quarter's mean is the last one's.
    assert abs(total[501:751].mean() - total[751:].mean()) < 0.1 * off


def test_what_leapfrog_misses_of_a_line_s_energy_where_it_goes_taut_falls_with_the_square_of_the_step():
    coarse, kinetic = totals("slack", 1e-3)
    fine, _ = totals("slack", 2.5e-4)
    off = [np.abs(total - total[0]).max() for total in (coarse, fine)]
    assert off[0] < 2e-3 * kinetic
    assert off[1] < 0.15 * off[0]


@pytest.mark.parametrize(("method", "order"), [("leapfrog", 2), ("rk4", 4), ("implicit_midpoint", 2)])
def test_steps_of_a_stiffening_rope_are_of_the_declared_order(method, order):
    net = rope(8, damping=1.0, gravity=10.0, law="stiffening")
    truth, counts = exact(net, 0.4), [200 * 2**i for i in range(4)]
    errors = [np.abs(integrated(net, method, 0.4, steps).x - truth[0]).max() for steps in counts]
    assert slope(counts, errors) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("name", OTHERS)
def test_long_implicit_steps_follow_the_motion_of_short_explicit_ones(name):
    net = rope(20, stiffness=1e4, law=name)
    truth = integrated(net, "leapfrog", 0.5, 20_000).x
    errors = [np.abs(integrated(net, "implicit_midpoint", 0.5, steps).x - truth).max() for steps in (60, 240)]
    assert errors[0] < 0.02
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize("name", OTHERS)
def test_the_ledger_closes_where_links_go_slack_and_a_root_moves(name):
    net = dataclasses.replace(rope(8, law=name), pin_paths=(((0, 0), PATH),))
    for method in ("leapfrog", "implicit_midpoint"):
        errors = [residual(net, method, 0.4, steps) for steps in (500, 4000)]
        spent = integrated(net, method, 0.4, 4000, with_account=True)
        assert errors[1] < 0.3 * errors[0]
        assert errors[1] < 1e-3 * spent.dissipated


def stretched(name, strain, points=12):
    """A rope between two pins without gravity, stretched evenly: at rest."""
    return rope(
        points, 2.0, stiffness=500.0, damping=0.0, drag=0.0, gravity=0.0, end=(2.0 + 2.0 * strain, 0.0, 0.0), law=name
    )


@pytest.mark.parametrize("strain", [0.01, 0.2])
@pytest.mark.parametrize("name", KNOWN)
def test_a_stretched_rope_holds_to_its_critical_step_and_no_further(name, strain):
    """Its stiffest mode is the longitudinal sawtooth, at the stiffness of the stretched links."""
    net, record = stretched(name, strain), INTEGRATORS["leapfrog"]
    step = critical_step(net, record)
    stiff = 500.0 * (1.0 + 300.0 * strain**2 if name == "stiffening" else 1.0)
    assert step == pytest.approx(1.0 / np.sqrt(stiff) / np.sin(0.5 * np.pi * 10 / 11), rel=1e-3)
    assert outcome(record, net, 0.99 * step, net.x0) == STABLE
    assert outcome(record, net, 1.01 * step, net.x0) != STABLE
    assert gershgorin(net)[0] >= 2.0 / step * (1.0 - 1e-9)


def test_a_slack_rope_counts_as_about_to_be_taut():
    """In a kink each way its links have no tension; the next pull makes them springs."""
    slack, taut = stretched("slack", -0.1), stretched("slack", 1e-6)
    assert critical_step(slack, "leapfrog") == pytest.approx(critical_step(taut, "leapfrog"), rel=1e-3)


def test_one_stretched_link_counts_for_all():
    """A wave carries its strain to the others: they are as stiff then."""
    net = stretched("stiffening", 0.01)
    x = net.x0.copy()
    x[0, 0, 1:-1] += 0.05
    _, longest = strain_range(net, x)
    assert critical_step(net, "leapfrog", State(x, np.zeros_like(x))) == pytest.approx(
        critical_step(stretched("stiffening", longest), "leapfrog"), rel=1e-3
    )


@pytest.mark.parametrize(
    ("bad", "said"), [("elastic", "law"), (None, "law"), (1.0, "law"), (Stiffening(-1.0), "law.cubic")]
)
def test_an_unknown_law_is_refused(bad, said):
    with pytest.raises(ValueError, match=said):
        rope(law=bad)
    with pytest.raises(ValueError, match=said):
        dataclasses.replace(rope(), law=bad)


def test_a_law_of_strain_asks_for_a_rest_length():
    with pytest.raises(ValueError, match="families rest"):
        dataclasses.replace(rope(law="stiffening"), families=(Family(0, 1, 0.0, 1.0, 0.0),))
