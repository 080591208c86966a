"""The cloth: its modes, its strips as hanging chains, its symmetry, the air, the sphere, itself."""

import dataclasses
import itertools
import math
import os

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Air, Contact, cloth, rope, simulate
from sim.springs.analysis.strain import structural_strain
from sim.springs.cloth import PIN_CHOICES, pleated_cloth, vertical_cloth
from sim.springs.forces.matrices import STIFFNESS
from sim.springs.integrators.implicit.tangent import products
from sim.springs.near.near_pairs import find_pairs, reach_of
from sim.springs.net import CLOTH
from sim.springs.points.acceleration import set_acceleration
from sim.springs.state import State, advance, energy
from sim.springs.statics import catenary, hanging_chain
from sim.validation import ApproximationWarning
from tests.naive import acceleration
from tests.sim.springs.nets import folded_sheet


def forces_of(net, x=None, v=None):
    """Accelerations by the kernels (3, rows, cols)."""
    x = net.x0 if x is None else x
    v = np.zeros_like(x) if v is None else v
    a = np.empty_like(x)
    set_acceleration(x.reshape(-1), v.reshape(-1), 0.0, net.kernel_view(1.0), a.reshape(-1))
    return a


def test_the_default_is_a_square_metre_held_at_two_corners():
    net = cloth()
    assert net.x0.shape == (3, 32, 32)
    assert net.pinned == {(0, 0), (0, 31)}
    assert net.masses.sum() == pytest.approx(1.0)
    assert [family[:2] for family in net.families] == CLOTH
    assert np.abs(forces_of(dataclasses.replace(net, gravity=(0.0, 0.0, 0.0)))).max() < 1e-9


@pytest.mark.parametrize("gather", [0.5, 0.9])
def test_pleats_narrow_a_cloth_and_keep_its_arc_length(gather):
    net = pleated_cloth(vertical_cloth(cloth(5, 200, pinned="edge")), gather)
    assert np.ptp(net.x0[0]) == pytest.approx(gather, rel=1e-12)
    # The wave between two particles is a little longer than their distance, most at its crests.
    assert np.linalg.norm(np.diff(net.x0, axis=2), axis=0).sum(axis=1) == pytest.approx(1.0, rel=3e-3)
    assert structural_strain(net, net.x0).max() < 0.02


@pytest.mark.parametrize("hold", PIN_CHOICES)
def test_what_is_pinned_stays(hold):
    net = cloth(5, 6, pinned=hold)
    run = simulate(net, duration=0.2, frames=3, step=1e-3, integrator="rk4")
    moved = np.abs(run.x[-1] - run.x[0]).max(axis=-1) > 0.0
    assert {(i, j) for i in range(5) for j in range(6) if not moved[i, j]} == set(net.pinned)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("shape", [(2, 2), (2, 9), (3, 2), (5, 7), (20, 17)])
def test_the_fused_forces_agree_with_the_formulas_link_by_link(shape, model):
    net = cloth(*shape, damping=0.3, drag=0.1, damping_model=model)
    rng = np.random.default_rng(1)
    x, v = net.x0 + 0.03 * rng.standard_normal(net.x0.shape), rng.standard_normal(net.x0.shape)
    naive = acceleration(net, x, v)
    assert np.abs(forces_of(net, x, v) - naive).max() < 1e-12 * np.abs(naive).max()


@pytest.mark.skipif(os.cpu_count() == 1, reason="one core")
@pytest.mark.parametrize(("rows", "cols"), [(16, 9), (33, 5), (64, 64)])
def test_two_threads_give_the_very_numbers_of_one(rows, cols):
    net = cloth(rows, cols, damping=0.3, drag=0.1)
    rng = np.random.default_rng(1)
    x, v = net.x0 + 0.03 * rng.standard_normal(net.x0.shape), rng.standard_normal(net.x0.shape)
    split = dataclasses.replace(net, threads=2)
    assert split.kernel_view(1.0).bands == 2
    assert (forces_of(split, x, v) == forces_of(net, x, v)).all()


