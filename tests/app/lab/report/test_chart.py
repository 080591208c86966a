"""Curves in the report."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from app.lab.check.program_check import Points, draw
from app.lab.course.task import Task, load_tasks
from app.lab.process.runner import Runner
from app.lab.report.chart import chart
from app.render.markup.line_chart import BOTTOM, LEFT, PLOT_HEIGHT, RIGHT, TOP, WIDTH

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


def test_points_far_from_the_reference_are_marks_at_the_edge_and_the_right_ones_lie_on_it() -> None:
    line, dots = places(chart(Points("x", "y", X, X**2, X**2)))
    assert dots == line
    svg = chart(Points("x", "y", X, X**2, 10.0 * X**2))
    _, dots = places(svg)
    assert len(dots) == 3  # up to 18, the reference's greatest and its range more
    assert svg.count('class="beyond"') == 4
    assert "beyond the chart" in svg


def test_a_curve_without_a_finite_value_is_left_out() -> None:
    assert chart(Points("x", "y", X, np.full(7, np.nan), None)) == ""


def fresnel(angle: np.ndarray, n: float) -> np.ndarray:
    """Reflectance of unpolarised light: the mean of both polarisations."""
    inside = np.arcsin(np.sin(angle) / n)
    across, along = np.cos(angle) - n * np.cos(inside), n * np.cos(angle) - np.cos(inside)
    sums = np.cos(angle) + n * np.cos(inside), n * np.cos(angle) + np.cos(inside)
    return ((across / sums[0]) ** 2 + (along / sums[1]) ** 2) / 2


def landing(speed: np.ndarray) -> np.ndarray:
    """Distance [m] of a jet 3 m above the sea at 45 degrees."""
    v = speed / np.sqrt(2.0)
    return v * (v + np.sqrt(v**2 + 6.0 * 9.81)) / 9.81


# Task -> the values of its curve in closed form, by what the labels of its axes and its text say.
CLOSED_FORMS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "net_buoyancy": lambda density: 9.81 * (1025.0 - density),
    "extra_draft": lambda d: d * (1.0 - 866.0 / 1025.0),
    "surface_colour": lambda d: 0.1 * (1.0 - np.exp(-30.0 * d)),
    "draft": lambda d: np.where(850.0 * d >= 500.0, 500.0 / 850.0, d + (500.0 - 850.0 * d) / 1025.0),
    "mixture_viscosity": lambda share: 10.0 ** (2.0 * share - 3.0),
    "wave_decay": lambda t: np.exp(-2.0 * 0.005 * 2.0**2 * t),
    "reflectance": lambda angle: fresnel(angle, 1.47),
    "jet_landing": landing,
    "gravity": lambda masses: 9.81 * np.cbrt(masses),
    "spectrum": lambda k: 0.01 * np.exp(-((9.81 / (49.0 * k)) ** 2)) / k**4,
    "damping_length": lambda t: 2.0 * np.sqrt(1e-3 * t),
    "dispersion": lambda k: np.floor(np.sqrt(9.81 * k) * 10.0 / np.pi) * np.pi / 10.0,
    "spring_force": lambda length: 10.0 * (length - 1.0),
    "rope_acceleration": lambda length: 800.0 * (length - 0.2) - 10.0,
    "step_euler": lambda steps: 1.25 ** (steps / 2.0),
    "step_rk4": lambda steps: (1.0 - 0.5**6 / 72.0 + 0.5**8 / 576.0) ** (steps / 2.0),
    "sphere_force": lambda distance: 10.0 * np.maximum(1.0 - distance, 0.0),
    "cloth_links": lambda n: 2.0 * n * (n - 1.0) + 2.0 * (n - 1.0) ** 2 + 2.0 * n * (n - 2.0),
    "line_tension": lambda s: 750.0 * (s**2 + 40.0**2) / 80.0,
}
WITH_CURVE = [task for task in load_tasks() if hasattr(task.check, "CURVE")]


@pytest.mark.parametrize("task", WITH_CURVE, ids=lambda task: task.name)
def test_the_curve_of_a_task_is_its_closed_form(task: Task) -> None:
    x = np.asarray(task.check.CURVE.x)
    found = np.asarray(task.check.CURVE.values(task.function, x))
    if task.name == "step_leapfrog":  # x^2 (1 - z^2/4) + v^2 stays, with z = 0.5
        assert np.ptp(found) > 0.01
        assert np.sqrt(1.0 - 0.5**2 / 4.0) - 1e-9 <= found.min()
        assert found.max() <= 1.0 + 1e-9
    else:
        assert found == pytest.approx(CLOSED_FORMS[task.name](x), rel=1e-9, abs=1e-9)


def test_the_curve_of_a_line_spans_the_lengths_of_the_task() -> None:
    (task,) = [task for task in WITH_CURVE if task.name == "line_tension"]
    assert (task.check.CURVE.x[0], task.check.CURVE.x[-1]) == (40.0, 120.0)


def test_every_curve_of_a_task_has_the_reference_and_the_student(tmp_path) -> None:
    for task in WITH_CURVE:
        (tmp_path / task.file).write_text(f"import numpy as np\ndef {task.name}(*a):\n    return 1 / 0\n", "utf-8")
        with Runner(tmp_path) as runner:
            points = draw(runner, task)
        assert points is not None
        assert np.isfinite(points.reference).all()
        assert np.ptp(points.reference) > 0.0 or task.name == "step_leapfrog"
        assert points.student is None
        assert (np.diff(points.x) > 0.0).all()
