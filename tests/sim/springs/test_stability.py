import dataclasses
import math
from collections import Counter

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, Grab, cloth, rope, simulate
from sim.springs.analysis.amplification import eigenvalues, limit_of_polynomial
from sim.springs.forces.matrices import DAMPING, STIFFNESS
from sim.springs.integrators import dop853, dopri5
from sim.springs.integrators.implicit.tangent import products
from sim.springs.stability import (
    Mode,
    critical_step,
    critical_stiffness,
    gauge,
    gershgorin,
    most_touching,
    step_limit,
    top_modes,
)
from sim.springs.state import State, advance
from tests.naive import own_contacts, tangent
from tests.sim.springs.nets import DAMPABLE, draped, patch, spread, touching_patch

ZETAS = (0.0, 0.01, 0.05, 0.1, 0.25, 0.5, 0.707, 1.0, 2.0)
LIMITS = {  # largest stable h omega at each zeta; None: beyond it a method grows too slowly to be seen
    "explicit_euler": (0, 0.02, 0.1, 0.2, 0.5, 1, 1.414, 2, 0.536),
    "symplectic_euler": (2, 1.980, 1.902, 1.810, 1.562, 1.236, 1.035, 0.828, 0.472),
    "leapfrog_lagged": (2, 1.980, 1.902, 1.810, 1.562, 1.236, 1.035, 0.828, 0.472),
    "leapfrog": (2,) * 9,
    "rk4": (2.82843, 2.849, 2.910, 2.951, 2.897, 2.623, 2.704, 2.785, 0.746),
    "rkn8": (None, 4.782, 5.532, 5.479, 5.849, 3.779, 3.279, 2.662, 1.329),
}
CASES = [
    (name, zeta, limit)
    for name, limits in LIMITS.items()
    for zeta, limit in zip(ZETAS, limits, strict=True)
    if limit is not None
]
STIFFEST = {  # largest stable link stiffness of the lab's rope: points, step, damping, drag
    (10, 1 / 60, 7.0, 1.0): {"explicit_euler": 435, "symplectic_euler": 2829, "leapfrog": 3700, "rk4": 7989},
    (10, 1 / 60, 0.0, 1.0): {"explicit_euler": 15, "symplectic_euler": 3669, "leapfrog": 3700, "rk4": 7433},
    (50, 1 / 120, 7.0, 0.5): {"explicit_euler": 855, "symplectic_euler": 12704, "leapfrog": 14415, "rk4": 30272},
    (50, 1 / 120, 0.0, 0.5): {"explicit_euler": 15, "symplectic_euler": 14384, "leapfrog": 14415, "rk4": 28861},
}


def tangent_matrix(net, x, part, t=0.0):
    """The matrix that `products` multiplies with."""
    return products(x.reshape(-1), np.eye(x.size), t, net.kernel_view(1.0), part).T


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
    assert np.abs(tangent_matrix(net, net.x0, STIFFNESS) - stiffness).max() < 1e-8 * np.abs(stiffness).max()
    assert np.abs(tangent_matrix(net, net.x0, DAMPING) - damping).max() < 1e-8 * np.abs(damping).max()


@pytest.mark.parametrize("make", [draped, spread])
@pytest.mark.parametrize("seed", range(3))
def test_tangent_products_of_links_and_faces_on_a_sphere_are_the_derivatives_of_the_forces(make, seed):
    """With the change of the place that touches, in the middle of links and faces and at common points."""
    net = make(Contact(900.0, 6.0), sphere_velocity=(0.0, 0.0, 0.0))
    x = net.x0 + (0.03 * np.random.default_rng(seed).standard_normal(net.x0.shape) if seed else 0.0)
    stiffness, damping = tangent(net, x)
    assert np.abs(tangent_matrix(net, x, STIFFNESS) - stiffness).max() < 1e-8 * np.abs(stiffness).max()
    assert np.abs(tangent_matrix(net, x, DAMPING) - damping).max() < 1e-8 * np.abs(damping).max()


