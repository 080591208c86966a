"""A cloth's edges and faces touch the sphere beside its points: forces, energy, and how deep a sphere comes."""

import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, cloth
from sim.springs.integrators.implicit.blocks import set_point_blocks
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.cells import faces
from sim.springs.points.face_places import face_reach
from sim.springs.stability import gershgorin, top_modes
from sim.springs.state import State, advance, energy, velocities
from tests import naive
from tests.sim.springs.nets import DAMPABLE, spread
from tests.sim.springs.reference import exact, integrated

CENTROID = np.full(3, 1 / 3)


def accelerations(net, x, v=None, t=0.0):
    a = np.empty(x.size)
    v = np.zeros(x.size) if v is None else v.reshape(-1).copy()
    set_acceleration(x.reshape(-1).copy(), v, t, net.kernel_view(1.0), a)
    return a.reshape(x.shape)


def points_alone(net):
    return dataclasses.replace(net, contact=net.contact._replace(links=False))


def cell(contact, parts, depth, radius=0.1, **more):
    """A free cell of 0.4 m without springs, level, on a sphere under a place of its first face; and the corners of it.

    parts (3,): of the corners. depth [m]: of the face, which touches a sphere that is smaller by a twentieth.
    """
    net = cloth(2, 2, 0.4, 0.4, 1.0, 0.0, 0.0, 0.0, 0.0, gravity=0.0, pinned="free", contact=contact)
    corners = faces(2, 2)[0]
    place = net.x0.reshape(3, -1)[:, corners] @ parts
    sphere = (*place[:2], depth - 0.95 * radius, radius)
    return dataclasses.replace(net, sphere=sphere, **more), corners


def deepest(net, x):
    """Largest depth [m] of a place of the cloth's faces in the sphere."""
    corners = x.reshape(3, -1).T[faces(*net.shape)] - np.array(net.sphere[:3])
    a, b, c = np.moveaxis(corners, 1, 0)

    def to_side(p, q):
        s = np.clip(-(p * (q - p)).sum(1) / ((q - p) ** 2).sum(1), 0.0, 1.0)
        return np.linalg.norm(p + s[:, None] * (q - p), axis=1)

    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    inside = np.all([(np.cross(q - p, -p) * normal).sum(1) >= 0.0 for p, q in ((a, b), (b, c), (c, a))], axis=0)
    sides = np.minimum(np.minimum(to_side(a, b), to_side(b, c)), to_side(c, a))
    return net.sphere[3] + net.radius - np.where(inside, np.abs((a * normal).sum(1)), sides).min()


@pytest.mark.parametrize("parts", [(0.5, 0.3, 0.2), CENTROID, (0.2, 0.6, 0.2)])
def test_a_face_is_pushed_at_the_place_that_touches(parts):
    """Half of k depth, shared by the place's parts of its corners; the fourth corner of the cell has none."""
    net, corners = cell(Contact(500.0, 0.0), np.array(parts), 0.01)
    force = (net.masses * accelerations(net, net.x0)).reshape(3, -1)
    expected = np.zeros((3, 4))
    expected[2, corners] = np.array(parts) * 0.5 * 500.0 * 0.01
    assert force == pytest.approx(expected, abs=1e-12)


def test_an_edge_is_pushed_as_stiffly_as_a_point():
    """Through both its faces, at the place of the diagonal over the sphere."""
    net, (_, b, c) = cell(Contact(500.0, 0.0), np.array((0.0, 0.3, 0.7)), 0.01)
    force = (net.masses * accelerations(net, net.x0)).reshape(3, -1)
    expected = np.zeros((3, 4))
    expected[2, [b, c]] = np.array((0.3, 0.7)) * 500.0 * 0.01
    assert force == pytest.approx(expected, abs=1e-12)


def test_without_faces_in_contact_and_with_the_lab_s_law_only_points_touch():
    net, _ = cell(Contact(500.0, 0.0), CENTROID, 0.01)
    for contact in (net.contact._replace(links=False), net.contact._replace(law="lab")):
        assert not accelerations(dataclasses.replace(net, contact=contact), net.x0).any()
    assert accelerations(net, net.x0).any()


