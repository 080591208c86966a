"""The tasks of the course lab: all items are there, what they name exists, and the references agree with sim."""

import re
from pathlib import Path

import numpy as np
import pytest

from app.lab.course.task import Task, load_tasks, read_task
from app.lab.report.report import written
from app.scenes import scene_named
from sim.floating import Hull, equilibrium_draft
from sim.ocean.dispersion import viscous_root
from sim.ocean.fluids.emulsions import arrhenius
from sim.ocean.fluids.fluids import fresnel
from sim.ocean.planets import gravity_of
from sim.ocean.spectra.phillips import PhillipsConditions, density
from sim.springs import rope, simulate
from sim.springs.stability import critical_step
from tests.app.lab.leaks import ALLOWED, gives_away, leaks
from tests.sim.mooring.catenary import catenary

TASKS = load_tasks()
REFERENCE = {task.name: task.function for task in TASKS if task.check is not None}
# The numbered items of the course lab's sections 1.1, 1.2, 3.2 and 3.3, and those that it calls optional.
ITEMS = {f"{section}-{i}" for section, n in (("1.1", 9), ("1.2", 6), ("3.2", 4), ("3.3", 3)) for i in range(1, n + 1)}
BEYOND = {"4.1-1"}  # of our own
OPTIONAL = {"1.1-8", "1.1-9", "3.3-1", "3.3-2", "3.3-3"} | BEYOND


def question(task: str, key: str):
    return next(q for t in TASKS if t.name == task for q in t.questions if q.key == key)


def test_no_text_gives_an_answer_away_before_it_is_given() -> None:
    assert leaks() == []
    for name in ALLOWED:
        assert question(*name.split("."))
    growth = question("step_euler", "growth")
    assert not gives_away(growth, "the amplitude changes from step to step")
    assert gives_away(growth, "by a factor of 1.414 in each step")
    assert gives_away(question("top_fluid", "on_top"), "the oil lies above")


def test_every_item_of_the_lab_has_a_task_and_the_optional_ones_are_marked() -> None:
    assert len(ITEMS) == 22
    assert {task.item for task in TASKS} == ITEMS | BEYOND
    assert {task.item for task in TASKS if task.optional} == OPTIONAL
    assert {task.item for task in TASKS if not task.optional} == ITEMS - OPTIONAL


def test_the_tasks_stand_in_the_order_of_the_lab() -> None:
    numbers = [[int(n) for n in re.findall(r"\d+", task.item)] for task in TASKS]
    assert numbers == sorted(numbers)
    assert [task.name for task in TASKS if task.item == "3.2-1"] == ["spring_force", "rope_acceleration"]


@pytest.mark.parametrize("task", [task for task in TASKS if task.setup], ids=lambda task: task.name)
def test_the_scene_and_the_preset_of_a_task_exist(task: Task) -> None:
    assert task.setup is not None
    assert task.setup.preset in scene_named(task.setup.scene).presets


def test_every_item_can_be_looked_at() -> None:
    assert {task.item for task in TASKS if task.setup} == ITEMS | BEYOND


def test_every_task_asks_before_and_after() -> None:
    """Predictions are neither right nor wrong; numbers and choices that are judged say why."""
    for task in TASKS:
        for asked in task.questions:
            if asked.key == "predict":
                assert asked.right is None, task.name
            elif asked.kind != "text":
                assert asked.right is not None, (task.name, asked.key)
                assert asked.why, (task.name, asked.key)
            for error in asked.typical_errors:
                assert error.answer != asked.right
                assert asked.kind != "choice" or error.answer in asked.choices
                assert asked.kind != "number" or not asked.is_near(float(error.answer), float(asked.right))


# ----- the references against sim


