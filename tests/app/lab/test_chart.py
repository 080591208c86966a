"""Curves in the report."""

import re

import numpy as np
import pytest

from app.lab.chart import chart
from app.lab.program_check import Points, draw
from app.lab.runner import Runner
from app.lab.task import load_tasks
from app.render.line_chart import BOTTOM, LEFT, MAX_TICKS, PLOT_HEIGHT, RIGHT, TOP, WIDTH, ticks

X = np.linspace(0.0, 3.0, 7)


def places(svg: str) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """The corners of the drawn line, and the drawn points."""
    (line,) = re.findall(r'<path d="M([^"]*)" fill="none" stroke="#1c6aa8" stroke-width="2"', svg)
    dots = re.findall(r'<circle cx="([^"]+)" cy="([^"]+)"', svg)
    corners = [place.split() for place in line.split("L")]
    return [(float(x), float(y)) for x, y in corners], [(float(x), float(y)) for x, y in dots]


@pytest.mark.parametrize(
    "student",
    [X**2, -X, 1e9 * X, np.full(7, np.nan), np.full(7, np.inf), np.zeros(7), None],
    ids=["right", "wrong", "huge", "nan", "inf", "zero", "none"],
)
@pytest.mark.parametrize("reference", [X**2, np.ones(7), np.zeros(7)], ids=["rising", "constant", "zero"])
def test_a_curve_stays_inside_its_chart(reference: np.ndarray, student: np.ndarray | None) -> None:
    svg = chart(Points("x <i>", "y", X, reference, student))
    assert "x &lt;i&gt;" in svg
    line, dots = places(svg)
    assert len(line) == len(X)
    for x, y in line + dots:
        assert LEFT <= x <= WIDTH - RIGHT
        assert TOP <= y <= PLOT_HEIGHT - BOTTOM
    assert "nan" not in svg
    assert "inf" not in svg


def test_points_far_from_the_reference_are_left_out_and_the_right_ones_lie_on_it() -> None:
    line, dots = places(chart(Points("x", "y", X, X**2, X**2)))
    assert dots == line
    _, dots = places(chart(Points("x", "y", X, X**2, 10.0 * X**2)))
    assert len(dots) == 3  # up to 18, the reference's greatest and its range more


def test_a_curve_without_a_finite_value_is_left_out() -> None:
    assert chart(Points("x", "y", X, np.full(7, np.nan), None)) == ""


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-3.7, 12.0), (1e-9, 2e-9), (1e8, 1.1e8), (2.0, 2.0)])
def test_ticks_are_round_and_few(low: float, high: float) -> None:
    found = ticks(low, high)
    assert 1 <= len(found) <= MAX_TICKS + 1
    assert all(low <= tick <= high for tick in found)


def test_the_curve_of_a_line_is_that_of_the_weight_and_height_of_the_task() -> None:
    (task,) = [task for task in load_tasks() if task.name == "line_tension"]
    s = np.asarray(task.check.CURVE.x)
    assert (s[0], s[-1]) == (40.0, 120.0)
    assert task.check.CURVE.values(task.function, s) == pytest.approx(750.0 * (s**2 + 40.0**2) / 80.0)


def test_every_curve_of_a_task_has_the_reference_and_the_student(tmp_path) -> None:
    for task in load_tasks():
        if not hasattr(task.check, "CURVE"):
            continue
        (tmp_path / task.file).write_text(f"import numpy as np\ndef {task.name}(*a):\n    return 1 / 0\n", "utf-8")
        with Runner(tmp_path) as runner:
            points = draw(runner, task)
        assert points is not None
        assert np.isfinite(points.reference).all()
        assert np.ptp(points.reference) > 0.0 or task.name == "step_leapfrog"
        assert points.student is None
        assert (np.diff(points.x) > 0.0).all()
