"""What the library refuses: kernels check no index, so that a wrong net or state would write beyond its arrays."""

import dataclasses
import math
from functools import partial

import numpy as np
import pytest

from sim.springs import (
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
from sim.springs.statics import catenary
from tests.refusals import Row, assert_refused, each

STILL = ((0.0, 0.0, 0.0),) * 4
HUGE = 10**7
DAMPED = Grab(0, 9, (0.0, 0.0, 0.0), 100.0, 5.0, 10.0)
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
    ("mass_ratios", np.ones(10), "mass_ratios"),
    ("mass_ratios", np.zeros((1, 10)), "mass_ratios"),
    ("mass_ratios", np.full((1, 10), math.nan), "mass_ratios"),
    ("side_ratio", 0.0, "side_ratio"),
    ("side_ratio", 0.5, "side_ratio"),  # a rope has no sides
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
HERE = (0.0, 0.0, 0.0)
WHOLE = [0, -1, 2.5]  # wrong types: tests/sim/test_wrong_types.py
ABOVE_0, FROM_0 = [0.0, -1.0, math.inf, 10**400], [-1.0, math.inf]
VECTORS = [1.0, "123", (1.0, 2.0), (1.0, 2.0, 3.0, 4.0), (1.0, 2.0, math.nan), (True, 0.0, 0.0), ("1", 0, 0)]
LAB = partial(lab_units, points=10, length=2.0, axial_stiffness=500.0, mass_per_length=1.0, axial_viscosity=0.1)


def contact(**values):
    rope(contact=Contact()._replace(**values))


def advanced(net=None, state=None, integrator="rk4", h=1e-3, steps=1):
    net = rope() if net is None else net
    advance(net, State.at_rest(net) if state is None else state, integrator, h, steps)


def too_many_points(call, *more):
    return lambda: call(rope(50), *more, State.at_rest(rope(10)))


REFUSED: list[Row] = [
    *each(rope, points=[*WHOLE, 10.0, 1_000_001], length=ABOVE_0, mass=ABOVE_0, gravity=[math.inf]),
    *each(rope, stiffness=FROM_0, damping=[*FROM_0, -1e-9], drag=FROM_0, radius=FROM_0),
    *each(rope, root=[None, *VECTORS, (2e9, 0.0, 0.0)], end=[*VECTORS, (2e9, 0.0, 0.0)], contact=[1.0, (800.0, 5.0)]),
    *each(rope, floor=[math.inf], damping_model=["", "Axial"]),
    *each(rope, sphere=[1.0, HERE, (0.0, 0.0, math.nan, 1.0)]),
    ("sphere radius", lambda: rope(sphere=(*HERE, -1.0)), "-1"),
    ("end", lambda: rope(1, end=(1.0, 0.0, 0.0)), ""),
    *each(
        contact,
        "contact.",
        stiffness=[*FROM_0, "1"],
        damping=[*FROM_0, math.nan],
        friction=[*FROM_0, True],
        law=["", "coulomb", None, 1],
    ),
    *each(cloth, rows=[*WHOLE, 1, 5000], cols=[*WHOLE, 1, 5000], width=ABOVE_0, length=ABOVE_0, density=ABOVE_0),
    *each(cloth, stiffness=FROM_0, shear=FROM_0, bend=FROM_0, damping=FROM_0, drag=FROM_0, thickness=FROM_0),
    *each(cloth, pinned=["middle", "left", 3, [(0, 32)], [(-1, 0)], ["ab", "c"], [(0.9, 1.9)], [(True, False)]]),
    *each(cloth, pinned=[[(0, 1, 2)]], contact=[3], air=[3], damping_model=["none"], floor=[math.nan]),
    *each(cloth, sphere=[HERE], origin=[(0.0, -1e9, 0.0)]),
    *each(partial(LAB, drag_per_length=0.2), points=[0, 2.5], length=[math.nan, -2.0], axial_stiffness=[-1.0]),
    *each(partial(LAB, drag_per_length=0.2), mass_per_length=[0.0], axial_viscosity=[math.inf]),
    *each(LAB, drag_per_length=["0.2"]),
    *each(partial(simulate, rope()), integrator=["", "rk5", "RK4"], with_account=[1]),
    *each(partial(simulate, rope()), step=[*ABOVE_0, 5e-324, 1e-300]),
    *each(partial(simulate, rope()), duration=[*ABOVE_0, 1e308], frames=[*WHOLE, 1, -5, 2.0]),
    *each(partial(simulate, rope(), "dopri5"), rtol=[1e-200, 0.0, -1.0, math.nan, "1", 2.0], atol=[1e-200]),
    *each(partial(simulate, rope(), "dop853"), rtol=[1e-18], duration=[1e10]),
    *each(partial(simulate, rope(damping=0.0, drag=0.0), "auto"), duration=[1e10]),
    ("rtol", lambda: simulate(rope(), "rk4", rtol=1e-6), "adaptive methods only"),
    ("x", lambda: simulate(rope(4), x=np.zeros((3, 3))), "(4, 3)"),
    ("x", lambda: simulate(rope(4), x=np.full((4, 3), math.nan)), "nan"),
    ("v", lambda: simulate(cloth(4, 5), v=np.zeros((20, 3))), "(4, 5, 3)"),
    ("v", lambda: simulate(rope(4), v="fast"), "(4, 3)"),
    ("mass", lambda: rope(4, mass=[1.0, 2.0, 3.0]), "4 of them"),
    ("mass", lambda: rope(4, mass=[1.0, 2.0, 3.0, 0.0]), "4 of them"),
    ("atol", lambda: simulate(rope(), "dopri5", 1e-3, atol=1e-6), "the step is given"),
    ("grab.damping", lambda: simulate(dataclasses.replace(rope(damping=0.0, drag=0.0), grab=DAMPED), "pefrl"), ""),
    *each(advanced, h=[-1e-3, 0.0, math.inf], steps=[-1, 1.5], integrator=["RK4"]),
    ("state", lambda: advanced(state=rope().x0), ""),
    ("state.x", lambda: advanced(rope(5000), State.at_rest(rope(10))), ""),
    ("state.x", lambda: advanced(cloth(3, 4), State(*[np.asfortranarray(cloth(3, 4).x0)] * 2)), "float64"),
    ("state.x", too_many_points(critical_step, "rk4"), ""),
    ("state.x", too_many_points(gauge, "rk4", 0.01), ""),
    ("state.x", too_many_points(critical_stiffness, "rk4", 0.01), ""),
    ("state.x", too_many_points(energy), ""),
    ("state.x", too_many_points(velocities), ""),
    ("state.v", lambda: advanced(rope(4), State(rope(4).x0, np.zeros((3, 1, 5)))), ""),
    ("state.v", lambda: advanced(rope(4), State(rope(4).x0, np.zeros((3, 1, 4), np.float32))), ""),
    *each(partial(critical_step, rope()), integrator=["rk5"]),
    ("integrator", lambda: critical_stiffness(rope(), "", 0.1), "leapfrog"),
    *each(partial(critical_stiffness, rope(), "rk4"), h=[0.0, -1.0, math.nan, math.inf, True]),
    ("points", lambda: catenary(1, 2.0, 1.0, 0.0, 800.0, 1.0, 10.0), "1"),
    *each(partial(catenary, 5, span=1.0, rise=0.0, stiffness=800.0, mass=1.0, gravity=10.0), length=ABOVE_0),
    *each(partial(catenary, length=2.0, span=1.0, rise=0.0, stiffness=8.0, mass=1.0, gravity=10.0), points=[1, 2.5]),
]


@pytest.mark.parametrize(("field", "value", "name"), FIELDS)
def test_a_net_that_kernels_cannot_take_is_refused_by_the_field_s_name(field, value, name):
    assert_refused(name, lambda: dataclasses.replace(rope(), **{field: value}))


@pytest.mark.parametrize(("name", "call", "words"), REFUSED)
def test_a_bad_argument_is_refused_by_name_value_and_what_is_allowed(name, call, words):
    assert_refused(name, call, words)


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
