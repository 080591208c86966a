"""The lab guide and the workbook in the panel, on a viser server without a browser."""

import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.lab.course.answers import FILE, read_answers
from app.lab.course.folder import PICTURES, make_folder
from app.lab.course.live_values import LiveNumber
from app.lab.course.task import load_tasks
from app.lab.student.workbook import Workbook
from app.panel.panel import Panel
from app.panel.workbook.guide import HIDE, PICTURE, SET_UP, SHOW, UNANSWERED, GuideTab, QuestionWidgets
from app.panel.workbook.task_list import BACK, ON
from app.render.markup.html import escape
from app.scenes.race.html import error_text
from app.server.viewer import Viewer
from tests import coroutines
from tests.waiting import wait_for

TASKS = load_tasks()


def does(callback: Any, value: object = None) -> None:
    """What viser does when a browser sets a widget."""
    coroutines.run(callback(SimpleNamespace(target=SimpleNamespace(value=value), client_id=1, client=None)))


def opened(workbook: Workbook, scene: str = "rope") -> Viewer:
    viewer = Viewer("127.0.0.1", 0, workbook=workbook)
    viewer.open(scene)
    return viewer


@pytest.fixture
def plain() -> Iterator[Viewer]:
    viewer = opened(Workbook(TASKS))
    yield viewer
    viewer.shut()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    make_folder(tmp_path / "mylab", TASKS)
    return tmp_path / "mylab"


@pytest.fixture
def student(folder: Path) -> Iterator[Viewer]:
    viewer = opened(Workbook(TASKS, folder))
    yield viewer
    viewer.shut()


def guide_of(viewer: Viewer) -> GuideTab:
    assert viewer.panel.guide is not None
    return viewer.panel.guide


def show(viewer: Viewer, name: str) -> GuideTab:
    """Show a task."""
    guide = guide_of(viewer)
    guide.workbook.go(next(i for i, task in enumerate(guide.workbook.tasks) if task.name == name))
    wait_for(lambda: guide.shown_task is not None and guide.shown_task.name == name)
    return guide


def widgets_of(guide: GuideTab, key: str) -> QuestionWidgets:
    return next(widgets for widgets in guide.questions if widgets.question.key == key)


def test_the_guide_of_a_scene_begins_with_its_first_question_and_turns(plain: Viewer) -> None:
    guide = guide_of(plain)
    assert guide.shown_task is not None
    assert guide.shown_task.item == "3.2-1"
    assert "Complete the rope" in guide.text.content
    does(guide.tasks.on_turn, ON)
    wait_for(lambda: "Euler" in guide.text.content)
    assert guide.tasks.chooser.value.startswith("3.2-2")
    does(guide.tasks.on_turn, BACK)
    wait_for(lambda: "Complete the rope" in guide.text.content)
    does(guide.tasks.on_chooser, guide.tasks.titles[0])
    wait_for(lambda: "Which fluid is on top" in guide.text.content)
    assert not guide.questions


def test_a_task_is_set_up_in_its_scene_and_its_answer_follows_the_parameters(plain: Viewer) -> None:
    guide = show(plain, "step_euler")
    does(guide.on_tool, SHOW)
    wait_for(lambda: SET_UP in guide.answer.content)  # leapfrog runs, so that the numbers are of something else
    assert HIDE in guide.tools.options
    does(guide.on_tool, SET_UP)
    wait_for(lambda: vars(plain.scene.params)["integrator"] == "explicit_euler")
    assert vars(plain.scene.params)["stiffness"] == vars(plain.settings.params)["stiffness"] == 200.0
    assert plain.panel.head.preset.value == "Lab code: 10 points (changed)"
    wait_for(lambda: "with 200\u00a0N/m it has" in guide.answer.content)
    assert "<math" in guide.answer.content
    plain.settings.set("stiffness", 300.0)
    wait_for(lambda: "with 300\u00a0N/m it has" in guide.answer.content)
    does(guide.on_tool, SHOW)
    wait_for(lambda: "math" not in guide.answer.content)