def test_a_cloth_of_few_rows_stays_on_one_thread():
    assert dataclasses.replace(cloth(15, 100), threads=8).kernel_view(1.0).bands == 1


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (3, 2), (5, 7)])
def test_a_taut_square_of_structural_springs_vibrates_as_the_discrete_membrane(p, q):
    """omega^2 = (4 T/m a) [sin^2(p pi/2(N+1)) + sin^2(q pi/2(M+1))], N x M free particles, tension T."""
    rows, cols, stretch = 9, 11, 1.2
    net = cloth(rows, cols, cols - 1.0, rows - 1.0, 1.0, 100.0, 0.0, 0.0, 0.0, gravity=0.0, pinned="rim")
    net = dataclasses.replace(net, x0=stretch * net.x0)
    tension, spacing = 100.0 * (stretch - 1.0), stretch
    i, j = np.meshgrid(np.arange(rows), np.arange(cols), indexing="ij")
    shape = np.sin(p * np.pi * i / (rows - 1)) * np.sin(q * np.pi * j / (cols - 1))
    x = net.x0.copy()
    x[2] += 1e-6 * shape
    across = math.sin(p * math.pi / (2 * (rows - 1))) ** 2 + math.sin(q * math.pi / (2 * (cols - 1))) ** 2
    expected = 4.0 * tension / (net.mass * spacing) * across
    assert forces_of(net, x)[2] == pytest.approx(-expected * 1e-6 * shape, abs=1e-9 * expected * 1e-6 + 1e-12)
    # and in time: half a period later it is upside down
    state = State(x, np.zeros_like(x))
    period = 2.0 * math.pi / math.sqrt(expected)
    advance(net, state, INTEGRATORS["dop853"], 0.5 * period / 60, 60)
    assert state.x[2] == pytest.approx(-1e-6 * shape, abs=1e-11)


def test_strips_without_cross_springs_hang_as_chains():
    """Those at the sides, of half the width, as the one between them."""
    net = vertical_cloth(cloth(8, 3, 0.2, 1.0, 1.0, 50.0, 0.0, 0.0, 0.5, 0.3, pinned="edge"))
    net = dataclasses.replace(
        net, families=tuple(f._replace(stiffness=0.0) if f[:2] == (0, 1) else f for f in net.families)
    )
    assert net.mass_ratios is not None
    chain = dataclasses.replace(rope(8, 1.0, net.mass, 50.0), mass_ratios=net.mass_ratios[None, :, 1])
    depth = hanging_chain(chain).x[:, 2]
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["leapfrog"], 2e-3, 20_000)
    for j in range(3):
        assert state.x[2, :, j] - state.x[2, 0, j] == pytest.approx(depth, abs=1e-9)


def test_a_strip_between_two_bars_hangs_as_the_catenary():
    """Structural springs down the strip only: each column is the discrete elastic catenary between its two pins."""
    rows, length, span, rise = 24, 1.2, 1.0, 0.1
    net = cloth(
        rows, 3, 0.2, length, 1.0, 300.0, 0.0, 0.0, 0.2, 0.3,
        pinned=[(i, j) for i in (0, rows - 1) for j in range(3)],
    )  # fmt: skip
    net = dataclasses.replace(
        net, families=tuple(f if f[:2] == (1, 0) else f._replace(stiffness=0.0, damping=0.0) for f in net.families)
    )
    x = net.x0.copy()
    x[1], x[2] = np.linspace(0.0, span, rows)[:, None], np.linspace(0.0, rise, rows)[:, None]
    net = dataclasses.replace(net, x0=x)
    exact = catenary(rows, length, span, rise, 300.0, net.masses[:, 1], 9.81)
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["leapfrog"], 1e-3, 30_000)
    for j in range(3):
        assert state.x[1, :, j] == pytest.approx(exact.x[:, 0], abs=1e-8)
        assert state.x[2, :, j] == pytest.approx(exact.x[:, 2], abs=1e-8)


def test_a_square_cloth_keeps_the_eight_symmetries_of_the_square():
    """Held at its four corners: turned and mirrored it is itself, wind from below, damping, sphere and all."""
    net = cloth(
        9, 9, origin=(-0.5, -0.5, 0.0), pinned="all corners", sphere=(0.0, 0.0, -0.3, 0.25), damping=0.02,
        contact=Contact(200.0, 0.1, 0.3), air=Air((0.0, 0.0, 2.0)),
    )  # fmt: skip
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["rk4"], 1e-3, 500)
    x, y, z = state.x
    assert z[4, 4] < -0.05  # on the sphere
    for turns, mirrored in itertools.product(range(4), (False, True)):
        u, v, w = x, y, z
        if mirrored:
            u, v, w = -u[:, ::-1], v[:, ::-1], w[:, ::-1]
        for _ in range(turns):
            u, v, w = -np.rot90(v, -1), np.rot90(u, -1), np.rot90(w, -1)
            u, v, w = np.ascontiguousarray(u), np.ascontiguousarray(v), np.ascontiguousarray(w)
        assert np.stack([u, v, w]) == pytest.approx(state.x, abs=1e-9)