def test_links_without_rest_length_are_as_stiff_where_their_points_meet():
    net = rope(3, damping=0.0, drag=0.0)
    net = dataclasses.replace(net, families=(net.families[0]._replace(rest=0.0),))
    k = net.families[0].stiffness / net.mass
    chain = k * np.array([[0.0, 0.0, 0.0], [0.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    np.testing.assert_allclose(
        tangent_matrix(net, np.zeros_like(net.x0), STIFFNESS), np.kron(np.eye(3), chain), atol=1e-9 * k
    )


def test_a_capped_grab_is_stiff_across_only():
    grab = Grab(0, 2, (1.0, 2.0, 3.0), 500.0, 3.0, 10.0)
    net = dataclasses.replace(rope(3), grab=grab)
    stiffness, _ = tangent(net, net.x0)
    assert np.abs(tangent_matrix(net, net.x0, STIFFNESS) - stiffness).max() < 1e-7 * np.abs(stiffness).max()


@pytest.mark.parametrize("amplitude", [0.0, 0.3, 1.0, 5.0])
@pytest.mark.parametrize("points", [2, 3, 5, 10, 50, 200])
def test_the_stiffest_mode_is_found_within_a_thousandth(points, amplitude):
    net = rope(points)
    shape = np.random.default_rng(points).standard_normal(net.x0.shape)
    x = net.x0 + amplitude * np.cumsum(shape, axis=2) * 2.0 / points
    largest = np.linalg.eigvalsh(tangent_matrix(net, x, STIFFNESS))[-1]
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
    largest = np.linalg.eigvalsh(tangent_matrix(net, net.x0, STIFFNESS))[-1]
    assert stiffest.omega == pytest.approx(math.sqrt(largest), rel=1e-3)
    assert most_damped.rate == pytest.approx(np.linalg.eigvalsh(tangent_matrix(net, net.x0, DAMPING))[-1], rel=2e-3)


@pytest.mark.parametrize("damping", [0.3, 1.0, 2.0, 3.0, 5.0, 10.0])
def test_the_limit_of_a_cloth_is_that_of_all_its_modes_where_stiffness_and_damping_have_different_ones(damping):
    net = cloth(3, 4, damping=damping)
    state = State.at_rest(net)
    state.x[:] *= 1.02
    k, d = (tangent_matrix(net, state.x, part) for part in (STIFFNESS, DAMPING))
    eigenvalues = np.linalg.eigvals(np.block([[np.zeros_like(k), np.eye(len(k))], [-k, -d]]))
    for name in ("rk4", "dopri5", "dop853"):
        # A real eigenvalue is the fast one of an oscillator without stiffness.
        exact = min(
            INTEGRATORS[name].stable_step(*((abs(s), -2.0 * s.real) if abs(s.imag) > 1e-6 else (0.0, -s.real)))
            for s in eigenvalues
            if s.real < -1e-6
        )
        assert critical_step(net, name, state) == pytest.approx(exact, rel=0.01)
    h = 1.0
    for _ in range(60):  # symplectic Euler: h^2 K + 2 h D reaches 4
        h = 2.0 / math.sqrt(np.linalg.eigvalsh(k + 2.0 / h * d)[-1])
    assert critical_step(net, "symplectic_euler", state) == pytest.approx(h, rel=0.01)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_gershgorin_bounds_every_state(model):
    for net in (rope(200, damping_model=model), patch(model), touching_patch(model, Contact(5000.0, 30.0, 0.0, "lab"))):
        stiffest, most_damped, *_ = top_modes(net)
        omega, rate = gershgorin(net)
        assert stiffest.omega <= omega
        assert most_damped.rate <= rate
    for seed in range(5):  # other states of the same nets
        x = patch(model).x0 + 0.1 * np.random.default_rng(seed).standard_normal((3, 3, 4))
        stiffest, most_damped, *_ = top_modes(patch(model), x)
        omega, rate = gershgorin(patch(model))
        assert stiffest.omega <= omega
        assert most_damped.rate <= rate
    assert gershgorin(rope(200))[0] == pytest.approx(top_modes(rope(200))[0].omega, rel=1e-3)


def test_gershgorin_counts_both_links_of_a_point_that_pokes_into_a_sphere():
    net = rope(3, 0.4, drag=0.0, sphere=(-0.2, 0.0, -0.49, 0.5), contact=Contact(1e5, 900.0), damping_model="axial")
    x = net.x0.copy()
    x[2, 0, 1] = -0.1
    stiffest, most_damped, *_ = top_modes(net, x)
    omega, rate = gershgorin(net, x)
    assert 0.95 * omega < stiffest.omega <= omega
    assert 0.95 * rate < most_damped.rate <= rate


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


@pytest.mark.parametrize("zeta", [0.0, 0.3, 0.999, 1.0, 5.0])
@pytest.mark.parametrize("coefficients", [(1.0, 1.0, 1 / 2, 1 / 6, 1 / 24), dopri5.POLYNOMIAL, dop853.POLYNOMIAL])
def test_limits_of_runge_kutta_methods_are_where_their_growth_leaves_1(coefficients, zeta):
    limit, both = limit_of_polynomial(coefficients, zeta), np.array(eigenvalues(zeta))

    def growth(z):
        return np.abs(np.polynomial.polynomial.polyval(z * both, coefficients)).max()

    assert max(map(growth, np.linspace(1e-3, limit - 1e-8, 2000))) <= 1.0 + 2e-9
    assert growth(limit + 2e-8) > 1.0 + 1e-9


def test_the_search_for_a_stiffness_asks_for_few_limits():
    asked = []
    rk4 = INTEGRATORS["rk4"]
    record = rk4._replace(stable_step=lambda *mode: asked.append(mode) or rk4.stable_step(*mode))
    net = rope(points=30, stiffness=8000.0, mass=0.3, damping=1.0, drag=0.1)
    modes = top_modes(net)
    found = critical_stiffness(net, record, 1 / 480, modes=modes)
    assert critical_step(net.with_stiffness(found), "rk4") == pytest.approx(1 / 480, rel=1e-6)
    assert len(asked) <= 14 * len(modes)


@pytest.mark.parametrize(("name", "limit"), [("pefrl", 2.989), ("dopri5", 0.9972), ("dop853", 5.960), ("rkn8", 3.2937)])
def test_undamped_limits_of_the_methods_of_high_order(name, limit):
    assert INTEGRATORS[name].limit(0.0) == pytest.approx(limit, rel=1e-3)
    assert growth(name, 0.0, 0.99 * limit) < 100.0
    if name not in ("dopri5", "rkn8"):  # which grow by 1e-5 a step there
        assert not growth(name, 0.0, 1.01 * limit) < 1000.0


@pytest.mark.parametrize(("name", "zeta"), [(name, zeta) for name, zeta, _ in CASES])
def test_integrators_hold_just_below_their_limit_and_fail_just_above(name, zeta):
    limit = INTEGRATORS[name].limit(zeta)
    if limit > 0.0:
        assert growth(name, zeta, 0.99 * limit) < 100.0
    if name != "leapfrog" or zeta == 0.0:  # with damping its limit is a bound
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


@pytest.mark.parametrize("damping", [1e4, 3e4, 1e5, 1e6, 1e12])
def test_damping_that_is_exact_never_shortens_the_step(damping):
    """omega = 2 sqrt(k/m) sin(17 pi/38) of ten points: no damping shortens leapfrog's 2/omega."""
    net = rope(10, stiffness=800.0, damping=damping)
    longest = 1.0 / (math.sqrt(800.0) * math.sin(17.0 * math.pi / 38.0))
    assert critical_step(net, "leapfrog") == pytest.approx(longest, rel=1e-6)
    found = gauge(net, "leapfrog", 1 / 60, State.at_rest(net))
    assert found.limit == 2.0
    assert found.share == pytest.approx(1.0 / (60.0 * longest), rel=1e-6)
    assert critical_stiffness(net, "leapfrog", 1 / 60) == pytest.approx(800.0 * (60.0 * longest) ** 2, rel=1e-6)


@pytest.mark.parametrize("zeta", [1e3, 1e6, 1e9])
@pytest.mark.parametrize(
    ("name", "reach"),  # of the real axis, over h rate: the other root is slow
    [("explicit_euler", 2.0), ("symplectic_euler", 2.0), ("leapfrog_lagged", 2.0), ("rk4", 2.785294)],
)
def test_far_beyond_critical_damping_the_rate_alone_limits_a_step(name, reach, zeta):
    record = INTEGRATORS[name]
    assert 2.0 * zeta * record.limit(zeta) == pytest.approx(reach, rel=1e-6)
    assert record.stable_step(0.0, 50.0) == pytest.approx(reach / 50.0, rel=1e-6)
    assert record.stable_step(0.0, 0.0) == math.inf


@pytest.mark.parametrize("omega", [1e-6, 0.05, 1.0, 1e6])
def test_the_damping_ratio_is_half_the_rate_over_the_frequency(omega):
    assert Mode(omega**2, 0.0, 0.4 * omega).zeta == pytest.approx(0.2)
    assert Mode(0.0, 0.0, omega).zeta == math.inf
    assert Mode(0.0, 0.0, 0.0).zeta == 0.0
    for record in INTEGRATORS.values():  # nothing of it slides
        assert step_limit(Mode(omega**2, 0.0, 0.4 * omega), record) == record.stable_step(omega, 0.4 * omega)


def test_the_gauge_of_what_only_damping_holds_has_no_frequency():
    """Across a rope at its rest length nothing is stiff, and the damping there is that along it."""
    net = rope(damping=1e4)
    found = gauge(net, "rk4", 1e-5, State.at_rest(net))
    assert (found.omega, found.zeta, found.h_omega, found.limit) == (0.0, math.inf, 0.0, 0.0)
    assert found.share == pytest.approx(1e-5 / critical_step(net, "rk4"), rel=1e-12)
    assert found.critical_step == pytest.approx(2.785294 / top_modes(net)[1].rate, rel=1e-3)
    assert found.highest == pytest.approx(top_modes(net)[0].omega, rel=1e-12)


def test_explicit_euler_without_damping_is_never_stable():
    assert critical_step(rope(damping=0.0, drag=0.0), "explicit_euler") == 0.0
    assert critical_stiffness(rope(damping=0.0, drag=0.0), "explicit_euler", 0.01) == 0.0


def test_nothing_that_moves_allows_every_step():
    assert critical_step(rope(1), "rk4") == math.inf
    assert critical_step(rope(2, stiffness=0.0, damping=0.0, drag=0.0), "rk4") == math.inf
    assert gauge(rope(1), "rk4", 0.01, State.at_rest(rope(1))).h_omega == 0.0


@pytest.mark.parametrize(("points", "damping"), [(10, 22.5), (15, 22.25), (30, 22.25)])
def test_a_less_damped_mode_may_limit_the_step_before_the_stiffest(points, damping):
    """A straight rope at its rest length has the modes of a chain along it; across it is damped, but not stiff."""
    net = rope(points, stiffness=800.0, damping=damping, drag=0.0)
    chain = 2.0 * np.eye(points - 1) - np.eye(points - 1, k=1) - np.eye(points - 1, k=-1)
    chain[-1, -1] = 1.0
    of_chain = np.linalg.eigvalsh(chain) / net.mass
    method = INTEGRATORS["rkn8"]
    limits = [method.stable_step(math.sqrt(stiffness * e), damping * e) for e in of_chain for stiffness in (0.0, 800.0)]
    assert critical_step(net, method) == pytest.approx(min(limits), rel=1e-3)
    assert min(limits) < 0.995 * method.stable_step(math.sqrt(800.0 * of_chain[-1]), damping * of_chain[-1])


def test_contact_lowers_the_critical_step():
    net = rope(10, floor=0.1, contact=Contact(80_000.0, 5.0))
    assert critical_step(net, "leapfrog") < 0.5 * critical_step(rope(10), "leapfrog")
    assert critical_step(net, "leapfrog") == pytest.approx(2.0 / top_modes(net)[0].omega, rel=1e-6)


def test_a_stiffness_beside_a_contact_is_the_one_that_reaches_the_step():
    net = rope(10, floor=0.1, contact=Contact(3000.0, 5.0))
    stiffness = critical_stiffness(net, "leapfrog", 1 / 60)
    at = rope(10, floor=0.1, contact=Contact(3000.0, 5.0), stiffness=stiffness)
    assert critical_step(at, "leapfrog") == pytest.approx(1 / 60, rel=1e-3)


def test_the_stiffness_is_that_of_the_stiffest_links_with_known_modes_too():
    net = patch()
    found = critical_stiffness(net, "leapfrog", 0.01, modes=top_modes(net))
    assert found == pytest.approx(critical_stiffness(net, "leapfrog", 0.01), rel=1e-6)
    assert critical_step(net.with_stiffness(found), "leapfrog") == pytest.approx(0.01, rel=1e-4)


def test_a_method_that_is_only_stable_where_damped_enough_has_a_largest_stiffness():
    """Of the damping ratio 0.3/sqrt(k), 0.1 or more."""
    record = INTEGRATORS["rk4"]._replace(
        stable_step=lambda omega, rate: 1.0 / max(omega, 1e-3) if rate > 0.2 * omega else 0.0
    )
    assert critical_stiffness(rope(2, 1.0, 1.0, 1.0, 0.6, 0.0, 0.0), record, 1e-6) == pytest.approx(9.0, rel=1e-6)


def folded():
    """A soft sheet, folded so that two rows of points push two others apart."""
    net = cloth(2, 8, 0.7, 0.1, 1.0, 2.0, 1.0, 0.5, 0.0, pinned="free", contact=Contact(300.0, 0.5), thickness=0.1)
    x = net.x0.copy()
    x[0, :, 4:] = x[0, :, 3::-1]
    x[2, :, 4:] = 0.07
    return dataclasses.replace(net, x0=x)


def test_a_net_s_contact_with_itself_counts_in_its_modes_and_bounds():
    net = folded()
    stiffness, damping = tangent(net, net.x0)
    assert np.abs(tangent_matrix(net, net.x0, STIFFNESS) - stiffness).max() < 1e-6 * np.abs(stiffness).max()
    assert np.abs(tangent_matrix(net, net.x0, DAMPING) - damping).max() < 1e-6 * np.abs(damping).max()
    stiffest, most_damped, *_ = top_modes(net)
    assert stiffest.omega > 3.0 * top_modes(dataclasses.replace(net, thickness=0.0))[0].omega
    for bound in (gershgorin(net), gershgorin(net, net.x0)):
        assert stiffest.omega <= bound[0]
        assert most_damped.rate <= bound[1]
    xs = np.moveaxis(net.x0, 0, -1)
    touched = Counter(particle for a, b, _ in own_contacts(net, xs, 0.0 * xs) for particle in (a, b))
    assert most_touching(net, net.x0) == max(touched.values())
    apart = np.stack([*np.mgrid[:2, :8].astype(float), np.zeros((2, 8))])
    assert gershgorin(net, apart) == gershgorin(dataclasses.replace(net, thickness=0.0))


def sliding_rope(friction, stiffness=800.0):
    """A rope on a floor of that stiffness, without other damping."""
    return rope(6, damping=0.0, drag=0.0, gravity=10.0, floor=0.1, contact=Contact(stiffness, 0.0, friction))


def test_friction_counts_as_the_strongest_damping_that_it_may_be():
    """h gamma = 1 along the floor: z^2 + 2 h gamma < 4 leaves z < sqrt 2 of symplectic Euler, and leapfrog's 2."""
    smooth, rough = sliding_rope(0.0), sliding_rope(0.5)
    bare = critical_step(smooth, "leapfrog")
    assert critical_step(rough, "symplectic_euler") == pytest.approx(bare / math.sqrt(2.0), rel=1e-3)
    assert critical_step(rough, "leapfrog_lagged") == pytest.approx(bare / math.sqrt(2.0), rel=1e-3)
    assert critical_step(rough, "leapfrog") == pytest.approx(bare, rel=1e-9)
    assert critical_step(rough, "rk4") <= critical_step(smooth, "rk4")
    assert critical_step(rough, "explicit_euler") == 0.0
    assert critical_step(rough, "implicit_euler") == math.inf
    found = gauge(rough, "symplectic_euler", 0.01, State.at_rest(rough))
    assert found.limit == pytest.approx(math.sqrt(2.0), rel=1e-3)
    assert found.h_omega / found.limit == pytest.approx(0.01 / found.critical_step, rel=1e-9)
    stiffness = critical_stiffness(rough, "symplectic_euler", 0.01)
    assert critical_step(rough.with_stiffness(stiffness), "symplectic_euler") == pytest.approx(0.01, rel=1e-3)


@pytest.mark.parametrize("stiffness", [800.0, 4800.0])  # of the floor: the stiffest mode slides, or stands upright
@pytest.mark.parametrize("amplitude", [1e-5, 0.003, 0.02])  # [m]: friction holds small ones in place at any step
def test_a_rope_on_a_rough_floor_comes_to_rest_within_its_critical_step(amplitude, stiffness):
    """The step is a bound: friction that stops a point in a step is no linear damping. Without friction it rattles."""
    rough = sliding_rope(0.5, stiffness)
    longest = critical_step(
        dataclasses.replace(rough, contact=rough.contact._replace(friction=0.0)), "symplectic_euler"
    )
    cases = [(0.97 * critical_step(rough, "symplectic_euler"), True), (1.04 * longest, False)]
    for h, holds in cases if amplitude > 0.01 else cases[:1]:
        state = State.at_rest(rough)
        state.x[2] = 0.1 - 10.0 / stiffness  # as deep as each point's weight over the stiffness
        state.x[0, 0, 1:] += amplitude * (-1.0) ** np.arange(5)
        advance(rough, state, INTEGRATORS["symplectic_euler"], h, 4000)
        assert bool(np.abs(state.v[0]).max() < 1e-6) is holds


def test_a_rough_sphere_counts_where_it_is():
    """The same as a floor, where it is large: the stiffest mode that slides is the floor's."""
    floor = sliding_rope(0.5, 4800.0)
    moved = dataclasses.replace(
        floor, floor=None, sphere=(0.0, 0.0, -1e5 - 2.9, 1e5), sphere_velocity=(0.0, 0.0, 1.0), epoch=-3.0
    )
    assert critical_step(moved, "symplectic_euler") == pytest.approx(critical_step(floor, "symplectic_euler"), rel=1e-3)


def test_what_nothing_holds_has_a_gauge_on_a_rough_floor():
    net = rope(stiffness=0.0, damping=0.0, drag=0.0, floor=0.1, contact=Contact(0.0, 0.0, 0.5))
    found = gauge(net, "rk4", 0.01, State.at_rest(net))
    assert found.limit == INTEGRATORS["rk4"].limit(0.0)
    assert found.critical_step == math.inf


def test_a_step_that_is_not_given_is_half_the_critical_one_or_shorter():
    net = cloth()
    run = simulate(net, duration=0.02, frames=3, integrator="leapfrog")
    assert run.diverged_at is None
    assert run.step is not None
    assert run.step <= 0.5 * critical_step(net, "leapfrog")
    assert run.step == pytest.approx(0.5 * critical_step(net, "leapfrog"), rel=0.1)
    assert simulate(rope(), duration=0.1, frames=2, integrator="leapfrog").step == pytest.approx(1 / 1200, rel=1e-12)
    undamped, hardly = rope(damping=0.0, drag=0.0), rope(damping=0.0, drag=0.05)
    run = simulate(hardly, duration=1e-4, frames=2, integrator="explicit_euler")
    assert run.step == pytest.approx(0.5 * critical_step(hardly, "explicit_euler"), rel=0.1)
    assert simulate(undamped, duration=0.1, frames=2, integrator="explicit_euler").step == pytest.approx(
        1 / 1200, rel=1e-12
    )
    assert simulate(rope(), duration=0.1, frames=3, step=0.03, integrator="rk4").step == pytest.approx(0.025, rel=1e-12)
    assert simulate(rope(), duration=0.01, frames=2, integrator="dopri5").step is None