def test_a_task_shows_its_parameters_again_in_step_with_the_controls(plain: Viewer) -> None:
    show(plain, "step_euler")
    controls = plain.panel.controls
    wait_for(lambda: [control.name for control in controls.again] == ["integrator", "stiffness"])
    again = controls.again[1]
    does(again.on_field, "1.5k")
    assert vars(plain.settings.params)["stiffness"] == 1500.0
    assert controls["stiffness"].field.value == again.field.value == "1500"
    does(controls["stiffness"].on_field, "300")
    assert again.field.value == "300"
    does(again.on_field, "a lot")
    assert "a lot" in again.line.content
    assert again.field.value == "300"
    plain.settings.undo()
    assert again.field.value == "800"
    show(plain, "spring_force")
    wait_for(lambda: [control.name for control in controls.again] == ["damping", "drag"])
    show(plain, "cloth_links")  # of another scene
    wait_for(lambda: not controls.again)


def test_a_task_without_an_answer_offers_none(student: Viewer) -> None:
    guide = show(student, "net_buoyancy")
    wait_for(lambda: guide.tools.options == (SET_UP, PICTURE))
    show(student, "top_fluid")
    wait_for(lambda: guide.tools.options == (SET_UP, SHOW, PICTURE))


def test_a_control_that_means_nothing_is_hidden_in_a_task_too(plain: Viewer) -> None:
    controls = plain.panel.controls
    controls.show_again(("sphere_radius",), guide_of(plain).again.place)
    assert not controls.again[0].visible
    plain.settings.set("sphere", True)
    assert controls.again[0].visible


def test_a_task_of_another_scene_opens_it_and_stays_the_shown_one(plain: Viewer) -> None:
    guide = show(plain, "cloth_links")
    does(guide.on_tool, SET_UP)
    wait_for(lambda: plain.is_open and plain.panel.kind.name == "cloth")
    assert plain.scene.params == type(plain.scene.params)()
    again = guide_of(plain)
    assert again.shown_task is not None
    assert again.shown_task.name == "cloth_links"
    # The set-up of a task is not what the scene opens with later.
    assert "cloth" not in plain.first_params


def test_a_student_predicts_measures_and_explains(student: Viewer, folder: Path) -> None:
    guide = show(student, "step_euler")
    does(guide.on_tool, SHOW)
    wait_for(lambda: "Write your prediction first" in guide.answer.content)
    does(widgets_of(guide, "predict").on_field, "It flies apart.")
    widgets_of(guide, "predict").flush(float("inf"))
    number = widgets_of(guide, "stiffness")
    does(number.on_field, "a lot")
    wait_for(lambda: "was not saved: not a number. Write a number in N/m" in number.line.content)
    does(number.on_field, "720")
    wait_for(lambda: "At that stiffness the rope flies apart" in number.line.content)
    assert "Not right" in number.line.content
    does(guide.on_tool, SET_UP)
    wait_for(lambda: vars(student.scene.params)["integrator"] == "explicit_euler")
    student.settings.set("stiffness", 440.0)
    wait_for(lambda: 'data-done="yes"' in guide.text.content)
    assert number.reader is not None
    wait_for(lambda: number.reader is not None and number.reader.visible)
    does(number.on_read_off)
    wait_for(lambda: "Right." in number.line.content)
    assert number.field.value == "440"
    does(guide.on_tool, SHOW)
    wait_for(lambda: "<math" in guide.answer.content)
    assert widgets_of(guide, "predict").field.disabled
    kept = read_answers(folder).values
    assert kept["step_euler", "predict"] == "It flies apart."
    assert kept["step_euler", "stiffness"] == 440.0
    assert kept["step_euler", "done"] == "1"


def test_everything_is_there_again_on_another_day_and_an_editor_is_seen(student: Viewer, folder: Path) -> None:
    guide = show(student, "step_rk4")
    does(widgets_of(guide, "predict").on_field, "higher")
    does(widgets_of(guide, "evaluations").on_field, "4")
    student.shut()
    other = opened(Workbook(TASKS, folder))
    try:
        again = show(other, "step_rk4")
        assert widgets_of(again, "predict").field.value == "higher"
        assert widgets_of(again, "evaluations").field.value == "4"
        assert widgets_of(again, "stiffness").field.value == ""
        (folder / FILE).write_text("[step_rk4]\nevaluations = 5\n", "utf-8")
        wait_for(lambda: widgets_of(again, "evaluations").field.value == "5")
        assert widgets_of(again, "predict").field.value == UNANSWERED
        (folder / FILE).write_text("[step_rk4\n", "utf-8")
        wait_for(lambda: "answers.toml" in again.answer.content)
    finally:
        other.shut()


