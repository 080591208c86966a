"""A rope touches itself, link on link: forces, account, matrices, and the list of links that are near to each other."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, PinPath, critical_step, rope, simulate
from sim.springs.forces.matrices import DAMPING, STIFFNESS
from sim.springs.integrators.implicit.tangent import products
from sim.springs.near.near_pairs import SKIN, find_pairs, refresh_pairs
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.link_pairs import pair_at
from sim.springs.stability import gershgorin, top_modes
from sim.springs.state import State, advance, energy, velocities
from sim.validation import ApproximationWarning
from tests import naive
from tests.sim.springs.nets import DAMPABLE
from tests.sim.springs.reference import exact, integrated


def tangled(points=24, seed=0, contact=None, radius=0.02, **more):
    """A rope of links of 0.1 m in a heap, free of all but itself and air."""
    rng = np.random.default_rng(seed)
    net = rope(points, 0.1 * (points - 1), 0.1, 800.0, 1.0, 0.1, contact=contact or Contact(500.0, 7.0), radius=radius,
               self_contact=True)  # fmt: skip
    way = rng.standard_normal((points - 1, 3))
    way *= 0.1 / np.linalg.norm(way, axis=1)[:, None]
    x = np.zeros((points, 3))
    for j in range(points - 1):
        x[j + 1] = 0.85 * x[j] + way[j]
    return dataclasses.replace(net, **{"x0": placed(x), "mass_ratios": rng.uniform(0.5, 2.0, (1, points)), **more})


def placed(x):
    return np.ascontiguousarray(np.asarray(x).T[:, None])


def crossed(depth=0.01, at=(0.5, 0.5), contact=None, *, mass=0.1, joined=0.5):
    """Two links of 0.4 m, one above the other at right angles, joined by a long loop that weighs nothing beside them.

    at: the parts of the links at which they cross.
    """
    net = rope(6, 0.4 * 5, mass, 0.0, 0.0, 0.0, 0.0, contact=contact or Contact(500.0, 0.0), radius=0.03,
               self_contact=True)  # fmt: skip
    s, t = at
    high = 0.06 - depth
    x = [
        (-0.4 * s, 0.0, 0.0), (0.4 * (1.0 - s), 0.0, 0.0), (3.0, joined, 1.0), (3.0, joined, 2.0),
        (0.0, -0.4 * t, high), (0.0, 0.4 * (1.0 - t), high),
    ]  # fmt: skip
    return dataclasses.replace(net, x0=placed(x), pinned=frozenset())


def accelerations(net, x, v=None):
    a = np.empty(x.size)
    v = np.zeros(x.size) if v is None else v.reshape(-1).copy()
    set_acceleration(x.reshape(-1).copy(), v, 0.0, net.kernel_view(0.01), a)
    return a.reshape(x.shape)


def column_of(net):
    families = tuple(f._replace(di=1, dj=0) for f in net.families)
    x0, ratios = np.ascontiguousarray(net.x0.transpose(0, 2, 1)), np.ascontiguousarray(net.mass_ratios.T)
    return dataclasses.replace(net, x0=x0, families=families, mass_ratios=ratios)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("floor", [None, -0.1])
def test_forces_are_those_of_the_slow_reference(floor, turned):
    """In heaps, with floor and sphere beside; of a column as of a row."""
    around = {} if floor is None else {"floor": floor, "sphere": (0.1, 0.0, 0.0, 0.12)}
    for seed in range(4):
        net = tangled(seed=seed, **around)
        net = column_of(net) if turned else net
        for speed in (0.0, 1.0, 30.0):
            v = speed * np.random.default_rng(seed).standard_normal(net.x0.shape)
            v[:, 0, 0] = 0.0
            assert len(list(naive.strand_touches(net, np.moveaxis(net.x0, 0, -1), np.moveaxis(v, 0, -1)))) > 3
            expected = naive.acceleration(net, net.x0, v, 0.0, 0.01)
            assert np.abs(accelerations(net, net.x0, v) - expected).max() <= 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("at", [(0.5, 0.5), (0.2, 0.9), (0.0, 1.0)])
def test_crossed_links_push_at_the_place_where_they_cross(at):
    """k depth, shared by (1 - s, s) on each."""
    net = crossed(0.01, at)
    force = 0.1 * accelerations(net, net.x0)[2, 0]
    s, t = at
    assert force == pytest.approx(5.0 * np.array([s - 1.0, -s, 0.0, 0.0, 1.0 - t, t]), abs=1e-12)


def pair_of(*ends):
    """The `LinkPair` of the links between the first two and the last two of four points."""
    return pair_at(np.ascontiguousarray(np.array(ends, dtype=np.float64).T).reshape(-1), 4, 0, 2)


def test_the_nearest_places_are_those_of_the_slow_reference():
    """Of links anywhere, in one plane, nearly parallel, and without a length."""
    rng = np.random.default_rng(4)
    for flat in (1.0, 1e-3, 1e-9, 0.0):
        for _ in range(200):
            ends = rng.standard_normal((4, 3)) * (1.0, flat, flat)
            ends[2:] += rng.standard_normal(3) * (0.0, 0.1, 0.0)
            pair, (s, t) = pair_of(*ends), naive.nearest_places(*ends)
            places = [ends[0] + s * (ends[1] - ends[0]), ends[2] + t * (ends[3] - ends[2])]
            assert pair.distance == pytest.approx(np.linalg.norm(places[1] - places[0]), rel=1e-6, abs=1e-9)
            assert 0.0 <= pair.s <= 1.0
            assert 0.0 <= pair.t <= 1.0
            if flat == 1.0:
                normal = (places[1] - places[0]) / np.linalg.norm(places[1] - places[0])
                assert (pair.s, pair.t, pair.nx, pair.ny, pair.nz) == pytest.approx((s, t, *normal), abs=1e-9)
    spot = pair_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-1.0, 2.0, 0.0), (1.0, 2.0, 0.0))
    assert (spot.t, spot.distance, spot.ny) == (0.5, 2.0, 1.0)


@pytest.mark.parametrize(("shift", "s", "t"), [(0.0, 0.5, 0.5), (0.5, 0.75, 0.25), (-0.2, 0.4, 0.6), (1.5, 1.0, 0.0)])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_parallel_links_touch_in_the_middle_of_their_overlap(shift, s, t, way):
    """In one direction and in opposite ones; without an overlap at their ends."""
    ends = [(shift, 0.3, 0.0), (shift + 1.0, 0.3, 0.0)]
    pair = pair_of((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), *(ends if way > 0.0 else ends[::-1]))
    assert (pair.s, pair.t) == pytest.approx((s, t if way > 0.0 else 1.0 - t), abs=1e-12)


def test_a_straight_rope_does_not_touch_itself_however_thick():
    """Less than half a circle of rope lies between near links, also of a rope thicker than its links are long."""
    for radius in (0.01, 0.06, 0.3):
        net = rope(30, 2.0, radius=radius, self_contact=True)
        bare = rope(30, 2.0, radius=radius)
        assert (accelerations(net, net.x0) == accelerations(bare, bare.x0)).all()


def test_the_tightest_bend_touches_and_a_wider_one_does_not():
    for bend, touches in ((0.8, True), (1.1, False)):
        radius = 0.05
        net = rope(60, 1.0, radius=radius, self_contact=True, gravity=0.0)
        length = net.families[0].rest * np.arange(60)
        half = 0.5 * math.pi * bend * 2.0 * radius
        turn = np.clip((length - 0.5 + 0.5 * half) / (0.5 * bend * 2.0 * radius), 0.0, math.pi)
        x = np.zeros((60, 3))
        x[1:, 0] = np.cumsum(np.cos(0.5 * (turn[1:] + turn[:-1]))) * net.families[0].rest
        x[1:, 1] = np.cumsum(np.sin(0.5 * (turn[1:] + turn[:-1]))) * net.families[0].rest
        assert (energy(net, State.still(placed(x))).contact > 0.0) == touches


def spin(net, state):
    return np.cross(state.x[:, 0].T, net.masses[0][:, None] * velocities(net, state)[:, 0].T).sum(axis=0)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_contact_keeps_momentum_and_angular_momentum(name):
    """Exactly, for methods that keep them: its forces are two and two opposite, in one line."""
    record = INTEGRATORS[name]
    damping = 0.0 if record.undamped_only else 3.0
    net = tangled(contact=Contact(500.0, damping), drag=0.0, pinned=frozenset(), gravity=(0.0, 0.0, 0.0))
    net = dataclasses.replace(net, families=(net.families[0]._replace(damping=0.0),))
    state = State.at_rest(net)
    pressed = energy(net, state).contact
    advance(net, state, record, 1e-5 if record.order == 1 else 2e-4, 200)
    assert pressed > 0.1
    moved = (net.masses[0] * velocities(net, state)[:, 0]).sum(axis=1)
    assert moved == pytest.approx(np.zeros(3), abs=1e-11)
    assert spin(net, state) == pytest.approx(
        np.zeros(3), abs=1e-11 if record.symplectic else 1e-3 if record.order == 1 else 1e-6
    )


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_bounce_of_links_has_the_restitution_of_its_closed_form(name):
    """e = exp(-b/w (pi - atan(2 b w / (w^2 - b^2)))), Schwager & Poeschel, cond-mat/0701278, of two equal links."""
    stiffness, damping, mass = 500.0, 3.0, 0.1
    net = crossed(-1e-12, contact=Contact(stiffness, damping), mass=mass)
    v0 = np.zeros_like(net.x0)
    v0[2, 0, 4:] = -0.5
    beta = 0.5 * damping / mass  # two links of 2 m, at their middles, have the reduced mass m
    omega = math.sqrt(stiffness / mass - beta * beta)
    restitution = math.exp(-beta / omega * (math.pi - math.atan(2.0 * beta * omega / (omega**2 - beta**2))))
    record = INTEGRATORS[name]
    steps = 20000 if record.order == 1 else 2000
    state = integrated(net, name, 0.08, steps, v0)
    after = state.v[2, 0, 4:].mean() - state.v[2, 0, :2].mean()
    assert after == pytest.approx(0.5 * restitution, rel=3e-3 if record.order == 1 else 1e-3)


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("damping", [0.0, 4.0])
@pytest.mark.parametrize(("name", "most"), [("leapfrog", 1e-6), ("tr_bdf2", 1e-6), ("implicit_midpoint", 2e-6)])
def test_methods_of_second_order_are_so_while_links_touch(name, most, damping, friction):
    """And slide over each other."""
    net = crossed(0.015, (0.3, 0.6), Contact(800.0, damping, friction))
    v0 = np.zeros_like(net.x0)
    v0[:, 0, 4:] = np.array([[1.2, 0.6, -0.5], [0.9, 0.8, -0.4]]).T
    seconds = 0.015
    x, _ = exact(net, seconds, v0)
    errors = [np.abs(integrated(net, name, seconds, count, v0).x - x).max() for count in (20, 40, 80)]
    assert energy(net, State.still(x)).contact > 0.0
    assert errors[1] < 0.27 * errors[0]
    assert errors[2] < 0.27 * errors[1]
    assert errors[2] < most


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("name", ["leapfrog", "rk4", "symplectic_euler", "dopri5", "tr_bdf2", "implicit_midpoint"])
def test_the_account_closes_while_a_pin_pushes_a_rope_onto_itself(name, friction):
    """Stored, dissipated and put in, to 1e-3 of the largest kinetic energy."""
    net = crossed(-0.01, (0.4, 0.7), Contact(2000.0, 6.0, friction))
    path = PinPath(0.0, ((0.0, -0.28, 0.07), (0.05, 0.0, -0.6), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    families = (net.families[0]._replace(stiffness=300.0, damping=1.0),)
    net = dataclasses.replace(net, pinned=frozenset({(0, 4)}), pin_paths=(((0, 4), path),), families=families)
    v0 = np.zeros_like(net.x0)
    v0[:, 0, 4] = path.coefficients[1]
    state = State.at_rest(net)
    state.v[:] = v0
    before = energy(net, state)
    kinetic, off, pressed = before.kinetic, 0.0, 0.0
    for _ in range(40):
        advance(net, state, name, 2e-6 if name == "symplectic_euler" else 2e-5, 1000 if name == "symplectic_euler"
                else 100, with_account=True)  # fmt: skip
        now = energy(net, state)
        kinetic, pressed = max(kinetic, now.kinetic), max(pressed, now.contact)
        off = max(off, abs(now.total - before.total + state.dissipated - state.work))
    assert pressed > 1e-3 * kinetic
    assert off < 1e-3 * kinetic


def matrix(net, part, x):
    """A part of the tangent over the mass (3 n, 3 n), column by column."""
    return products(x.reshape(-1).copy(), np.eye(x.size), 0.0, net.kernel_view(1.0), part)


@pytest.mark.parametrize("at", [(0.5, 0.5), (0.2, 0.9), (0.0, 0.4), (0.0, 1.0)])
def test_the_tangent_is_the_derivative_of_the_force(at):
    """Of links that cross askew: at inner places, at an end of one, and end on end."""
    net = crossed(0.015, at)
    x = net.x0[:, 0].T.copy()
    x[5] += (0.06, 0.0, -0.01)
    net = dataclasses.replace(net, x0=placed(x), contact=Contact(500.0, 7.0))
    assert energy(net, State.at_rest(net)).contact > 0.0
    flat, step = net.x0.reshape(-1), 1e-6
    found = [matrix(net, part, net.x0) for part in (STIFFNESS, DAMPING)]
    for j, u in enumerate(step * np.eye(flat.size)):
        ends = [accelerations(net, (flat + sign * u).reshape(net.x0.shape)).reshape(-1) for sign in (-1.0, 1.0)]
        assert found[0][j] == pytest.approx((ends[0] - ends[1]) / (2.0 * step), abs=2e-4)
        rates = [accelerations(net, net.x0, sign * u).reshape(-1) for sign in (-1.0, 1.0)]
        assert found[1][j] == pytest.approx((rates[0] - rates[1]) / (2.0 * step), abs=2e-4)


def test_the_stable_step_knows_the_contact():
    """Crossed links are an oscillator of k and m: leapfrog's limit is 2/omega; beyond it they fly apart."""
    net = crossed(0.02, contact=Contact(5e4, 0.0))
    limit = critical_step(net, "leapfrog")
    assert limit == pytest.approx(2.0 * math.sqrt(0.1 / 5e4), rel=1e-3)
    assert top_modes(net)[0].omega <= gershgorin(net, net.x0)[0]
    heap = tangled(contact=Contact(5e4, 0.0))
    assert critical_step(heap, "leapfrog") < 0.5 * critical_step(dataclasses.replace(heap, thickness=0.0), "leapfrog")
    assert top_modes(heap)[0].omega <= gershgorin(heap, heap.x0)[0]


