"""The march of a rope by a student's functions: what is wrong in a result is said of the function that made it."""

import types

import numpy as np
import pytest

from app.lab.rope_march import Forces, Functions, Segment, Unfit, march

FORCES = Forces(
    1.0, 800.0, 7.0, 1.0, 0.2, 10.0, -np.inf, 0.4, (9.0, 0.0, 3.0), (-20.0, 0.0, 0.0), 800.0, 5.0, 0.3, False, -1,
    (0.0, 0.0, 0.0), 0.0, 0.0, 1.0,
)  # fmt: skip


def test_nan_is_said_of_the_force_of_a_sphere_that_has_come_near() -> None:
    def sphere_force(x, v, centre, radius, stiffness, damping):
        return np.full(3, np.nan) if np.linalg.norm(x - centre) < 0.5 else np.zeros(3)

    x = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0], [-0.4, 0.0, 3.0]])
    module = types.SimpleNamespace(sphere_force=sphere_force)
    segment = Segment(2000, 1 / 960, FORCES, np.zeros((0, 4, 3)))
    functions = Functions(module, ["sphere_force"], "step_rk4", {})  # type: ignore[arg-type]
    with pytest.raises(Unfit, match="sphere_force returns NaN"):
        march(functions, x, np.zeros((3, 3)), [segment])
