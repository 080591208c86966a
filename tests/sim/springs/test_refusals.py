"""What the library refuses: kernels check no index, so that a wrong net or state would write beyond its arrays."""

import dataclasses
import math

import numpy as np
import pytest

from sim.springs import (
    INTEGRATORS,
    Air,
    Contact,
    Grab,
    PinPath,
    State,
    advance,
    cloth,
    critical_step,
    lab_units,
    rope,
    simulate,
)  # fmt: skip
from sim.springs.net import Family
from sim.springs.stability import critical_stiffness, gauge, top_modes
from sim.springs.state import energy, velocities

STILL = ((0.0, 0.0, 0.0),) * 4
HUGE = 10**7
FIELDS = [  # of a rope of ten points: field, value, name in the error
    ("x0", np.zeros((2, 1, 10)), "x0"),
    ("x0", np.zeros((3, 10)), "x0"),
    ("x0", np.zeros((3, 0, 10)), "x0"),
    ("x0", np.zeros((3, 1, 10), dtype=bool), "x0"),
    ("x0", np.full((3, 1, 10), 2e9), "x0"),
    ("x0", [[0.0]], "x0"),
    ("families", (Family(0, 0, 0.1, 1.0, 0.0),), "families"),
    ("families", (Family(0, -1, 0.1, 1.0, 0.0),), "families"),
    ("families", (Family(-1, 0, 0.1, 1.0, 0.0),), "families"),
    ("families", (Family(0, 1.5, 0.1, 1.0, 0.0),), "families"),  # type: ignore[arg-type]
    ("families", (Family(0, 1, -0.1, 1.0, 0.0),), "families rest"),
    ("families", (Family(0, 1, 0.1, math.nan, 0.0),), "families stiffness"),
    ("families", (Family(0, 1, 0.1, 1.0, -1.0),), "families damping"),
    ("mass", 0.0, "mass"),
    ("mass", math.nan, "mass"),
    ("mass", -1.0, "mass"),
    ("drag", -1.0, "drag"),
    ("gravity", (0.0, 10.0), "gravity"),
    ("pinned", frozenset({(0, 10)}), "pinned"),
    ("pinned", frozenset({(-1, 0)}), "pinned"),
    ("pinned", frozenset({(0, 0.5)}), "pinned"),
    ("damping_model", "Axial", "damping_model"),
    ("floor", math.nan, "floor"),
    ("sphere", (0.0, 0.0, 0.0, -1.0), "sphere radius"),
    ("sphere_velocity", (0.0, 1.0), "sphere_velocity"),
    ("sphere_velocity", (0.0, 1.0, math.inf), "sphere_velocity"),
    ("epoch", math.nan, "epoch"),
    ("contact", Contact(-1.0), "contact.stiffness"),
    ("radius", -0.1, "radius"),
    ("thickness", math.inf, "thickness"),
    ("thickness", -0.1, "thickness"),
    ("threads", 0, "threads"),
    ("threads", 1.5, "threads"),
    ("grab", Grab(0, HUGE, (0.0, 0.0, 0.0), 1.0, 1.0, 1.0), "grab"),
    ("grab", Grab(0, 1000, (0.0, 0.0, 0.0), 1.0, 1.0, 1.0), "grab"),
    ("grab", Grab(1, 0, (0.0, 0.0, 0.0), 1.0, 1.0, 1.0), "grab"),
    ("grab", Grab(0, -1, (0.0, 0.0, 0.0), 1.0, 1.0, 1.0), "grab"),
    ("grab", Grab(0, 1, (0.0, 0.0, math.nan), 1.0, 1.0, 1.0), "grab.target"),
    ("grab", Grab(0, 1, (0.0, 0.0, 0.0), -1.0, 1.0, 1.0), "grab.stiffness"),
    ("grab", Grab(0, 1, (0.0, 0.0, 0.0), 1.0, math.nan, 1.0), "grab.damping"),
    ("grab", Grab(0, 1, (0.0, 0.0, 0.0), 1.0, 1.0, -1.0), "grab.max_force"),
    ("pin_paths", (((0, HUGE), PinPath(0.0, STILL)),), "pin_paths"),
    ("pin_paths", (((0, 3), PinPath(0.0, STILL)),), "pin_paths"),  # a free point
    ("pin_paths", (((0, 0), PinPath(math.nan, STILL)),), "pin_paths start"),
    ("pin_paths", (((0, 0), PinPath(0.0, STILL[:3])),), "pin_paths coefficients"),  # type: ignore[arg-type]
    ("pin_paths", (((0, 0), PinPath(0.0, ((0.0, 0.0),) * 4)),), "pin_paths coefficients"),  # type: ignore[arg-type]
    ("air", Air(), "air"),  # a rope has no cells
    ("air", 1.2, "air"),
]
CALLS = {  # a name in the error: calls that it is in
    "net": [
        lambda: simulate("rope"),  # type: ignore[arg-type]
        lambda: simulate(None),  # type: ignore[arg-type]
        lambda: critical_step("rope", "rk4"),  # type: ignore[arg-type]
        lambda: advance(None, State.at_rest(rope()), INTEGRATORS["rk4"], 0.01, 1),  # type: ignore[arg-type]
    ],
    "state": [lambda: advance(rope(), rope().x0, INTEGRATORS["rk4"], 0.01, 1)],  # type: ignore[arg-type]
    "state.x": [
        lambda: advance(rope(5000), State.at_rest(rope(10)), INTEGRATORS["rk4"], 1e-4, 1),
        lambda: critical_step(rope(50), "rk4", State.at_rest(rope(10))),
        lambda: gauge(rope(50), "rk4", 0.01, State.at_rest(rope(10))),
        lambda: critical_stiffness(rope(50), "rk4", 0.01, State.at_rest(rope(10))),
        lambda: energy(rope(50), State.at_rest(rope(10))),
        lambda: velocities(rope(50), State.at_rest(rope(10))),
    ],
    "state.v": [
        lambda: advance(rope(4), State(rope(4).x0, np.zeros((3, 1, 5))), INTEGRATORS["rk4"], 1.0, 1),
        lambda: advance(rope(4), State(rope(4).x0, np.zeros((3, 1, 4), np.float32)), INTEGRATORS["rk4"], 1.0, 1),
    ],
    "rtol": [lambda: simulate(rope(), "dopri5", rtol=1e-200), lambda: simulate(rope(), "dop853", rtol=1e-18)],
    "atol": [lambda: simulate(rope(), "dopri5", atol=1e-200)],
    "h": [
        lambda: advance(rope(), State.at_rest(rope()), "rk4", -1e-3, 10),
        lambda: advance(rope(), State.at_rest(rope()), "rk4", 0.0, 10),
        lambda: advance(rope(), State.at_rest(rope()), "rk4", math.nan, 10),
        lambda: advance(rope(), State.at_rest(rope()), "rk4", math.inf, 10),
    ],
    "steps": [
        lambda: advance(rope(), State.at_rest(rope()), "rk4", 1e-3, -1),
        lambda: advance(rope(), State.at_rest(rope()), "rk4", 1e-3, 1.5),  # type: ignore[arg-type]
    ],
    "integrator": [
        lambda: advance(rope(), State.at_rest(rope()), "RK4", 1e-3, 1),
        lambda: advance(rope(), State.at_rest(rope()), None, 1e-3, 1),  # type: ignore[arg-type]
    ],
    "step": [lambda: simulate(rope(), step=5e-324), lambda: simulate(rope(), step=1e-300)],
    "duration": [
        lambda: simulate(rope(), duration=1e308),
        lambda: simulate(rope(), "dop853", duration=1e10),
        lambda: simulate(rope(damping=0.0, drag=0.0), "auto", duration=1e10),
    ],
    "with_account": [lambda: simulate(rope(), with_account="no"), lambda: simulate(rope(), with_account=1)],  # type: ignore[arg-type]
    "grab.damping": [
        lambda: simulate(
            dataclasses.replace(rope(damping=0.0, drag=0.0), grab=Grab(0, 9, (0.0, 0.0, 0.0), 100.0, 5.0, 10.0)),
            "pefrl",
        )
    ],
    "end": [lambda: rope(1, end=(1.0, 0.0, 0.0)), lambda: rope(end=(2e9, 0.0, 0.0))],
    "root": [lambda: rope(root=(2e9, 0.0, 0.0))],
    "origin": [lambda: cloth(origin=(0.0, -1e9, 0.0))],
    "pinned": [
        lambda: cloth(pinned=[(0.9, 1.9)]),  # type: ignore[list-item]
        lambda: cloth(pinned=[(True, False)]),
        lambda: cloth(pinned=[(0, 32)]),
        lambda: cloth(pinned=[(0, 1, 2)]),  # type: ignore[list-item]
        lambda: cloth(pinned=7),  # type: ignore[arg-type]
        lambda: cloth(pinned="left"),
    ],
    "points": [lambda: lab_units(0, 2.0, 500.0, 1.0, 0.1, 0.2), lambda: lab_units(2.5, 2.0, 500.0, 1.0, 0.1, 0.2)],  # type: ignore[arg-type]
    "length": [
        lambda: lab_units(10, math.nan, 500.0, 1.0, 0.1, 0.2),
        lambda: lab_units(10, -2.0, 500.0, 1.0, 0.1, 0.2),
    ],
    "axial_stiffness": [lambda: lab_units(10, 2.0, -1.0, 1.0, 0.1, 0.2)],
    "mass_per_length": [lambda: lab_units(10, 2.0, 500.0, 0.0, 0.1, 0.2)],
    "axial_viscosity": [lambda: lab_units(10, 2.0, 500.0, 1.0, math.inf, 0.2)],
    "drag_per_length": [lambda: lab_units(10, 2.0, 500.0, 1.0, 0.1, "0.2")],  # type: ignore[arg-type]
}


