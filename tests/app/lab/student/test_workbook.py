"""The workbook: what it keeps in answers.toml, what it refuses, and what it remembers."""

import os
import threading
import time
from pathlib import Path

import pytest
from msgspec.structs import replace

from app.lab.course.answers import FILE, Answers, read_answers
from app.lab.course.folder import MAX_PICTURES, PICTURES, make_folder
from app.lab.course.live_values import LiveNumber
from app.lab.course.task import Question, Task, load_tasks
from app.lab.student.workbook import DONE, MAX_TEXT, Workbook, read_off
from app.scenes import scene_named
from sim.parameters import parameters_of

TASKS = load_tasks()  # with their checks: the folder's files are made of them
DRAFT = next(task for task in TASKS if task.name == "extra_draft")
ODD = "Two\nlines \"\"\" \\ 波 🌊 '''"
PREDICT, MEASURE, EXPLAIN = DRAFT.questions


def test_a_law_that_is_no_formula_is_named() -> None:
    assert DRAFT.guide is not None
    broken = replace(DRAFT, guide=replace(DRAFT.guide, law=("a = {b",)))
    with pytest.raises(ValueError, match=r"extra_draft\.toml: law: 'a = \{b' .*braces"):
        Workbook([broken])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    make_folder(tmp_path / "mylab", TASKS)
    return tmp_path / "mylab"


def answered(folder: Path, task: Task, question: Question) -> object:
    return read_answers(folder).of(task, question)


def test_without_a_folder_the_guides_are_shown_and_nothing_is_kept() -> None:
    book = Workbook(TASKS)
    assert len(book.tasks) == 23
    assert not book.is_shown(book.task)
    book.show_answer(book.task)
    assert book.is_shown(book.task)
    book.show_answer(book.task)
    assert not book.is_shown(book.task)
    book.go_to_scene("cloth")
    assert book.task.item == "3.3-3"
    book.go(10**6)
    assert book.index == 22
    book.go(-5)
    assert book.index == 0
    with pytest.raises(ValueError, match="at least one"):
        Workbook([])