def test_the_force_is_continuous_as_the_place_crosses_edges_and_corners():
    """The sphere moves under a crumpled cloth, up to 6 cm deep, along a line through faces, edges and a corner."""
    net = spread(Contact(500.0, 0.0, 0.0), sphere_velocity=(0.0, 0.0, 0.0), pinned=frozenset())
    middle = net.x0[:, 2, 2]
    ways = np.linspace(-0.4, 0.4, 4001)[:, None] * np.array((0.8, 0.6, 0.0))
    found = [
        net.masses * accelerations(dataclasses.replace(net, sphere=(*(middle + way + (0.0, 0.0, -0.25)), 0.3)), net.x0)
        for way in ways
    ]
    jumps = np.abs(np.diff(found, axis=0)).max()
    assert np.ptp(found, axis=0).max() > 30.0
    assert jumps < 0.6  # [N]: the sphere moves by 0.2 mm at a time, 0.1 N of its stiffness at up to 5 contacts a point


@pytest.mark.parametrize("seed", range(3))
def test_the_force_is_the_gradient_of_the_energy(seed):
    net = spread(Contact(900.0, 0.0), pinned=frozenset(), damping_model="isotropic")
    net = dataclasses.replace(net, drag=0.0, families=tuple(f._replace(damping=0.0) for f in net.families))
    x = net.x0 + 0.04 * np.random.default_rng(seed).standard_normal(net.x0.shape)

    def stored(y):
        state = State.at_rest(net)
        state.x[:] = y
        return energy(net, state).total

    gradient, step = np.zeros(x.size), 1e-6
    for i in range(x.size):
        way = np.zeros(x.size)
        way[i] = step
        way = way.reshape(x.shape)
        gradient[i] = (stored(x + way) - stored(x - way)) / (2.0 * step)
    force = net.masses * accelerations(net, x)
    touched = force - net.masses * accelerations(points_alone(net), x)
    assert np.abs(touched).max() > 5.0
    assert force.ravel() == pytest.approx(-gradient, abs=1e-6 * np.abs(gradient).max())


def test_one_long_cell_of_a_fine_cloth_is_not_overlooked():
    """Its corners are far from the sphere, and all other sides are as short as at rest."""
    net = cloth(8, 8, 0.7, 0.7, pinned="free", gravity=0.0, sphere=(0.0, 0.0, -0.07, 0.1))
    x = net.x0.copy()
    x[0, :, 4:] += 2.0
    x[1, 4:] += 2.0
    x[:2] -= (0.5 * (x[:2, 3, 3] + x[:2, 4, 4]))[:, None, None]
    reach = face_reach(x.reshape(-1), 0.0, net.kernel_view(1.0))
    assert np.linalg.norm(x - np.array(net.sphere[:3])[:, None, None], axis=0).min() > 1.0
    assert reach > np.linalg.norm(x[:, 3, 3] - np.array(net.sphere[:3])) ** 2
    springs = accelerations(points_alone(net), x)
    pushed = np.argwhere((accelerations(net, x) != springs).any(axis=0)).tolist()
    assert pushed == [[3, 3], [4, 4]] or pushed == [[3, 4], [4, 3]]
    assert face_reach(net.x0.reshape(-1).copy(), 0.0, dataclasses.replace(net, radius=1e-3).kernel_view(1.0)) > 0.0
    far = dataclasses.replace(net, sphere=(0.0, 0.0, -0.5, 0.1)).kernel_view(1.0)
    assert face_reach(net.x0.reshape(-1).copy(), 0.0, far) == 0.0


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_face_that_is_thrown_on_a_sphere_bounces_as_an_oscillator(name):
    """Hit at its centroid it stays level: three masses on half the stiffness, sin(omega t) for half a period."""
    net, corners = cell(Contact(500.0, 0.0), CENTROID, 0.0)
    mass, speed, record = float(net.masses[0, 0]), 0.5, INTEGRATORS[name]
    state = State.at_rest(net)
    state.v[2] = -speed
    omega = math.sqrt(0.5 * 500.0 / (3.0 * mass))
    quarter = 0.5 * math.pi / omega
    steps = 4000 if record.order < 2 else 1000
    advance(net, state, record, quarter / steps, steps)
    tolerance = {1: 1e-3, 2: 1e-5}.get(record.order, 1e-8) * speed / omega
    assert state.x.reshape(3, -1)[2, corners] == pytest.approx(-speed / omega, abs=tolerance)
    assert energy(net, state).contact == pytest.approx(0.5 * 3.0 * mass * speed**2, rel=1e-3)
    advance(net, state, record, quarter / steps, steps + 20)
    fourth = ({0, 1, 2, 3} - set(corners.tolist())).pop()
    v = velocities(net, state).reshape(3, -1)
    assert v[2, corners] == pytest.approx(speed, rel=1e-3)
    assert v[:, fourth] == pytest.approx((0.0, 0.0, -speed), abs=2e-6)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_smooth_sphere_turns_no_cloth_about_its_centre(name):
    """Its force points away from its centre: the cloth's angular momentum about it stays."""
    net, _ = cell(Contact(500.0, 0.0), np.array((0.5, 0.3, 0.2)), 0.0)
    state, record = State.at_rest(net), INTEGRATORS[name]
    state.v[2] = -0.5, -0.6
    state.v[0] = 0.2

    def spin():
        arms = state.x.reshape(3, -1).T - np.array(net.sphere[:3])
        momenta = (net.masses * velocities(net, state)).reshape(3, -1).T
        return np.cross(arms, momenta).sum(axis=0)

    before, stored, pressed = spin(), energy(net, state).total, 0.0
    for _ in range(40):
        advance(net, state, record, 1e-5 if record.order < 2 else 1e-4, 100 if record.order < 2 else 10)
        pressed = max(pressed, energy(net, state).contact)
    tolerance = 1e-9 if record.symplectic else {1: 1e-4, 2: 1e-5}.get(record.order, 1e-7)
    assert pressed > 0.05 * stored
    assert spin() == pytest.approx(before, abs=tolerance)


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_cloth_settles_on_a_sphere_between_its_points_where_no_force_is_left(name):
    rim = [(i, j) for i in range(4) for j in range(4) if i in (0, 3) or j in (0, 3)]
    net = cloth(
        4, 4, 0.6, 0.6, 1.0, 200.0, 100.0, 5.0, 0.5, 1.0, pinned=rim, sphere=(0.28, 0.29, 0.0, 0.06),
        contact=Contact(300.0, 2.0), radius=0.01,
    )  # fmt: skip
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], 5e-4, 12_000)
    xs = np.moveaxis(state.x, 0, -1)
    assert len(list(naive.face_touches(net, xs, 0.0 * xs, 0.0))) > 0
    assert np.abs(naive.acceleration(net, state.x, 0.0 * state.x)).max() < 1e-6