def gaps(net, x):
    """{(i, j): distance} of all links without a common point, by the slow reference."""
    xs, found = x[:, 0].T, {}
    for i, j in itertools.combinations(range(len(xs) - 1), 2):
        if j - i >= 2:
            s, t = naive.nearest_places(xs[i], xs[i + 1], xs[j], xs[j + 1])
            found[i, j] = np.linalg.norm(xs[j] + t * (xs[j + 1] - xs[j]) - xs[i] - s * (xs[i + 1] - xs[i]))
    return found


def expected_pairs(net, x, reach):
    return [pair for pair, gap in gaps(net, x).items() if gap < reach]


@pytest.mark.parametrize("radius", [0.004, 0.02, 0.12])
def test_the_list_of_pairs_is_that_of_all_near_links(radius):
    """Thinner and thicker than its links are long; each pair once."""
    for seed in range(3):
        net = tangled(60, seed, radius=radius)
        p = net.kernel_view(1.0)
        find_pairs(net.x0.reshape(-1), p)
        found = sorted(map(tuple, p.pairs[: p.pairs[-1, 0]].tolist()))
        assert found == sorted(expected_pairs(net, net.x0, (1.0 + SKIN) * net.thickness))
        assert p.pairs[-1, 1] == -1
        least = min(gaps(net, net.x0).values())
        assert p.nearest[0] == pytest.approx(min(least, (1.0 + SKIN) * net.thickness), rel=1e-9)