def test_the_first_task_that_is_open_is_shown_on_another_day(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    assert len(book.tasks) == len(TASKS)
    assert book.index == 0
    for question, text in zip(book.task.questions, ("oil", "oil", "Archimedes: F = rho g V."), strict=True):
        book.answer(book.task, question, text)
    # The second task has a function and no question, and is complete here.
    assert Workbook(TASKS, folder).task.name == "extra_draft"


def test_the_workbook_goes_on_after_the_last_task_that_was_begun(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    euler = next(task for task in TASKS if task.name == "step_euler")
    book.answer(euler, euler.questions[0], "It flies apart.")
    assert Workbook(TASKS, folder).task is euler
    for question in euler.questions[1:]:
        book.answer(euler, question, str(question.right))
    assert Workbook(TASKS, folder).task.name == "step_rk4"


def test_steps_are_ticked_off_one_after_the_other(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    spring = next(task for task in TASKS if task.name == "spring_force")
    hanging = {"damping": LiveNumber(7.0), "drag": LiveNumber(1.0), "time": LiveNumber(20.0, "s")}
    book.watch(spring, hanging)
    assert not book.done(spring)
    book.watch(spring, {**hanging, "damping": LiveNumber(0.0), "drag": LiveNumber(0.0)})
    assert book.done(spring) == {1}
    book.watch(spring, hanging)
    assert book.done(spring) == {1, 2}


@pytest.mark.parametrize(
    ("question", "text", "kept"),
    [
        (PREDICT, "as before", "as before"), (MEASURE, "0,031", 0.031), (MEASURE, "31 mm", 0.031),
        (MEASURE, " 3.1e-2 m ", 0.031), (MEASURE, "", None), (EXPLAIN, ODD, ODD),
        (EXPLAIN, "x" * MAX_TEXT, "x" * MAX_TEXT), (EXPLAIN, "[draft]\nmeasure = 3", "[draft]\nmeasure = 3"),
    ],
)  # fmt: skip
def test_answers_are_kept(folder: Path, question: Question, text: str, kept: object) -> None:
    book = Workbook(TASKS, folder)
    book.answer(DRAFT, question, text)
    assert answered(folder, DRAFT, question) == book.answers.of(DRAFT, question) == kept
    assert read_answers(folder).error == ""


@pytest.mark.parametrize(
    ("question", "text", "reason"),
    [
        (PREDICT, "sideways", "not one of the choices"), (MEASURE, "a lot", "number in m"), (MEASURE, "1,000", "comma"),
        (MEASURE, "5 kg", "no unit"), (MEASURE, "1e999", "stored"), (MEASURE, "nan", "number"),
        (EXPLAIN, "x" * (MAX_TEXT + 1), "at most 4000"), (EXPLAIN, "a\x07b", "control"), (EXPLAIN, "\ud800", "control"),
    ],
)  # fmt: skip
def test_what_is_not_allowed_is_refused_in_one_line_and_changes_nothing(folder: Path, question, text, reason) -> None:
    book = Workbook(TASKS, folder)
    before = (folder / FILE).read_bytes()
    with pytest.raises(ValueError, match=reason) as error:
        book.answer(DRAFT, question, text)
    assert "\n" not in str(error.value)
    assert (folder / FILE).read_bytes() == before


def test_a_prediction_comes_before_the_answer_and_stays(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    with pytest.raises(ValueError, match="prediction first"):
        book.show_answer(DRAFT)
    book.answer(DRAFT, PREDICT, "higher")
    book.show_answer(DRAFT)
    with pytest.raises(ValueError, match="can no longer be changed"):
        book.answer(DRAFT, PREDICT, "deeper")
    again = Workbook(TASKS, folder)
    assert again.is_shown(DRAFT)
    assert answered(folder, DRAFT, PREDICT) == "higher"


def test_what_is_seen_to_be_done_is_ticked_off_for_good(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    thin, thick = ({"spill": "layer", "layer_thickness": LiveNumber(d, "m")} for d in (0.2, 0.6))
    book.watch(DRAFT, thin)
    assert not book.done(DRAFT)
    book.watch(DRAFT, thick)
    assert book.done(DRAFT) == {1}
    written = (folder / FILE).stat().st_mtime_ns
    book.watch(DRAFT, thick)
    book.watch(DRAFT, thin)
    assert (folder / FILE).stat().st_mtime_ns == written
    assert Workbook(TASKS, folder).done(DRAFT) == {1}
    (folder / FILE).write_text(f'[extra_draft]\n{DONE} = "x 99999999999 1 ²"\n', "utf-8")
    book.refresh()
    assert book.done(DRAFT) == {1}


def test_a_new_value_stands_above_the_heading_of_the_next_task(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    book.answer(DRAFT, EXPLAIN, "One line.\n# no comment")
    before = (folder / FILE).read_text("utf-8")
    book.store(DRAFT.name, "done", "1")
    assert (folder / FILE).read_text("utf-8") == before.replace('# no comment"""\n', '# no comment"""\ndone = "1"\n')


def test_only_one_value_changes_and_comments_and_edits_stay(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    path = folder / FILE
    text = path.read_text("utf-8").replace('name = ""', 'name = "Ada"  # mine')
    path.write_text(text.replace("[extra_draft]", "# my own note\n[extra_draft]"), "utf-8")
    book.answer(DRAFT, MEASURE, "0.03")
    book.answer(DRAFT, EXPLAIN, "One line.\n# no comment\nmeasure = 4")
    book.answer(DRAFT, MEASURE, "0.031")
    book.store("extra_draft", DONE, "1")
    now = path.read_text("utf-8")
    assert "# my own note\n[extra_draft]" in now
    assert 'name = "Ada"  # mine' in now
    assert read_answers(folder).name == "Ada"
    assert answered(folder, DRAFT, MEASURE) == 0.031
    assert answered(folder, DRAFT, EXPLAIN) == "One line.\n# no comment\nmeasure = 4"
    assert now.count("measure = 0.031") == 1
    assert len(now.splitlines()) == len(text.splitlines()) + 1 + 4  # the note, three lines of text, what was done


@pytest.mark.parametrize(
    "text",
    ["", 'extra_draft = {measure = 1}\nname = "Ada"\n', '[top_fluid]\nlaw = """\n[extra_draft]\nmeasure = 2"""\n',
     "[extra_draft]\nmeasure = [\n1,\n2]\n", "['extra_draft']\nmeasure = 1\n"],
)  # fmt: skip
def test_a_file_written_in_another_way_gets_the_answer_too(folder: Path, text: str) -> None:
    (folder / FILE).write_text(text, "utf-8")
    before = read_answers(folder)
    Workbook(TASKS, folder).answer(DRAFT, MEASURE, "0.031")
    after = read_answers(folder)
    assert after.error == ""
    assert answered(folder, DRAFT, MEASURE) == 0.031
    assert after.name == before.name
    left = {key: value for key, value in before.values.items() if key != ("extra_draft", "measure")}
    assert {key: after.values[key] for key in left} == left


def test_a_broken_file_is_said_and_never_written_over(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    (folder / FILE).write_text("[extra_draft\nmine", "utf-8")
    with pytest.raises(ValueError, match="Nothing is saved until you repair this"):
        book.answer(DRAFT, MEASURE, "0.031")
    assert (folder / FILE).read_text("utf-8") == "[extra_draft\nmine"
    book.refresh()
    assert FILE in book.answers.error


def test_a_file_that_was_removed_is_made_again_and_a_folder_that_is_gone_is_an_error(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    (folder / FILE).unlink()
    book.answer(DRAFT, MEASURE, "0.031")
    assert answered(folder, DRAFT, MEASURE) == 0.031
    folder.rename(folder.with_name("moved"))
    with pytest.raises(OSError, match=r"."):
        book.answer(DRAFT, MEASURE, "0.032")


def test_changes_from_two_threads_are_both_kept(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    ticking = threading.Thread(target=lambda: [book.store("extra_draft", DONE, str(i)) for i in range(10)])
    ticking.start()
    for i in range(10):
        book.answer(DRAFT, EXPLAIN, f"Sentence number {i}.")
    ticking.join()
    assert book.answers.values["extra_draft", DONE] == "9"
    assert answered(folder, DRAFT, EXPLAIN) == "Sentence number 9."


def test_a_look_at_the_file_that_began_before_a_change_does_not_undo_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    book = Workbook(TASKS, folder)
    (folder / FILE).write_text("[extra_draft]\nmeasure = 1\n", "utf-8")
    has_read = threading.Event()

    def read_slowly(folder: Path) -> Answers:
        found = read_answers(folder)
        if threading.current_thread() is looking:
            has_read.set()
            time.sleep(0.2)
        return found

    looking = threading.Thread(target=book.refresh)
    monkeypatch.setattr("app.lab.student.workbook.read_answers", read_slowly)
    looking.start()
    assert has_read.wait(10.0)
    book.answer(DRAFT, MEASURE, "2")
    looking.join()
    assert book.answers.of(DRAFT, MEASURE) == 2.0


def test_edits_of_the_file_are_seen(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    revision = book.revision
    book.refresh()
    assert book.revision == revision
    (folder / FILE).write_text("[extra_draft]\nmeasure = 7\n", "utf-8")
    book.refresh()
    assert book.revision == revision + 1
    assert book.verdict(DRAFT, MEASURE).state == "wrong"
    # again within the same tick of the clock of files, and of the same size
    stamp = (folder / FILE).stat().st_mtime_ns
    (folder / FILE).write_text("[extra_draft]\nmeasure = 8\n", "utf-8")
    os.utime(folder / FILE, ns=(stamp, stamp))
    book.refresh()
    assert book.answers.of(DRAFT, MEASURE) == 8.0


def test_what_is_read_off_is_a_number_of_the_scene() -> None:
    assert read_off(MEASURE, {"box_deeper": LiveNumber(0.0310244, "m")}) == "0.0310244"
    assert read_off(MEASURE, {}) == ""
    assert read_off(MEASURE, {"box_deeper": LiveNumber(float("nan"), "m")}) == ""


def test_pictures_are_named_by_their_task_and_none_replaces_another(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    names = [book.add_picture(DRAFT, "radial_sea-1s", bytes([i])) for i in range(3)]
    assert names == [f"extra_draft-radial_sea-1s{end}.jpg" for end in ("", "-2", "-3")]
    assert [(folder / PICTURES / name).read_bytes() for name in names] == [b"\0", b"\1", b"\2"]
    for i in range(MAX_PICTURES - 3):
        (folder / PICTURES / str(i)).touch()
    with pytest.raises(ValueError, match="60 pictures"):
        book.add_picture(DRAFT, "again", b"")


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_the_name_is_changed_in_its_place(folder: Path, end: str) -> None:
    before = (folder / FILE).read_text("utf-8").replace("\n", end)
    (folder / FILE).write_bytes(before.encode())
    book = Workbook(TASKS, folder)
    book.rename('  Ada "L." \\1  Lovelace ')
    after = before.replace('name = ""', 'name = "Ada \\"L.\\" \\\\1 Lovelace"', 1)
    assert (folder / FILE).read_bytes().decode() == after
    assert book.answers.name == 'Ada "L." \\1 Lovelace'
    with pytest.raises(ValueError, match="at most 100"):
        book.rename("x" * 101)
    (folder / FILE).write_text('# mine\n[extra_draft]\nexplain = """\nname = 1\n"""\n', "utf-8")
    book.rename("Ada")
    assert read_answers(folder).name == "Ada"
    assert read_answers(folder).values["extra_draft", "explain"] == "name = 1\n"


def test_what_would_answer_a_question_is_hidden_until_it_is_answered(folder: Path) -> None:
    book = Workbook(TASKS, folder)
    task = next(task for task in TASKS if task.name == "step_euler")
    book.go(book.tasks.index(task))
    assert book.hidden() == {"stiffness", "time_step"}
    for question in task.questions:
        book.answer(task, question, "720" if question.kind == "number" else "It trembles and flies apart.")
    assert book.hidden() == frozenset()
    assert Workbook(TASKS).hidden() == frozenset()


def test_what_a_task_hides_is_a_parameter_or_a_heading_of_its_scene() -> None:
    for task in TASKS:
        if task.setup is not None and task.setup.hide:
            kind = scene_named(task.setup.scene)
            headings = {"Archimedes' principle", "Fluids"} if kind.name == "radial_sea" else set()
            assert set(task.setup.hide) <= {*parameters_of(kind.params), *headings}, task.name


def test_a_task_is_open_begun_or_right_by_its_answers_and_its_function(folder: Path) -> None:
    states: dict[str, str] = {}
    book = Workbook(TASKS, folder, lambda: states)
    task = next(task for task in TASKS if task.name == "rope_acceleration")
    assert book.state(task) == "open"
    states[task.name] = "wrong"
    assert book.state(task) == "begun"
    states[task.name] = "right"
    assert book.state(task) == "begun"
    book.answer(task, task.questions[0], "Damping and air take energy.")
    assert book.state(task) == "right"


@pytest.mark.parametrize("text", ["11.25 cm", "112.5mm", "0.1125 m", "0,1125"])
def test_a_length_is_taken_in_its_common_units(folder: Path, text: str) -> None:
    book = Workbook(TASKS, folder)
    task = next(task for task in TASKS if task.name == "spring_force")
    question = next(question for question in task.questions if question.key == "stretch")
    book.answer(task, question, text)
    assert book.verdict(task, question).state == "right"