@pytest.mark.parametrize("damping", [0.0, 3.0])
def test_leapfrog_is_of_second_order_while_faces_touch(damping):
    net = spread(Contact(300.0, damping), pinned=frozenset(), damping_model="isotropic")
    v0 = 0.2 * np.random.default_rng(1).standard_normal(net.x0.shape)
    x, _ = exact(net, 0.02, v0)
    assert len(list(naive.face_touches(net, np.moveaxis(x, 0, -1), 0.0 * np.moveaxis(x, 0, -1), 0.02))) > 3
    errors = [np.abs(integrated(net, "leapfrog", 0.02, count, v0).x - x).max() for count in (20, 40, 80)]
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]


def test_the_blocks_of_an_implicit_step_resist_no_less_than_the_contacts():
    net, g = spread(Contact(900.0, 20.0), sphere_velocity=(0.0, 0.0, 0.0), pinned=frozenset()), 0.01
    count = net.x0[0].size

    def blocks(one):
        points, x = np.zeros(6 * count), one.x0.reshape(-1).copy()
        set_point_blocks(x, np.zeros_like(x), 0.0, g, one.kernel_view(1.0), points)
        xx, xy, xz, yy, yz, zz = points.reshape(6, count)
        dense = np.zeros((count, 3, count, 3))
        each = np.arange(count)
        dense[each, :, each] = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0)
        return dense.reshape(3 * count, -1)

    size, xs = g * 20.0 + g * g * 900.0, np.moveaxis(net.x0, 0, -1)
    expected = np.zeros((3 * count, 3 * count))
    for corners, parts, _, spring, _ in naive.face_touches(net, xs, 0.0 * xs, 0.0):
        rows = np.zeros((count, 3))
        rows[[i * net.shape[1] + j for i, j in corners]] = np.outer(parts, spring / np.linalg.norm(spring))
        expected += 0.5 * size * np.outer(rows, rows)
    over = blocks(net) - blocks(points_alone(net)) - expected
    assert np.linalg.eigvalsh(expected)[-1] > 0.5 * size
    assert np.linalg.eigvalsh(over)[0] > -1e-12
    assert np.trace(over) < 2.0 * np.trace(expected)


