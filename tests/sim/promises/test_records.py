"""Public records are what their names promise: copies that nobody can change, comparable, hashable and picklable."""

import copy
import dataclasses
import pickle
import re
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import sim.floating
import sim.mooring
import sim.ocean
import sim.springs
from sim.floating import Body, FloatState, Hull, float_in, linear_forces, make_fleet
from sim.mooring import Line, LineType, MooredBody, Point, System, moored
from sim.ocean import SPECTRA, NonlinearSea, RadialSea, Sea, draw_waves, stokes_wave
from sim.springs import State, advance, cloth, rope, simulate
from sim.springs.net import Net
from sim.springs.statics import catenary
from sim.water import Water
from sim.waves import Waves
from tests.refusals import assert_refused

CHAIN = LineType("chain", 0.1, 200.0, 1e8)
POINTS = (Point(1, "fixed", (-60.0, 0.0, -30.0)), Point(2, "coupled", (0.0, 0.0, -1.0)))
JONSWAP = SPECTRA["jonswap"]


def system(**more: Any) -> System:
    return System((Line(1, CHAIN, 1, 2, 70.0, 5),), POINTS, water=Water(30.0), **more)


def waves() -> Waves:
    return Waves([0.1, 0.2], [0.0, 0.1], [1.0, 0.5], [0.0, 1.0])


RECORDS: dict[str, Callable[[], Any]] = {
    "net": lambda: rope(5), "cloth": lambda: cloth(4, 4), "masses": lambda: rope(3, mass=[1.0, 2.0, 3.0]),
    "system": system, "waves": waves, "water": Water, "hull": lambda: Hull.box(1.0, 1.0, 1.0),
    "body": lambda: Body(Hull.box(1.0, 1.0, 1.0)), "conditions": lambda: JONSWAP.conditions(wind_speed=9.0),
    "state": lambda: State.at_rest(rope(5)), "line": lambda: system().lines[0],
    "sea": lambda: Sea(32, 100.0), "nonlinear sea": lambda: NonlinearSea(32, 100.0, start=Sea(32, 100.0)),
    "radial sea": lambda: RadialSea(draw_waves(JONSWAP, JONSWAP.conditions(wind_speed=9.0), 8)),
    "float state": lambda: FloatState(Sea(32, 100.0), [Body(Hull.box(1.0, 1.0, 0.5)).afloat()]),
    "fleet": lambda: make_fleet([Body(Hull.box(1.0, 1.0, 0.5)).afloat()]), "rest": lambda: system().at_rest(),
    "run": lambda: simulate(rope(5), 0.1, 3), "energy": lambda: simulate(rope(5), 0.1, 3).energy,
    "mooring run": lambda: simulate(system(), duration=0.1, frames=3),
    "float run": lambda: float_in(Sea(32, 100.0), [Body(Hull.box(1.0, 1.0, 0.5)).afloat()], duration=0.1, frames=3),
    "forces": lambda: linear_forces(Body(Hull.box(4.0, 4.0, 2.0)), [1.0, 2.0]), 
    "stokes": lambda: stokes_wave(1.0, 50.0), "catenary": lambda: catenary(20, 1.2, 0.9, 0.0, 1e4, 0.01, 9.81),
    "loaded": lambda: Body(Hull.box(1.0, 1.0, 1.0), mass=500.0, inertia=np.array([50.0, 60.0, 70.0])),
    "moored": lambda: moored(1, Body(Hull.box(4.0, 4.0, 2.0)), 1.0),
    "with body": lambda: system(bodies=(RECORDS["moored"](),)), "at": lambda: Sea(32, 100.0).at([[1.0, 2.0]], 0.0),
    "kinematics": lambda: Sea(32, 100.0).kinematics([[1.0, 2.0, -3.0]], 0.0),
}  # fmt: skip
MUTABLE = {"state"}


def arrays_of(record: Any) -> list[np.ndarray]:
    if dataclasses.is_dataclass(record):
        values = [getattr(record, field.name) for field in dataclasses.fields(record)]
    else:
        values = list(record) if isinstance(record, tuple) else list(vars(record).values())
    return [value for value in values if isinstance(value, np.ndarray)]


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_can_be_compared_hashed_shown_copied_and_saved(name: str) -> None:
    one, other = RECORDS[name](), RECORDS[name]()
    assert one == one
    for same in (one == other, one != other, [one] == [other], (0, one) == (0, other)):
        assert isinstance(same, bool)
    assert (one == other) != (one != other)
    assert isinstance(hash(one), int)
    assert repr(one)
    for again in (pickle.loads(pickle.dumps(one)), copy.deepcopy(one), copy.copy(one)):
        assert type(again) is type(one)
        for before, after in zip(arrays_of(one), arrays_of(again), strict=True):
            np.testing.assert_array_equal(before, after)


@pytest.mark.parametrize("package", [sim.floating, sim.mooring, sim.ocean, sim.springs])
def test_every_public_record_of_arrays_is_equal_to_itself_only(package: ModuleType) -> None:
    public = [getattr(package, name) for name in package.__all__]
    for kind in [kind for kind in public if isinstance(kind, type) and hasattr(kind, "_fields")]:
        if any(re.search(r"^[^\[]*(Array|ndarray)|dict.*Array", str(one)) for one in kind.__annotations__.values()):
            assert (kind.__eq__, kind.__ne__, kind.__hash__) == (object.__eq__, object.__ne__, object.__hash__), kind


