"""The guides of the lab's items: set-ups that load, answers that are finite, numbers that closed forms confirm."""

import math
import re
from collections.abc import Callable

import pytest

from app.lab.course.live_values import LiveNumber, LiveValues, fill_in, names_in
from app.lab.course.task import Task, load_tasks
from app.panel.workbook.guide import SnapshotValues
from app.panel.workbook.task_setups import setup_of_task
from app.render.markup.formula import formula
from app.scenes import scene_named
from app.server.loop.sim_loop import SimLoop

TASKS = load_tasks(with_checks=False)
GUIDED = [task for task in TASKS if task.guide is not None]
ITEMS = {f"{section}-{i}" for section, n in (("1.1", 9), ("1.2", 6), ("3.2", 4), ("3.3", 3)) for i in range(1, n + 1)}
ITEMS |= {"4.1-1"}  # of our own
TICKS = 4


def values_of(task: Task, **changes: object) -> LiveValues:
    """The live values a few frames after the task was set up. changes: other parameters."""
    assert task.setup is not None
    setup = setup_of_task(task.setup)
    kind, params = scene_named(setup.scene), setup.params
    if changes:
        params = type(params)(**{**vars(params), **changes})
    loop = SimLoop(kind.make(params))
    for _ in range(TICKS):
        loop.tick(1 / 30)
    return SnapshotValues(kind, loop.latest)


@pytest.fixture(scope="module")
def found() -> Callable[[str], LiveValues]:
    """The live values of each task as it is set up, computed once."""
    known: dict[str, LiveValues] = {}

    def of(name: str) -> LiveValues:
        if name not in known:
            known[name] = values_of(next(task for task in TASKS if task.name == name))
        return known[name]

    return of


def number(values: LiveValues, name: str) -> float:
    value = values[name]
    assert isinstance(value, LiveNumber)
    return value.value


def test_each_of_the_22_items_has_one_guide() -> None:
    assert {task.item for task in GUIDED} == ITEMS
    assert len(GUIDED) == 23


@pytest.mark.long  # sets up and runs 23 tasks
@pytest.mark.parametrize("task", GUIDED, ids=lambda task: task.name)
def test_the_answer_of_each_guide_is_finite_where_it_is_set_up(task: Task, found) -> None:
    assert task.guide is not None
    assert task.setup is not None
    values = found(task.name)
    assert all(condition.holds(values) for condition in task.guide.needs)
    parameters = scene_named(task.setup.scene).params.__dataclass_fields__
    named = names_in(task.guide.answer) | set(task.setup.show) - parameters.keys()
    assert named, "an answer without a number of the scene"
    for name in named:
        value = values[name]
        assert isinstance(value, LiveNumber), name
        assert math.isfinite(value.value), name
    text = fill_in(task.guide.answer, values)
    assert not re.search(r"[{}…∞]|\bnan\b", text), text
    assert task.guide.question.endswith(("?", ".", "(optional)"))
    assert task.guide.law
    for law in task.guide.law:
        assert formula(law).startswith("<math")


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)
def test_what_a_task_watches_and_reads_off_is_in_its_scene_and_not_yet_done(task: Task, found) -> None:
    if task.setup is None:
        assert not task.steps
        return
    values = found(task.name)
    for step in task.steps:
        for condition in step.when:
            assert condition.name in values, condition.name
        assert not all(condition.holds(values) for condition in step.when), step.text
        parameters = scene_named(task.setup.scene).params.__dataclass_fields__
        for condition in step.when:  # what is asked for can be set
            if condition.name in parameters and isinstance(condition.value, str):
                assert condition.value in parameters[condition.name].metadata["parameter"].choices
    for question in task.questions:
        assert not question.read_off or isinstance(values[question.read_off], LiveNumber)


# ----- the numbers of the answers against closed forms