@pytest.mark.parametrize("angle", [0.1, 0.7, 1.2, math.pi / 2])
def test_the_wind_on_a_flat_plate_is_the_formula_s(angle):
    """Drag rho/2 C_D A sin(a) u^2 along the wind, lift rho/2 C_L A sin(a) cos(a) u^2 across it."""
    air = Air((7.0 * math.cos(angle), 0.0, 7.0 * math.sin(angle)), 1.2, 1.1, 0.8)
    net = cloth(12, 17, 1.5, 0.8, gravity=0.0, pinned="free", air=air)
    force = (net.masses * forces_of(net)).reshape(3, -1).sum(axis=1)
    along = np.array([math.cos(angle), 0.0, math.sin(angle)])
    across = np.array([-math.sin(angle), 0.0, math.cos(angle)])
    q = 0.5 * 1.2 * 1.5 * 0.8 * 49.0 * math.sin(angle)
    assert force @ along == pytest.approx(q * 1.1, rel=1e-12)
    assert force @ across == pytest.approx(q * 0.8 * math.cos(angle), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", ["leapfrog", "rk4"])
def test_a_flat_cloth_falls_at_its_terminal_speed(name):
    """m g = rho/2 C_D A v^2."""
    net = cloth(6, 6, density=0.2, pinned="free", air=Air(density=1.2, drag=1.2))
    run = simulate(net, duration=2.0, frames=3, step=1e-3, integrator=name)
    assert run.v[-1, :, :, 2].mean() == pytest.approx(-math.sqrt(0.2 * 9.81 / (0.6 * 1.2)), rel=1e-2)


def drape(n, thickness=0.0, seconds=3.0, friction=0.6, step=1 / 3000):
    net = cloth(
        n, n, 1.2, 1.2, 0.3, 800.0, 200.0, 3.0, 0.02, origin=(-0.6, -0.6, 0.45), pinned="free",
        sphere=(0.0, 0.0, 0.0, 0.4), contact=Contact(300.0, 0.2, friction), air=Air(), thickness=thickness,
    )  # fmt: skip
    state, deepest = State.at_rest(net), 0.0
    for _ in range(round(seconds * 30)):
        advance(net, state, INTEGRATORS["symplectic_euler"], step, round(1 / 30 / step))
        deepest = max(deepest, 0.4 - np.linalg.norm(state.x, axis=0).min())
    return net, state, deepest


def test_a_cloth_drapes_over_a_sphere_and_rests_on_it():
    """Never deeper than 1 % of the radius, and at rest the sphere carries the weight within 1 %."""
    net, state, deepest = drape(24, seconds=5.0)
    assert deepest < 0.004
    assert np.abs(state.v).max() < 0.1
    distance = np.linalg.norm(state.x, axis=0)
    on = distance < 0.4
    total = dataclasses.replace(net, drag=0.0)
    without = dataclasses.replace(total, sphere=None)
    push = net.masses * (forces_of(total, state.x, state.v) - forces_of(without, state.x, state.v))
    force = push.reshape(3, -1).sum(axis=1)
    assert on.sum() > 50
    assert force[2] == pytest.approx(net.masses.sum() * 9.81, rel=1e-2)
    assert state.x[2].min() < -0.2


def test_a_sphere_dragged_at_full_speed_pushes_the_cloth_and_does_not_pass():
    """5 m/s, faster than the pursuit of a dragged gizmo moves a metre."""
    net = vertical_cloth(
        cloth(24, 24, 1.0, 1.0, 0.3, 800.0, 200.0, 3.0, 0.02, pinned="edge", contact=Contact(1000.0, 0.3))
    )
    net = dataclasses.replace(net, sphere=(0.5, -0.5, -0.6, 0.2), sphere_velocity=(0.0, 5.0, 0.0))
    state = State.at_rest(net)
    for _ in range(20):
        advance(net, state, INTEGRATORS["leapfrog"], 1 / 4000, 40)
        centre = np.array([0.5, -0.5 + 5.0 * state.t, -0.6])
        assert np.linalg.norm(state.x - centre[:, None, None], axis=0).min() > 0.17
    assert state.x[1, 12:].max() > 0.5


def test_the_pairs_found_by_hashing_are_all_there_are():
    net = dataclasses.replace(cloth(14, 13, thickness=0.09), x0=0.3 * np.random.default_rng(2).random((3, 14, 13)))
    p = net.kernel_view(1.0)
    find_pairs(net.x0.reshape(-1), p)
    listed = [tuple(sorted(pair)) for pair in p.pairs[: p.pairs[-1, 0]].tolist()]
    found, points, reach = set(listed), net.x0.reshape(3, -1).T, reach_of(p)
    expected = {
        (a, b)
        for a, b in itertools.combinations(range(14 * 13), 2)
        if np.linalg.norm(points[a] - points[b]) < reach
        and not (abs(a // 13 - b // 13) <= 2 and abs(a % 13 - b % 13) <= 2)
    }
    assert len(expected) < 24 * 14 * 13
    assert found == expected
    assert len(listed) == len(found)
    assert reach > 1.5 * 0.09


@pytest.mark.parametrize(("rows", "cols"), [(2, 2), (5, 9), (32, 32)])
def test_a_particle_has_the_mass_of_the_cloth_nearest_to_it(rows, cols):
    net = cloth(rows, cols, 2.0, 3.0, density=0.4)
    cell = 0.4 * 2.0 / (cols - 1) * 3.0 / (rows - 1)
    assert net.masses.sum() == pytest.approx(0.4 * 6.0)
    assert net.masses[0, 0] == net.masses[-1, 0] == net.masses[0, -1] == pytest.approx(cell / 4)
    assert net.masses[0, 1:-1] == pytest.approx(np.full(cols - 2, cell / 2))
    assert net.masses[1:-1, -1] == pytest.approx(np.full(rows - 2, cell / 2))
    assert net.masses[1:-1, 1:-1] == pytest.approx(np.full((rows - 2, cols - 2), cell))


def lowest_frequency(net):
    """Of the motions in the plane of a flat cloth that change its energy [rad/s]."""
    size = net.x0.size
    matrix = products(net.x0.reshape(-1), np.eye(size), 0.0, net.kernel_view(1.0), STIFFNESS)
    plane = 2 * size // 3  # x and y
    squares = np.linalg.eigvalsh(matrix[:plane, :plane])
    return math.sqrt(squares[squares > 1e-3 * squares[-1] / size][0])


def test_the_error_of_a_cloth_s_lowest_frequency_falls_with_the_square_of_the_spacing():
    """Strips held at one end: pi/2 sqrt(k/s)/L with mass s per area. A whole cloth, free, has no closed form."""
    strips, free = [], []
    for n in (5, 9, 17):
        strips.append(lowest_frequency(cloth(n, n, density=0.5, shear=0.0, bend=0.0, pinned="edge")))
        free.append(lowest_frequency(cloth(n, n, 2.0, density=0.5, bend=0.0, pinned="free")))
    error = 0.5 * math.pi * math.sqrt(981.0 / 0.5) - np.array(strips)
    assert error[:-1] / error[1:] == pytest.approx(4.0, rel=0.02)
    assert (free[1] - free[0]) / (free[2] - free[1]) == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize(("rows", "cols"), [(2, 2), (5, 9), (32, 32)])
def test_a_stretched_cloth_has_the_energy_of_its_width_at_every_resolution(rows, cols):
    """By a thousandth along columns: (cols - 1) strips of (rows - 1) links of k each."""
    net = cloth(rows, cols, 2.0, 3.0, shear=0.0, bend=0.0)
    state = State.at_rest(net)
    state.x[1] *= 1.001
    cell = 3.0 / (rows - 1)
    assert energy(net, state).elastic == pytest.approx(
        0.5 * 981.0 * (cols - 1) * (rows - 1) * (1e-3 * cell) ** 2, rel=1e-9
    )


def test_a_hanging_cloth_s_tension_is_the_continuum_s_at_every_resolution():
    """Summed along a strip it is w L^2/2 per width of a sheet of weight w per area, so that the stretch is too."""
    for n in (3, 5, 17):
        net = cloth(n, n, density=0.5, stiffness=1.0, shear=0.0, bend=0.0, pinned="edge")
        strip = 1.0 / (n - 1)  # [m] wide, half as wide at the sides
        for j, width in ((0, strip / 2), (1, strip)):
            tension = 9.81 * net.masses[:0:-1, j].cumsum()
            assert tension.sum() * strip == pytest.approx(width * 0.5 * 9.81 / 2.0, rel=1e-12)


def test_a_flat_cloth_thicker_than_its_spacing_does_not_push_itself_apart():
    """Less than pi/2 thicknesses of cloth lie between two particles of a fold; farther ones push each other."""
    net = cloth(16, 16, gravity=0.0, pinned="free", thickness=0.25)
    state = State.at_rest(net)
    assert energy(net, state).total < 1e-20
    advance(net, state, "leapfrog", 1e-4, 1000)
    assert np.abs(state.x - net.x0).max() < 1e-12
    assert state.left_out == 0
    folded = net.x0.copy()
    folded[1, 8:], folded[2, 8:] = folded[1, 7::-1], 0.2
    assert energy(net, State(folded, np.zeros_like(folded))).contact > 0.0
    spacing = 1.0 / 15
    p = net.kernel_view(1.0)
    find_pairs(folded.reshape(-1), p)
    apart = np.abs(np.diff(np.stack(np.divmod(p.pairs[: p.pairs[-1, 0]], 16)), axis=2))[..., 0]
    assert np.hypot(*(spacing * apart)).min() == pytest.approx(0.5 * math.pi * 0.25, abs=spacing)


def test_a_heap_that_fills_the_list_of_pairs_is_reported():
    net = cloth(20, 20, thickness=0.02, gravity=0.0, pinned="free", contact=Contact(1.0, 0.0))
    heap = np.ascontiguousarray(1e-3 * np.random.default_rng(1).random(net.x0.shape))
    state = State(heap, np.zeros_like(heap))
    advance(net, state, "leapfrog", 1e-5, 1)
    p = net.kernel_view(1.0)
    find_pairs(heap.reshape(-1), p)
    assert p.pairs[-1, 0] == 24 * 400
    first = np.unique(p.pairs[: p.pairs[-1, 0], 0])  # of them the last has only some of its pairs
    assert len(first) - 1 == 400 - state.left_out
    assert 0 < state.left_out < 400
    heaped = dataclasses.replace(net, x0=heap)
    for method in ("leapfrog", "dopri5"):
        with pytest.warns(ApproximationWarning, match=r"self-contact left out up to \d+ particles"):
            assert simulate(heaped, duration=1e-4, frames=2, integrator=method).left_out == state.left_out
    assert simulate(net, duration=1e-3, frames=2, step=1e-4, integrator="leapfrog").left_out == 0


def test_a_cloth_that_falls_onto_itself_does_not_pass_through():
    """The upper part comes down on the lower and stays above it."""
    net = folded_sheet(100.0)
    for name in ("leapfrog", "rk4"):
        state = State.at_rest(net)
        advance(net, state, INTEGRATORS[name], 1 / 3000, 2000)
        assert state.x[2, 16:].min() > 0.02
        assert state.x[2, 16:].max() < 0.1
        through = State.at_rest(dataclasses.replace(net, thickness=0.0))
        advance(dataclasses.replace(net, thickness=0.0), through, INTEGRATORS[name], 1 / 3000, 2000)
        assert through.x[2, 16:].min() < -0.1


def test_self_contact_keeps_momentum_and_energy():
    rng = np.random.default_rng(5)
    net = cloth(
        10, 10, stiffness=1.0, shear=1.0, bend=0.0, gravity=0.0, pinned="free", damping=0.0, thickness=0.16,
        contact=Contact(5.0, 0.0),
    )  # fmt: skip
    net = dataclasses.replace(
        net, x0=net.x0 * np.array([0.45, 0.45, 1.0])[:, None, None] + 0.02 * rng.random((3, 10, 10))
    )
    state = State.at_rest(net)
    before = energy(net, state)
    assert before.contact > 0.0
    advance(net, state, INTEGRATORS["rk4"], 1e-4, 1000)
    assert (net.masses * state.v).reshape(3, -1).sum(axis=1) == pytest.approx(np.zeros(3), abs=1e-12)
    assert energy(net, state).total == pytest.approx(before.total, rel=1e-3)


@pytest.mark.parametrize("name", ["implicit_euler", "tr_bdf2"])
def test_an_implicit_step_takes_a_cloth_far_beyond_the_explicit_limit(name):
    net = cloth(10, 10, density=0.3, stiffness=1e5, shear=5e4, bend=100.0)
    state = State.at_rest(net)
    for _ in range(60):
        before = state.force_evals
        advance(net, state, INTEGRATORS[name], 1 / 60, 1)
        assert state.force_evals - before <= 120
        assert np.abs(state.x).max() < 2.0
    assert state.x[2].min() < -0.15
