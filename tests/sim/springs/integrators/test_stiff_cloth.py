"""Implicit steps of a stiff cloth: factors by nested dissection, iterations that do not grow, errors of the solver."""

import contextlib
import dataclasses
import math
import warnings

import numpy as np
import pytest

from sim.springs import Net, cloth, simulate
from sim.springs.cloth import pleated_cloth, vertical_cloth
from sim.springs.integrators.implicit import dissection, quasi_newton
from sim.springs.integrators.implicit import steps as implicit
from sim.springs.state import State, advance
from sim.validation import ApproximationWarning

SIX = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])  # of a symmetric block


def grid_matrix(rows, cols, pinned):
    """A random matrix on a grid, dense and as `factorise` takes it: (dense, diagonal, beside, inverse masses)."""
    rng, n = np.random.default_rng(rows * cols), rows * cols
    blocks = 5.0 * rng.standard_normal((n, 4, 3))
    blocks = np.einsum("nea,neb->neab", blocks, blocks)
    dense, free = np.zeros((n, 3, n, 3)), np.ones(n)
    free[pinned] = 0.0
    for a in range(n):
        dense[a, :, a] += np.eye(3)
        for e, (dr, dc) in enumerate(dissection.DIRECTIONS):
            r, c = a // cols + dr, a % cols + dc
            if not (r < rows and 0 <= c < cols):
                continue
            b = r * cols + c
            dense[a, :, a] += blocks[a, e]
            dense[b, :, b] += blocks[a, e]
            dense[a, :, b] -= blocks[a, e]
            dense[b, :, a] -= blocks[a, e]
    diagonal = np.array([dense[a, :, a][SIX] for a in range(n)])
    for a in pinned:
        dense[a] = dense[:, :, a] = 0.0
        dense[a, :, a] = np.eye(3)
    return dense.reshape(3 * n, 3 * n), diagonal.ravel(), blocks[:, :, SIX[0], SIX[1]].ravel(), free


@pytest.mark.parametrize(
    ("rows", "cols", "pinned"),
    [
        (1, 1, []),
        (1, 7, [0]),
        (2, 2, []),
        (4, 5, [3, 19]),
        (13, 17, [0, 100]),
        (9, 2, []),
        (1, 300, [299]),
        (3, 270, []),
    ],
)
def test_the_factors_solve_with_the_matrix_on_the_grid(rows, cols, pinned):
    """To single precision, of small grids and of long ones."""
    dense, diagonal, beside, free = grid_matrix(rows, cols, pinned)
    grid = dissection.dissect(rows, cols)
    dissection.factorise(diagonal, beside, free, grid)
    r = np.random.default_rng(1).standard_normal((3, rows * cols)) * free
    z = np.full(r.size, np.nan)
    for _ in range(2):  # solving leaves the factors as they are
        dissection.solve(grid, r.ravel(), z)
        assert z.reshape(3, -1).T.ravel() == pytest.approx(np.linalg.solve(dense, r.T.ravel()), rel=1e-3, abs=1e-5)


def test_every_particle_is_eliminated_once_and_after_those_that_it_separates():
    grid = dissection.dissect(20, 33)
    assert sorted(grid.order) == list(range(20 * 33))
    for first, count, whole, _, _ in grid.nodes:
        times = grid.order[grid.fronts[first : first + whole]]
        assert (np.diff(times) > 0).all()
        assert (np.diff(times[:count]) == 1).all()


def test_the_factors_take_little_more_than_the_grid():
    """Their numbers grow as n log n: from 32 x 32 to 128 x 128, 16 times as many particles, below 30 times."""
    sizes = [dissection.dissect(n, n).factors.size for n in (32, 128)]
    assert sizes[1] < 30 * sizes[0]


def pleats(n: int, stiffness: float, shear: float, bend: float) -> Net:
    """A curtain of n x n particles."""
    flat = cloth(n, n, 1.6, 1.6, 0.3, stiffness, shear, bend, 0.02, pinned="edge")
    return pleated_cloth(vertical_cloth(flat), 0.62)


