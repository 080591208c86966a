"""Right solutions move rope and cloth as the program does at any value of a parameter; or the panel names it."""

import dataclasses
import functools
import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.student.session import Session
from app.messages import GrabTo, StudentAnswer
from app.panel.workbook.code_panel import code_lines, tables_of
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.cloth.start import build, sphere_home
from app.scenes.cloth.student_cloth import unlike
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene
from sim.parameters import Parameter, Value, effect_of_change, in_words, parameters_of
from sim.springs import LAWS
from tests.app.lab.student.test_session import save, taken
from tests.waiting import wait_for

TASKS = load_tasks()
FRAME = 1 / 15  # [s] of a scene's motion
BEFORE, AFTER = 0.1, 0.5  # [s] of motion before and after the parameter is changed
FALL = 1.6  # [s] after which the floor is reached
# A parameter is tested in the first of these in which it acts on the motion. The rope falls over the sphere onto the
# floor, its root swings, and a hand pulls it. The cloth falls over a sphere that moves up and down, onto the floor, in
# the wind, and a hand pulls it; or it hangs in pleats that touch each other.
ROPE = RopeParams(
    integrator="rk4", time_step=1 / 120, points=8, length=6.0, sphere=True, root_swing=0.1, swing_period=2.0, pull=20.0
)
CLOTH = ClothParams(
    integrator="rk4", time_step=1 / 120, rows=5, cols=6, stiffness=100.0, shear=60.0, bend=3.0, damping=0.2,
    density=1.0, start="level", sphere=True, sphere_radius=0.4, bob=0.2, width=1.0, length=3.6, contact_damping=2.0,
    pull=1.0,
)  # fmt: skip
PLEATS = dataclasses.replace(
    CLOTH, start="hanging", pinned="corners", width=0.4, length=0.4, gather=0.4, shear=20.0, bend=0.5, sphere=False
)
KNOT = dataclasses.replace(ROPE, start="knot", points=30, length=1.2)  # whose strands touch from the start
BASES = {"rope": (ROPE, dataclasses.replace(ROPE, units="material"), KNOT), "cloth": (CLOTH, PLEATS)}
SCENES: dict[str, Any] = {"rope": RopeScene, "cloth": ClothScene}
HELD = {"rope": 5, "cloth": 22}  # point that the hand pulls
FILES = {"rope": "rope.py", "cloth": "cloth.py"}
# Kernels are compiled for these that no other test of a plain run calls.
ALONE = {("cloth", "law"): pytest.mark.stress, ("rope", "law"): pytest.mark.long}
# The parameters of the cloth that a plain run tries; each takes a third of a second.
SAMPLE = {"integrator", "pinned", "start", "density", "thickness", "friction", "wind", "sphere_radius"}
CASES = [
    pytest.param(
        name,
        parameter,
        marks=ALONE.get((name, parameter), pytest.mark.long if name == "cloth" and parameter not in SAMPLE else ()),
    )
    for name, bases in BASES.items()
    for parameter, declared in parameters_of(bases[0]).items()
    if declared.affects != "look"
]


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    """A folder with the reference solutions, which move rope and cloth."""
    folder = tmp_path_factory.mktemp("lab") / "mine"
    make_folder(folder, TASKS)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.lab.student.live_net.COMPILE_AFTER", 1e6)
        session = Session(folder, TASKS)
        wait_for(lambda: session.state.version == 1)
        for name, file in FILES.items():
            sources = (inspect.getsource(task.function) for task in TASKS if task.file == file)
            save(session, "import numpy as np\n\n\n" + "\n\n".join(sources), file)
            wait_for(lambda name=name: taken(session, name) == session.state.version)
        yield session
        session.close()


