import dataclasses
import itertools

import numpy as np
import pytest

from sim.jit import kernel
from sim.springs import INTEGRATORS, Air, Contact, Grab, PinPath, State, advance, cloth, rope
from sim.springs.damping import damp_motion, damp_others, make_decay
from sim.springs.points.acceleration import accelerate, make_scratch, set_acceleration
from sim.springs.state import energy
from tests import naive
from tests.sim.springs.nets import KNIGHT, draped, hairpin, patch, spread, touching_patch


@kernel
def set_undamped(x, v, t, p, a):
    accelerate(x, v, t, p, False, make_scratch(p), a)


@kernel
def damp_for(x, v, t, s, p, reverse):
    damp_motion(x, v, s, make_decay(p, s), p, reverse)
    damp_others(x, v, t, s, p, reverse)


def shaken(net, seed=1):
    """Positions and velocities off any symmetry."""
    rng = np.random.default_rng(seed)
    v = rng.standard_normal(net.x0.shape)
    for i, j in net.pinned:
        v[:, i, j] = 0.0
    return net.x0 + 0.05 * rng.standard_normal(net.x0.shape), v


def ours(net, x, v, t, h, function=set_acceleration):
    a = np.full(net.x0.size, np.nan)
    function(x.reshape(-1).copy(), v.reshape(-1).copy(), t, net.kernel_view(h), a)
    return a.reshape(net.x0.shape)


def agrees(net, x, v, t=0.3, h=0.01):
    expected = naive.acceleration(net, x, v, t, h)
    assert np.abs(ours(net, x, v, t, h) - expected).max() <= 1e-12 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("points", [1, 2, 3, 7, 64])
def test_a_rope_s_forces_are_the_formulas(points, model):
    net = rope(points, damping_model=model, end=None)
    agrees(net, *shaken(net))
    agrees(dataclasses.replace(net, gravity=(1.0, -2.0, 3.0)), *shaken(net))
    agrees(dataclasses.replace(net, families=(net.families[0]._replace(damping=0.0),)), *shaken(net))


@pytest.mark.parametrize("law", ["clipped", "lab"])
@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("shape", [(1, 9), (3, 4), (5, 3), (2, 2), (6, 1)])
def test_a_net_s_forces_are_the_formulas(shape, model, law):
    rows, cols = shape
    contact = Contact(900.0, 20.0, 0.4, law)
    grab = Grab(rows - 1, cols - 1, (1.0, 1.0, 1.0), 200.0, 5.0, 30.0)
    cloth = dataclasses.replace(touching_patch(model, contact, rows=rows, cols=cols), grab=grab, radius=0.02)
    for net in (cloth, dataclasses.replace(cloth, families=(*cloth.families, KNIGHT))):
        for seed in range(3):
            x, v = shaken(net, seed)
            agrees(net, x, v)
            agrees(net, x, 30.0 * v)


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("floor", [None, 0.1])
def test_forces_on_links_that_touch_the_sphere_are_the_formulas(floor, friction):
    net = draped(Contact(900.0, 20.0, friction), floor=floor)
    for seed in range(5):
        x, v = shaken(net, seed)
        places = list(naive.link_touches(net, x[:, 0].T[None], v[:, 0].T[None], 0.3))
        assert {0.0 < s < 1.0 for *_, s, _, _, _ in places} == {False, True} or seed
        agrees(net, x, v)
        agrees(net, x, 30.0 * v)


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("floor", [None, 0.1])
def test_forces_on_faces_that_touch_the_sphere_are_the_formulas(floor, friction):
    """At corners, sides and insides of faces, some of whose corners touch it themselves."""
    net = spread(Contact(900.0, 20.0, friction), floor=floor)
    for seed in range(5):
        x, v = shaken(net, seed)
        xs, vs = np.moveaxis(x, 0, -1), np.moveaxis(v, 0, -1)
        shared = {int((parts > 1e-14).sum()) for _, parts, *_ in naive.face_touches(net, xs, vs, 0.3)}
        assert shared == {1, 2, 3} or seed
        for one in (net, dataclasses.replace(net, families=(*net.families, KNIGHT))):
            agrees(one, x, v)
            agrees(one, x, 30.0 * v)


