import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, Grab, rope
from sim.springs.integrators.implicit.tangent import DAMPING, STIFFNESS, set_tangent
from sim.springs.stability import critical_step, critical_stiffness, gauge, gershgorin, top_modes
from sim.springs.state import State, advance
from tests.naive import tangent
from tests.sim.springs.nets import DAMPABLE, patch, touching_patch

ZETAS = (0.0, 0.01, 0.05, 0.1, 0.25, 0.5, 0.707, 1.0, 2.0)
LIMITS = {  # largest stable h omega at each zeta
    "explicit_euler": (0, 0.02, 0.1, 0.2, 0.5, 1, 1.414, 2, 0.536),
    "symplectic_euler": (2, 1.980, 1.902, 1.810, 1.562, 1.236, 1.035, 0.828, 0.472),
    "leapfrog_lagged": (2, 1.980, 1.902, 1.810, 1.562, 1.236, 1.035, 0.828, 0.472),
    "leapfrog": (2,) * 9,
    "rk4": (2.82843, 2.849, 2.910, 2.951, 2.897, 2.623, 2.704, 2.785, 0.746),
}
CASES = [(name, zeta, limit) for name, limits in LIMITS.items() for zeta, limit in zip(ZETAS, limits, strict=True)]
STIFFEST = {  # largest stable link stiffness of the lab's rope: points, step, damping, drag
    (10, 1 / 60, 7.0, 1.0): {"explicit_euler": 435, "symplectic_euler": 2829, "leapfrog": 3700, "rk4": 7989},
    (10, 1 / 60, 0.0, 1.0): {"explicit_euler": 15, "symplectic_euler": 3669, "leapfrog": 3700, "rk4": 7433},
    (50, 1 / 120, 7.0, 0.5): {"explicit_euler": 855, "symplectic_euler": 12704, "leapfrog": 14415, "rk4": 30272},
    (50, 1 / 120, 0.0, 0.5): {"explicit_euler": 15, "symplectic_euler": 14384, "leapfrog": 14415, "rk4": 28861},
}


def products(net, x, part, t=0.0):
    """The matrix that `set_tangent` multiplies with."""
    p = net.kernel_view(1.0)
    matrix = np.zeros((x.size, x.size))
    for j in range(x.size):
        unit, out = np.zeros(x.size), np.empty(x.size)
        unit[j] = 1.0 if p.inverse_masses[j % p.inverse_masses.size] else 0.0
        set_tangent(x.reshape(-1), unit, t, p, part, out)
        matrix[:, j] = out
    return matrix


def swung(net, seconds, name="rk4"):
    """The net after it has swung for a while."""
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], 1e-4, round(seconds / 1e-4))
    return state


@pytest.mark.parametrize("law", ["clipped", "lab"])
@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_tangent_products_are_the_derivatives_of_the_forces(model, law):
    # At rest the derivative of the clipped law's normal force is that of its spring and dashpot.
    net = dataclasses.replace(touching_patch(model, Contact(900.0, 6.0, 0.0, law)), sphere_velocity=(0.0, 0.0, 0.0))
    stiffness, damping = tangent(net, net.x0)
    assert np.abs(products(net, net.x0, STIFFNESS) - stiffness).max() < 1e-8 * np.abs(stiffness).max()
    assert np.abs(products(net, net.x0, DAMPING) - damping).max() < 1e-8 * np.abs(damping).max()


def test_a_capped_grab_is_stiff_across_only():
    grab = Grab(0, 2, (1.0, 2.0, 3.0), 500.0, 3.0, 10.0)
    net = dataclasses.replace(rope(3), grab=grab)
    stiffness, _ = tangent(net, net.x0)
    assert np.abs(products(net, net.x0, STIFFNESS) - stiffness).max() < 1e-7 * np.abs(stiffness).max()


