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
replaced = partial(dataclasses.replace, rope(10))


def family(**values):
    replaced(families=(Family(0, 1, 0.1, 1.0, 0.0)._replace(**values),))


def grab(**values):
    replaced(grab=Grab(0, 1, (0.0, 0.0, 0.0), 1.0, 1.0, 1.0)._replace(**values))


def path(point=(0, 0), start=0.0, coefficients=STILL):
    replaced(pin_paths=((point, PinPath(start, coefficients)),))


FIELDS: list[Row] = [  # of a rope of ten points
    *each(replaced, mass=[0.0, math.nan, -1.0], side_ratio=[0.0], drag=[-1.0], floor=[math.nan], epoch=[math.nan]),
    *each(replaced, side_ratio=[0.5], air=[1.2], threads=[0, 1.5], radius=[-0.1], thickness=[math.inf, -0.1]),
    *each(replaced, mass_ratios=[np.ones(10), np.zeros((1, 10)), np.full((1, 10), math.nan)], damping_model=["Axial"]),
    *each(replaced, x0=[np.zeros((2, 1, 10)), np.zeros((3, 10)), np.zeros((3, 0, 10)), np.full((3, 1, 10), 2e9)]),
    *each(replaced, forces=[(1.0,), [], ((0.0, 1.0),)]),
    *each(replaced, x0=[np.zeros((3, 1, 10), dtype=bool), [[0.0]]], gravity=[(0.0, 10.0)]),
    *each(replaced, sphere_velocity=[(0.0, 1.0), (0.0, 1.0, math.inf)]),
    *(("pinned", partial(replaced, pinned=frozenset({pin})), "") for pin in ((0, 10), (-1, 0), (0, 0.5))),
    *(("families", partial(family, di=di, dj=dj), "") for di, dj in ((0, 0), (0, -1), (-1, 0), (0, 1.5))),
    *each(family, "families ", rest=[-0.1], stiffness=[math.nan], damping=[-1.0]),
    *(("grab", partial(grab, row=row, col=col), "") for row, col in ((0, HUGE), (0, 1000), (1, 0), (0, -1))),
    *each(grab, "grab.", target=[(0.0, 0.0, math.nan)], stiffness=[-1.0], damping=[math.nan], max_force=[-1.0]),
    *(("pin_paths", partial(path, (0, point)), "") for point in (HUGE, 3)),  # not there, and free
    *each(path, "pin_paths ", start=[math.nan], coefficients=[STILL[:3], ((0.0, 0.0),) * 4]),
    ("air", partial(replaced, air=Air()), ""),  # a rope has no cells
    ("contact.stiffness", partial(replaced, contact=Contact(-1.0)), ""),
    ("sphere radius", partial(replaced, sphere=(0.0, 0.0, 0.0, -1.0)), ""),
]  # fmt: skip
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
    *each(partial(simulate, rope(), integrator="dopri5"), rtol=[1e-200, 0.0, -1.0, math.nan, "1", 2.0], atol=[1e-200]),
    *each(partial(simulate, rope(), integrator="dop853"), rtol=[1e-18], duration=[1e10]),
    *each(partial(simulate, rope(damping=0.0, drag=0.0), integrator="auto"), duration=[1e10]),
    ("rtol", lambda: simulate(rope(), integrator="rk4", rtol=1e-6), "adaptive methods only"),
    ("x", lambda: simulate(rope(4), x=np.zeros((3, 3))), "(4, 3)"),
    ("x", lambda: simulate(rope(4), x=np.full((4, 3), math.nan)), "nan"),
    ("v", lambda: simulate(cloth(4, 5), v=np.zeros((20, 3))), "(4, 5, 3)"),
    ("v", lambda: simulate(rope(4), v="fast"), "(4, 3)"),
    ("mass", lambda: rope(4, mass=[1.0, 2.0, 3.0]), "4 of them"),
    ("mass", lambda: rope(4, mass=[1.0, 2.0, 3.0, 0.0]), "4 of them"),
    ("atol", lambda: simulate(rope(), step=1e-3, integrator="dopri5", atol=1e-6), "the step is given"),
    (
        "grab.damping",
        lambda: simulate(dataclasses.replace(rope(damping=0.0, drag=0.0), grab=DAMPED), integrator="pefrl"),
        "",
    ),
    *each(advanced, h=[-1e-3, 0.0, math.inf], steps=[-1, 1.5], integrator=["RK4"]),
    ("state", lambda: advanced(state=rope().x0), ""),
    ("state.x", lambda: advanced(rope(5000), State.at_rest(rope(10))), ""),
    ("state.x", lambda: advanced(cloth(3, 4), State(*[np.asfortranarray(cloth(3, 4).x0)] * 2)), "float64"),
    ("state.x", too_many_points(critical_step, "rk4"), ""),
    ("state.x", too_many_points(gauge, "rk4", 0.01), ""),
    ("state.x", too_many_points(critical_stiffness, "rk4", 0.01), ""),
    ("state.x", too_many_points(energy), ""),
    ("state.x", too_many_points(velocities), ""),
    ("state.v", lambda: advanced(rope(4), State(rope(4).x0.copy(), np.zeros((3, 1, 5)))), ""),
    ("state.v", lambda: advanced(rope(4), State(rope(4).x0.copy(), np.zeros((3, 1, 4), np.float32))), ""),
    *(
        ("state.rubs", lambda rubs=rubs: advanced(rope(4), dataclasses.replace(State.at_rest(rope(4)), rubs=rubs)), "")
        for rubs in (None, np.zeros((2, 3)), np.zeros(5), np.zeros((1, 5), np.float32))
    ),
    *each(partial(critical_step, rope()), integrator=["rk5"]),
    ("integrator", lambda: critical_stiffness(rope(), "", 0.1), "leapfrog"),
    *each(partial(critical_stiffness, rope(), "rk4"), h=[0.0, -1.0, math.nan, math.inf, True]),
    ("points", lambda: catenary(1, 2.0, 1.0, 0.0, 800.0, 1.0, 10.0), "1"),
    *each(partial(catenary, 5, span=1.0, rise=0.0, stiffness=800.0, mass=1.0, gravity=10.0), length=ABOVE_0),
    *each(partial(catenary, length=2.0, span=1.0, rise=0.0, stiffness=8.0, mass=1.0, gravity=10.0), points=[1, 2.5]),
]


@pytest.mark.parametrize(("name", "call", "words"), [*FIELDS, *REFUSED])
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
        assert simulate(broken, duration=0.1, frames=3, integrator="dopri5").diverged_at == 0.0
    assert simulate(net, duration=0.01, frames=2, integrator="dop853", rtol=1e-14, atol=1e-14).diverged_at is None


def test_there_are_no_modes_of_what_is_not_finite():
    net = rope(3)
    assert top_modes(net, np.full_like(net.x0, math.nan)) == []
