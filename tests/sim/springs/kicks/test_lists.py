"""Lists of near parts over calls: a cancelled solve leaves none, and a change of positions from outside is noticed."""

import contextlib
import dataclasses

import numpy as np
import pytest

from sim.interruption import STOP, TURN, InterruptionError, stop_request, use_request
from sim.springs import Contact, State, advance, rope
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.near.near_cells import fill_far, fill_neighbours
from sim.springs.near.near_pairs import LOOKS_UNASKED, UNASKED, find_pairs, refresh_pairs
from sim.springs.near.windows import BLOCK
from tests.sim.springs.kicks.cloths import all_crossings, thrown_layers
from tests.sim.springs.kicks.test_apart import crossings
from tests.sim.springs.kicks.test_near_cells import crumpled

STEP = 1 / 300


@contextlib.contextmanager
def counted_looks(cancelling=0):
    """A list of the looks at this thread's request; the look of that number, from 1 on, cancels."""
    before, request, looks = stop_request(), np.zeros(4, np.int64), []

    def look():
        looks.append(len(looks) + 1)
        request[STOP] |= len(looks) == cancelling
        request[TURN] = 1

    request[TURN] = 1
    use_request(request, look)
    try:
        yield looks
    finally:
        use_request(before)


def thrown_rope():
    """A soft rope whose first link lies 0.3 m below its last one, which is thrown at it."""
    net = rope(6, 2.0, 0.1, 0.0, 0.0, 0.0, 0.0, contact=Contact(20.0, 0.0), radius=0.03, self_contact=True)
    x = [(-0.2, 0.0, 0.0), (0.2, 0.0, 0.0), (3.0, 0.5, 1.0), (3.0, 0.5, 2.0), (0.0, -0.2, 0.3), (0.0, 0.2, 0.3)]
    net = dataclasses.replace(net, x0=np.ascontiguousarray(np.array(x).T[:, None]), pinned=frozenset())
    v = np.zeros_like(net.x0)
    v[2, 0, 4:] = -50.0
    return net, v


NETS = {"cloth": lambda: thrown_layers(3, 0.6, 10.0), "rope": thrown_rope}


def heap(points):
    """A rope in a ball, each link near to many others."""
    rng = np.random.default_rng(0)
    net = rope(points, 1.0, 0.1, 1.0, 0.0, 0.0, 0.0, contact=Contact(1.0, 0.0), radius=0.05, self_contact=True)
    return dataclasses.replace(net, x0=0.1 * rng.standard_normal(net.x0.shape), pinned=frozenset())


def all_near(x, p):
    return fill_far(x, x, p, 0.1)


def all_neighbours(x, p):
    return fill_neighbours(x, x, p, 0.04, 0.06)


