import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, lab_units, rope, statics
from sim.springs.state import State, acceleration, advance, velocities
from sim.springs.statics import catenary, equilibrium, hanging_chain
from sim.validation import ConvergenceError
from tests.sim.springs.nets import DAMPABLE

WEIGHT = 9.80665  # [N/m] of the reference ropes, 2 m long


def continuum(span, rise, stiffness, length=2.0, weight=WEIGHT):
    """The elastic catenary (Irvine 1981): end forces (H, V) [N] of an unstrained length, and its shape (x, z)(s).

    x = H s/EA + H/w [asinh((V + w s)/H) - asinh(V/H)], z = (V s + w s^2/2)/EA + H/w [sqrt(1 + ((V + w s)/H)^2) -
    sqrt(1 + (V/H)^2)], with V the vertical force at the left, solved by Newton with differences.
    """

    def shape(force, s):
        H, V = force
        a, b = V / H, (V + weight * s) / H
        x = H * s / stiffness + H / weight * (math.asinh(b) - math.asinh(a))
        z = (V * s + weight * s * s / 2) / stiffness + H / weight * (math.sqrt(1 + b * b) - math.sqrt(1 + a * a))
        return np.array([x, z])

    force = np.array([5.0, -10.0])
    for _ in range(60):
        gap = shape(force, length) - (span, rise)
        jacobian = np.stack([(shape(force + d, length) - shape(force - d, length)) / 2e-6 for d in np.eye(2) * 1e-6], 1)
        force = force - np.linalg.solve(jacobian, gap)
    return force, lambda s: shape(force, s)


def refined(links, span, rise, stiffness):
    """The chain of a material rope: EA [N], 2 m, `WEIGHT`."""
    units = lab_units(links + 1, 2.0, stiffness, WEIGHT / 9.80665, 0.0, 0.0)
    return catenary(links + 1, 2.0, span, rise, units["stiffness"], units["mass"], 9.80665)


@pytest.mark.parametrize(
    ("span", "rise", "stiffness", "horizontal", "right", "middle"),
    [
        (1.5, 0.0, 500.0, 5.2336347022265771245, 9.80665, -0.60962198928404164368),
        (1.5, 0.5, 500.0, 5.5265694996488330771, 12.579399287042765281, -0.28592592613134905669),
        (2.2, 0.0, 100.0, 15.620355973776559349, 9.80665, -0.3369227048377570738),
    ],
)
def test_the_continuum_catenary_is_the_reference(span, rise, stiffness, horizontal, right, middle):
    force, shape = continuum(span, rise, stiffness)
    assert force[0] == pytest.approx(horizontal, rel=1e-9)
    assert force[1] + WEIGHT * 2.0 == pytest.approx(right, rel=1e-9)
    assert shape(1.0)[1] == pytest.approx(middle, rel=1e-9)