def test_gershgorin_bounds_a_point_that_is_pushed_through_all_its_faces():
    """Contact five times as stiff as that of the particle alone, at a point where eight triangles meet."""
    net = cloth(5, 5, 0.4, 0.4, stiffness=0.0, shear=0.0, bend=0.0, damping=0.0, pinned="free")
    x = net.x0.copy()
    x[2, 1, 2] -= 0.05
    net = dataclasses.replace(net, sphere=(*x[:2, 1, 2], x[2, 1, 2] - 0.09, 0.1), contact=Contact(500.0, 3.0))
    stiffest, most_damped, *_ = top_modes(net, x)
    assert stiffest.omega**2 == pytest.approx(5.0 * 500.0 / net.masses[1, 2], rel=1e-9)
    assert most_damped.rate == pytest.approx(5.0 * 3.0 / net.masses[1, 2], rel=1e-9)
    inner = dataclasses.replace(net, pinned=frozenset({(i, j) for i in range(5) for j in range(5)} - {(1, 2)}))
    assert gershgorin(inner) == pytest.approx((stiffest.omega, most_damped.rate), rel=1e-9)


def test_a_fine_cloth_rests_on_its_points_as_if_faces_did_not_touch():
    """Cells of 4 cm on a sphere of 0.4 m."""
    net = cloth(
        20, 20, 0.76, 0.76, 0.3, 800.0, 200.0, 3.0, 0.02, origin=(-0.38, -0.38, 0.412), pinned="free",
        sphere=(0.0, 0.0, 0.0, 0.4), contact=Contact(60.0, 0.1, 0.4), radius=0.012,
    )  # fmt: skip
    states = []
    for one in (net, points_alone(net)):
        state = State.at_rest(one)
        advance(one, state, INTEGRATORS["leapfrog"], 2.5e-4, 4000)
        states.append(state)
    assert (np.linalg.norm(states[0].x, axis=0) < 0.412).sum() > 20
    assert np.array_equal(states[0].x, states[1].x)


def thrown(seed):
    """A cloth of cells of 0.1 m above a small sphere, tilted and turned, thrown at it; and its velocities."""
    rng = np.random.default_rng(seed)
    radius = 0.02 * 10.0 ** rng.uniform()
    net = cloth(
        16, 16, 1.5, 1.5, 0.3, 800.0, 200.0, 6.0, 0.02, 0.005, origin=(-0.75, -0.75, 0.0), pinned="free",
        sphere=(0.0, 0.0, 0.0, radius), contact=Contact(1e4, 0.5, 0.3), radius=0.012,
    )  # fmt: skip
    x, y, _ = net.x0 + rng.uniform(-0.1, 0.1, 3)[:, None, None]
    turn = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi)) * (x + 1j * y)
    slope_x, slope_y = rng.uniform(-0.3, 0.3, 2)
    z = slope_x * turn.real + slope_y * turn.imag
    z += radius + 0.062 - z[np.abs(turn) < 0.4].min()
    net = dataclasses.replace(net, x0=np.ascontiguousarray([turn.real, turn.imag, z]))
    v = np.zeros_like(net.x0)
    v[2] = -rng.uniform(0.0, 3.0)
    return net, v


@pytest.mark.parametrize("seed", range(6))
def test_a_small_sphere_comes_no_deeper_into_a_cloth_that_falls_on_it_than_a_quarter_of_its_radius(seed):
    """It does not pass between points, where it passes a cloth whose points alone touch."""
    net, v = thrown(seed)
    state, depth = State.at_rest(net), 0.0
    state.v[:] = v
    for _ in range(500):
        advance(net, state, INTEGRATORS["leapfrog"], 1e-4, 15)
        depth = max(depth, deepest(net, state.x))
    assert 0.0 < depth < 0.25 * (net.sphere[3] + net.radius)
    assert np.abs(state.x[:, 7:9, 7:9].mean(axis=(1, 2))).max() < 0.5  # it lies on the sphere


def test_points_alone_let_a_small_sphere_through():
    net, v = thrown(2)
    state = State.at_rest(net)
    state.v[:] = v
    advance(points_alone(net), state, INTEGRATORS["leapfrog"], 1e-4, 10_000)
    assert state.x[2].max() < -0.5


@pytest.mark.parametrize("seed", range(3))
def test_the_account_of_a_falling_cloth_closes(seed):
    """To a thousandth of its largest kinetic energy, without friction."""
    net, v = thrown(seed)
    net = dataclasses.replace(net, contact=net.contact._replace(friction=0.0), sphere_velocity=(0.2, 0.0, 0.1))
    state = State.at_rest(net)
    state.v[:] = v
    before, off = energy(net, state), 0.0
    kinetic, pressed = before.kinetic, 0.0
    for _ in range(100):
        advance(net, state, INTEGRATORS["leapfrog"], 1e-4, 40, with_account=True)
        now = energy(net, state)
        kinetic, pressed = max(kinetic, now.kinetic), max(pressed, now.contact)
        off = max(off, abs(now.total - before.total + state.dissipated - state.work))
    assert pressed > 1e-3 * kinetic
    assert off < 1e-3 * kinetic
