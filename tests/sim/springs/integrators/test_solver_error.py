"""The solver of implicit steps against Newton's method with SciPy's sparse factors, and the orders that it leaves."""

import dataclasses

import numpy as np
import pytest
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import splu

from sim.springs import INTEGRATORS, Net, cloth, rope
from sim.springs.cloth import vertical_cloth
from sim.springs.integrators.implicit.steps import GAMMA
from sim.springs.net import link_table
from sim.springs.points.acceleration import set_acceleration
from sim.springs.state import State, advance
from tests.sim.springs.nets import FAMILIES
from tests.sim.springs.reference import exact, integrated, slope


class Reference:
    """Stages v = V + g a(X + g v, v) of a net of springs with isotropic damping, solved to round-off."""

    def __init__(self, net: Net):
        self.net, self.p = net, net.kernel_view(1.0)
        self.n, self.free = net.x0[0].size, np.tile(net.inverse_masses() > 0.0, 3)
        self.mass = np.tile(net.masses.ravel(), 3)
        self.ends, self.links = link_table(net.shape, net.families, float(net.side_ratio))

    def acceleration(self, x, v):
        a = np.zeros_like(x)
        set_acceleration(x, v, 0.0, self.p, a)
        return a

    def matrix(self, x, g):
        """M + g D + g^2 K of the free points."""
        a, b, (rest, k, damping) = self.ends[:, 0], self.ends[:, 1], self.links.T
        r = x.reshape(3, -1)[:, b] - x.reshape(3, -1)[:, a]
        length = np.linalg.norm(r, axis=0)
        turning = k * (1.0 - rest / length)
        parts = [(np.arange(3 * self.n), np.arange(3 * self.n), self.mass + g * self.net.drag)]
        for e in range(3):
            for f in range(3):
                s = g * g * (k - turning) * r[e] * r[f] / length**2
                s = s + (g * g * turning + g * damping if e == f else 0.0)
                for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                    parts.append((e * self.n + i, f * self.n + j, sign * s))
        i, j, s = (np.concatenate([np.asarray(part[q]) for part in parts]) for q in range(3))
        whole = coo_array((s, (i, j)), shape=(3 * self.n, 3 * self.n)).tocsc()
        hold = diags_array(self.free.astype(float))
        return (hold @ whole @ hold + diags_array(1.0 - self.free)).tocsc()

    def stage(self, X, V, g, v):
        """x and v, by Newton's method with steps cut until the residual falls."""

        def residual(v):
            return np.where(self.free, self.mass * (V + g * self.acceleration(X + g * v, v) - v), 0.0)

        v = v.copy()
        r = residual(v)
        for _ in range(100):
            u, part = splu(self.matrix(X + g * v, g)).solve(r), 1.0
            if np.abs(u).max() <= 1e-9 * np.abs(v).max():
                return X + g * (v + u), v + u
            while part > 1e-3 and np.linalg.norm(residual(v + part * u)) > (1.0 - 0.1 * part) * np.linalg.norm(r):
                part *= 0.5
            v += part * u
            r = residual(v)
        raise AssertionError("the reference does not converge")

    def step(self, name, x, v, h):
        if name == "implicit_euler":
            return self.stage(x, v, h, v)
        g, c = 0.5 * GAMMA * h, 1.0 / (GAMMA * (2.0 - GAMMA))
        a = np.where(self.free, self.acceleration(x, v), 0.0)
        x1, v1 = self.stage(x + g * v, v + g * a, g, v)
        return self.stage(c * x1 + (1.0 - c) * x, c * v1 + (1.0 - c) * v, g, v1)

    def run(self, name, state, h, steps):
        x, v = state.x.ravel().copy(), state.v.ravel().copy()
        for _ in range(steps):
            x, v = self.step(name, x, v, h)
        return x.reshape(state.x.shape)


@pytest.mark.parametrize("points", [257, 600, 5000])
@pytest.mark.parametrize("name", ["implicit_euler", "tr_bdf2"])
def test_a_long_rope_of_unequal_masses_is_solved_to_round_off(name, points):
    masses = 0.02 * np.linspace(1.0, 1.2, points)
    net = rope(points, 5.0, masses, 1e5, 0.5, 0.01)
    state, h = State.at_rest(net), 1 / 240
    expected = Reference(net).run(name, state, h, 12)
    advance(net, state, name, h, 12)
    assert np.abs(expected - net.x0).max() > 0.01
    assert state.unsettled == 0
    assert state.x == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("name", ["implicit_euler", "tr_bdf2"])
