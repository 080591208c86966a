"""Adaptive methods, and the methods that refuse what they cannot do."""

import dataclasses
import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate._ivp import dop853_coefficients
from scipy.integrate._ivp.rk import RK45

from sim.springs import INTEGRATORS, Air, cloth, rope, simulate
from sim.springs.analysis.amplification import polynomial_of
from sim.springs.integrators import dop853, dopri5, rkn8
from sim.springs.integrators.embedded import stages
from sim.springs.integrators.embedded.errors import error_of
from sim.springs.integrators.embedded.march import first_step
from sim.springs.integrators.embedded.stages import is_smooth_net
from sim.springs.points.acceleration import set_acceleration
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, energy
from tests.sim.springs.reference import integrated

ADAPTIVE = [name for name, record in INTEGRATORS.items() if record.adaptive]


def test_the_coefficients_are_those_of_an_independent_source():
    def lower(rows):
        return np.array([[*row, *(0.0,) * (len(rows) - len(row))] for row in rows])

    assert lower(dopri5.A)[:, :5] == pytest.approx(RK45.A, abs=1e-15)
    assert np.array(dopri5.B) == pytest.approx(RK45.B, abs=1e-15)
    assert np.sign(dopri5.E[0] * RK45.E[0]) * np.array(dopri5.E) == pytest.approx(RK45.E, abs=1e-15)
    assert lower(dop853.A) == pytest.approx(dop853_coefficients.A[:12, :12], abs=1e-15)
    assert np.array(dop853.B) == pytest.approx(dop853_coefficients.B, abs=1e-15)
    assert np.array(dop853.E5) == pytest.approx(dop853_coefficients.E5[:12], abs=1e-15)
    assert np.array(dop853.E3) == pytest.approx(dop853_coefficients.E3[:12], abs=1e-15)


@pytest.mark.parametrize(("module", "order"), [(dopri5, 5), (dop853, 8)])
def test_the_stability_polynomial_is_the_exponential_s_to_the_order(module, order):
    exact = np.cumprod([1.0, *(1.0 / i for i in range(1, order + 1))])
    assert polynomial_of(module.A, module.B)[: order + 1] == pytest.approx(exact, rel=1e-12)


def test_rkn8_solves_the_order_conditions_of_nystroem_methods():
    """Those of order 8 for x'' = g(x), of order 6 for its estimate, and those that take damping in (exact sums)."""
    c, b, b_v, e, e_v = ([Fraction(w) for w in row] for row in (rkn8.C, rkn8.B, rkn8.B_V, rkn8.E, rkn8.E_V))
    positions, velocities = (
        [[Fraction(w) for w in (*row, *(0.0,) * (8 - len(row)))] for row in rows] for rows in (rkn8.A, rkn8.V)
    )
    powers = [[t**q for t in c] for q in range(9)]
    ones = powers[0]

    def total(*factors):
        """sum_i of the product of vectors."""
        return sum(math.prod(terms) for terms in zip(*factors, strict=True))

    def times(rows, vector):
        return [total(row, vector) for row in rows]

    def is_close(found, wanted):
        assert abs(float(found - Fraction(wanted))) < 1e-15

    for w, w_v, order in ((b, b_v, 8), ([p - q for p, q in zip(b, e, strict=False)], None, 6)):
        for q in range(order - 1):
            is_close(total(w, powers[q]), Fraction(1, (q + 1) * (q + 2)))
        if w_v is not None:
            for q in range(order):
                is_close(total(w_v, powers[q]), Fraction(1, q + 1))
    for q in range(6):
        is_close(total(e_v[:8], powers[q]) + e_v[8], 0)
    assert abs(total(e_v[:8], powers[6]) + e_v[8]) > 1e-4
    for p in range(6):
        for q in range(6 - p):
            chain = total(b_v, powers[p], times(positions, powers[q]))
            is_close(chain, Fraction(1, (q + 1) * (q + 2) * (p + q + 3)))
    for p, q in itertools.product(range(3), range(2)):  # a chain of two
        inner = times(positions, times(positions, powers[q]))
        is_close(total(b_v, powers[p], inner), Fraction(1, math.prod(range(q + 1, q + 5)) * (p + q + 5)))

    second = [row[1] for row in velocities]
    for i in range(8):
        is_close(total(velocities[i], ones), c[i])
        if i != 1:
            is_close(total(velocities[i], c), c[i] ** 2 / 2)
        is_close(total(b_v, [row[i] for row in velocities]), b_v[i] * (1 - c[i]))
    for p in range(5):
        for q in range(5 - p):
            chain = total(b_v, powers[p], times(velocities, powers[q]))
            is_close(chain, Fraction(1, (q + 1) * (p + q + 2)))
    for p, q in ((0, 2), (0, 3), (1, 2)):
        is_close(total(e_v[:8], powers[p], times(velocities, powers[q])) + e_v[8] * total(b_v, powers[q]), 0)
    is_close(total(b_v, c, second), 0)
    is_close(total(e_v[:8], second), 0)