def values_of(declared: Parameter, value: Any) -> list[Value]:
    """Three values or more, where there are so many: all choices; or the default, and one on each side of `value`."""
    if declared.choices:
        return list(declared.choices)
    if declared.kind is bool:
        return [False, True]
    sides = (0.75 * value, 1.25 * value) if value else (0.5 * declared.high, declared.high)
    return [declared.default, *(declared.kind(min(max(side, declared.low), declared.high)) for side in sides)]


def run(scene: Any, seconds: float) -> None:
    """Advance by some time [s], with as much time for the student's as it needs."""
    end = scene.time + seconds
    while scene.time < end - 1e-9:
        scene.advance(max(1, round(FRAME / scene.step)))
        while scene.student is not None and scene.student.sent:
            wait_for(scene.student.answers.qsize)
            scene.handle(StudentAnswer())


def moved(name: str, base: Any, new: Any, starts_anew: bool, seconds: float, session: Session | None = None) -> Any:
    """The positions some time after other parameters are set. session: moves a rope or a cloth beside the program's."""
    scene = SCENES[name](base, None if session is None else session.live)
    scene.handle(GrabTo(HELD[name], (-1.0, 0.5, 1.5), 0))
    run(scene, BEFORE)
    if starts_anew:
        scene.params = new
        scene.reset()
    else:
        scene.change_forces(new)
    run(scene, seconds)
    return scene.state.x


unchanged = functools.cache(moved)


def changed(name: str, base: Any, parameter: str, value: Value, session: Session | None = None) -> tuple[Any, Any]:
    """The positions some time after a parameter was changed, and those without the change.

    The latter only where no student's functions move the scene.
    """
    new = dataclasses.replace(base, **{parameter: value})
    how = effect_of_change(base, new) == "start", FALL if parameter == "floor" else AFTER
    return moved(name, base, new, *how, session), None if session else unchanged(name, base, base, *how)


def tried(base: Any, parameter: str, every: bool) -> list[Value]:
    """The values of a parameter that are tried: one that is not that of `base`, or all."""
    own = getattr(base, parameter)
    values = values_of(parameters_of(base)[parameter], own)
    return values if every else [value for value in reversed(values) if value != own][:1]


def acts(name: str, base: Any, parameter: str, values: list[Value]) -> bool:
    """True if one of the values makes another motion than that of `base`."""
    pairs = (changed(name, base, parameter, value) for value in values)
    return any(x.shape != own.shape or np.abs(x - own).max() > 1e-4 for x, own in pairs)


@pytest.mark.parametrize("every", [False, pytest.param(True, marks=pytest.mark.stress)], ids=["one value", "all"])
@pytest.mark.parametrize(("name", "parameter"), CASES)
def test_right_solutions_feel_every_parameter_or_the_panel_names_it(
    session: Session, name: str, parameter: str, every: bool
) -> None:
    bases = (base for base in BASES[name] if acts(name, base, parameter, tried(base, parameter, every)))
    base = next(bases, None)
    assert base is not None, f"{parameter} moves nothing in BASES: add a scene in which it does"
    declared = parameters_of(base)[parameter]
    for value in tried(base, parameter, every):
        changed(name, base, parameter, value, session)
        report = getattr(session, name).report
        assert report.version
        assert not report.restarts
        if not report.difference < 1e-9:
            said = code_lines(session.state, report, tables_of(session), name)
            title = declared.title or in_words(parameter)
            missing = (
                f"{parameter} {value}: {report.difference} m apart; give it to `forces_of`, or name it in `unlike`"
            )
            assert title.lower() in said.lower(), missing


def test_the_panel_names_the_link_of_a_cloth():
    stiffening = dataclasses.replace(CLOTH, law="stiffening")
    assert build(CLOTH, sphere_home(CLOTH)).law == LAWS["spring"].numbers
    assert build(stiffening, sphere_home(stiffening)).law == LAWS["stiffening"].numbers
    assert not any(line.startswith("Link: ") for line in unlike(CLOTH))
    assert any(line.startswith("Link: ") for line in unlike(stiffening))
