"""The implicit methods: their direct solver, what stiffness does to them, and what they do to energy."""

import dataclasses

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Air, Contact, cloth, rope, simulate
from sim.springs.integrators.implicit import blocks, steps
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.integrators.implicit.dissection import DIRECTIONS
from sim.springs.points.acceleration import set_acceleration
from sim.springs.state import State, advance, energy
from sim.springs.statics import hanging_chain
from tests.naive import tangent
from tests.sim.springs.nets import folded_sheet, touching_patch

IMPLICIT = [name for name, record in INTEGRATORS.items() if record.implicit]
STIFF = rope(2, stiffness=1e12, damping=0.0, drag=0.0, gravity=0.0)  # omega = 1e6 1/s


@pytest.mark.parametrize("n", [1, 2, 3, 60])
def test_the_block_solver_agrees_with_a_dense_solve(n):
    rng = np.random.default_rng(n)
    off = rng.standard_normal((n, 3, 3))
    own = (12.0 + rng.random((n, 1, 1))) * np.eye(3) + rng.standard_normal((n, 3, 3))
    dense = np.zeros((3 * n, 3 * n))
    for j in range(n):
        at, after = slice(3 * j, 3 * j + 3), slice(3 * j + 3, 3 * j + 6)
        dense[at, at] = own[j]
        if j + 1 < n:
            dense[at, after] = dense[after, at] = off[j]
    r = rng.standard_normal((n, 3))
    u = r.copy()
    solve_block_tridiagonal(own.reshape(n, 9).copy(), off.reshape(n, 9), u)
    assert u.ravel() == pytest.approx(np.linalg.solve(dense, r.ravel()), abs=1e-12)


def air_matrix(net, v, g):
    """g times the derivative of the air's forces that is kept: rho/2 A [C_D |s| (I + n n^T) + C_L |u| (1 - (s/u)^2)^2
    n n^T] of each cell, s = u . n, shared by its corners."""
    rows, cols = net.shape
    matrix, x = np.zeros((3, rows * cols, 3, rows * cols)), net.x0
    for i in range(rows - 1):
        for j in range(cols - 1):
            diagonals = x[:, i + 1, j + 1] - x[:, i, j], x[:, i, j + 1] - x[:, i + 1, j]
            n = 0.5 * np.cross(*diagonals)
            area = np.linalg.norm(n)
            n = n / area
            corners = [a * cols + b for a in (i, i + 1) for b in (j, j + 1)]
            u = np.array(net.air.wind) - v.reshape(3, -1)[:, corners].mean(axis=1)
            speed, s = np.linalg.norm(u), abs(u @ n)
            lift = net.air.lift * speed * (1.0 - (s / speed) ** 2) ** 2
            block = net.air.drag * s * (np.eye(3) + np.outer(n, n)) + lift * np.outer(n, n)
            for a in corners:
                for b in corners:
                    matrix[:, a, :, b] += g * 0.5 * net.air.density * area * block / 16.0
    return matrix.reshape(3 * rows * cols, -1)


def test_the_blocks_of_a_rope_s_points_are_all_of_their_matrix():
    """Beside no links: nine entries of the six that are kept, and the mass where a point is pinned."""
    p, n = rope(4).kernel_view(1.0), 4
    work = steps.make_work(p, False)
    points = np.random.default_rng(3).standard_normal((6, n))
    diagonal, beside = np.full((n, 9), np.nan), np.full((n, 9), np.nan)
    blocks.set_rope_blocks(p, points.ravel(), 0.0 * work.links, work.pairs, work.solver.numbers, diagonal, beside)
    xx, xy, xz, yy, yz, zz = points
    expected = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)
    expected[0] = p.mass[0] * np.eye(3)  # the root
    assert diagonal.reshape(n, 3, 3) == pytest.approx(expected)
    assert np.all(beside[: n - 1] == 0.0)