def test_a_text_is_kept_when_the_typing_pauses_and_when_the_task_is_left(student: Viewer, folder: Path) -> None:
    guide = show(student, "reflectance")
    text = widgets_of(guide, "explain")
    does(text.on_field, "Hardly any")
    does(text.on_field, "Hardly any light comes")
    assert ("reflectance", "explain") not in read_answers(folder).values or not read_answers(folder).values[
        "reflectance", "explain"
    ]
    does(guide.tasks.on_turn, ON)
    wait_for(lambda: guide.shown_task is not None and guide.shown_task.name != "reflectance")
    assert read_answers(folder).values["reflectance", "explain"] == "Hardly any light comes"
    again = widgets_of(show(student, "reflectance"), "explain")
    assert again.field.value == "Hardly any light comes"
    does(again.on_field, "x" * 4500)
    again.flush(float("inf"))
    wait_for(lambda: "at most 4000 characters" in again.line.content)
    assert read_answers(folder).values["reflectance", "explain"] == "Hardly any light comes"


def test_a_folder_that_cannot_be_written_is_said(student: Viewer, folder: Path) -> None:
    guide = show(student, "step_rk4")
    folder.rename(folder.with_name("moved"))
    choice = widgets_of(guide, "predict")
    does(choice.on_field, "higher")
    wait_for(lambda: "answers.toml could not be written: No such file" in choice.line.content)


def test_what_could_not_be_ticked_off_is_said_until_it_can(student: Viewer, folder: Path) -> None:
    guide = show(student, "step_euler")
    does(guide.on_tool, SET_UP)
    wait_for(lambda: vars(student.scene.params)["integrator"] == "explicit_euler")
    moved = folder.rename(folder.with_name("moved"))
    student.settings.set("stiffness", 440.0)
    wait_for(lambda: "could not be written" in guide.answer.content)
    moved.rename(folder)
    wait_for(lambda: 'data-done="yes"' in guide.text.content)
    wait_for(lambda: "could not be written" not in guide.answer.content)


def test_a_picture_is_kept_for_the_task_that_is_shown(student: Viewer, folder: Path, monkeypatch) -> None:
    def refuse(client: object, size: object, *, jpeg: bool) -> bytes:
        raise TimeoutError("the browser has gone")

    guide = show(student, "spring_force")
    wait_for(lambda: "time" in guide.values)
    words: list[Any] = []
    client = SimpleNamespace(
        add_notification=lambda title, body, **_: words.append(SimpleNamespace(body=body)) or words[-1]
    )
    event = SimpleNamespace(target=SimpleNamespace(value=PICTURE), client_id=1, client=client)
    monkeypatch.setattr(
        "app.panel.recording.report_pictures.take_picture", lambda client, size, *, jpeg: b"\xff\xd8\xff"
    )
    coroutines.run(guide.on_tool(event))
    wait_for(lambda: "The report has the picture" in words[-1].body)
    name = next((folder / PICTURES).iterdir()).name
    assert name.startswith("spring_force-rope-")
    assert name in words[-1].body
    monkeypatch.setattr("app.panel.recording.report_pictures.take_picture", refuse)
    wait_for(lambda: not guide.pictures.busy.locked())
    coroutines.run(guide.on_tool(event))
    wait_for(lambda: words[-1].body == "No picture was taken: the browser has gone")
    assert len(list((folder / PICTURES).iterdir())) == 1
    # A picture that comes late is of another task, or of another scene.
    for change in (lambda: show(student, "step_euler"), lambda: student.open("cloth")):
        guide = show(student, "spring_force")

        def come_late(*_: object, change: Callable[[], object] = change, **__: object) -> bytes:
            change()
            return b"\xff\xd8\xff"

        monkeypatch.setattr("app.panel.recording.report_pictures.take_picture", come_late)
        coroutines.run(guide.on_tool(event))
        wait_for(lambda: "another task or scene was opened" in words[-1].body)
        assert len(list((folder / PICTURES).iterdir())) == 1


def test_the_name_is_kept_and_refused(student: Viewer, folder: Path) -> None:
    guide = guide_of(student)
    does(guide.on_name, "Ada")
    assert read_answers(folder).name == "Ada"
    does(guide.on_name, "x" * 101)
    wait_for(lambda: "A name has at most" in guide.answer.content)
    assert read_answers(folder).name == "Ada"