def test_a_water_is_a_value() -> None:
    fresh = Water(40, 9.81, 1000)
    assert fresh == Water(np.float64(40.0), density=np.float32(1000.0))  # type: ignore[arg-type]
    assert {fresh: 1}[Water(40.0, density=1000.0)] == 1
    assert all(type(value) is float for value in dataclasses.astuple(fresh))
    with pytest.raises(dataclasses.FrozenInstanceError):
        fresh.depth = 3.0  # type: ignore[misc]
    for name in ("depth", "gravity", "density"):
        assert_refused(name, lambda name=name: Water(**{name: -1.0}))  # type: ignore[misc]


def test_a_saved_sea_is_the_same_sea() -> None:
    places = [[1.0, 2.0], [30.0, -7.0]]
    for name in ("sea", "nonlinear sea", "radial sea"):
        sea = RECORDS[name]()
        sea.at(places, 0.3)
        again = pickle.loads(pickle.dumps(sea))
        assert again.time == sea.time == 0.3
        for t in (0.3, 2.0):
            for one, other in zip(sea.at(places, t), again.at(places, t), strict=True):
                np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("saved", [False, True])
def test_immutable_records_hold_read_only_copies(saved: bool) -> None:
    x0, ratios, kx, mass = rope(5).x0.copy(), np.ones((1, 5)), np.array([0.1]), np.eye(6) * 1e5
    given = rope(5)
    net = Net(x0, given.families, given.mass, given.drag, given.gravity, given.pinned, mass_ratios=ratios)
    wave = Waves(kx, [0.0], [1.0], [0.0])
    moored = system(bodies=(MooredBody(1, (0.0, 0.0, 0.0), mass, np.eye(6)),)).bodies[0]
    if saved:
        net, wave = pickle.loads(pickle.dumps(net)), pickle.loads(pickle.dumps(wave))
    kept = [net.x0, net.mass_ratios, wave.kx, wave.ky, wave.amplitude, wave.phase, wave.omega, wave.k]
    if not saved:
        kept += [moored.mass, moored.stiffness]
    before = [array.copy() for array in kept]
    for array in (x0, ratios, kx, mass):
        array += 9.0
    for array, value in zip(kept, before, strict=True):
        np.testing.assert_array_equal(array, value)
        with pytest.raises(ValueError, match="read-only"):
            array += 1.0
    with pytest.raises(ValueError, match="read-only"):
        copy.deepcopy(net).x0[...] += 1.0


KINDS = {
    "float32": lambda a: a.astype(np.float32), "big-endian": lambda a: a.astype(">f8"), "list": lambda a: a.tolist(),
    "strided": lambda a: np.repeat(a, 2, axis=0)[::2], "Fortran": np.asfortranarray,
    "read-only": lambda a: np.lib.stride_tricks.as_strided(a, writeable=False),
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_of_any_kind_are_taken(kind: str) -> None:
    change = KINDS[kind]
    places = np.array([[1.0, 2.0], [3.5, -4.0], [20.0, 8.0]])
    for name in ("sea", "nonlinear sea", "radial sea"):
        sea = RECORDS[name]()
        np.testing.assert_array_equal(sea.at(change(places), 1.0).velocity, sea.at(places, 1.0).velocity)
        depths = np.column_stack([places, [-1.0, -2.0, -0.5]])
        np.testing.assert_array_equal(
            sea.kinematics(change(depths), 1.0).velocity, sea.kinematics(depths, 1.0).velocity
        )
    numbers = np.array([0.125, 0.25, 0.5])
    taken = Waves(change(numbers), change(numbers), change(numbers), change(numbers))
    np.testing.assert_array_equal(taken.amplitude, numbers)
    assert taken.amplitude.dtype == np.float64


def test_no_points_and_no_waves_are_taken() -> None:
    nothing = np.zeros((0, 2))
    for sea in (
        *(RECORDS[name]() for name in ("sea", "nonlinear sea", "radial sea")),
        RadialSea(Waves([], [], [], [])),
    ):
        assert sea.at(nothing, 1.0).velocity.shape == (0, 3)
        assert sea.height_at(nothing, 1.0)[0].shape == (0,)
        assert sea.kinematics(np.zeros((0, 3)), 1.0).velocity.shape == (0, 3)
    at = RadialSea(Waves([], [], [], [])).at([[0.0, 1.0], [2.0, 3.0]], 1.0, size=[1.0, 2.0])
    assert not at.velocity.any()
    assert at.height.tolist() == [0.0, 0.0]


def test_a_state_that_cannot_be_advanced_is_refused_by_name() -> None:
    net = rope(5)
    state = State.at_rest(net)
    state.x.flags.writeable = False
    assert_refused("state.x", lambda: advance(net, state, "rk4", 1e-3, 1), "read-only")
    state = State.at_rest(net)
    state.v = state.x
    assert_refused("state.v", lambda: advance(net, state, "rk4", 1e-3, 1), "an array of its own")