def test_the_accelerations_and_steps_are_those_of_the_rope() -> None:
    """The lab's functions, put together, make the same rope as sim does."""
    n, h, steps = 6, 1 / 240, 60
    net = rope(points=n, length=1.0, stiffness=300.0, damping=3.0, drag=0.5, gravity=9.0, mass=0.8)
    values = (0.8, 300.0, 3.0, 0.5, 0.2, 9.0)

    def acceleration(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return REFERENCE["rope_acceleration"](x, v, *values)

    for name, integrator in (("step_euler", "explicit_euler"), ("step_rk4", "rk4")):
        run = simulate(net, duration=steps * h, frames=2, step=h, integrator=integrator)
        x, v = run.x[0], run.v[0]
        for _ in range(steps):
            x, v = REFERENCE[name](x, v, h, acceleration)
        assert np.abs(x - run.x[1]).max() < 1e-9, name
        assert np.abs(v - run.v[1]).max() < 1e-7, name
    undamped = rope(points=n, length=1.0, stiffness=300.0, damping=0.0, drag=0.0, gravity=9.0, mass=0.8)
    values = (0.8, 300.0, 0.0, 0.0, 0.2, 9.0)
    run = simulate(undamped, duration=steps * h, frames=2, step=h, integrator="leapfrog")
    x, v = run.x[0], run.v[0]
    for _ in range(steps):
        x, v = REFERENCE["step_leapfrog"](x, v, h, acceleration)
    assert np.abs(x - run.x[1]).max() < 1e-9


def test_the_cloth_forces_are_those_of_single_springs() -> None:
    rng = np.random.default_rng(3)
    x, v = rng.normal(size=(2, 4, 3))
    links = [(0, 1), (1, 2), (2, 3), (0, 3)]
    force = REFERENCE["cloth_forces"](x, v, links, np.ones(4), 7.0, 2.0)
    expected = np.zeros((4, 3))
    for i, j in links:
        expected[i] += REFERENCE["spring_force"](x[i], x[j], v[i], v[j], 7.0, 2.0, 1.0)
        expected[j] += REFERENCE["spring_force"](x[j], x[i], v[j], v[i], 7.0, 2.0, 1.0)
    assert np.allclose(force, expected)


def test_drafts_volumes_and_buoyancy_are_those_of_the_floating_bodies() -> None:
    for thickness in (0.2, 5.0):
        box = Hull.box(1.0, 1.0, 1.0)
        layers = [(850.0, thickness), (1025.0, np.inf)]
        draft = REFERENCE["draft"](500.0, 1.0, 850.0, thickness, 1025.0)
        assert abs(draft - equilibrium_draft(box, 500.0, layers=layers)) < 1e-6
    extra = REFERENCE["draft"](500.0, 1.0, 850.0, 0.2, 1025.0) - 500.0 / 1025.0
    assert abs(REFERENCE["extra_draft"](0.2, 850.0, 1025.0) - extra) < 1e-12
    hull = Hull.cylinder(0.5, 2.0)
    assert abs(REFERENCE["mesh_volume"](hull.vertices, hull.faces) / hull.volume - 1.0) < 1e-9


def test_fluids_planets_and_waves_are_those_of_the_ocean() -> None:
    assert np.isclose(REFERENCE["mixture_viscosity"](0.05, 0.001, 0.3), arrhenius(0.05, 0.001, 0.3))
    for angle in (0.0, 0.4, 1.3):
        assert np.isclose(REFERENCE["reflectance"](angle, 1.47), fresnel(angle, 1.47).mean)
    for mass in (0.01, 1.0, 100.0):
        assert np.isclose(REFERENCE["gravity"](mass), gravity_of(mass, "same_density"))
    k, nu = 2.0 * np.pi, 1e-5
    left = REFERENCE["wave_decay"](1.0, k, nu, 60.0)
    assert abs(np.log(left) / (-viscous_root(k, nu)[1] * 60.0) - 1.0) < 0.01
    conditions = PhillipsConditions(wind_speed=7.0, wind_direction=0.0, gravity=9.81, phillips_constant=0.01)
    mine = REFERENCE["spectrum"](np.array([0.2, 0.1]), np.array([7.0, 0.0]), 0.01, 9.81)
    assert np.isclose(mine, density(np.array(0.2), np.array(0.1), conditions))


def test_the_tension_of_a_line_is_that_of_the_catenary() -> None:
    found = catenary(100.0, 1e12, 700.0, 80.0, 40.0)
    hanging = 100.0 - found.lying
    assert np.isclose(REFERENCE["line_tension"](700.0, hanging, 40.0), np.hypot(found.horizontal, found.vertical))


@pytest.mark.parametrize(("task", "integrator"), [("step_euler", "explicit_euler"), ("step_rk4", "rk4")])
def test_the_stiffness_that_is_asked_for_is_the_limit_of_the_rope(task: str, integrator: str) -> None:
    asked = question(task, "stiffness")
    assert isinstance(asked.right, float)
    steps = [critical_step(rope(points=10, stiffness=asked.right * f), integrator) for f in (0.9, 1.1)]
    assert steps[0] > 1 / 60 > steps[1]


# ----- files of tasks


GOOD = """
item = "9.1-1"
title = "A question"
statement = "Say something."

[[question]]
key = "say"
ask = "What?"
kind = "choice"
choices = ["a", "b"]
right = "a"
"""
BROKEN = {
    "item = ": ("bad.toml", "a TOML file"),
    GOOD.replace('"9.1-1"', '"first"'): ("item", "3.2-1"),
    GOOD.replace('title = "A question"', ""): ("bad.toml", "required field `title`"),
    GOOD.replace('title = "A question"', "title = 1"): ("title", "Expected `str`"),
    GOOD.replace("statement", "optional = 3\nstatement"): ("optional", "Expected `bool`"),
    GOOD.replace("statement", "colour = 3\nstatement"): ("colour", "docs/lab.md lists the entries"),
    GOOD.replace('right = "a"', 'right = "c"'): ("say", "one of them right"),
    GOOD.replace('choices = ["a", "b"]', ""): ("say", "at least two choices"),
    GOOD.replace('"choice"', '"guess"'): ("guess", "choice, number, text"),
    GOOD.replace('"choice"', '"number"'): ("say", "a finite number"),
    GOOD.replace('"choice"', '"text"'): ("say", "judged by the teacher"),
    GOOD.replace('key = "say"', 'key = "Say it"'): ("Say it", "small letters"),
    GOOD + GOOD[GOOD.index("[[question]]") :]: ("say, say", "a different key"),
    GOOD[: GOOD.index("[[question]]")]: ("bad.toml", "or questions"),
    GOOD.replace("[[question]]", "[question]"): ("question", "Expected `array`"),
    GOOD + "[guide]\nquestion = 'What?'\nanswer = 'It is {x'": ("answer", "names in braces"),
    GOOD + "[guide]\nquestion = 'What?'\nanswer = 'It is {x:long}'": ("answer", "names in braces"),
    GOOD + "[guide]\nquestion = 'What?'\nanswer = 'a'\nlaw = 3": ("law", "Expected `array`"),
    GOOD + "[guide]\nquestion = 'What?'\nanswer = 'a'\nneeds = {x = '> y'}": ("x", "a relation"),
    GOOD + "[guide]\nquestion = 'What?'\nanswer = 'a'\nneeds = 3": ("needs", "a table"),
    GOOD + "[guide]\nanswer = 'a'": ("bad.toml", "required field `question`"),
    GOOD + "[[do]]\ntext = 'Go'": ("bad.toml", "required field `when`"),
    GOOD + "[[do]]\ntext = 'Go'\nwhen = {}": ("when", "length >= 1"),
    GOOD + "[setup]\nscene = 'rope'\nlook = 'a'\nparameters = 3": ("parameters", "Expected `object`"),
}


@pytest.mark.parametrize("text", BROKEN, ids=range(len(BROKEN)))
def test_a_file_that_is_no_task_is_named_with_what_is_wrong(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(ValueError, match=re.escape(BROKEN[text][1])) as caught:
        read_task(path)
    assert BROKEN[text][0] in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("x = ", "SyntaxError"), ("1 / 0", "ZeroDivisionError"), ("def inputs(rng): pass", "a function bad"),
        ("def bad(x):\n    'x'", "a function inputs"), ("def bad(x): pass\ndef inputs(rng): pass", "docstring"),
    ],
)  # fmt: skip
def test_a_check_that_lacks_a_part_is_named(tmp_path: Path, code: str, said: str) -> None:
    (tmp_path / "bad.toml").write_text(GOOD.replace("statement", 'file = "mine.py"\nstatement'), "utf-8")
    (tmp_path / "bad.py").write_text(code, "utf-8")
    with pytest.raises(ValueError, match=said):
        read_task(tmp_path / "bad.toml")