@pytest.mark.parametrize("max_force", [1.0, 1e6])
def test_the_grab_pulls_at_most_its_cap(max_force):
    net = dataclasses.replace(rope(5), grab=Grab(0, 3, (1.0, 2.0, 3.0), 500.0, 3.0, max_force))
    agrees(net, *shaken(net))


def test_without_damping_no_force_depends_on_the_velocity():
    net = touching_patch("isotropic", Contact(900.0, 20.0, 0.4))
    x, v = shaken(net)
    smooth = net.contact._replace(friction=0.0)  # friction holds against the other forces, also at rest
    still = dataclasses.replace(net, contact=smooth, sphere_velocity=(0.0, 0.0, 0.0), sphere=(0.36, 0.36, -0.93, 1.0))
    # The sphere is at that place at t = 0.1.
    assert ours(net, x, v, 0.1, 0.01, set_undamped) == pytest.approx(
        naive.acceleration(still, x, 0.0 * v), rel=1e-12, abs=1e-10
    )


def test_pinned_particles_have_no_acceleration():
    net = dataclasses.replace(patch(), pinned=frozenset({(0, 0), (1, 2), (2, 3)}))
    a = ours(net, *shaken(net), 0.0, 0.01)
    assert all((a[:, i, j] == 0.0).all() for i, j in net.pinned)


def test_coincident_points_are_pulled_nowhere():
    net = rope(4)
    x, v = net.x0.copy(), np.zeros_like(net.x0)
    x[:, 0, 2] = x[:, 0, 1]
    assert np.isfinite(ours(net, x, v, 0.0, 0.01)).all()


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("make", [touching_patch, draped, spread])
def test_split_damping_starts_as_the_damping_forces(make, model, reverse):
    """For a short time s, v changes by s times the accelerations that depend on v."""
    net = make(contact=Contact(900.0, 20.0))
    net = dataclasses.replace(net, damping_model=model)
    x, v = shaken(net)
    changes = []
    for s in (1e-5, 5e-6):
        w = v.reshape(-1).copy()
        damp_for(x.reshape(-1), w, 0.1, s, net.kernel_view(1.0), reverse)
        changes.append((w - v.ravel()) / s)
    rate = (2.0 * changes[1] - changes[0]).reshape(v.shape)
    forces = naive.acceleration(net, x, v, 0.1, 1e-9) - ours(net, x, v, 0.1, 1.0, set_undamped)
    assert rate == pytest.approx(forces, rel=1e-5, abs=1e-5 * np.abs(forces).max())