def test_the_numbers_of_the_oil_are_those_of_archimedes_and_fresnel(found) -> None:
    values = found("extra_draft")
    assert number(values, "added_draft") == pytest.approx(0.2 * (1.0 - 866.0 / 1025.0), abs=1e-4)
    assert number(values, "net_force") == pytest.approx((1025.0 - 866.0) * 9.81, rel=2e-3)
    values = found("draft")
    height, density = number(values, "box_height"), number(values, "box_density")
    oil, water = number(values, "oil_density"), number(values, "water_density")
    assert number(values, "box_draft_at_rest") == pytest.approx(0.2 + (density * height - oil * 0.2) / water, rel=1e-3)
    assert number(values, "box_draft_in_water") == pytest.approx(density * height / water, rel=1e-3)
    assert number(values, "box_mean_draft") == pytest.approx(number(values, "box_draft_at_rest"), abs=2e-3)  # no waves
    values = found("mixture_viscosity")
    phi = number(values, "fraction")
    expected = number(values, "oil_viscosity") ** phi * number(values, "water_viscosity") ** (1.0 - phi)
    assert number(values, "solution_viscosity") == pytest.approx(expected)
    values = found("reflectance")
    for fluid in ("oil", "water"):
        n = number(values, f"{fluid}_index")
        assert number(values, f"{fluid}_reflectance") == pytest.approx(((n - 1.0) / (n + 1.0)) ** 2)
    values = found("wave_decay")
    assert number(values, "clean_wave_speed") == pytest.approx(math.sqrt(9.81 * 10.0 / (2.0 * math.pi)), rel=1e-3)
    assert number(values, "height_left") < 1.0
    assert number(values, "slope_left") < number(values, "height_left")
    values = found("jet_landing")
    t = number(values, "flight_time")
    assert 20.0 + 9.5 * t - 0.5 * 9.81 * t * t == pytest.approx(0.0, abs=1e-9)
    assert number(values, "flight_distance") == pytest.approx(t * math.hypot(9.0, 7.0))
    values = found("surface_colour")
    assert number(values, "film_light") == pytest.approx(math.exp(-0.1 / 0.07))
    assert number(values, "opaque_thickness") == pytest.approx(0.07e-3 * math.log(10.0))  # "less than 10 %"


def test_the_numbers_of_the_seas_are_those_of_their_laws(found) -> None:
    values = found("gravity")
    assert number(values, "gravity_here") == pytest.approx(9.81 * 100.0 ** (1 / 3), rel=1e-3)
    assert number(values, "height_over_earth") == pytest.approx(100.0 ** (-1 / 3), rel=0.01)  # 1/g
    assert number(values, "open_speed") == pytest.approx(number(values, "earth_speed"), rel=0.01)
    spectrum = next(task for task in TASKS if task.name == "spectrum")
    developed = values_of(spectrum, spectrum="pierson_moskowitz", start="as set")
    assert number(developed, "height_by_wind") == pytest.approx(4.0, rel=0.01)  # U squared
    assert number(developed, "twice_speed") == pytest.approx(2.0 * number(developed, "open_speed"), rel=0.01)
    limited = values_of(spectrum, spectrum="jonswap")
    assert 1.5 < number(limited, "height_by_wind") < 4.0  # the fetch limits it
    values = found("damping_length")
    assert number(values, "minute_length") == pytest.approx(2.0 * math.sqrt(5e-4 * 60.0))
    seconds_of_decay = number(values, "time")
    assert number(values, "damping_so_far") == pytest.approx(2.0 * math.sqrt(5e-4 * seconds_of_decay), rel=0.3)
    values = found("grids")
    assert number(values, "grid_points") == 128 * 128 + 1
    side = 2 * round(number(values, "grid_radius") / number(values, "inner_spacing")) + 1
    assert number(values, "square_points") == side**2
    slow = values_of(next(task for task in TASKS if task.name == "dispersion"), dispersion_scale=0.5)
    for name, ratio in (("significant_height", 1.0), ("peak_period", 2.0)):
        assert number(slow, name) == pytest.approx(ratio * number(found("dispersion"), name), rel=0.02)


def test_the_numbers_of_the_springs_are_those_of_statics_and_stability(found) -> None:
    values = found("spring_force")
    assert number(values, "top_stretch_at_rest") == pytest.approx(9 * 10.0 / 800.0)
    h, damping, drag = 1 / 60, 7.0, 1.0
    eigenvalue = 2.0 * (1.0 - math.cos(math.pi * 17 / 19))  # the fastest mode of 9 springs with one free end
    euler = (damping * eigenvalue + drag) / (h * eigenvalue)
    assert number(found("step_euler"), "largest_stiffness") == pytest.approx(euler, rel=0.01)
    values = found("step_rk4")
    assert 2000.0 < number(values, "largest_stiffness") < 10_000.0
    assert number(values, "h_omega") == pytest.approx(h * math.sqrt(2000.0 * eigenvalue), rel=0.02)
    values = found("cloth_links")
    assert number(values, "structural_links") == 2 * 32 * 31
    assert number(values, "shear_links") == 2 * 31 * 31
    assert number(values, "bend_links") == 2 * 32 * 30
    rest = values_of(next(task for task in TASKS if task.name == "sphere_force"), contact_stiffness=500.0)
    assert number(rest, "contact_force") == pytest.approx(500.0 * number(rest, "contact_depth"))