@pytest.mark.parametrize(
    ("search", "net", "least_looks"),
    [
        (all_near, crumpled(14, 6, 0.2), 4 * 2),  # one a block
        (all_neighbours, crumpled(14, 6, 0.2), 14),  # one a row
        (find_pairs, crumpled(14, 6, 0.2), 14 * 6 // (UNASKED + BLOCK**2)),
        (find_pairs, heap(300), 299 // (UNASKED + BLOCK)),
    ],
)
def test_a_search_that_is_cancelled_lists_nothing(search, net, least_looks):
    """At each of its looks at the request."""
    x, rows = net.x0.reshape(-1), "pairs" if search is find_pairs else "near"
    with counted_looks() as looks:
        p = net.kernel_view(1.0)
        search(x, p)
    assert getattr(p, rows)[-1, 0] > 20
    assert len(looks) >= least_looks
    for number in looks:
        with counted_looks(number):
            p = net.kernel_view(1.0)
            search(x, p)
        assert getattr(p, rows)[-1, 0] == 0
        if rows == "near":
            assert p.near[-1, 1] == 0
        else:
            assert p.nearest[0] == 0.0


def test_long_loops_over_pairs_look_at_the_request():
    net = heap(300)
    x = net.x0.reshape(-1)
    with counted_looks(1):
        p = net.kernel_view(1.0)
        assert refresh_pairs(x, p) == 0
    with counted_looks() as looks:
        p = net.kernel_view(1.0)
        count = refresh_pairs(x, p)
        assert count > 1000
        looks.clear()
        for _ in range(LOOKS_UNASKED // count):
            assert refresh_pairs(x, p) == count
    assert looks == [1]
    with counted_looks(1):
        q = net.kernel_view(1.0)._replace(pairs=p.pairs, seen=p.seen, nearest=p.nearest)
        q.looks[0] = LOOKS_UNASKED
        assert refresh_pairs(x, q) == 0


def test_a_cancelled_step_parts_nothing():
    """Else a cancelled solve would take as long as all sweeps of its last call. The list of pairs is there."""
    net, v = thrown_rope()
    x, v, ledger = net.x0.reshape(-1).copy(), v.reshape(-1), np.zeros(3)
    x[-2:] = 0.03
    moved = x.copy()
    moved[-2:] -= 0.02
    p = net.kernel_view(STEP)
    remember_places(x, p, True)
    assert keep_apart(moved.copy(), v.copy(), 0.0, p, False, ledger)
    assert p.pairs[-1, 0] == 1
    with counted_looks(1) as looks:
        y = moved.copy()
        assert not keep_apart(y, v.copy(), 0.0, p._replace(stop=stop_request()), False, ledger)
    assert np.array_equal(y, moved)
    assert looks == [1]


@pytest.mark.parametrize("kind", NETS)
def test_lists_of_a_cancelled_solve_are_not_used(kind):
    """At each of its looks: the state stays, and the same call made again is bitwise the one without."""
    net, v = NETS[kind]()
    start = State.at_rest(net)
    start.v[:] = v
    expected = start.copy()
    advance(net, expected, "leapfrog", STEP, 8)
    cancelled, ended = 0, False
    while not ended:
        state = start.copy()
        advance(net, state, "leapfrog", STEP, 2)
        assert state.lists is not None
        before = state.copy()
        with counted_looks(cancelled + 1) as looks, contextlib.suppress(InterruptionError):
            advance(net, state, "leapfrog", STEP, 6)
        ended = len(looks) <= cancelled
        if not ended:
            assert np.array_equal(state.x, before.x)
            assert np.array_equal(state.v, before.v)
            assert state.t == before.t
            advance(net, state, "leapfrog", STEP, 6)
            cancelled += 1
        assert np.array_equal(state.x, expected.x)
        assert np.array_equal(state.v, expected.v)
    assert cancelled >= 10


@pytest.mark.parametrize("kind", NETS)
def test_parts_that_are_moved_between_two_calls_and_thrown_back_do_not_pass(kind):
    """At the end of the next step they would be where the list was made, and only its start tells that they moved."""
    net, _ = NETS[kind]()
    state = State.at_rest(net)
    advance(net, state, "leapfrog", STEP, 1)
    before = state.x.copy()
    part = (slice(None), slice(6, 12)) if kind == "cloth" else (slice(None), slice(None), slice(4, 6))
    state.x[part][2] -= 0.6
    state.v[part][2] = 0.6 / STEP
    below, fresh = state.x.copy(), state.copy()
    for each in (state, fresh):
        advance(net, each, "leapfrog", STEP, 1)
    assert np.abs(state.x - before).max() > 0.1  # they are held below
    if kind == "cloth":
        assert len(all_crossings(below, before, *net.shape)) > 10
        assert all_crossings(below, state.x, *net.shape) == []
    else:
        assert crossings(below[:, 0].T, before[:, 0].T) != []
        assert crossings(below[:, 0].T, state.x[:, 0].T) == []
    assert np.array_equal(state.x, fresh.x)
    assert np.array_equal(state.v, fresh.v)