def test_the_list_lasts_until_a_point_has_moved_by_half_the_skin():
    """Until then it has every pair that touches."""
    net, rng = tangled(60, 5), np.random.default_rng(1)
    p = net.kernel_view(1.0)
    margin = 0.5 * SKIN * net.thickness
    find_pairs(net.x0.reshape(-1), p)
    seen = p.seen.copy()
    for _ in range(20):
        way = rng.standard_normal((60, 3))
        x = net.x0 + placed(0.98 * margin * way / np.linalg.norm(way, axis=1)[:, None])
        x -= placed(np.tile((x - net.x0)[:, 0].mean(axis=1), (60, 1))) * 0.98
        refresh_pairs(x.reshape(-1), p)
        if (p.seen == seen).all():
            listed = set(map(tuple, p.pairs[: p.pairs[-1, 0]].tolist()))
            assert set(expected_pairs(net, x, net.thickness)) <= listed
    find_pairs(net.x0.reshape(-1), p)
    fallen = net.x0 + placed(np.tile((0.0, 0.0, -5.0), (60, 1)))
    refresh_pairs(fallen.reshape(-1), p)
    assert (p.seen == seen).all()  # all of it has moved alike
    far = net.x0.copy()
    far[0, 0, 7] += 1.1 * margin
    refresh_pairs(far.reshape(-1), p)
    assert (p.seen == far.reshape(-1)).all()


def test_a_heap_that_fills_the_list_is_reported():
    net = rope(80, 8.0, radius=0.01, self_contact=True, gravity=0.0, contact=Contact(1.0, 0.0))
    heap = np.ascontiguousarray(1e-3 * np.random.default_rng(1).random(net.x0.shape))
    net = dataclasses.replace(net, x0=heap)
    with pytest.warns(ApproximationWarning, match="self-contact left out"):
        assert simulate(net, duration=1e-5, frames=2, step=1e-5, integrator="leapfrog").left_out > 0


def test_a_rope_without_a_radius_has_nothing_that_touches():
    with pytest.raises(ValueError, match="self_contact: True is not allowed; allowed: False, as a rope of radius 0"):
        rope(self_contact=True)
    with pytest.raises(ValueError, match="self_contact"):
        rope(radius=0.1, self_contact=1)  # type: ignore[arg-type]
    assert rope(radius=0.1, self_contact=True).thickness == 0.2
    assert rope(radius=0.1).thickness == 0.0
