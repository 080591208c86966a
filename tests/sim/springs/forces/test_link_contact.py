"""A rope's links touch the sphere as capsules of the rope's radius: forces, account, and how deep they come."""

import dataclasses
import itertools

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, rope
from sim.springs.integrators.implicit import blocks, steps
from sim.springs.points.acceleration import set_acceleration
from sim.springs.state import State, advance, energy, velocities
from tests import naive
from tests.sim.springs.nets import DAMPABLE, draped
from tests.sim.springs.reference import exact, integrated


def accelerations(net, x, v=None, t=0.0):
    a = np.empty(x.size)
    v = np.zeros(x.size) if v is None else v.reshape(-1).copy()
    set_acceleration(x.reshape(-1).copy(), v, t, net.kernel_view(1.0), a)
    return a.reshape(x.shape)


def bar(contact, *, sphere, length=0.4, mass=0.1, **more):
    """A free link, level along x with its middle at the origin, of a rope of 0.03 m."""
    net = rope(2, length, mass, 1e4, 0.0, 0.0, 0.0, sphere=sphere, contact=contact, radius=0.03)
    x0 = np.zeros((3, 1, 2))
    x0[0, 0] = -0.5 * length, 0.5 * length
    return dataclasses.replace(net, **{"x0": x0, "pinned": frozenset(), **more})


def deepest(net, x, t=0.0):
    """Largest depth [m] of a place of the rope in the sphere."""
    centre = np.array(net.sphere[:3]) + (t - net.epoch) * np.array(net.sphere_velocity)
    ends = itertools.pairwise(x[:, 0].T)
    near = min(np.linalg.norm(a + naive.nearest_part(a, b, centre) * (b - a) - centre) for a, b in ends)
    return net.sphere[3] + net.radius - near


@pytest.mark.parametrize("part", [0.0, 0.2, 0.5, 1.0])
def test_a_link_is_pushed_at_the_place_that_touches(part):
    """k depth, shared by (1 - s, s)."""
    net = bar(Contact(500.0, 0.0), sphere=(0.4 * part - 0.2, 0.0, -0.12, 0.1))
    force = 0.1 * accelerations(net, net.x0)[:, 0].T
    assert force == pytest.approx(np.outer((1.0 - part, part), (0.0, 0.0, 500.0 * 0.01)), abs=1e-12)


def test_the_force_is_continuous_as_the_place_leaves_an_end():
    """The sphere moves along a bent rope at a depth of 5 mm, past the end of its links and past their bend."""
    net = rope(3, 0.4, 0.1, 0.0, 0.0, 0.0, 0.0, contact=Contact(500.0, 3.0, 0.3), radius=0.03)
    x = np.array([[-0.2, 0.0, 0.19], [0.0, 0.0, 0.0], [0.0, 0.0, -0.06]])[:, None]
    v = np.random.default_rng(0).standard_normal(x.shape)
    places = np.linspace(-0.25, 0.25, 4001)
    net = dataclasses.replace(net, pinned=frozenset())
    found = [
        0.1 * accelerations(dataclasses.replace(net, sphere=(place, 0.0, -0.125, 0.1)), x, v)[:, 0] for place in places
    ]
    jumps = np.abs(np.diff(found, axis=0)).max()
    assert np.abs(found).max() > 30.0
    assert jumps < 0.1  # [N]: the sphere moves by 0.125 mm at a time, which is 0.0625 N of its stiffness


def test_a_contact_at_a_free_end_is_that_of_a_point():
    links = bar(Contact(500.0, 4.0, 0.3), sphere=(0.28, 0.01, -0.05, 0.1))
    points = dataclasses.replace(links, contact=links.contact._replace(links=False))
    v = np.random.default_rng(2).standard_normal(links.x0.shape)
    assert deepest(links, links.x0) > 0.0
    assert accelerations(links, links.x0, v) == pytest.approx(accelerations(points, points.x0, v), abs=1e-11)


def test_without_links_in_contact_and_with_the_lab_s_law_only_points_touch():
    across = bar(Contact(500.0, 0.0), sphere=(0.0, 0.0, -0.12, 0.1))
    for contact in (across.contact._replace(links=False), across.contact._replace(law="lab")):
        assert not accelerations(dataclasses.replace(across, contact=contact), across.x0).any()
    assert accelerations(across, across.x0).any()


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_smooth_sphere_turns_no_link_about_its_centre(name):
    """Its force points away from its centre: the rope's angular momentum about it stays, and its energy."""
    net = bar(Contact(500.0, 0.0), sphere=(0.05, 0.03, -0.15, 0.1))
    v0 = np.zeros_like(net.x0)
    v0[:, 0] = np.array([[0.3, 0.2, -1.0], [0.2, -0.1, -1.2]]).T
    state = State.at_rest(net)
    state.v[:] = v0

    def spin():
        arms = state.x[:, 0].T - np.array(net.sphere[:3])
        return np.cross(arms, net.mass * velocities(net, state)[:, 0].T).sum(axis=0)

    before, stored, pressed, record = spin(), energy(net, state).total, 0.0, INTEGRATORS[name]
    for _ in range(60):
        advance(net, state, record, 2e-5 if record.order < 2 else 2e-4, 100 if record.order < 2 else 10)
        pressed = max(pressed, energy(net, state).contact)
    tolerance = 1e-9 if record.symplectic else {1: 1e-4, 2: 1e-5}.get(record.order, 1e-7)
    assert pressed > 0.05 * stored
    assert spin() == pytest.approx(before, abs=tolerance)


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_link_balances_on_a_small_sphere_as_deep_as_its_weight(name):
    """Beside its middle it would tip: the place of contact is where its weight acts. Friction holds it."""
    contact = Contact(2000.0, 8.0, 0.5)
    net = bar(contact, sphere=(0.0, 0.0, -0.05 - 0.03 + 0.2 * 9.81 / 2000.0, 0.05), gravity=(0.0, 0.0, -9.81))
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], 1e-4, 2000)
    assert deepest(net, state.x) == pytest.approx(0.2 * 9.81 / 2000.0, rel=1e-9)
    assert np.abs(state.x - net.x0).max() < 1e-9


