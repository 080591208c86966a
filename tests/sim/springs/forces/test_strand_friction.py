"""Coulomb's law between strands: what can rest rests, what slides has mu N, and a strand over another is a capstan."""

import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, PinPath, rope
from sim.springs.forces.strand_friction import FORCE_AT
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.link_pairs import opening_of, pair_at
from sim.springs.state import State, advance
from tests.sim.springs.forces.test_strand_contact import accelerations, placed, tangled
from tests.sim.springs.nets import DAMPABLE

G = 9.81  # [m/s^2]
FRICTION = 0.4
STIFFNESS, RADIUS, LOAD = 4000.0, 0.03, 0.1  # [N/m], [m], [kg] of each end of a bar


def rails(bar, count=1, gravity=(0.0, 0.0, -G), friction=FRICTION):
    """Pinned links of 8 m along x, side by side about y = 0, and across them a bar with ends (2, 3), all one chain
    whose links do not pull."""
    x = []
    for number in range(count):
        y = 0.3 * (number - 0.5 * (count - 1))
        x += [(-4.0, y, 0.0), (4.0, y, 0.0), (9.0, y, -5.0 - number), (-9.0, y, -5.0 - number)]
    pinned = frozenset((0, j) for j in range(len(x)))
    x += list(bar)
    net = rope(len(x), 0.4 * (len(x) - 1), LOAD, 0.0, 0.0, 0.0, 0.0, contact=Contact(STIFFNESS, 20.0, friction),
               radius=RADIUS, self_contact=True)  # fmt: skip
    return dataclasses.replace(net, x0=placed(x), pinned=pinned, gravity=gravity)


def bar_at_rest(count):
    """Ends of a bar that lies on rails: each bears its share of 2 LOAD."""
    high = 2.0 * RADIUS - 2.0 * LOAD * G / count / STIFFNESS
    return [(0.0, -0.3, high), (0.0, 0.3, high)]


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_thrown_bar_stops_after_its_way(name):
    """v^2 / (2 mu g), with an error of first order in the step, and then rests."""
    net, errors = rails(bar_at_rest(1)), []
    for h in (1 / 480, 1 / 1920):
        state = State.at_rest(net)
        state.v[0, 0, -2:] = 2.0
        advance(net, state, INTEGRATORS[name], h, round(0.8 / h))
        way = state.x[0, 0, -2:].copy()
        errors.append(abs(way / (2.0**2 / (2.0 * FRICTION * G)) - 1.0).max())
        advance(net, state, INTEGRATORS[name], h, round(1.0 / h))
        assert state.x[0, 0, -2:] == pytest.approx(way, abs=1e-9)
    assert errors[0] < 0.02
    assert errors[1] < max(0.3 * errors[0], 1e-4)


@pytest.mark.parametrize("name", DAMPABLE)
@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize(("pull", "slides"), [(0.39, 0.0), (0.5, 0.1)])
def test_a_pull_above_mu_n_moves_a_bar_and_one_below_does_not(name, count, pull, slides):
    """On rails that slope: a = g (sin alpha - mu cos alpha), or none; here by gravity (pull, 0, -1) g."""
    net = rails(bar_at_rest(count), count, (pull * G, 0.0, -G))
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], 1e-3, 1000)
    assert state.x[0, 0, -2:] == pytest.approx(0.5 * slides * G, rel=3e-3, abs=1e-8)


@pytest.mark.parametrize(("name", "h"), [("leapfrog", 1e-3), ("implicit_euler", 1 / 60), ("tr_bdf2", 1 / 60)])
def test_a_bar_rests_for_a_minute_on_two_rails(name, h):
    """Also one that bears more on one end than on the other, and lies askew."""
    low = 2.0 * RADIUS - 2.0 * LOAD * G / STIFFNESS
    net = rails([(0.1, -0.35, low), (-0.1, 0.2, low)], 2, (0.25 * G, 0.1 * G, -G))
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], h, round(3.0 / h))
    start = state.x.copy()
    advance(net, state, INTEGRATORS[name], h, round(60.0 / h))
    assert np.abs(state.x - start).max() < 1e-6


def touching(net, v):
    """(pair, mu N) of each touching pair of links, by all pairs."""
    x, n = net.x0.reshape(-1).copy(), net.shape[1]
    for a in range(n - 1):
        for b in range(a + 2, n - 1):
            pair = pair_at(x, n, a, b)
            depth = net.thickness - pair.distance
            if depth > 0.0 and (b - a - 1) * net.families[0].rest >= 0.5 * math.pi * net.thickness:
                opening = np.dot(opening_of(v.reshape(-1), n, pair), (pair.nx, pair.ny, pair.nz))
                push = max(0.0, net.contact.stiffness * depth - net.contact.damping * opening)
                yield pair, net.contact.friction * push


def shares(pair):
    """(point, share of a force on the second link) of a pair."""
    return (pair.a, pair.s - 1.0), (pair.a + 1, -pair.s), (pair.b, 1.0 - pair.t), (pair.b + 1, pair.t)