def test_steps_remembered_correct_the_factors_as_bfgs_does():
    """Against the formula of Broyden, Fletcher, Goldfarb and Shanno for the whole inverse, more steps than are kept."""
    dense, diagonal, beside, free = grid_matrix(4, 5, [3])
    grid, n = dissection.dissect(4, 5), 60
    dissection.factorise(diagonal, beside, free, grid)
    order = np.arange(n).reshape(20, 3).T.ravel()  # from x, y, z of each particle to all x, all y, all z
    inverse, rng = np.linalg.inv(dense)[np.ix_(order, order)], np.random.default_rng(0)
    forces, u = rng.standard_normal((60, 60)), np.zeros(n)
    real = dense[np.ix_(order, order)] + 0.1 * forces @ forces.T
    memory, count, expected = quasi_newton.make_memory(n), 0, inverse
    steps = rng.standard_normal((quasi_newton.KEPT + 2, n))
    for step in steps:
        count = quasi_newton.remember(memory, count, step / 2.0, 2.0, real @ step, 0.0 * step)
    for step in steps[-quasi_newton.KEPT :]:
        change = real @ step
        turn = np.eye(n) - np.outer(step, change) / (step @ change)
        expected = turn @ expected @ turn.T + np.outer(step, step) / (step @ change)
    assert count == len(steps)
    r = rng.standard_normal(n) * np.tile(free, 3)
    quasi_newton.set_step(memory, count, grid, r, u)
    assert u == pytest.approx(expected @ r, rel=1e-4, abs=1e-4)
    quasi_newton.set_step(memory, count, grid, real @ steps[-1], u)
    assert u == pytest.approx(steps[-1], abs=1e-9)


def test_a_step_that_meets_no_resistance_is_not_remembered():
    memory, step = quasi_newton.make_memory(6), np.arange(1.0, 7.0)
    assert quasi_newton.remember(memory, 3, step, 1.0, step, step) == 3
    assert quasi_newton.remember(memory, 3, step, 1.0, step, 2.0 * step) == 3
    assert quasi_newton.remember(memory, 3, step, 1.0, step, 0.5 * step) == 4


def corrections(n: int, stiffness: float) -> int:
    """Of a stage to 1e-3 of its change: a flat cloth is struck everywhere, so lightly that forces are linear."""
    g, net = 1 / 60, cloth(n, n, 1.6, 1.6, 0.3, stiffness, 0.5 * stiffness, 0.1 * stiffness, 0.02, gravity=0.0)
    p, x0 = net.kernel_view(g), net.x0.ravel()
    v0 = 1e-9 * np.random.default_rng(0).standard_normal(x0.size) * np.tile(net.inverse_masses().ravel() > 0.0, 3)
    limits = implicit.OF_EULER._replace(error=math.inf, most=100)
    work = implicit.make_work(p, False)
    taken, *_ = implicit.solve_stage(x0, v0, 0.0 * v0, g, g, limits, False, p, x0.copy(), v0.copy(), work)
    return taken


def test_corrections_grow_neither_with_the_grid_nor_with_stiffness():
    """Each is one solve with the factors. Conjugate gradients with blocks of 3 x 3 took hundreds to thousands."""
    counts = {(n, k): corrections(n, k) for n in (32, 64, 128) for k in (1e3, 1e4, 1e6)}
    assert max(counts.values()) <= 1.5 * min(counts.values())
    assert max(counts.values()) < 20


TIGHT = implicit.OF_EULER._replace(error=0.0, usable=0.0, most=400)


def tight_run(net: Net, steps: int) -> np.ndarray:
    """Positions after steps of implicit Euler of 1/60 s, each solved to round-off."""
    state, h = State.at_rest(net), 1 / 60
    x, v, p = state.x.ravel(), state.v.ravel(), net.kernel_view(h)
    work = implicit.make_work(p, False)
    for s in range(steps):
        x0, v0 = x.copy(), v.copy()
        *_, settled, _ = implicit.solve_stage(x0, v0, 0.0 * v0, h, (s + 1) * h, TIGHT, False, p, x, v, work)
        assert settled
    return state.x


@pytest.mark.parametrize("stiffness", [800.0, 1e4, 1e5])
def test_the_solver_s_error_is_below_a_hundredth_of_the_method_s_own(stiffness):
    """Though steps end after so many corrections, settled or not."""
    net = dataclasses.replace(pleats(16, stiffness, 200.0, 6.0), gravity=(3.0, 5.0, -9.81))
    steps = 24
    state, fine = State.at_rest(net), State.at_rest(net)
    advance(net, state, "implicit_euler", 1 / 60, steps)
    advance(net, fine, "leapfrog", 1 / 24000, 400 * steps)
    tight = tight_run(net, steps)
    own = np.sqrt(((tight - fine.x) ** 2).mean())
    assert own > 1e-3
    assert np.sqrt(((state.x - tight) ** 2).mean()) < 0.01 * own


