"""The longest stable step of a mooring, against all modes of dense matrices."""

import functools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System, critical_step, read_moordyn
from sim.springs import INTEGRATORS, State
from sim.springs.stability import top_modes
from sim.water import Water
from tests.sim.mooring.dense import Array, frequencies_squared, longest_steps, unit_mass_matrices
from tests.sim.mooring.systems import chain_on_bed, taut_rope

FILES = sorted((Path(__file__).with_name("moordyn") / "files").glob("*.txt"))
SYSTEMS: dict[str, Callable[[], System]] = {
    **{f"chain of {n}": functools.partial(chain_on_bed, n) for n in (2, 5, 20, 80)},
    **{f"taut rope of {n}": functools.partial(taut_rope, n) for n in (2, 20)},
    **{path.stem: functools.partial(read_moordyn, path) for path in FILES},
}
TOLERANCES = {"rk4": 1e-3, "dopri5": 1e-3, "dop853": 1e-3, "symplectic_euler": 5e-3}


@functools.cache
def system_of(name: str) -> System:
    """A system at rest, made when a test asks for it: its kernels take seconds to compile."""
    return SYSTEMS[name]()


@functools.cache
def matrices(name: str) -> tuple[Array, Array]:
    """`unit_mass_matrices` of a system at rest."""
    system = system_of(name)
    return unit_mass_matrices(system, State.at_rest(system).x)


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_longest_step_is_that_of_all_damped_modes(name):
    system = system_of(name)
    state = State.at_rest(system)
    *exact, undamped = longest_steps(*matrices(name), [INTEGRATORS[one] for one in (*TOLERANCES, "leapfrog")])
    for (method, tolerance), step in zip(TOLERANCES.items(), exact, strict=True):
        assert critical_step(system, method, state) == pytest.approx(step, rel=tolerance)
    # A slack link counts as taut, so that the step may be shorter.
    assert 0.995 * undamped < critical_step(system, "leapfrog", state) < 1.0001 * undamped


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_longest_step_of_rkn8_is_not_only_that_of_the_stiffest_mode(name):
    """Its limit falls and rises with the damping: that of each undamped mode, with the damping of its shape."""
    system = system_of(name)
    state = State.at_rest(system)
    K, D = matrices(name)
    squares, shapes = np.linalg.eigh(K)
    rates = np.einsum("ij,ij->j", shapes, D @ shapes)
    pairs = [(math.sqrt(max(square, 0.0)), rate) for square, rate in zip(squares, rates, strict=True)]
    most, worst = np.linalg.eigh(D)
    pairs.append((math.sqrt(max(float(worst[:, -1] @ K @ worst[:, -1]), 0.0)), float(most[-1])))
    exact = min(INTEGRATORS["rkn8"].stable_step(*pair) for pair in pairs if pair[0] ** 2 > 1e-9 * squares[-1])
    assert critical_step(system, "rkn8", state) == pytest.approx(exact, rel=2e-3)


def test_a_slack_link_counts_as_one_that_is_just_taut():
    """A line whose upper end comes nearer: as stiff as if it were taut in the same direction."""
    system = taut_rope(20)
    places = np.linspace((-20.0, 0.0, -50.0), (0.0, 0.0, -1.0), 21).T
    taut, slack = (State.at_rest(system) for _ in range(2))
    taut.x[:, system.nodes_of[1]] = places
    slack.x[:, system.nodes_of[1]] = 0.9 * places
    assert frequencies_squared(system, slack.x)[-1] < 1e-3 * frequencies_squared(system, taut.x)[-1]
    assert top_modes(system, slack.x)[0].omega == pytest.approx(top_modes(system, taut.x)[0].omega, rel=0.01)


def test_of_long_lines_only_products_are_taken():
    kind = LineType("chain", 0.1, 80.0, 5e8)
    points = (Point(1, "fixed", (0.0, 0.0, -200.0)), Point(2, "coupled", (800.0, 0.0, 0.0)))
    steps = [
        critical_step(System((Line(1, kind, 1, 2, 850.0, n),), points, Water(200.0)), "leapfrog") for n in (100, 2000)
    ]
    assert steps[0] / steps[1] == pytest.approx(20.0, rel=1e-3)  # 2/omega = l sqrt(m/EA)


def test_a_line_without_free_nodes_has_no_limit():
    assert critical_step(taut_rope(1), "leapfrog") == math.inf
