"""Forces that a net declares act on the student's rope and cloth as on the program's."""

import dataclasses
import types
from typing import Any

import numpy as np
import pytest

from app.lab.process import declared_forces
from app.lab.process.cloth_march import ClothFunctions
from app.lab.process.rope_march import ClothData, Functions, Segment, march, packed, unpacked
from app.lab.process.wire import Foreign, pack, unpack
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.start import build, sphere_home
from app.scenes.springs.student_net import forces_of
from sim.springs import Net, State, advance, rope
from sim.springs.forces import OWN

STEPS, H, START = 60, 1e-3, 2.0  # their number, [s], and the time [s] of the first
OF_EACH = pytest.mark.parametrize("numbers", [pytest.param(one(), id=force.name) for one, force in OWN.items()])
NO_TASK = types.ModuleType("rope")  # of which no function is written: the reference solutions move it


def march_by_reference(net: Net, sheet: ClothData | None = None) -> np.ndarray:
    """Positions (n, 3) [m] after the steps, through the messages between the lab and the process that takes them."""
    forces = forces_of(net, START)._replace(mass=net.mass)
    segment = Segment(STEPS, H, forces, np.zeros((0, 4, 3)))
    segment = unpacked(unpack(pack(packed(segment), lambda _: 0), lambda _: None))
    functions: Any = Functions(NO_TASK, (), "step_rk4", {})
    if sheet is not None:
        functions = ClothFunctions(NO_TASK, (), "step_rk4", sheet)
    x = net.x0.reshape(3, -1).T
    return march(functions, x, np.zeros_like(x), [segment]).x[-1]


def march_by_program(net: Net) -> np.ndarray:
    state = State(net.x0.copy(), np.zeros_like(net.x0), START)
    advance(net, state, "rk4", H, STEPS)
    return state.x.reshape(3, -1).T


@OF_EACH
def test_the_student_s_rope_moves_under_it_as_the_program_s(numbers: Any) -> None:
    still = rope(5, 1.0, floor=None)
    net = dataclasses.replace(still, forces=(numbers,))
    x = march_by_reference(net)
    np.testing.assert_allclose(x, march_by_program(net), rtol=0.0, atol=1e-10)
    assert np.abs(x - march_by_program(still)).max() > 1e-5


@OF_EACH
def test_the_student_s_cloth_moves_under_it_as_the_program_s(numbers: Any) -> None:
    """Its points have unlike masses, and two of them are pinned."""
    params = ClothParams(rows=4, cols=5, stiffness=100.0, shear=60.0, bend=3.0, gather=1.0)
    still = build(params, sphere_home(params))
    across, down, shear, _, bend, _ = still.families
    pins = tuple(5 * i + j for i, j in sorted(still.pinned))
    sheet = ClothData(4, 5, (across.rest, down.rest), shear.stiffness, bend.stiffness, pins)
    net = dataclasses.replace(still, forces=(numbers,))
    x = march_by_reference(net, sheet)
    np.testing.assert_allclose(x, march_by_program(net), rtol=0.0, atol=1e-10)
    assert np.abs(x - march_by_program(still)).max() > 1e-5


def test_what_a_function_returns_passes_from_one_process_to_another() -> None:
    def refuse(function: object) -> int:
        raise AssertionError

    def through(value: object) -> object:
        return unpack(pack(value, refuse), refuse)

    assert through(np.array([1, "a", None], dtype=object)) == [1, "a", None]
    assert through((1, [2.5, True], "x", None)) == (1, [2.5, True], "x", None)
    assert through({3}) == [3]
    assert through(np.int64(7)) == 7
    assert through(2**70) == float(2**70)
    array = np.arange(6.0).reshape(2, 3)[:, ::2]
    assert np.array_equal(through(array), array)  # type: ignore[arg-type]
    assert through(1 + 2j) == 1 + 2j
    for value, name in ((np.array(["ab"]), "array of <U2"), ({}, "dict"), (b"x", "bytes")):
        found = through(value)
        assert isinstance(found, Foreign)
        assert found.type_name == name


def test_points_go_to_the_kernel_by_components_and_their_accelerations_come_back_by_points(monkeypatch):
    rng = np.random.default_rng(3)
    x, v, record = rng.normal(size=(4, 3)), rng.normal(size=(4, 3)), object()
    asked = []

    def set_declared(x, v, t, p, a):
        asked.append((t, p))
        a[:] = 2.0 * x + 3.0 * v

    monkeypatch.setattr(declared_forces, "set_declared", set_declared)
    assert declared_forces.accelerations(x, v, 1.5, record) == pytest.approx(2.0 * x + 3.0 * v)
    assert asked == [(1.5, record)]