def test_the_matrix_of_an_implicit_step_has_the_whole_of_each_contact():
    """g b + g^2 k of n n^T, n spread over the ends by (1 - s, s), beside the matrix without the sphere."""
    net, g = draped(Contact(900.0, 20.0), sphere_velocity=(0.0, 0.0, 0.0)), 0.01

    def matrix(one):
        p = one.kernel_view(1.0)
        work = steps.make_work(p, False)
        x = one.x0.reshape(-1).copy()
        steps.set_blocks(x, g, 0.0, p, x, np.zeros_like(x), work)
        diagonal, beside = work.solver.diagonal, work.solver.beside
        blocks.set_rope_blocks(p, work.points, work.links, work.pairs, work.solver.numbers, diagonal, beside)
        n = p.cols
        dense = np.zeros((n, 3, n, 3))
        for j in range(n):
            dense[j, :, j] = diagonal[j].reshape(3, 3)
            if j + 1 < n:
                dense[j, :, j + 1] = beside[j].reshape(3, 3)
                dense[j + 1, :, j] = beside[j].reshape(3, 3).T
        return dense

    expected, xs = np.zeros((9, 3, 9, 3)), np.moveaxis(net.x0, 0, -1)
    for (_, a), (_, b), s, force, _, _ in naive.link_touches(net, xs, 0.0 * xs, 0.0):
        spread = np.zeros((9, 3))
        spread[a], spread[b] = (1.0 - s) * force, s * force
        spread /= np.linalg.norm(force)
        expected += (g * 20.0 + g * g * 900.0) * np.multiply.outer(spread, spread)
    expected[0], expected[:, :, 0] = 0.0, 0.0
    found = matrix(net) - matrix(dataclasses.replace(net, sphere=None))
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_leapfrog_is_of_second_order_where_a_link_slides_and_bobs(damping):
    net = bar(
        Contact(800.0, damping, 0.3), sphere=(0.02, 0.0, -0.106, 0.1), gravity=(0.0, 0.0, -10.0),
        sphere_velocity=(0.0, 0.4, 0.0),
    )  # fmt: skip
    v0 = np.zeros_like(net.x0)
    v0[1, 0] = -2.0, -1.8
    x, _ = exact(net, 0.02, v0)
    errors = [np.abs(integrated(net, "leapfrog", 0.02, count, v0).x - x).max() for count in (20, 40, 80)]
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]
    assert errors[2] < 1e-6


def thrown(seed):
    """A loose rope of 12 links above a small sphere, in any shape, thrown at it; and its velocities."""
    rng = np.random.default_rng(seed)
    radius, link = rng.uniform(0.02, 0.2), rng.uniform(0.08, 0.25)
    net = rope(
        13, 12 * link, 0.05, 500.0 / link, 1.0, 0.02, 9.81, sphere=(0.0, 0.0, 0.0, radius),
        contact=Contact(1e5, 20.0, 0.3), radius=0.035,
    )  # fmt: skip
    along = rng.standard_normal((12, 3)) * (1.0, 1.0, 0.2)
    along *= link / np.linalg.norm(along, axis=1)[:, None]
    x = np.concatenate([np.zeros((1, 3)), np.cumsum(along, axis=0)])
    x += (*(rng.uniform(-0.05, 0.05, 2) - 0.5 * (x[6, :2] + x[7, :2])), radius + 0.2 - x[:, 2].min())
    net = dataclasses.replace(net, x0=np.ascontiguousarray(x.T[:, None]), pinned=frozenset())
    v = np.zeros_like(net.x0)
    v[2] = -rng.uniform(0.0, 4.0)
    return net, v


@pytest.mark.parametrize("seed", range(12))
def test_a_rope_that_falls_on_a_small_sphere_comes_no_deeper_than_a_fifth_of_its_radius(seed):
    """No link passes, and the account closes to a thousandth of the largest kinetic energy."""
    net, v = thrown(seed)
    state = State.at_rest(net)
    state.v[:] = v
    before, depth, off = energy(net, state), 0.0, 0.0
    kinetic = before.kinetic
    for _ in range(1000):
        advance(net, state, INTEGRATORS["leapfrog"], 5e-5, 20, with_account=True)
        now = energy(net, state)
        depth, kinetic = max(depth, deepest(net, state.x)), max(kinetic, now.kinetic)
        off = max(off, abs(now.total - before.total + state.dissipated - state.work))
    assert 0.0 < depth < 0.2 * net.radius
    assert off < 1e-3 * kinetic