@pytest.mark.parametrize(("field", "value", "name"), FIELDS)
def test_a_net_that_kernels_cannot_take_is_refused_by_the_field_s_name(field, value, name):
    with pytest.raises(ValueError, match=rf"^{name}: .* is not allowed; allowed: \S"):
        dataclasses.replace(rope(), **{field: value})


@pytest.mark.parametrize(("name", "call"), [(name, call) for name, calls in CALLS.items() for call in calls])
def test_a_bad_argument_is_refused_by_name_value_and_what_is_allowed(name, call):
    with pytest.raises(ValueError, match=rf"^{name}: .* is not allowed; allowed: \S"):
        call()


def test_a_state_in_another_order_in_memory_is_refused():
    net = cloth(3, 4)
    with pytest.raises(ValueError, match=r"^state\.x: 'float64"):
        advance(net, State(np.asfortranarray(net.x0), np.zeros_like(net.x0)), INTEGRATORS["rk4"], 1e-4, 1)


def test_whole_numbers_are_positions_too():
    whole = dataclasses.replace(rope(3), x0=np.arange(9).reshape(3, 1, 3))
    assert whole.x0.dtype == np.float64
    assert whole.x0.flags.c_contiguous
    assert dataclasses.replace(rope(3), x0=np.zeros((1, 3, 3)).swapaxes(0, 1)).x0.flags.c_contiguous


def test_no_stricter_tolerance_than_round_off_and_no_step_of_nan_are_taken():
    """A state that is not finite ends an adaptive run at once, and not never."""
    net = rope(3)
    broken = dataclasses.replace(net, x0=np.full_like(net.x0, math.nan))
    with pytest.warns(RuntimeWarning, match=r"dopri5 in its own steps diverged at t = 0 s"):
        assert simulate(broken, "dopri5", duration=0.1, frames=3).diverged_at == 0.0
    assert simulate(net, "dop853", rtol=1e-14, atol=1e-14, duration=0.01, frames=2).diverged_at is None


def test_there_are_no_modes_of_what_is_not_finite():
    net = rope(3)
    assert top_modes(net, np.full_like(net.x0, math.nan)) == []
