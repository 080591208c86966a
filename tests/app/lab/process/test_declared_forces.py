"""Forces that a net declares, on a student's points: what goes to the program's kernel, and what comes back."""

import numpy as np
import pytest

from app.lab.process import declared_forces


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