def test_the_guide_says_the_errors_of_a_race_as_its_table_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both are read after each update of the panel while the race runs."""
    seen: list[tuple[list[str], list[str]]] = []
    update = Panel.update

    def spy(panel: Panel, *arguments: Any) -> None:
        update(panel, *arguments)
        notes = panel.controls_tab.readings.notes
        if panel.guide is not None and "Results" in notes:
            table = re.findall(r"<tr><td>(?:<b>)?(.*?)(?:</b>)?</td>", notes["Results"].text.content)
            now = re.findall(r"Error of rope \d: <b>(.*?)</b>", panel.guide.readings.content)
            if now and table:
                seen.append((now, table[: len(now)]))

    monkeypatch.setattr(Panel, "update", spy)
    viewer = opened(Workbook(TASKS), "race")
    try:
        show(viewer, "compare_methods")
        viewer.loop.run.audience = lambda: 1
        wait_for(lambda: len({tuple(now) for now, _ in seen}) >= 6)
    finally:
        viewer.shut()
    for now, table in seen:
        assert now == table


@pytest.mark.parametrize(
    ("error", "floor", "said"),
    [(8.88e-16, 1e-9, "< 1 nm"), (1.84e-9, 1e-9, "1.84 nm"), (0.153, 1e-9, "153 mm"), (0.1, math.nan, "–")],
)
def test_an_error_is_written_as_in_the_table(error: float, floor: float, said: str) -> None:
    result: Any = SimpleNamespace(error=error, error_floor=floor)
    assert format(LiveNumber(error, "m", "Error of rope 1", floor), "u") == said
    assert re.sub("</?b>", "", error_text(result)) == escape(said)


def test_a_page_that_is_turned_in_the_middle_of_a_look_does_not_tick_off_a_step_of_the_next_task(
    student: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    guide = show(student, "step_euler")
    does(guide.on_tool, SET_UP)
    wait_for(lambda: vars(student.scene.params)["integrator"] == "explicit_euler")
    guide = guide_of(student)
    wait_for(lambda: guide.shown_task is not None and guide.shown_task.name == "step_euler")
    student.served.stop_threads()
    workbook, watched = guide.workbook, []
    set_up_of = workbook.set_up_of

    def set_up_and_turn(task: Any) -> Any:
        found = set_up_of(task)
        workbook.index = 0  # as a callback does, on the event loop
        return found

    monkeypatch.setattr(workbook, "set_up_of", set_up_and_turn)
    monkeypatch.setattr(workbook, "watch", lambda task, values: watched.append(task.name))
    guide.update(student.loop.latest, True)
    assert watched == ["step_euler"]


def test_the_signs_of_all_tasks_are_worked_out_where_an_answer_or_a_check_is_new(student: Viewer) -> None:
    guide = show(student, "step_euler")
    student.served.stop_threads()
    states: dict[str, str] = {}
    asked = []
    guide.workbook.programs = lambda: dict(states)
    guide.tasks.titles_now = lambda: asked.append(1) or guide.tasks.titles  # type: ignore[method-assign]
    guide.update(student.loop.latest, True)
    asked.clear()
    for state, count in (({}, 0), ({"gravity": "right"}, 1), ({"gravity": "right"}, 1), ({"gravity": "wrong"}, 2)):
        states = state
        guide.update(student.loop.latest, True)
        assert len(asked) == count
    guide.workbook.revision += 1
    guide.update(student.loop.latest, True)
    assert len(asked) == 3


def test_a_set_up_that_is_refused_is_said_by_the_next_look(student: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    guide = show(student, "step_euler")
    student.served.stop_threads()

    def refuse(_: object) -> None:
        raise ValueError("the file of this set-up is gone")

    monkeypatch.setattr(guide, "set_up", refuse)
    guide.update(student.loop.latest, False)
    does(guide.on_tool, SET_UP)
    guide.update(student.loop.latest, False)
    assert "the file of this set-up is gone" in guide.answer.content


def test_what_is_asked_for_in_the_middle_of_a_look_is_shown_by_the_next(
    student: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    guide = show(student, "step_euler")
    student.served.stop_threads()
    said = "The prediction could not be kept."

    def ask_meanwhile() -> None:
        guide.refusal, guide.stale = said, True  # as a browser's act does

    guide.refusal, guide.stale = "", True
    with monkeypatch.context() as patch:
        patch.setattr(guide.questions[-1], "show", ask_meanwhile)
        guide.update(student.loop.latest, False)
    assert said not in guide.answer.content
    guide.update(student.loop.latest, False)
    assert said in guide.answer.content
