"""No strand of a rope passes another in a step, however long or fast the step is: by a slow look at each step."""

import dataclasses
import itertools

import numpy as np
import pytest

from benchmarks.knots import determinant, least_distance
from sim.springs import INTEGRATORS, Contact, Grab, rope, simulate
from sim.springs.kicks.apart import LEAST, NEAREST
from sim.springs.state import State, advance, energy
from sim.validation import ApproximationWarning
from tests.sim.springs.kicks.knots import DETERMINANTS, knotted_rope, pulled, spaced


def volume(a, b, c):
    return float(np.dot(a, np.cross(b, c)))


def crossings(before, after):
    """Pairs of links without a common point that cross in a straight motion from before to after (n, 3).

    Two links are in one plane where the volume between their ends, a cubic in time, vanishes.
    """
    found = []
    for i, j in itertools.combinations(range(len(before) - 1), 2):
        if j - i < 2:
            continue
        ends = [i, i + 1, j, j + 1]
        starts, ways = before[ends], after[ends] - before[ends]
        a, b = starts[1:] - starts[0], ways[1:] - ways[0]
        cubic = [
            volume(*b),
            volume(a[0], b[1], b[2]) + volume(b[0], a[1], b[2]) + volume(b[0], b[1], a[2]),
            volume(b[0], a[1], a[2]) + volume(a[0], b[1], a[2]) + volume(a[0], a[1], b[2]),
            volume(*a),
        ]
        for time in np.roots(cubic):
            if abs(time.imag) < 1e-9 and 0.0 <= time.real <= 1.0:
                p, q, r, s = starts + time.real * ways
                parts = np.linalg.lstsq(np.column_stack([q - p, r - s]), r - p)[0]
                if (parts >= 0.0).all() and (parts <= 1.0).all():
                    found.append((i, j, time.real))
    return found


def wild(seed, radius=0.02):
    """A soft rope of 20 links in a heap, and velocities of 5 m/s and more in all directions."""
    rng = np.random.default_rng(seed)
    net = rope(20, 1.9, 0.1, 50.0, 0.3, 0.0, 0.0, contact=Contact(300.0, 1.0), radius=radius, self_contact=True)
    way = rng.standard_normal((19, 3))
    way *= 0.1 / np.linalg.norm(way, axis=1)[:, None]
    x = np.zeros((20, 3))
    for j in range(19):
        x[j + 1] = 0.85 * x[j] + way[j]
    net = dataclasses.replace(net, x0=np.ascontiguousarray(x.T[:, None]), pinned=frozenset())
    return net, 5.0 * rng.standard_normal(net.x0.shape)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "leapfrog" else pytest.mark.long) for name in INTEGRATORS]
)
@pytest.mark.parametrize("step", [1 / 60, 1 / 300])
def test_no_link_passes_another_in_a_heap_that_is_torn_about(name, step):
    """In 40 steps, each looked at; without contact with itself links pass."""
    passed = 0
    for seed in range(2):
        net, v = wild(seed)
        if INTEGRATORS[name].undamped_only:
            link = net.families[0]._replace(damping=0.0)
            net = dataclasses.replace(net, families=(link,), contact=Contact(300.0, 0.0))
        for one in (net, dataclasses.replace(net, thickness=0.0)):
            state = State.at_rest(one)
            state.v[:] = v
            for _ in range(40):
                before = state.x[:, 0].T.copy()
                advance(one, state, name, step, 1)
                if one is net:
                    assert crossings(before, state.x[:, 0].T) == []
                else:
                    passed += len(crossings(before, state.x[:, 0].T))
    assert passed > 10


@pytest.mark.parametrize("step", [1 / 60, 1 / 480])
@pytest.mark.parametrize("speed", [2.0, 20.0, 200.0])
def test_a_link_thrown_at_another_stays_on_its_side(speed, step):
    """At up to 50 times the thickness in a step. Momentum stays, and the account has what the stop took."""
    net = rope(6, 2.0, 0.1, 0.0, 0.0, 0.0, 0.0, contact=Contact(20.0, 0.0), radius=0.03, self_contact=True)
    x = [(-0.2, 0.0, 0.0), (0.2, 0.0, 0.0), (3.0, 0.5, 1.0), (3.0, 0.5, 2.0), (0.0, -0.2, 0.3), (0.0, 0.2, 0.3)]
    net = dataclasses.replace(net, x0=np.ascontiguousarray(np.array(x).T[:, None]), pinned=frozenset())
    state = State.at_rest(net)
    state.v[2, 0, 4:] = -speed
    before, least = energy(net, state).total, np.inf
    for _ in range(round(1.0 / (speed * step)) + 30):
        advance(net, state, "leapfrog", step, 1, with_account=True)
        high = state.x[2, 0]
        least = min(least, 0.5 * (high[4] + high[5] - high[0] - high[1]))
    assert least > 0.9 * LEAST * net.thickness
    assert state.v[2, 0].sum() == pytest.approx(-2.0 * speed, rel=1e-12)
    after = energy(net, state).total
    assert after <= before
    assert after + state.dissipated == pytest.approx(before, rel=0.05)