@pytest.mark.parametrize("name", ADAPTIVE)
def test_the_error_follows_the_tolerance(name):
    net = rope(10)
    fine = integrated(net, "dop853", 2.0, 2000)
    evals, errors = [], []
    for rtol in (1e-4, 1e-6, 1e-8, 1e-10):
        run = simulate(net, duration=2.0, frames=2, integrator=name, rtol=rtol, atol=1e-3 * rtol)
        errors.append(np.abs(run.x[-1].T - fine.x[:, 0]).max())
        evals.append(run.force_evals)
        assert errors[-1] < 10.0 * rtol
    assert errors == sorted(errors, reverse=True)
    assert evals == sorted(evals)


@pytest.mark.parametrize("name", ADAPTIVE)
def test_frames_are_as_good_between_steps_as_at_their_ends(name):
    net = rope(6)
    run = simulate(net, duration=1.0, frames=333, integrator=name, rtol=1e-8, atol=1e-10)
    truth = simulate(net, duration=1.0, frames=333, step=1e-4, integrator="dop853")
    assert np.abs(run.x - truth.x).max() < 1e-7
    assert np.abs(run.v - truth.v).max() < 1e-6


@pytest.mark.parametrize("points", [7, 200, 385])
def test_a_bare_rope_s_blocks_change_nothing(points):
    """Against the same step stage by stage, for one block, for two, and for five with a shorter last one."""
    net, stiffness, h = rope(points, length=0.1 * points, stiffness=2e4), 2e4, 1e-3
    p, x = net.kernel_view(1.0), net.x0.ravel() + 1e-3 * np.random.default_rng(0).standard_normal(net.x0.size)
    v, start, found = 0.1 * np.sin(np.arange(x.size)), np.zeros(x.size), []
    set_acceleration(x, v, 0.0, p, start)
    for whole in (False, True):
        room = stages.make_stages(dop853.METHOD, x, p)
        room.k[: x.size] = start
        xn, vn = np.zeros(x.size), np.zeros(x.size)
        if whole:
            stages.step_any(dop853.METHOD, x, v, 0.0, h, p, room, xn, vn, np.zeros(2), False)
        else:
            stages.step_bare_rope(dop853.METHOD, x, v, h, p, room, xn, vn)
        error = error_of(dop853.METHOD, x, v, h, room, xn, vn, 1e-6, 1e-9)
        found.append((xn, vn, room.k[12 * room.stride :][: x.size], error))
    # Round-off of a length is that of the places, and the stiffest link of 1 kg makes an acceleration of it.
    length = np.spacing(np.abs(x).max())
    for part, whole, unit in zip(*found, (1.0, h * stiffness, stiffness, 1e6 * h**2 * stiffness), strict=True):
        assert part == pytest.approx(whole, rel=0.0, abs=10.0 * length * unit)


@pytest.mark.parametrize("module", [dopri5, dop853, rkn8], ids=lambda module: module.__name__.rpartition(".")[2])
def test_the_estimated_error_is_the_weighted_root_mean_square_of_the_tableau_s_rows(module):
    method, size, h, rtol, atol = module.METHOD, 15, 1e-2, 1e-3, 1e-4
    random = np.random.default_rng(1)
    x, v, xn, vn = random.standard_normal((4, size))
    room = stages.make_stages(method, x, rope(5).kernel_view(1.0))
    k = room.k.reshape(method.stages + 1, room.stride)
    k[:, :size] = random.standard_normal((method.stages + 1, size))
    sums = []
    for row in range(method.stages + 1, len(method.counts)):
        terms = method.terms[row]
        ex, ev = h**2 * method.g[row] @ k[terms, :size], h * method.a[row] @ k[terms, :size]
        parts = (ex / (atol + rtol * np.maximum(abs(x), abs(xn))), ev / (atol + rtol * np.maximum(abs(v), abs(vn))))
        sums.append(np.mean(np.square(parts)))
    wanted = math.sqrt(sums[0]) if len(sums) == 1 else sums[0] / math.sqrt(sums[0] + 0.01 * sums[1])
    assert error_of(method, x, v, h, room, xn, vn, rtol, atol) == pytest.approx(wanted, rel=1e-13)