@pytest.mark.parametrize("speed", [0.0, 0.02, 3.0])
def test_in_a_heap_every_touching_pair_obeys_coulomb(speed):
    """Friction is a sum of tangential forces of at most mu N on the pairs. Where one is less, the places stop within
    the step; where one slides fast, it is against the motion."""
    h = 0.01
    for seed in range(4):
        net = tangled(seed=seed, contact=Contact(500.0, 3.0, 0.5))
        n = net.shape[1]
        v = speed * np.random.default_rng(seed).standard_normal(net.x0.shape)
        v[:, 0, 0] = 0.0
        view, a = net.kernel_view(h), np.empty(net.x0.size)
        set_acceleration(net.x0.reshape(-1).copy(), v.reshape(-1).copy(), 0.0, view, a)
        smooth = dataclasses.replace(net, contact=net.contact._replace(friction=0.0))
        left = a.reshape(net.x0.shape) - accelerations(smooth, net.x0, v)
        pairs = list(touching(net, v))
        assert len(pairs) > 3
        assert [(pair.a, pair.b) for pair, _ in pairs] == sorted(map(tuple, view.touching[: len(pairs)].tolist()))
        rubs = {tuple(ends): row for ends, row in zip(view.touching.tolist(), view.rubs[: len(pairs)], strict=False)}
        for pair, most in pairs:
            force, normal = rubs[pair.a, pair.b][FORCE_AT : FORCE_AT + 3], np.array([pair.nx, pair.ny, pair.nz])
            mobility = 0.0
            for j, share in shares(pair):
                left[:, 0, j] -= share * net.inverse_masses()[j] * force
                mobility += share**2 * net.inverse_masses()[j]
            slip = np.array(opening_of(v.reshape(-1), n, pair)) / h
            stopped = slip + opening_of(a, n, pair)
            slip, stopped = slip - slip @ normal * normal, stopped - stopped @ normal * normal
            assert abs(force @ normal) < 1e-9
            assert np.linalg.norm(force) <= most * (1.0 + 1e-9)
            if np.linalg.norm(force) < 0.999 * most:
                assert np.linalg.norm(stopped) < 1e-4 * mobility * most
            elif np.linalg.norm(slip) > 2.0 * mobility * most:  # it slides on
                assert force == pytest.approx(-most / np.linalg.norm(slip) * slip, rel=1e-6, abs=1e-9)
        assert np.abs(left).max() < 1e-9 * np.abs(a).max()


@pytest.mark.parametrize("name", ["leapfrog", "tr_bdf2"])
def test_a_heap_moves_the_same_however_its_steps_are_shared_among_calls_and_copies(name):
    """The friction of the last step is part of the state."""
    net = tangled(seed=1, contact=Contact(500.0, 3.0, 0.5))
    once, often = State.at_rest(net), State.at_rest(net)
    advance(net, once, name, 1e-3, 15)
    for _ in range(5):
        advance(net, often, name, 1e-3, 3)
        often = often.copy()
    assert len(once.rubs) > 3
    assert np.abs(often.x - once.x).max() < 1e-14
    assert np.abs(often.rubs - once.rubs).max() < 1e-9 * np.abs(once.rubs[:, 2:]).max()


def tensions(net, state):
    """(points - 1,) [N] of the links, by their lengths."""
    lengths = np.linalg.norm(np.diff(state.x[:, 0], axis=1), axis=0)
    return net.families[0].stiffness * (lengths - net.families[0].rest)


def over_a_strand(friction, speed):
    """A light rope half around a pinned strand of its own radius: a pin pulls one end down, a weight of 1 kg hangs from
    the other, as stretched as it bears. Returns the net and the number of its pins."""
    r, rest, stiffness = 0.04, 0.01, 2e4
    spacing = rest + G / stiffness
    turn = np.arange(math.floor(math.pi * r / spacing) + 1) * spacing / r
    down = np.arange(1, 26) * spacing
    path = [(r, 0.0, -z) for z in down[::-1]] + [(r * math.cos(a), 0.0, r * math.sin(a)) for a in turn]
    path += [(-r, 0.0, (math.pi - turn[-1]) * r - z) for z in down]
    x = [(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (2.0, 1.0, 0.0), (2.0, 0.0, -1.0), *path]
    mass = [*[1e-4] * (len(x) - 1), 1.0]
    net = rope(len(x), rest * (len(x) - 1), mass, stiffness, 0.3, 0.0, G, contact=Contact(2e4, 1.0, friction),
               radius=r / 2.0, self_contact=True)  # fmt: skip
    pin = PinPath(0.0, (path[0], (0.0, 0.0, -speed), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    pinned = frozenset((0, j) for j in range(5))
    return dataclasses.replace(net, x0=placed(x), pinned=pinned, pin_paths=(((0, 4), pin),)), len(pinned)


@pytest.mark.parametrize(
    "friction", [0.4, pytest.param(0.0, marks=pytest.mark.long), pytest.param(0.2, marks=pytest.mark.long)]
)
def test_a_strand_that_slips_over_another_has_the_tensions_of_the_capstan(friction):
    """exp(mu theta) on half a turn, on a polygon of 12 links, to 1.5 %."""
    net, first = over_a_strand(friction, 0.03)
    state, pulls = State.at_rest(net), []
    advance(net, state, "leapfrog", 2e-5, 100_000)
    for _ in range(70):  # four swings of the weight
        advance(net, state, "leapfrog", 2e-5, 1000)
        tension = tensions(net, state)
        pulls.append((tension[first + 2], tension[-2]))
    high, low = np.mean(pulls, axis=0)
    assert high / low == pytest.approx(math.exp(friction * math.pi), rel=0.015)