@pytest.mark.parametrize("s", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_split_damping_only_takes_kinetic_energy(model, s):
    net = patch(model)
    x, v = shaken(net)
    w = v.reshape(-1).copy()
    damp_for(x.reshape(-1), w, 0.0, s, net.kernel_view(1.0), False)
    assert (net.masses.ravel() * w.reshape(3, -1) ** 2).sum() < (net.masses * v**2).sum()


def test_split_damping_keeps_momentum_of_a_free_net():
    net = dataclasses.replace(patch("isotropic"), pinned=frozenset(), drag=0.0)
    x, v = shaken(net)
    w = v.reshape(-1).copy()
    damp_for(x.reshape(-1), w, 0.0, 0.02, net.kernel_view(1.0), False)
    before, after = ((net.masses.ravel() * y.reshape(3, -1)).sum(axis=1) for y in (v, w))
    assert after == pytest.approx(before, abs=1e-13)


def own_power(net, x, v, t, h):
    """(dissipated, put in) [W] by the formulas of `tests.naive`, of pins that move as v says."""
    xs, vs = np.moveaxis(x, 0, -1), np.moveaxis(v, 0, -1)
    dissipated = work = 0.0

    def pair(a, b, on_b, spring):
        nonlocal dissipated, work
        dissipated -= (on_b - spring) @ (vs[b] - vs[a])
        for end, force in ((a, -on_b), (b, on_b)):
            if end in net.pinned:
                work -= force @ vs[end]

    for a, b, family in naive.neighbours(net):
        r = xs[b] - xs[a]
        pair(a, b, -naive.link_force(net, family, r, vs[b] - vs[a]), -naive.link_force(net, family, r, np.zeros(3)))
    for (a, b, force), (_, _, spring) in zip(
        naive.own_contacts(net, xs, vs), naive.own_contacts(net, xs, 0.0 * vs), strict=True
    ):
        pair(a, b, force, spring)
    for a, b, s, force, spring, slip in naive.link_touches(net, xs, vs, t):
        dissipated -= (force - spring) @ slip
        work += force @ np.array(net.sphere_velocity)
        for end, share in ((a, 1.0 - s), (b, s)):
            work -= share * force @ vs[end] if end in net.pinned else 0.0
    for corners, parts, force, spring, slip in naive.face_touches(net, xs, vs, t):
        if net.pinned.issuperset(corners):
            continue
        dissipated -= (force - spring) @ slip
        work += force @ np.array(net.sphere_velocity)
        work -= sum(part * force @ vs[c] for c, part in zip(corners, parts, strict=True) if c in net.pinned)
    pressed = naive.loads(net, xs, vs, t)
    for i, j in itertools.product(*map(range, net.shape)):
        if (i, j) in net.pinned:
            continue
        dissipated += net.drag * vs[i, j] @ vs[i, j]
        for depth, normal, velocity, on_sphere in naive.surfaces(net, xs[i, j], t):
            slip = vs[i, j] - velocity
            force = naive.contact_force(net, depth, normal, slip, on_sphere)
            dissipated -= (force - net.contact.stiffness * depth * normal) @ slip
            work += force @ velocity
        for load, velocity in pressed[i, j]:
            slip = vs[i, j] - velocity
            force = naive.friction(net, net.masses[i, j], load, slip, np.zeros(3), h)
            dissipated -= force @ slip
            work += force @ velocity
        if net.grab is not None and (i, j) == (net.grab.row, net.grab.col):
            work += naive.grab_force(net.grab, xs[i, j], np.zeros(3)) @ vs[i, j]
            dissipated += net.grab.damping * vs[i, j] @ vs[i, j]
    return dissipated, work


def drawn_at(net, row, col):
    """A net with one pinned point, which moves."""
    path = PATH._replace(coefficients=(tuple(net.x0[:, row, col].tolist()), *PATH.coefficients[1:]))
    return dataclasses.replace(net, pinned=frozenset({(row, col)}), pin_paths=(((row, col), path),))


PATH = PinPath(0.0, ((0.0, 0.0, 0.0), (0.5, -0.2, 0.7), (0.0,) * 3, (0.0,) * 3))
SHAKEN = hairpin(3.0, 3.0, 0.5, (((0, 0), PATH),))  # its root moves
POWERED = {
    **{
        f"patch, {model}, {law}": touching_patch(model, Contact(900.0, 6.0, 0.3 if law == "clipped" else 0.0, law))
        for model in ("isotropic", "axial")
        for law in ("clipped", "lab")
    },
    "links on a sphere": drawn_at(draped(Contact(900.0, 6.0, 0.3)), 0, 0),
    "pin in a sphere": drawn_at(draped(Contact(900.0, 6.0), damping_model="isotropic"), 0, 4),
    "faces on a sphere": drawn_at(spread(Contact(900.0, 6.0, 0.3)), 2, 3),
    "pin of faces in a sphere": drawn_at(spread(Contact(900.0, 6.0), damping_model="isotropic"), 1, 2),
    "hairpin": SHAKEN,
    "hairpin, axial": dataclasses.replace(SHAKEN, damping_model="axial"),
}


@pytest.mark.parametrize("case", POWERED)
@pytest.mark.parametrize("name", ["rk4", "leapfrog"])
def test_a_short_step_books_the_powers_of_the_formulas(name, case):
    """Stored energy changes by what was put in less what was dissipated, and each is its own formula."""
    net, h = POWERED[case], 1e-6
    state = State.at_rest(net)
    state.v[:] = 0.5 * np.random.default_rng(4).standard_normal(state.v.shape)
    for i, j in net.pinned:
        state.v[:, i, j] = net.pin_paths[0][1].coefficients[1] if net.pin_paths else 0.0
    dissipated, work = own_power(net, state.x, state.v, 0.0, h)
    before = energy(net, state)
    advance(net, state, INTEGRATORS[name], h, 1, with_account=True)
    after = energy(net, state)
    assert state.dissipated / h == pytest.approx(dissipated, rel=3e-3, abs=1e-6)
    assert state.work / h == pytest.approx(work, rel=3e-3, abs=1e-6)
    assert (after.total - before.total) / h == pytest.approx(work - dissipated, rel=3e-3, abs=1e-3)
    moved = [after[part] - before[part] for part in range(4)]
    assert min(abs(change) for change in moved) > 0.0


def test_the_stored_energies_are_the_formulas():
    for net in POWERED.values():
        xs = np.moveaxis(net.x0, 0, -1)
        state = State.at_rest(net)
        state.v[:] = np.random.default_rng(4).standard_normal(state.v.shape)
        vs = np.moveaxis(state.v, 0, -1)
        free = [p for p in itertools.product(*map(range, net.shape)) if p not in net.pinned]
        elastic = sum(
            0.5 * family.stiffness * (np.linalg.norm(xs[b] - xs[a]) - family.rest) ** 2
            for a, b, family in naive.neighbours(net)
        )
        contact = sum(
            0.5 * net.contact.stiffness * depth**2 for p in free for depth, *_ in naive.surfaces(net, xs[p], 0.0)
        )
        contact += sum(
            0.5 * (spring @ spring) / net.contact.stiffness
            for *_, spring, _ in naive.link_touches(net, xs, 0.0 * xs, 0.0)
        )
        contact += sum(
            (spring @ spring) / net.contact.stiffness
            for corners, _, _, spring, _ in naive.face_touches(net, xs, 0.0 * xs, 0.0)
            if not net.pinned.issuperset(corners)
        )
        contact += sum(
            0.5 * (force @ force) / net.contact.stiffness for _, _, force in naive.own_contacts(net, xs, 0.0 * xs)
        )
        kinetic = sum(0.5 * net.masses[p] * vs[p] @ vs[p] for p in free)
        gravity = sum(-net.masses[p] * np.array(net.gravity) @ xs[p] for p in free)
        assert energy(net, state) == pytest.approx((kinetic, elastic, gravity, contact), rel=1e-12)


@pytest.mark.parametrize("drag", [0.0, 2.0])
@pytest.mark.parametrize("points", [2, 3, 4, 5, 10, 17, 130])
def test_leapfrog_s_steps_in_one_call_are_those_one_by_one(points, drag):
    """In one call the damping that ends a step and that which begins the next are one pass; with an account they are
    not. The velocities at the end of each call are damped to the end."""
    path = PinPath(0.0, ((0.0, 0.0, 0.0), (0.3, -0.2, 0.1), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    end = (1.5, 0.5, -0.2) if points > 3 else None
    net = rope(points, damping=7.0, drag=drag, end=end)
    x, v = shaken(net)
    for moving in (net, dataclasses.replace(net, pin_paths=(((0, 0), path),))):
        states = [State(x.copy(), v.copy()) for _ in range(3)]
        whole, single, account = states
        for _ in range(4):
            advance(moving, whole, INTEGRATORS["leapfrog"], 1 / 480, 9)
            advance(moving, account, INTEGRATORS["leapfrog"], 1 / 480, 9, with_account=True)
            for _ in range(9):
                advance(moving, single, INTEGRATORS["leapfrog"], 1 / 480, 1)
            for other in (single, account):
                assert np.abs(whole.x - other.x).max() < 1e-13
                assert np.abs(whole.v - other.v).max() < 1e-11


def test_air_pushes_a_cloth_that_moves_as_one_that_stands_in_the_wind_against_it():
    still, moved = np.array((3.0, -2.0, 5.0)), np.array((0.7, 1.1, -0.4))
    sheet = cloth(4, 5, stiffness=0.0, damping=0.0, drag=0.0, gravity=0.0)
    x0 = sheet.x0 + np.random.default_rng(5).normal(0.0, 0.05, sheet.x0.shape)
    found = []
    for wind, velocity in ((still, moved), (still - moved, 0.0 * moved)):
        net = dataclasses.replace(sheet, x0=x0, air=Air(tuple(wind)))
        state = State.at_rest(net)
        state.v[:] += velocity[:, None, None]
        advance(net, state, INTEGRATORS["explicit_euler"], 1e-3, 1)
        found.append(state.v - velocity[:, None, None])
    assert found[0] == pytest.approx(found[1], rel=1e-9, abs=1e-12)
    assert np.abs(found[0]).max() > 1e-3