def test_the_lumped_chain_converges_to_the_continuum_at_second_order():
    errors = [refined(n, 1.5, 0.0, 500.0).x[n // 2, 2] + 0.60962198928404164368 for n in (4, 8, 16, 32, 64, 128)]
    assert errors == pytest.approx([-2.31e-2, -5.46e-3, -1.341e-3, -3.339e-4, -8.340e-5, -2.084e-5], rel=1e-3)
    ratios = np.divide(errors[:-1], errors[1:])
    assert list(ratios) == pytest.approx([4.23, 4.07, 4.016, 4.004, 4.001], abs=6e-3)


def test_a_fine_chain_has_the_continuum_s_end_force():
    # The end links carry half a spacing less rope than the continuum does at its ends.
    shape = refined(512, 2.2, 0.0, 100.0)
    assert shape.tension.max() == pytest.approx(18.443587096061249756, rel=2e-3)


@pytest.mark.parametrize("points", [3, 4, 10, 51, 400])
@pytest.mark.parametrize(
    ("span", "rise", "stiffness"),
    [(1.5, 0.0, 800.0), (1.5, 0.5, 8e5), (1.0, -1.2, 800.0), (3.0, 1.0, 50.0), (1.99999, 0.0, 1e6), (-1.0, 0.2, 800.0)],
)
def test_forces_balance_at_every_point_of_a_catenary(points, span, rise, stiffness):
    shape = catenary(points, 2.0, span, rise, stiffness, 1.0, 10.0)
    links = np.diff(shape.x, axis=0)
    lengths = np.linalg.norm(links, axis=1)
    # As round as 1e-12 m allows: 1e6 N/m makes 1e-6 N of it.
    assert stiffness * (lengths - 2.0 / (points - 1)) == pytest.approx(shape.tension, rel=1e-9, abs=1e-11 * stiffness)
    forces = shape.tension[:, None] * links / lengths[:, None]
    assert np.diff(forces, axis=0) == pytest.approx(np.tile([0.0, 0.0, 10.0], (points - 2, 1)), abs=1e-8)
    assert shape.x[-1] == pytest.approx([span, 0.0, rise])


def test_a_weightless_stretched_rope_is_straight():
    shape = catenary(5, 2.0, 2.4, 0.0, 800.0, 1.0, 0.0)
    assert shape.tension == pytest.approx(np.full(4, 80.0))
    assert shape.x[:, 0] == pytest.approx(np.linspace(0.0, 2.4, 5))


@pytest.mark.parametrize(("span", "gravity"), [(1.0, 0.0), (0.0, 0.0)])
def test_a_slack_weightless_rope_has_no_catenary(span, gravity):
    with pytest.raises(ValueError, match="span: "):
        catenary(5, 2.0, span, 0.0, 800.0, 1.0, gravity)


def test_a_catenary_that_is_not_found_is_no_wrong_argument(monkeypatch):
    monkeypatch.setattr(statics, "ITERATIONS", 1)
    with pytest.raises(
        ConvergenceError, match=r"catenary of a rope: no solution after 1 iterations; \S+ m at its last"
    ):
        catenary(9, 2.0, 1.0, 0.3, 800.0, 1.0, 10.0)


def test_a_rope_folded_on_itself_hangs_in_two_equal_legs():
    shape = catenary(5, 2.0, 0.0, 0.0, 800.0, 1.0, 10.0)
    assert shape.tension == pytest.approx([15.0, 5.0, 5.0, 15.0])
    assert shape.x[2, 2] == pytest.approx(-(1.0 + 20.0 / 800.0))


def test_the_hanging_chain_has_the_lab_s_numbers():
    shape = hanging_chain(rope(10, gravity=10.0))
    depth = -shape.x[:, 2]
    assert depth[1] - 2.0 / 9 == pytest.approx(0.1125, rel=1e-12)
    assert depth[-1] == pytest.approx(2.5625, rel=1e-12)
    scene = hanging_chain(rope(50, gravity=10.0))
    assert -scene.x[1, 2] - 2.0 / 49 == pytest.approx(0.6125, rel=1e-12)
    assert -scene.x[-1, 2] == pytest.approx(2.0 + 10.0 * 49 * 50 / 1600.0, rel=1e-12)


def test_equilibria_are_where_the_forces_are_none():
    for net in (rope(10), rope(10, end=(1.0, 1.0, 0.3), root=(0.2, -0.1, 0.4)), rope(7, gravity=-10.0)):
        state = State(np.ascontiguousarray(equilibrium(net).x.T[:, None]), np.zeros_like(net.x0))
        assert np.abs(acceleration(net, state, 1.0)).max() < 1e-10


@pytest.mark.parametrize("end", [None, (-1.2, 0.3, 0.2)])
@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", DAMPABLE)
def test_every_integrator_settles_at_the_exact_equilibrium(name, model, end):
    # Drag of twice the slowest mode's frequency: it decays by exp(-2.3 t) and is 1e-9 m of 2 m after 10 s.
    net = rope(10, drag=4.6, end=end, damping_model=model)
    state = State.at_rest(net)
    h = 1 / 1200
    advance(net, state, INTEGRATORS[name], h, 36_000)
    assert np.abs(state.x[:, 0].T - equilibrium(net).x).max() < 1e-9
    assert np.abs(velocities(net, state)).max() < 1e-9


@pytest.mark.parametrize("h", [1 / 60, 1 / 240, 1 / 3000])
@pytest.mark.parametrize("damping", [0.0, 7.0])
def test_the_equilibrium_depends_neither_on_the_step_nor_on_the_damping(h, damping):
    net = rope(10, damping=damping, drag=4.0)
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["leapfrog"], h, round(40.0 / h))
    assert np.abs(state.x[:, 0].T - equilibrium(net).x).max() < 1e-9


def test_nets_that_do_not_hang_are_refused():
    for net in (rope(4, stiffness=0.0), dataclasses.replace(rope(4), pinned=frozenset({(0, 1)}))):
        with pytest.raises(ValueError, match="allowed"):
            equilibrium(net)
    with pytest.raises(ValueError, match="pinned at point 0 only"):
        hanging_chain(rope(4, end=(1.0, 0.0, 0.0)))