@pytest.mark.parametrize("amplitude", [0.0, 0.3, 1.0, 5.0])
@pytest.mark.parametrize("points", [2, 3, 5, 10, 50, 200])
def test_the_stiffest_mode_is_found_within_a_thousandth(points, amplitude):
    net = rope(points)
    shape = np.random.default_rng(points).standard_normal(net.x0.shape)
    x = net.x0 + amplitude * np.cumsum(shape, axis=2) * 2.0 / points
    largest = np.linalg.eigvalsh(products(net, x, STIFFNESS))[-1]
    assert top_modes(net, x)[0].omega == pytest.approx(math.sqrt(largest), rel=1e-3)


def test_the_stiffest_mode_of_a_thousand_points_is_the_fixed_free_chain_s():
    # omega = 2 sqrt(k/m) sin((2n - 1) pi / (2 (2n + 1))) of n moving points
    top = 2.0 * math.sqrt(800.0) * math.sin(1997 * math.pi / (2 * 1999))
    assert top_modes(rope(1000))[0].omega == pytest.approx(top, rel=1e-4)


@pytest.mark.parametrize("contact", [Contact(800.0, 5.0), Contact(20_000.0, 50.0), Contact(100.0, 200.0, 0.0, "lab")])
@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_extreme_eigenvalues_match_dense_ones_in_contact(model, contact):
    net = touching_patch(model, contact)
    stiffest, most_damped, *_ = top_modes(net)
    largest = np.linalg.eigvalsh(products(net, net.x0, STIFFNESS))[-1]
    assert stiffest.omega == pytest.approx(math.sqrt(largest), rel=1e-3)
    assert most_damped.rate == pytest.approx(np.linalg.eigvalsh(products(net, net.x0, DAMPING))[-1], rel=2e-3)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_gershgorin_bounds_every_state(model):
    for net in (rope(200, damping_model=model), patch(model), touching_patch(model, Contact(5000.0, 30.0, 0.0, "lab"))):
        stiffest, most_damped, *_ = top_modes(net)
        omega, rate = gershgorin(net)
        assert stiffest.omega <= omega
        assert most_damped.rate <= rate
    assert gershgorin(rope(200))[0] == pytest.approx(top_modes(rope(200))[0].omega, rel=1e-3)


@pytest.mark.parametrize(("case", "name"), [(case, name) for case in STIFFEST for name in STIFFEST[case]])
def test_the_largest_stable_stiffness_is_the_lab_s_table(case, name):
    points, h, damping, drag = case
    found = critical_stiffness(rope(points, damping=damping, drag=drag), name, h)
    assert round(found) == STIFFEST[case][name]


def test_stability_of_the_hanging_chain_is_that_of_the_straight_one():
    # With the lab's damping the top mode is along the rope, whatever its tension.
    net = rope(10)
    hanging = State.at_rest(net)
    link = np.arange(1, 10)
    hanging.x[:, 0, 1:] = 0.0
    hanging.x[2, 0, 1:] = -np.cumsum(2.0 / 9 + 10.0 * (10 - link) / 800.0)
    for name, stiffness in STIFFEST[(10, 1 / 60, 7.0, 1.0)].items():
        assert round(critical_stiffness(net, name, 1 / 60, hanging)) == stiffness


def test_the_gauge_reads_the_lab_s_default():
    net = rope()
    found = gauge(net, "symplectic_euler", 1 / 60, State.at_rest(net))
    assert found.h_omega == pytest.approx(0.930, abs=5e-4)
    assert found.zeta == pytest.approx(0.253, abs=5e-4)
    assert found.limit == pytest.approx(2.0 * (math.sqrt(1.0 + found.zeta**2) - found.zeta), rel=1e-12)
    assert found.critical_step == pytest.approx(critical_step(net, "symplectic_euler"), rel=1e-12)
    scene = gauge(rope(50, drag=0.5), "symplectic_euler", 1 / 120, State.at_rest(rope(50)))
    assert scene.h_omega == pytest.approx(0.471, abs=5e-4)