def near_matrix(net, x, v, g):
    """The matrix that a net's factors are made of, dense, of the free points."""
    p, n = net.kernel_view(1.0), net.x0[0].size
    work = steps.make_work(p, False)
    steps.set_blocks(x, g, 0.0, p, x, v, work)
    diagonal, beside = work.solver.diagonal, work.solver.beside
    blocks.set_near_blocks(p, work.links, work.points, diagonal, beside)
    dense, six = np.zeros((3, n, 3, n)), ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
    rows, cols = net.shape

    def add(a, b, block):
        for (i, j), value in zip(zip(*six, strict=True), block, strict=True):
            dense[i, a, j, b] += value
            dense[j, a, i, b] += value if i != j else 0.0

    for a in range(n):
        add(a, a, diagonal.reshape(n, 6)[a])
        for way, (di, dj) in enumerate(DIRECTIONS):
            i, j = a // cols + di, a % cols + dj
            if i < rows and 0 <= j < cols:
                add(a, i * cols + j, -beside.reshape(n, 4, 6)[a, way])
                add(i * cols + j, a, -beside.reshape(n, 4, 6)[a, way])
    free = np.tile(net.inverse_masses().ravel() > 0.0, 3)
    return dense.reshape(3 * n, 3 * n)[np.ix_(free, free)], free


def folded_patch(model):
    """A net folded onto itself, on a floor, pulled, in wind. Contact is so soft that what turns its force, which the
    matrix leaves out, is below 1e-6 of the mass."""
    net = touching_patch(model, Contact(1e-2, 6.0), cols=6, thickness=0.36)
    x0 = np.random.default_rng(2).normal(0.0, 0.01, (3, 3, 6))
    x0[0] += 0.33 * np.arange(3)[:, None]
    x0[1:] += np.array([[0.0, 0.33, 0.66, 0.9, 0.7, 0.36], [0.0, 0.0, 0.0, 0.2, 0.33, 0.3]])[:, None]
    return dataclasses.replace(net, sphere=None, x0=x0, air=Air((3.0, -2.0, 5.0)))


@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_a_net_s_factors_are_of_a_matrix_that_resists_no_less_than_its_forces(model):
    """M + g D + g^2 K of a folded net, K and D by differences."""
    net, g = folded_patch(model), 0.01
    root, v = np.sqrt(np.tile(net.masses.ravel(), 3)), np.zeros(net.x0.size)
    matrix, free = near_matrix(net, net.x0.ravel(), v, g)
    lone = dataclasses.replace(net, air=None)
    stiffness, damping = (root[:, None] * part * root for part in tangent(lone, net.x0))
    dense = (np.diag(root**2) + g * damping + g * g * stiffness + air_matrix(net, v, g))[np.ix_(free, free)]
    least = np.linalg.eigvalsh(matrix - dense)[0]
    assert least > -1e-6 * np.diag(dense).min()
    assert np.linalg.eigvalsh(matrix)[0] > 0.0


@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_a_net_s_factors_are_of_its_matrix_where_links_between_neighbours_are_stretched(model):
    net, g = folded_patch(model), 0.01
    families = tuple(one for one in net.families if max(one.di, abs(one.dj)) < 2)
    x0 = 2.0 * touching_patch(model, Contact(1e-2, 6.0), cols=6).x0
    net = dataclasses.replace(net, families=families, thickness=0.0, air=None, x0=x0)
    root = np.sqrt(np.tile(net.masses.ravel(), 3))
    matrix, free = near_matrix(net, x0.ravel(), np.zeros(x0.size), g)
    stiffness, damping = (root[:, None] * part * root for part in tangent(net, x0))
    dense = (np.diag(root**2) + g * damping + g * g * stiffness)[np.ix_(free, free)]
    assert matrix == pytest.approx(dense, abs=1e-6 * np.diag(dense).min())


@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_a_net_s_stage_solves_its_equation(model):
    """v = v0 + g a(x0 + g v, v), by the accelerations that explicit methods take."""
    net, g = folded_patch(model), 0.01
    p, x0 = net.kernel_view(1.0), net.x0.ravel()
    v0 = np.random.default_rng(1).normal(0.0, 0.1, x0.size) * np.tile(net.inverse_masses().ravel() > 0.0, 3)
    x, v, work = x0.copy(), v0.copy(), steps.make_work(p, False)
    limits = steps.OF_EULER._replace(error=0.0, usable=0.0, most=100)
    taken, evals, settled, usable = steps.solve_stage(x0, v0, 0.0 * v0, g, 0.0, limits, False, p, x, v, work)
    assert settled
    assert usable
    assert taken < min(evals, 60)
    a = np.zeros_like(x)
    set_acceleration(x, v, 0.0, p, a)
    assert x == pytest.approx(x0 + g * v, abs=1e-14)
    assert v == pytest.approx(v0 + g * a, abs=1e-7 * np.abs(v).max())


def struck(net):
    """The oscillator, its end at 1e-3 m from rest along the link."""
    state = State.at_rest(net)
    state.x[0, 0, 1] -= 1e-3
    return state