def test_a_long_net_of_one_row_is_solved_as_the_rope_that_it_is(name):
    """By the factors of a net, as it has links that skip points, without stiffness; with tolerances of its own."""
    net = rope(600, 5.0, 0.02, 1e5, 0.5, 0.01)
    chain, wide = State.at_rest(net), State.at_rest(net)
    advance(net, chain, name, 1 / 240, 24)
    other = (family._replace(stiffness=0.0, damping=0.0) for family in FAMILIES[1:])
    advance(dataclasses.replace(net, families=(*net.families, *other)), wide, name, 1 / 240, 24)
    assert wide.unsettled == 0
    assert wide.x == pytest.approx(chain.x, abs=1e-4)


def strip(rows: int, cols: int, stretch: float, noise: float, speed: float) -> tuple[Net, State]:
    """A hanging strip of cloth, held along its upper edge, its points displaced and in motion."""
    flat = cloth(rows, cols, 0.01 * cols, 0.01 * rows, 1.0, 2e4, 1e4, 2e3, 0.05, pinned="edge")
    net = vertical_cloth(flat)
    state, rng = State.at_rest(net), np.random.default_rng(0)
    free = net.inverse_masses().reshape(net.shape) > 0.0
    state.x[:] = net.x0 * (1.0 + stretch) + noise * rng.standard_normal(net.x0.shape) * free
    state.v[:] = speed * rng.standard_normal(net.x0.shape) * free
    return net, state


@pytest.mark.parametrize(
    ("rows", "cols"), [(6, 255), (6, 256), (6, 257), pytest.param(40, 300, marks=pytest.mark.long)]
)
@pytest.mark.parametrize(("name", "h"), [("implicit_euler", 1 / 240), ("tr_bdf2", 1 / 4800)])
def test_a_step_of_a_stretched_cloth_settles_where_newton_s_method_does(name, h, rows, cols):
    net, state = strip(rows, cols, 0.03, 2e-5, 0.05)
    expected = Reference(net).run(name, state, h, 1)
    before = state.x.copy()
    advance(net, state, name, h, 1)
    motion = np.abs(expected - before).max()
    assert motion > 1e-4
    assert state.unsettled == 0
    assert state.x == pytest.approx(expected, abs=min(1e-5, 0.01 * motion))


@pytest.mark.parametrize(("rows", "cols"), [(6, 256), (6, 257), pytest.param(40, 300, marks=pytest.mark.long)])
def test_a_step_of_a_crumpled_cloth_settles_where_newton_s_method_does_or_is_counted(rows, cols):
    net, state = strip(rows, cols, 1e-3, 2e-4, 0.2)
    expected = Reference(net).run("implicit_euler", state, 1 / 240, 1)
    advance(net, state, "implicit_euler", 1 / 240, 1)
    assert state.unsettled == 1 or np.abs(state.x - expected).max() < 1e-5


SMOOTH = {
    "isotropic": {"damping": 0.3, "drag": 0.05},
    "axial": {"damping": 0.3, "damping_model": "axial"},
    "stiffening": {"damping": 0.1, "law": "stiffening"},
}
SECONDS = 0.24


@pytest.mark.parametrize(
    "case", [case if case != "stiffening" else pytest.param(case, marks=pytest.mark.long) for case in SMOOTH]
)
@pytest.mark.parametrize("name", ["tr_bdf2", "implicit_midpoint"])
def test_the_solver_leaves_a_damped_cloth_its_order(name, case):
    """Its error is below a third of the method's, at every step."""
    net = cloth(5, 6, 1.0, 0.8, 1.0, 300.0, 120.0, 40.0, **SMOOTH[case])
    rng = np.random.default_rng(3)
    free = net.inverse_masses().reshape(net.shape) > 0.0
    net = dataclasses.replace(net, x0=net.x0 + 0.03 * rng.standard_normal(net.x0.shape) * free)
    v0 = 0.3 * rng.standard_normal(net.x0.shape) * free
    truth, _ = exact(net, SECONDS, v0)
    counts, errors = (240, 480, 960, 1920), []
    for steps in counts:
        state = integrated(net, name, SECONDS, steps, v0)
        assert state.unsettled == 0
        errors.append(np.abs(state.x - truth).max())
    assert slope(counts, errors) > 1.9
    assert (np.diff(np.log2(errors)) < -1.6).all()


@pytest.mark.parametrize("name", [name for name, record in INTEGRATORS.items() if record.implicit])
def test_a_step_that_cannot_settle_is_counted(name):
    """A light cloth of 1e8 N/m that buckles, at 1/60 s."""
    flat = cloth(12, 12, 1.6, 1.6, 0.3, 1e8, 200.0, 6.0, 0.02)
    net = dataclasses.replace(vertical_cloth(flat), gravity=(3.0, 5.0, -9.81))
    state = State.at_rest(net)
    state.x *= 0.9
    advance(net, state, name, 1 / 60, 3)
    assert state.unsettled > 0