def growth(name, zeta, z):
    """How many times as far an oscillator of frequency 1 and damping ratio zeta is after many steps of z.

    The oscillator is the stretch of a rope of two points, one of them pinned, without gravity.
    """
    net = rope(2, 1.0, 1.0, 1.0, 2.0 * zeta, 0.0, 0.0)
    state = State.at_rest(net)
    state.x[0, 0, 1] -= 1e-6
    state.v[0, 0, 1] = 1e-6
    # One per cent beyond its limit explicit Euler grows by exp(0.005 z^2) a step.
    advance(net, state, INTEGRATORS[name], z, max(6000, round(1600.0 / z**2)))
    return float(np.hypot(state.x[0, 0, 1] + 1.0, state.v[0, 0, 1])) / 1e-6


@pytest.mark.parametrize(("name", "zeta", "limit"), CASES)
def test_declared_limits_are_the_table_s(name, zeta, limit):
    assert INTEGRATORS[name].limit(zeta) == pytest.approx(limit, rel=1e-2, abs=1e-12)


@pytest.mark.parametrize(("name", "zeta"), [(name, zeta) for name, zeta, _ in CASES])
def test_integrators_hold_just_below_their_limit_and_fail_just_above(name, zeta):
    limit = INTEGRATORS[name].limit(zeta)
    if limit > 0.0:
        assert growth(name, zeta, 0.99 * limit) < 100.0
    # The split damping of the leapfrog outlives its limit where it is overdamped: 2 is what is promised.
    if name != "leapfrog" or zeta < 0.3:
        assert not growth(name, zeta, 1.01 * limit if limit else 0.05) < 1000.0


@pytest.mark.parametrize("name", DAMPABLE)
@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_a_swinging_rope_holds_at_nine_tenths_of_its_critical_step(name, model):
    net = rope(8, drag=4.0, damping_model=model)
    state = swung(net, 0.5)
    h = critical_step(net, name, state)
    assert h > 0.0
    still = swung(net, 12.0)
    h = 0.9 * min(h, critical_step(net, name, still), 0.1)
    advance(net, still, INTEGRATORS[name], h, 3000)
    assert np.abs(still.v).max() < 1.0


def test_explicit_euler_without_damping_is_never_stable():
    assert critical_step(rope(damping=0.0, drag=0.0), "explicit_euler") == 0.0
    assert critical_stiffness(rope(damping=0.0, drag=0.0), "explicit_euler", 0.01) == 0.0


def test_nothing_that_moves_allows_every_step():
    assert critical_step(rope(1), "rk4") == math.inf
    assert critical_step(rope(2, stiffness=0.0, damping=0.0, drag=0.0), "rk4") == math.inf
    assert gauge(rope(1), "rk4", 0.01, State.at_rest(rope(1))).h_omega == 0.0


def test_contact_lowers_the_critical_step():
    net = rope(10, floor=0.1, contact=Contact(80_000.0, 5.0))
    assert critical_step(net, "leapfrog") < 0.5 * critical_step(rope(10), "leapfrog")
    assert critical_step(net, "leapfrog") == pytest.approx(2.0 / top_modes(net)[0].omega, rel=1e-6)


def test_a_stiffness_beside_a_contact_is_the_one_that_reaches_the_step():
    net = rope(10, floor=0.1, contact=Contact(3000.0, 5.0))
    stiffness = critical_stiffness(net, "leapfrog", 1 / 60)
    at = rope(10, floor=0.1, contact=Contact(3000.0, 5.0), stiffness=stiffness)
    assert critical_step(at, "leapfrog") == pytest.approx(1 / 60, rel=1e-3)


@pytest.mark.parametrize(
    "function", [lambda: critical_step(rope(), "rk5"), lambda: critical_stiffness(rope(), "", 0.1)]
)
def test_an_unknown_integrator_is_refused_with_the_known_ones(function):
    with pytest.raises(ValueError, match=r"integrator: .*leapfrog"):
        function()


@pytest.mark.parametrize("h", [0.0, -1.0, math.nan, math.inf, True])
def test_a_step_that_is_none_is_refused(h):
    with pytest.raises(ValueError, match="h: "):
        critical_stiffness(rope(), "rk4", h)
