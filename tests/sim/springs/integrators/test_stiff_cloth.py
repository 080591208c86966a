"""Implicit steps of a stiff cloth: factors by nested dissection, iterations that do not grow, errors of the solver."""

import dataclasses

import numpy as np
import pytest

from sim.springs import Net, cloth, simulate
from sim.springs.cloth import pleated_cloth, vertical_cloth
from sim.springs.integrators.implicit import dissection, newton
from sim.springs.state import State, advance

SIX = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])  # of a symmetric block


def grid_matrix(rows, cols, pinned, tile=dissection.TILE):
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
            if c // tile == a % cols // tile and r // tile == a // cols // tile:
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
    """To single precision; a grid of more than a tile's columns without the coupling of its tiles."""
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


def iterations(n: int, stiffness: float) -> int:
    """Of a solve to 1e-4 with rough forces on a curtain that is bent, stretched and pressed."""
    g, net = 1 / 60, pleats(n, stiffness, 0.5 * stiffness, 0.1 * stiffness)
    p, rng = net.kernel_view(g), np.random.default_rng(0)
    x = 1.002 * (net.x0.ravel() + rng.normal(0.0, 0.016 / n, net.x0.size))
    work, v = newton.make_work(p, False), np.zeros(x.size)
    newton.set_blocks(x, g, 0.0, p, x, v, work)
    work.r[:] = rng.standard_normal(x.size) * np.tile(net.masses.ravel() * (net.inverse_masses().ravel() > 0.0), 3)
    return newton.correct_net(1e-4, g, p, work)


def test_iterations_grow_neither_with_the_grid_nor_with_stiffness():
    """Block Jacobi takes hundreds to thousands. With stiffness they grow until bend springs outweigh the masses."""
    counts = {(n, k): iterations(n, k) for n in (32, 64, 128) for k in (1e3, 1e4, 1e6)}
    for k in (1e3, 1e4, 1e6):
        assert counts[128, k] <= counts[64, k] <= counts[32, k]
    for n in (32, 64, 128):
        assert counts[n, 1e6] <= 1.5 * counts[n, 1e4]
        assert counts[n, 1e6] <= 2.2 * counts[n, 1e3]
    assert max(counts.values()) < 30


TIGHT = newton.Exactness(share=0.0, usable=0.0, most=200)


def tight_run(net: Net, steps: int) -> np.ndarray:
    """Positions after steps of implicit Euler of 1/60 s, each solved to round-off."""
    state, h = State.at_rest(net), 1 / 60
    x, v, p = state.x.ravel(), state.v.ravel(), net.kernel_view(h)
    work = newton.make_work(p, False)
    for s in range(steps):
        x0, v0 = x.copy(), v.copy()
        *_, settled, _ = newton.solve_stage(x0, v0, h, (s + 1) * h, TIGHT, p, x, v, work, 200)
        assert settled
    return state.x


@pytest.mark.parametrize(("stiffness", "share"), [(800.0, 0.01), (1e4, 0.05)])
def test_the_solver_s_error_is_a_small_part_of_the_method_s_own(stiffness, share):
    """A hundredth; more where links buckle all the time, as steps end after eight corrections."""
    net = dataclasses.replace(pleats(16, stiffness, 200.0, 6.0), gravity=(3.0, 5.0, -9.81))
    steps = 24
    state, fine = State.at_rest(net), State.at_rest(net)
    advance(net, state, "implicit_euler", 1 / 60, steps)
    advance(net, fine, "leapfrog", 1 / 24000, 400 * steps)
    tight = tight_run(net, steps)
    own = np.sqrt(((tight - fine.x) ** 2).mean())
    assert own > 1e-3
    assert np.sqrt(((state.x - tight) ** 2).mean()) < share * own


def test_a_step_depends_on_no_step_before_it_in_the_same_call():
    net = pleats(12, 1e5, 200.0, 6.0)
    one, many = State.at_rest(net), State.at_rest(net)
    advance(net, one, "implicit_euler", 1 / 64, 6)
    for _ in range(6):
        advance(net, many, "implicit_euler", 1 / 64, 1)
    assert (one.x == many.x).all()
    assert one.force_evals == many.force_evals


def test_a_cloth_that_falls_freely_is_solved_in_one_correction_or_two():
    net = cloth(24, 24, stiffness=1e6, shear=5e5, bend=1e5, pinned="free")
    state = State.at_rest(net)
    advance(net, state, "implicit_euler", 1 / 60, 10)
    assert state.force_evals <= 30
    assert state.v[2] == pytest.approx(-9.81 / 6, rel=1e-6)


def test_the_midpoint_method_s_account_closes_on_a_damped_cloth_that_buckles():
    """Midpoints that are not solved feed the motion: the account then misses more than the motion's energy."""
    net = dataclasses.replace(pleats(12, 1e4, 200.0, 6.0), gravity=(3.0, 5.0, -9.81))
    run = simulate(net, 0.5, 31, 1 / 60, "implicit_midpoint", with_account=True)
    total = run.energy.total + run.energy.dissipated
    assert run.unsettled == 0
    assert np.abs(total - total[0]).max() < 0.02 * run.energy.kinetic.max()


def test_steps_that_were_taken_unsettled_are_counted_however_they_are_shared_out():
    net = pleats(12, 1e6, 200.0, 6.0)
    one, many, loose = State.at_rest(net), State.at_rest(net), State.at_rest(net)
    advance(net, one, "implicit_euler", 1 / 64, 20)
    for _ in range(20):
        advance(net, many, "implicit_euler", 1 / 64, 1)
    advance(net, loose, "leapfrog", 1e-5, 20)
    assert 0 < one.unsettled == many.unsettled <= 20
    assert loose.unsettled == 0
    run = simulate(net, 20 / 64, 2, 1 / 64, "implicit_euler")
    assert run.unsettled == one.unsettled