def test_slow_contact_is_left_to_its_force():
    """The account of a heap that moves gently closes as that of the force alone does."""
    net, v = wild(3)
    net = dataclasses.replace(net, contact=Contact(3000.0, 2.0))
    run = simulate(net, 0.2, 3, 1e-4, "leapfrog", v=0.02 * v[:, 0].T, with_account=True)
    assert run.energy.contact.max() > 0.0
    assert run.unsettled == 0
    assert np.abs(run.energy.error).max() < 1e-3 * run.energy.contact.max()


@pytest.mark.parametrize("name", DETERMINANTS)
def test_the_determinant_of_a_knot_does_not_depend_on_its_polygon(name):
    """Turned, reversed, mirrored and finer it is the same; of a curve without a knot it is 1."""
    rope_points = knotted_rope(name).x0[:, 0].T
    turns = [np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))[0] for seed in range(20)]
    for points in (rope_points[::-1], rope_points * (1.0, 1.0, -1.0), *(rope_points @ turn for turn in turns)):
        assert determinant(points) == DETERMINANTS[name]
    assert determinant(spaced(rope_points, 400)[0]) == DETERMINANTS[name]
    wave = np.linspace(0.0, 9.0, 60)
    assert determinant(np.column_stack([wave, np.sin(3.0 * wave), np.cos(2.0 * wave)])) == 1


def test_without_contact_with_itself_a_knot_is_lost_at_once():
    loose = dataclasses.replace(knotted_rope("trefoil"), thickness=0.0)
    *_, state = pulled(loose, 1, 0.5, 1 / 1000)
    assert determinant(state.x[:, 0].T) == 1


@pytest.mark.parametrize("name", DETERMINANTS)
@pytest.mark.parametrize(("seconds", "runs"), [(2.0, 1), pytest.param(60.0, 100, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("method", "step"), [
    ("leapfrog", 1 / 1000), ("tr_bdf2", 1 / 50), ("implicit_euler", 1 / 50),
    pytest.param("tr_bdf2", 1 / 500, marks=pytest.mark.long),
    pytest.param("implicit_midpoint", 1 / 100, marks=pytest.mark.long),
])  # fmt: skip
def test_a_knot_stays_a_knot_while_a_hand_pulls_at_it(name, seconds, runs, method, step):
    """At 10 m/s, in random directions, at random points; looked at ten times a second."""
    for seed in range(runs):
        for state in pulled(knotted_rope(name), seed, seconds, step, method):
            assert determinant(state.x[:, 0].T) == DETERMINANTS[name]


@pytest.mark.parametrize("stiffness", [200.0, 1000.0])
def test_strands_that_a_pull_presses_together_keep_a_distance(stiffness):
    """A pull above what their contact can hold at any depth: without a least distance they come to within round-off."""
    net = knotted_rope("trefoil", tail=1.5, gravity=(0.0, 0.0, 0.0))
    link = net.families[0]._replace(stiffness=5000.0, damping=1.0)
    end = net.shape[1] - 1
    hand = Grab(0, end, tuple(5.0 * net.x0[:, 0, end]), 2000.0, 1.0, 50.0)
    net = dataclasses.replace(
        net, families=(link,), contact=Contact(stiffness, 1.0), grab=hand, pinned=frozenset({(0, 0)})
    )
    state = State.at_rest(net)
    for _ in range(4):
        advance(net, state, "leapfrog", 1 / 2000, 1000)
        assert least_distance(state.x[:, 0].T, 4) > 0.9 * NEAREST * LEAST * net.thickness
    assert least_distance(state.x[:, 0].T, 4) < LEAST * net.thickness
    assert determinant(state.x[:, 0].T) == 3


def test_a_run_says_that_strands_were_slowed_down():
    """Of a heap that is torn about in long steps; not of a gentle one."""
    net, v = wild(0, radius=0.045)
    with pytest.warns(ApproximationWarning, match="strands that touch were slowed down in [0-9]+ steps"):
        simulate(net, 0.5, 3, 1 / 30, "symplectic_euler", v=v[:, 0].T)


def test_a_run_in_steps_of_its_own_says_so_too():
    net, v = wild(0, radius=0.045)
    with pytest.warns(ApproximationWarning, match="strands that touch were slowed down in 1 step, as"):
        run = simulate(net, 0.5, 3, integrator="dopri5", rtol=1e-2, atol=1e-2, v=v[:, 0].T)
    assert run.slowed == run.state.slowed == 1
    assert run.unsettled == 0