@pytest.mark.parametrize("name", [name for name in IMPLICIT if INTEGRATORS[name].l_stable])
def test_an_l_stable_method_makes_an_end_of_what_it_cannot_follow(name):
    """z = 1e6: |R| is 1e-6 of implicit Euler, and 2.4e-6 of TR-BDF2, so that round-off is all that is left."""
    state = struck(STIFF)
    advance(STIFF, state, INTEGRATORS[name], 1.0, 3)
    assert abs(state.x[0, 0, 1] + 2.0) < 1e-12


def test_the_midpoint_method_keeps_what_it_cannot_follow_within_bounds():
    state = struck(STIFF)
    for _ in range(200):
        advance(STIFF, state, INTEGRATORS["implicit_midpoint"], 1.0, 1)
        assert abs(state.x[0, 0, 1] + 2.0) < 1.001e-3


@pytest.mark.parametrize(
    ("name", "stiffness"),
    [
        ("implicit_euler", 800.0),
        ("implicit_euler", 1e9),
        ("tr_bdf2", 800.0),
        ("tr_bdf2", 1e9),
        ("implicit_midpoint", 800.0),
    ],
)
def test_the_equilibrium_is_the_exact_one_even_in_long_steps(name, stiffness):
    """The midpoint method keeps what it cannot follow, so it only settles where it can."""
    net = rope(10, stiffness=stiffness, drag=20.0)
    state = State.at_rest(net)
    exact = hanging_chain(net).x.T[:, None]
    state.x[:] = exact
    state.x[0, 0, 1:] += 1e-3 * np.arange(1, 10)
    advance(net, state, INTEGRATORS[name], 0.1, 2000)
    assert np.abs(state.x - exact).max() < 1e-9


@pytest.mark.parametrize("name", ["implicit_euler", "tr_bdf2"])
def test_a_rope_of_1e9_newtons_a_metre_neither_explodes_nor_stalls(name):
    """A fall from level at the lab's own 1/60 s; a correction is one force evaluation and one direct solve."""
    net = rope(50, stiffness=1e9)
    state = State.at_rest(net)
    for _ in range(120):
        before = state.force_evals
        advance(net, state, INTEGRATORS[name], 1 / 60, 1)
        assert state.force_evals - before <= 40
        assert np.linalg.norm(state.x, axis=0).max() < 2.001
    assert np.abs(state.v).max() < 20.0


@pytest.mark.parametrize("stiffness", [1.0, 30.0, 800.0, 1e5, 1e7, 1e8, 1e9])
def test_the_midpoint_method_keeps_the_energy_at_any_stiffness(stiffness):
    """A fall of an undamped rope from level at the lab's own 1/60 s, in a whip that turns links by radians a step."""
    net = rope(50, stiffness=stiffness, damping=0.0, drag=0.0)
    run = simulate(net, duration=2.0, frames=121, step=1 / 60, integrator="implicit_midpoint")
    total = run.energy.total
    assert run.energy.kinetic.max() > 400.0
    assert np.abs(total - total[0]).max() < 1e-9
    assert run.force_evals < 120 * 20


@pytest.mark.parametrize("stiffness", [800.0, 1e9])
def test_the_midpoint_method_takes_what_damping_takes(stiffness):
    net = rope(50, stiffness=stiffness)
    run = simulate(net, duration=2.0, frames=121, step=1 / 60, integrator="implicit_midpoint", with_account=True)
    total = run.energy.total + run.energy.dissipated
    assert run.energy.dissipated[-1] > 100.0
    assert np.abs(total - total[0]).max() < 1e-8


def test_the_midpoint_method_keeps_the_energy_of_a_stiff_cloth():
    net = cloth(12, 12, stiffness=1e5, shear=5e4, bend=1e4, damping=0.0)
    run = simulate(net, duration=0.5, frames=31, step=1 / 60, integrator="implicit_midpoint")
    total = run.energy.total
    assert run.energy.kinetic.max() > 0.5
    assert np.abs(total - total[0]).max() < 1e-8