def test_a_step_depends_on_no_step_before_it_in_the_same_call():
    net = pleats(12, 1e5, 200.0, 6.0)
    one, many = State.at_rest(net), State.at_rest(net)
    advance(net, one, "implicit_euler", 1 / 64, 6)
    for _ in range(6):
        advance(net, many, "implicit_euler", 1 / 64, 1)
    assert (one.x == many.x).all()
    assert one.force_evals == many.force_evals


def test_a_cloth_that_falls_freely_is_solved_in_two_corrections():
    net = cloth(24, 24, stiffness=1e6, shear=5e5, bend=1e5, pinned="free")
    state = State.at_rest(net)
    advance(net, state, "implicit_euler", 1 / 60, 10)
    assert state.force_evals <= 30
    assert state.v[2] == pytest.approx(-9.81 / 6, rel=1e-6)


@pytest.mark.parametrize(("n", "stiffness"), [(12, 1e4), (16, 1.5e6)])
def test_the_midpoint_method_s_account_closes_on_a_damped_cloth_that_buckles(n, stiffness):
    """Also where steps do not settle: what they leave would feed the motion, but is mended."""
    net = dataclasses.replace(pleats(n, stiffness, 200.0, 6.0), gravity=(3.0, 5.0, -9.81))
    is_settled = stiffness < 1e6
    warned = pytest.warns(ApproximationWarning, match="implicit_midpoint had not settled")
    with contextlib.nullcontext() if is_settled else warned:
        run = simulate(net, 0.5, 31, 1 / 60, "implicit_midpoint", with_account=True)
    total = run.energy.total + run.energy.dissipated
    assert (run.unsettled == 0) == is_settled
    assert run.energy.dissipated[-1] > 10.0
    assert np.abs(total - total[0]).max() < 1e-9 * run.energy.kinetic.max()


def test_steps_that_were_taken_unsettled_are_counted_however_they_are_shared_out():
    net = pleats(12, 1e6, 200.0, 6.0)
    one, many, loose = State.at_rest(net), State.at_rest(net), State.at_rest(net)
    advance(net, one, "implicit_euler", 1 / 64, 20)
    for _ in range(20):
        advance(net, many, "implicit_euler", 1 / 64, 1)
    advance(net, loose, "leapfrog", 1e-5, 20)
    assert 0 < one.unsettled == many.unsettled <= 20
    assert loose.unsettled == 0
    with pytest.warns(
        ApproximationWarning, match=f"implicit_euler had not settled in {one.unsettled} steps of 0.015625 s"
    ):
        run = simulate(net, 20 / 64, 2, 1 / 64, "implicit_euler")
    assert run.unsettled == one.unsettled
    with warnings.catch_warnings():
        warnings.simplefilter("error", ApproximationWarning)
        assert simulate(net, 20e-5, 2, 1e-5, "leapfrog").unsettled == 0


@pytest.mark.parametrize("may_split", [True, False])
def test_a_stage_that_will_not_be_usable_ends_early_if_it_may_be_split(may_split):
    net = dataclasses.replace(pleats(16, 1e6, 200.0, 6.0), gravity=(3.0, 5.0, -9.81))
    state, g, limits = State.at_rest(net), 1 / 120, implicit.OF_MIDPOINT
    advance(net, state, "implicit_midpoint", 1 / 60, 2)
    x0, v0, p = state.x.ravel(), state.v.ravel(), net.kernel_view(2 * g)
    work = implicit.make_work(p, True)
    taken, _, settled, usable = implicit.solve_stage(
        x0, v0, 0.0 * v0, g, state.t, limits, may_split, p, x0.copy(), v0.copy(), work
    )
    assert not settled
    assert not usable
    assert taken == (implicit.FEW if may_split else limits.most)


def test_a_stiff_curtain_settles_in_halves_rather_than_after_many_corrections():
    """Both are counted: the steps that have not settled, and the force evaluations."""
    net = dataclasses.replace(pleats(24, 3e4, 200.0, 6.0), gravity=(3.0, 5.0, -9.81))
    state = State.at_rest(net)
    advance(net, state, "implicit_midpoint", 1 / 60, 24)
    assert state.unsettled == 0
    assert state.force_evals < 24 * 400