def test_a_task_of_a_teacher_replaces_the_one_of_its_name(tmp_path: Path) -> None:
    (tmp_path / "top_fluid.toml").write_text(GOOD, "utf-8")
    tasks = load_tasks(tmp_path)
    assert len(tasks) == len(TASKS)
    assert tasks[-1].name == "top_fluid"
    assert tasks[-1].item == "9.1-1"
    with pytest.raises(ValueError, match="--tasks"):
        load_tasks(tmp_path / "none")


def test_a_report_leaves_out_functions_that_are_empty_with_their_headings() -> None:
    source = """import numpy as np


# 3.2-1
# Complete the rope.
def rope(x):
    \"\"\"The force.\"\"\"


# 3.2-2
def begun(x):
    return x


def last(x):
    ...
"""
    assert written(source) == "import numpy as np\n\n\n# 3.2-2\ndef begun(x):\n    return x\n"
    assert written("def broken(:\n") == "def broken(:\n"


@pytest.mark.parametrize("task", [one for one in TASKS if hasattr(one.check, "behaviour")], ids=lambda task: task.name)
def test_a_reference_behaves_as_its_task_says(task: Task) -> None:
    task.check.behaviour(task.function)


def test_points_of_the_tasks_on_springs_move_at_metres_a_second() -> None:
    for name in ("spring_force", "rope_acceleration", "cloth_forces"):
        task = next(task for task in TASKS if task.name == name)
        rng = np.random.default_rng(3)
        for sample in (task.check.inputs(rng) for _ in range(100)):
            of_points = [np.max(np.abs(value)) for value in sample if np.shape(value)[-1:] == (3,)]
            assert max(of_points) < 30.0, name


@pytest.mark.parametrize("name", ["step_leapfrog", "step_rk4", "step_euler"])
def test_accelerations_depend_on_the_velocity_where_a_method_can_follow_it(name: str) -> None:
    """Not with leapfrog, which knows the velocity half a step away only."""
    task = next(task for task in TASKS if task.name == name)
    x, v, _, acceleration = task.check.inputs(np.random.default_rng(1))
    depends = not np.allclose(acceleration(x, v), acceleration(x, v + 1.0))
    assert depends == (name != "step_leapfrog")