def test_a_stiff_rope_in_long_steps_moves_as_in_short_ones():
    """Second order in the motion that the steps can follow, whatever becomes of the modes they cannot."""
    net = rope(50, stiffness=1e7)
    ends = []
    for count in (60, 120, 3840):
        state = State.at_rest(net)
        advance(net, state, INTEGRATORS["implicit_midpoint"], 1 / count, count // 2)
        ends.append(state.x)
    errors = [np.linalg.norm(x - ends[2], axis=0).max() for x in ends[:2]]
    assert errors[0] < 5e-3
    assert errors[1] < 0.4 * errors[0]


@pytest.mark.parametrize("z", [0.05, 0.3, 0.93, 1.5, 10.0])
def test_implicit_euler_takes_exactly_its_share_of_the_energy(z):
    """1/(1 + z^2) a step, of a link that stays straight."""
    net = rope(2, length=1e3, stiffness=1.0, damping=0.0, drag=0.0, gravity=0.0)
    state = State.at_rest(net)
    state.x[0, 0, 1] -= 0.4
    before = energy(net, state).total
    advance(net, state, INTEGRATORS["implicit_euler"], z, 1)
    assert energy(net, state).total == pytest.approx(before / (1.0 + z * z), rel=1e-9)


def test_the_midpoint_method_runs_backwards_to_where_it_began():
    net = rope(10, damping=0.0, drag=0.0)
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["implicit_midpoint"], 1 / 240, 240)
    state.v *= -1.0
    advance(net, state, INTEGRATORS["implicit_midpoint"], 1 / 240, 240)
    assert np.abs(state.x - net.x0).max() < 1e-8


def test_the_stiffest_rope_takes_few_corrections_in_any_step():
    net = rope(50, stiffness=1e9, damping=0.0, drag=0.0)
    state, taken = State.at_rest(net), []
    for _ in range(120):
        before = state.force_evals
        advance(net, state, INTEGRATORS["implicit_midpoint"], 1 / 60, 1)
        taken.append(state.force_evals - before)
    assert max(taken) < 130


@pytest.mark.parametrize("name", IMPLICIT)
def test_a_rope_1e4_times_as_heavy_and_stiff_moves_alike_at_the_same_cost(name):
    """It is pressed at the start, where the matrix leaves a part of its geometric stiffness out."""
    runs = []
    for s in (1.0, 1e4):
        net = rope(20, mass=0.01 * s, stiffness=10.0 * s, damping=1e-4 * s, drag=1e-4 * s)
        x = 0.8 * net.x0[:, 0].T
        x[1:] += 0.01 * np.random.default_rng(1).standard_normal((19, 3))
        runs.append(simulate(net, x=x, duration=0.5, frames=3, step=1 / 240, integrator=name))
    one, other = runs
    assert np.abs(one.x - other.x).max() < 1e-6
    assert one.force_evals == pytest.approx(other.force_evals, abs=3)


STORM = cloth(
    6, 6, density=0.1, stiffness=800.0, shear=200.0, bend=6.0, damping=0.02, pinned="edge", air=Air((0.0, 25.0, 25.0))
)


@pytest.mark.parametrize("name", IMPLICIT)
def test_a_light_cloth_in_a_storm_is_held_in_long_steps(name):
    """The wind's force changes within a step by more than the cloth's inertia resists."""
    state = State.at_rest(STORM)
    for _ in range(12):
        before = state.force_evals
        advance(STORM, state, INTEGRATORS[name], 1 / 60, 1)
        assert state.force_evals - before < 400
    short = State.at_rest(STORM)
    advance(STORM, short, INTEGRATORS["leapfrog"], 1 / 6000, 1200)
    assert np.abs(state.v).max() < 25.0
    assert np.linalg.norm(state.x - short.x, axis=0).max() < 0.2


@pytest.mark.parametrize("stiffness", [300.0, 1000.0])
def test_a_sheet_that_lies_on_itself_comes_to_rest_in_long_steps(stiffness):
    """TR-BDF2, as the damping of implicit Euler would do it alone. A first step of 1/60 s would fold it otherwise."""
    net = folded_sheet(stiffness)
    state, short = State.at_rest(net), State.at_rest(net)
    advance(net, state, INTEGRATORS["tr_bdf2"], 1 / 90, 45)
    advance(net, short, INTEGRATORS["leapfrog"], 1 / 6000, 3000)
    assert state.force_evals < 45 * 40
    assert np.abs(state.v).max() < 5e-3
    assert np.abs(state.x - short.x).max() < 1e-5
    fast = State.at_rest(net)
    advance(net, fast, INTEGRATORS["implicit_euler"], 1 / 60, 10)
    assert fast.force_evals < 10 * 40
    assert np.abs(fast.v).max() < 3.0