@pytest.mark.parametrize(("name", "rtol"), [("dopri5", 1e-4), ("dop853", 1e-4), ("rkn8", 1e-6)])
def test_steps_that_are_undone_leave_no_trace(name, rtol):
    """Of this stiff rope some steps without an estimate are followed by one that breaks the tolerance."""
    net = rope(129, 1.0, 1 / 129, 125568.0, 0.256, 0.2 / 129)
    run = simulate(net, duration=1.0, frames=3, integrator=name, rtol=rtol, atol=0.01 * rtol, with_account=True)
    truth = simulate(net, duration=1.0, frames=3, integrator=name, rtol=1e-9, atol=1e-11)
    assert np.abs(run.x - truth.x).max() < 5e-3 * rtol
    total = run.energy.total + run.energy.dissipated - run.energy.work
    assert np.abs(total - total[0]).max() < 2.0 * rtol


@pytest.mark.parametrize("name", ADAPTIVE)
def test_steps_are_as_long_as_stability_allows_and_few_are_taken_in_vain(name):
    net = rope(40, stiffness=2e5)
    x, v = net.x0.ravel().copy(), np.zeros(net.x0.size)
    march = INTEGRATORS[name].march
    assert march is not None
    kept, times = np.zeros((2, x.size)), np.array([0.0, 1.0])
    evals, steps, _, _ = march(
        x, v, times, 1e-3, 1e-5, net.kernel_view(1.0), False, kept, kept.copy(), np.zeros((2, 2))
    )
    assert 0.9 < steps * critical_step(net, name) < 1.2
    assert evals - 1 <= 1.05 * steps * INTEGRATORS[name].evals


def test_dense_output_costs_nothing():
    few, many = (simulate(rope(6), duration=1.0, frames=frames, integrator="dopri5", rtol=1e-6) for frames in (2, 1001))
    assert few.force_evals == many.force_evals


@pytest.mark.parametrize("name", ADAPTIVE)
def test_the_ledger_closes_within_the_tolerance(name):
    run = simulate(rope(8), duration=1.0, frames=11, integrator=name, rtol=1e-9, atol=1e-12, with_account=True)
    balance = run.energy.total + run.energy.dissipated - run.energy.work
    assert np.abs(balance - balance[0]).max() < 1e-5


def test_pefrl_refuses_damping():
    for net in (rope(), rope(damping=0.0), rope(damping=0.0, drag=0.0, floor=-1.0)):
        with pytest.raises(ValueError, match=r"^integrator: 'pefrl' is not allowed; .* damped"):
            simulate(net, integrator="pefrl")
        with pytest.raises(ValueError, match="damped"):
            advance(net, State.at_rest(net), INTEGRATORS["pefrl"], 1e-3, 1)


def test_pefrl_keeps_its_energy_far_better_than_leapfrog_at_the_same_cost():
    net = rope(2, length=1e3, stiffness=1.0, damping=0.0, drag=0.0, gravity=0.0)
    swings = []
    for name, z in (("leapfrog", 0.1), ("pefrl", 0.4)):
        state = State.at_rest(net)
        state.x[0, 0, 1] -= 0.4
        total = []
        for _ in range(2000):
            advance(net, state, INTEGRATORS[name], z, 1)
            total.append(energy(net, state).total)
        swings.append(np.ptp(total))
    assert swings[1] < 0.05 * swings[0]


def test_the_first_step_is_a_hundredth_of_the_time_of_a_change():
    """In units of the tolerance of each number."""
    x, v, a = np.array([1.0, -2.0, 0.0]), np.array([0.5, 0.0, 3.0]), np.array([-4.0, 8.0, 1.0])
    wx, wv = 1.0 / (1e-3 + 1e-2 * np.abs(x)), 1.0 / (1e-3 + 1e-2 * np.abs(v))
    size, change = ((wx * x) ** 2 + (wv * v) ** 2).sum(), ((wx * v) ** 2 + (wv * a) ** 2).sum()
    assert first_step(x, v, a, 1e-2, 1e-3) == pytest.approx(0.01 * np.sqrt(size / change))
    assert first_step(x, 0.0 * x, 0.0 * x, 1e-2, 1e-3) == 1e-6


def test_a_net_is_rough_where_it_can_touch_something():
    net = rope(5, gravity=10.0)
    assert is_smooth_net(net.kernel_view(1.0))
    assert is_smooth_net(cloth(4, 4, air=Air((3.0, 0.0, 0.0))).kernel_view(1.0))
    assert not is_smooth_net(dataclasses.replace(net, floor=0.0).kernel_view(1.0))
    assert not is_smooth_net(dataclasses.replace(net, sphere=(0.0, 0.0, 0.0, 0.5)).kernel_view(1.0))
