"""Bending stiffness of lines against closed forms of beams, and its energy and tangent against differences."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System, critical_step, read_moordyn, simulate
from sim.springs.analysis.energy import energies
from sim.springs.forces.under_water.bending import energy
from sim.springs.points.acceleration import set_rest_forces
from sim.springs.state import State
from sim.water import Water
from tests.refusals import assert_refused
from tests.sim.mooring.dense import frequencies_squared, stiffness_matrix
from tests.sim.mooring.systems import chain_on_bed

NO_WATER = Water(50.0, density=0.0)
FILES = Path(__file__).with_name("moordyn") / "files"
EI, LENGTH = 1e4, 10.0


def cantilever(segments: int, pull: float, load: float) -> System:
    """A weightless beam, clamped along x, with a pull along it and a load down at its free end."""
    kind = LineType("beam", 0.01, 1e-6, 1e7, 0.0, bending=EI)
    points = (
        Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "free", (LENGTH, 0.0, -5.0), 1e-3, force=(pull, 0.0, -load)),
    )  # fmt: skip
    line = Line(1, kind, 1, 2, LENGTH, segments, clamp_at_start=(1.0, 0.0, 0.0))
    return System((line,), points, dataclasses.replace(NO_WATER, gravity=1e-9), bed_stiffness=0.0)


@pytest.mark.parametrize("pull", [1.0, 10.0, 100.0])
def test_a_cantilever_sinks_as_the_beam_with_a_pull_does(pull):
    """w = P/H (L - tanh(b L)/b) with b = sqrt(H/EI) (Timoshenko and Gere, Theory of Elastic Stability, 1.11)."""
    b = math.sqrt(pull / EI)
    exact = 1.0 / pull * (LENGTH - math.tanh(b * LENGTH) / b)
    errors = []
    for segments in (10, 20, 40):
        rest = cantilever(segments, pull, 1.0).at_rest()
        errors.append((-5.0 - rest.x[1][-1, 2]) / exact - 1.0)
    assert 0.0 < errors[0] < 5e-3
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(4.0, rel=0.05)  # of second order


def test_the_axial_force_at_a_clamp_is_the_pull_along_it():
    """The fraction of bending is of the size of EI times the squared curvature: 3 % here."""
    rest = cantilever(40, 1000.0, 300.0).at_rest()
    ways = np.diff(rest.x[1], axis=0)
    along = (1000.0 * ways[:, 0] - 300.0 * ways[:, 2]) / np.linalg.norm(ways, axis=1)
    assert rest.tension[1] == pytest.approx(along, rel=1e-6)


# Least tension [N] of each line, where it hangs lowest or highest, with MoorDyn 2.7.2 as in `test_moordyn_features.py`.
LEAST = {"stiff_sagbend": 30141.233, "stiff_slack": 2751.1125}


@pytest.mark.parametrize("name", LEAST)
def test_the_tension_in_the_sagbend_is_that_of_moordyn(name):
    system = read_moordyn(FILES / f"{name}.txt")
    assert system.at_rest().tension[1].min() == pytest.approx(LEAST[name], rel=1e-3)


def test_a_clamp_at_the_end_is_that_at_the_start_of_a_line_the_other_way_round():
    system = cantilever(12, 10.0, 1.0)
    line = system.lines[0]
    turned = line._replace(start=2, end=1, clamp_at_start=None, clamp_at_end=(-2.0, 0.0, 0.0))
    there, here = (dataclasses.replace(system, lines=(one,)).at_rest() for one in (line, turned))
    assert here.x[1][::-1] == pytest.approx(there.x[1], abs=1e-9)
    assert here.x[1][0, 2] < -5.03


def beam(segments: int) -> System:
    """A beam of 1 N/m between two supports, with a tension of 10 N."""
    kind = LineType("beam", 0.01, 1.0 / 9.81, 1e7, 0.0, bending=1e5)
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "fixed", (LENGTH, 0.0, -5.0)))
    return System((Line(1, kind, 1, 2, LENGTH / (1.0 + 1e-6), segments),), points, NO_WATER, bed_stiffness=0.0)


def test_a_beam_on_two_supports_sinks_as_its_closed_form():
    rest = beam(20).at_rest()
    assert -5.0 - rest.x[1][:, 2].min() == pytest.approx(5.0 * LENGTH**4 / (384.0 * 1e5), rel=3e-3)


def test_a_beam_on_two_supports_swings_as_its_closed_form():
    """omega^2 m = T (n pi/L)^2 + EI (n pi/L)^4."""
    found = frequencies_squared(beam(40))
    k = np.pi / LENGTH * np.array([1.0, 1.0, 2.0, 2.0])  # in both planes
    exact = (10.0 * k**2 + 1e5 * k**4) * 9.81
    assert found[:4] == pytest.approx(exact, rel=5e-3)


def bent(system: System) -> tuple[np.ndarray, np.ndarray]:
    """Positions (3, n) and velocities of a line that is bent all over."""
    rng = np.random.default_rng(3)
    x = system.at_rest().nodes
    x[:, 2:] += 0.02 * rng.normal(size=x[:, 2:].shape)
    return x, rng.normal(size=x.shape)


def test_force_and_tangent_of_bending_are_derivatives_of_its_energy():
    system = cantilever(6, 50.0, 3.0)
    x, _ = bent(system)
    p = system.kernel_view(1.0)
    only = p._replace(links=p.links * [1.0, 0.0, 0.0, 0.0, 0.0], loads=0.0 * p.loads, gz=0.0)
    f = np.zeros(3 * p.cols)
    set_rest_forces(x.reshape(-1), only, f)
    step, flat = 1e-4, x.reshape(-1)
    slopes = np.array(
        [
            (energy(flat + step * one, 0.0, only) - energy(flat - step * one, 0.0, only)) / (2.0 * step)
            for one in np.eye(flat.size)
        ]
    )
    assert f[: flat.size] == pytest.approx(-slopes, rel=1e-6, abs=1e-6 * np.abs(slopes).max())
    matrix = stiffness_matrix(x, only)
    u = np.random.default_rng(5).normal(size=len(matrix))
    moved = x.copy()
    moved[:, 1:] += 1e-3 * u.reshape(3, -1)
    g = np.zeros(3 * p.cols)
    set_rest_forces(moved.reshape(-1), only, g)
    change = (g - f)[: flat.size].reshape(3, -1)[:, 1:].reshape(-1)
    assert change == pytest.approx(-1e-3 * matrix @ u, rel=1e-6, abs=1e-9 * np.abs(change).max())
    assert energies(x.reshape(-1), 0.0 * flat, 0.0, only)[1] == pytest.approx(energy(flat, 0.0, only))


def test_the_account_of_a_stiff_line_with_a_table_and_slack_damping_balances():
    kind = LineType("rope", 0.05, 5.0, 2e6, -0.3, bending=3e3, curve=((0.0, 0.0), (0.01, 1e4), (0.03, 8e4)))
    points = (Point(1, "fixed", (-20.0, 0.0, -29.0)), Point(2, "coupled", (0.0, 0.0, -5.0)))
    system = System((Line(1, kind, 1, 2, 31.0, 12),), points, Water(30.0), slack_damping=True)
    swing = lambda t: (1.5 * math.sin(2.0 * t), 0.0, -5.0 + 0.5 * math.sin(3.0 * t))  # noqa: E731
    run = simulate(system, duration=6.0, frames=61, step=2.5e-4, integrator="rk4", with_account=True, motion={2: swing})
    assert run.tension[1].min() < 0.0  # a slack link that shortens is damped
    work = np.abs(run.energy.dissipated).max()
    assert np.abs(run.energy.error).max() < 2e-4 * work


def test_slack_links_are_damped_on_demand_only():
    kind = LineType("rope", 0.05, 5.0, 2e6, 500.0)
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "fixed", (8.0, 0.0, -5.0)))
    system = System(
        (Line(1, kind, 1, 2, 10.0, 2),), points, dataclasses.replace(NO_WATER, gravity=0.0), bed_stiffness=0.0
    )
    from sim.springs.forces.under_water.bending import set_line_tensions

    x, v, out = np.array([0.0, 8.0, 4.0, 0.0, 0.0, 0.0, -5.0, -5.0, -5.0]), np.zeros(9), np.empty(2)
    v[2] = 0.3
    set_line_tensions(x, v, system.kernel_view(1.0), out)
    assert out == pytest.approx([0.0, 0.0])
    set_line_tensions(x, v, dataclasses.replace(system, slack_damping=True).kernel_view(1.0), out)
    assert out == pytest.approx([0.3 * 100.0, -0.3 * 100.0])  # the other one shortens


@pytest.mark.filterwarnings("ignore:the run with leapfrog")
@pytest.mark.parametrize(("factor", "holds"), [(0.95, True), (1.05, False)])
def test_a_stiff_line_diverges_at_the_step_of_the_gauge(factor, holds):
    kind = LineType("beam", 0.01, 0.1, 2e4, 0.0, bending=1e4)  # so that bending sets the step
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "fixed", (10.0, 0.0, -5.0)))
    system = System((Line(1, kind, 1, 2, 9.99, 20),), points, NO_WATER, bed_stiffness=0.0)
    rest = system.at_rest()
    rest.nodes[2, 2:] += 1e-6 * (-1.0) ** np.arange(19)
    step = factor * critical_step(system, "leapfrog", State.still(rest.nodes))
    plain = dataclasses.replace(system, lines=(system.lines[0]._replace(type=kind._replace(bending=0.0)),))
    assert step < 0.7 * critical_step(plain, "leapfrog")
    v = simulate(system, duration=400 * step, frames=2, step=step, start=State.still(rest.nodes))
    moved = np.abs(v.x[1][-1] - v.x[1][0]).max()
    assert (moved < 1e-4) == holds


def test_lines_with_tables_stretch_as_their_rows_say():
    """Weights hang on two ropes of unlike tables and one of constant EA; the last weighs more than the last row."""
    tables = ((0.0, 0.0), (0.01, 100.0), (0.03, 500.0)), ((0.0, 0.0), (0.02, 1e4), (0.05, 2e4), (0.1, 9e4))
    kinds = [LineType(f"rope {i}", 1e-3, 1e-6, 2e4, 0.0, curve=curve) for i, curve in enumerate((*tables, ()))]
    points, lines = [], []
    for i, (kind, weight) in enumerate(zip([*kinds, kinds[0]], (300.0, 15e3, 500.0, 700.0), strict=True)):
        top = (float(i), 0.0, -1.0)
        points += [Point(2 * i, "fixed", top), Point(2 * i + 1, "free", (float(i), 0.0, -3.0), weight / 9.81)]
        lines.append(Line(i, kind, 2 * i, 2 * i + 1, 2.0, 4))
    rest = System(tuple(lines), tuple(points), NO_WATER, bed_stiffness=0.0).at_rest()
    for i, strain in enumerate((0.02, 0.035, 500.0 / 2e4, 0.03 + 200.0 / 2e4)):
        assert -1.0 - rest.x[i][-1, 2] == pytest.approx(2.0 * (1.0 + strain), rel=1e-6)


ROWS = [
    ("line type chain: bending", {"bending": -1.0}),
    ("line type chain: bending", {"bending": math.nan}),
    ("line type chain: curve", {"curve": ((0.0, 0.0),)}),
    ("line type chain: curve", {"curve": ((0.0, 1.0), (0.1, 2.0))}),
    ("line type chain: curve", {"curve": ((0.0, 0.0), (0.1, 2.0), (0.2, 2.0))}),
]


@pytest.mark.parametrize(("name", "fields"), ROWS)
def test_what_no_line_has_is_refused(name, fields):
    system = chain_on_bed(4)
    line = system.lines[0]
    assert_refused(
        name, lambda: System((line._replace(type=line.type._replace(**fields)),), system.points, Water(40.0))
    )


def test_a_clamp_of_a_line_that_does_not_resist_bending_is_refused():
    system = chain_on_bed(4)
    lines = (system.lines[0]._replace(clamp_at_end=(1.0, 0.0, 0.0)),)
    assert_refused("line 1: clamp_at_end", lambda: System(lines, system.points, Water(40.0)), "EI")
    beam = cantilever(4, 1.0, 1.0)
    for direction in ((0.0, 0.0, 0.0), (1.0, math.nan, 0.0)):
        lines = (beam.lines[0]._replace(clamp_at_start=direction),)
        assert_refused("line 1: clamp_at_start", lambda lines=lines: System(lines, beam.points, Water(40.0)))
