"""The teacher's page: folders that are checked as files are saved, ropes, and who may read the page."""

import contextlib
import functools
import html
import http.client
import itertools
import os
import re
import shutil
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from app.commands.lab_class import make_server
from app.lab.check.check import TaskResult, check_folder
from app.lab.check.mistakes import mistakes, standing
from app.lab.check.program_check import Verdict, not_checked
from app.lab.course.answers import change_answer, read_answers
from app.lab.course.folder import folder_names, make_folder
from app.lab.course.task import Task, load_tasks
from app.lab.process.runner import Runner
from app.lab.process.runners import Runners
from app.lab.report.class_page import page, rows, strip, student_row
from app.lab.report.classroom import Classroom, Desk, Student
from app.lab.report.rope_picture import RopePicture, rope_picture, svg
from app.lab.student.saved import Saved, read_files, store
from app.lab.student.versions import Versions, stamps
from tests.app.lab.check.test_true_sentences import CALLERS, source_of
from tests.waiting import wait_for

ODD = "<b>" if os.name == "posix" else "b&b"  # a folder's name; Windows has no angle brackets in names
TASKS = tuple(task for task in load_tasks() if task.item.startswith("3.2"))
FORCE = """import numpy as np


def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):
    r = x2 - x1
    length = np.linalg.norm(r)
    return stiffness * (length - rest_length) * r / length {} damping * (v1 - v2)
"""
ROPE = next(task for task in TASKS if task.name == "rope_acceleration")
EVIL = "<img src=x onerror=alert(1)>"


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    """Three folders of a class, of which one has a name that is HTML."""
    found = [tmp_path / "class" / name for name in ("ada", "bo", ODD)]
    for folder in found:
        make_folder(folder, TASKS)
    return found


@pytest.fixture
def state_of() -> Iterator[Callable[[Path], Student]]:
    """The state of a folder, looked at again."""
    desks: dict[Path, Desk] = {}

    def look(folder: Path) -> Student:
        if folder not in desks:
            desks[folder] = Desk(folder, TASKS)
        desks[folder].student = desks[folder].checked()
        return desks[folder].student

    yield look
    for found in desks.values():
        found.versions.close()


def save(folder: Path, sign: str, more: str = "") -> None:
    """Write the function in place of its three dots. more: lines above it."""
    head, name, rest = (folder / "rope.py").read_text("utf-8").partition("\ndef spring_force(")
    body = FORCE.format(sign).partition("\n\n\ndef spring_force(")[2].partition(":\n")[2]
    (folder / "rope.py").write_text(more + head + name + rest.replace("    ...\n", body, 1), "utf-8")


@pytest.mark.parametrize(
    ("code", "text", "poses"),
    [
        (FORCE.format("-"), "Matches the reference.", 5),
        (FORCE.format("- 0.9 *"), "m from the reference.", 5),
        (FORCE.format("+"), "Flies apart within ", None),
        (FORCE.format("- nothing *"), "Does not run.", 0),
        ("import numpy as np\n\n\ndef spring_force(x1):\n    ...\n", "", 0),
    ],
)
def test_a_rope_is_drawn_as_far_as_it_gets(code: str, text: str, poses: int | None, tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text(code, "utf-8")
    with Runner(tmp_path) as runner:
        picture = rope_picture(runner, store(read_files(tmp_path), tmp_path, 1, TASKS))
    assert text in picture.text
    assert (picture.text == "") == (text == "")
    assert len(picture.own) == poses if poses is not None else 0 < len(picture.own) < 5
    assert np.isfinite(picture.own).all()
    assert svg(picture).count("<polyline") == len(picture.own) + bool(text)


def test_a_rope_falls_from_the_level_and_hangs_in_the_end(tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text(FORCE.format("-"), "utf-8")
    with Runner(tmp_path) as runner:
        picture = rope_picture(runner, store(read_files(tmp_path), tmp_path, 1, TASKS))
    tips = picture.own[:, -1, 2]
    assert tips[0] > 1.7
    assert tips[-1] < 0.3
    assert np.all(np.diff(tips) < 0.0)


def test_a_saved_file_changes_its_tasks_and_the_one_the_student_is_at(folders: list[Path], state_of) -> None:
    first = state_of(folders[0])
    assert (first.at, first.changed_at, first.rope.text) == ("", "", "")
    save(folders[0], "+")
    second = state_of(folders[0])
    assert second.at == "spring_force"
    assert second.changed_at
    assert second.programs["spring_force"].mistake == "sign of the damping reversed"
    change_answer(folders[0], TASKS, read_answers(folders[0]), "step_euler", "predict", "It explodes after a while.")
    third = state_of(folders[0])
    assert third.at == "step_euler"
    assert third.programs["spring_force"] is second.programs["spring_force"]  # not checked again
    assert state_of(folders[0]).changed_at == third.changed_at


def test_mistakes_are_counted_by_students_and_a_file_that_does_not_run_once(folders: list[Path], state_of) -> None:
    save(folders[0], "+")
    save(folders[1], "+")
    (folders[2] / "rope.py").write_text("def spring_force(:\n", "utf-8")
    change_answer(folders[1], TASKS, read_answers(folders[1]), "spring_force", "stretch", 0.5625)
    names = folder_names(folders)
    found = mistakes((names[folder], state_of(folder).results) for folder in folders)
    assert [(mistake.place, mistake.folders) for mistake in found] == [
        ("3.2-1 spring_force", ("ada", "bo")),
        ("3.2-1 Stretch", ("bo",)),
        ("rope.py", (ODD,)),
    ]
    assert "stretch of the whole rope" in found[1].text


def test_a_right_function_that_calls_a_wrong_one_waits_and_is_no_mistake(folders: list[Path], state_of) -> None:
    save(folders[0], "+")
    with (folders[0] / "rope.py").open("a", encoding="utf-8") as file:
        file.write("\n\n" + source_of(ROPE, CALLERS[ROPE.name]))
    results = {result.task.name: result for result in state_of(folders[0]).results}
    assert (results["spring_force"].state, results["rope_acceleration"].state) == ("wrong", "waits")
    assert [mistake.place for mistake in mistakes([("ada", tuple(results.values()))])] == ["3.2-1 spring_force"]


def test_the_page_has_folders_with_the_names_typed_and_escapes_all(folders: list[Path], state_of) -> None:
    save(folders[2], "+")
    (folders[2] / "answers.toml").write_text(
        f'name = "Ada <i>Lovelace"\n\n[spring_force]\npredict = "{EVIL}"\n', "utf-8"
    )
    text = page([state_of(folders[2])], 7, "word")
    assert html.escape(ODD) in text
    name = f'<td class="name">{html.escape(ODD)}<br><span class="faint small">Ada &lt;i&gt;Lovelace</span>'
    assert f"<tr>{name}" in text
    assert standing(state_of(folders[2]).results) in text
    assert "<b><" not in text
    assert EVIL not in text
    assert "http" not in text.replace("http-equiv", "")
    assert 'data-revision="7"' in text


def test_the_tasks_of_a_section_stand_together(tmp_path: Path) -> None:
    tasks = load_tasks()
    sections = [task.item.partition("-")[0] for task in tasks]
    student = Student(tmp_path)._replace(results=tuple(TaskResult(task, None, ()) for task in tasks))
    gaps = re.findall(r'class="cell [^"]*?( gap)?" title', strip(student))
    assert [bool(gap) for gap in gaps] == [False, *(one != other for one, other in itertools.pairwise(sections))]
    assert len(tasks) > len(set(sections)) > 1


def test_a_class_is_followed_and_nothing_is_written(folders: list[Path]) -> None:
    writes = 'open("left_behind", "w").write("x")\n'
    with Classroom(folders, TASKS) as classroom:
        wait_for(lambda: all(student.results for student in classroom.students.values()))
        before = classroom.revision
        files = {path for folder in folders for path in folder.rglob("*")}
        save(folders[1], "+", writes)
        assert classroom.wait(before, 60.0) > before
        wait_for(lambda: classroom.students[folders[1]].at == "spring_force")
        assert {path for folder in folders for path in folder.rglob("*")} == files
        assert "sign of the damping" in rows(tuple(classroom.students.values()))
        copies = [desk.versions.copies for desk in classroom.desks]
        assert all(copy.exists() for copy in copies)
    assert not any(copy.exists() for copy in copies)


def test_no_save_is_lost_whenever_it_comes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folders = [tmp_path / "class" / name for name in ("ada", "bo")]
    for folder in folders:
        folder.mkdir(parents=True)
        (folder / "rope.py").write_text("version 000", "utf-8")
    busy: dict[Path, int] = {}
    rng, checks, overlaps = np.random.default_rng(7), [], []

    def check(copies: Path, runner: Runner, task: Task, _: Sequence[Task]) -> Verdict:
        owner = copies.parent
        if busy.setdefault(owner, threading.get_ident()) != threading.get_ident():
            overlaps.append(owner)
        time.sleep(rng.uniform(0.0, 0.05))
        checks.append(owner)
        return Verdict("wrong", (copies / task.file).read_text("utf-8"))

    def picture(runner: Runner, saved: Saved) -> RopePicture:  # it comes last
        busy.pop(saved.folder.parent, None)
        return RopePicture()

    monkeypatch.setattr("app.lab.report.classroom.check_program", check)
    monkeypatch.setattr("app.lab.report.classroom.rope_picture", picture)
    monkeypatch.setattr("app.lab.report.classroom.LOOK_INTERVAL", 0.02)
    own = [task for task in TASKS if task.file == "rope.py"]

    def shown(folder: Path) -> set[str]:
        return {verdict.text for verdict in classroom.students[folder].programs.values()}

    with Classroom(folders, own) as classroom:
        wait_for(lambda: all(shown(folder) == {"version 000"} for folder in folders))
        for number in range(1, 101):
            for folder in folders:
                (folder / "rope.py").write_text(f"version {number:03}", "utf-8")
            time.sleep(rng.uniform(0.0, 0.05))
        wait_for(lambda: all(shown(folder) == {"version 100"} for folder in folders))
    assert not any("could not be checked" in student.error for student in classroom.students.values())
    assert len(set(checks)) == 2
    assert overlaps == []  # one thread has a folder until it is done


def test_a_folder_that_is_removed_and_made_again_is_followed(folders: list[Path]) -> None:
    with Classroom(folders[:1], TASKS) as classroom:
        wait_for(lambda: classroom.students[folders[0]].results)
        shutil.rmtree(folders[0])
        wait_for(lambda: "does not exist" in rows(tuple(classroom.students.values())))
        make_folder(folders[0], TASKS)
        wait_for(lambda: not classroom.students[folders[0]].error)
        save(folders[0], "+")
        wait_for(lambda: "sign of the damping" in rows(tuple(classroom.students.values())))


def test_folders_of_one_name_are_told_apart_on_the_page(tmp_path: Path, state_of) -> None:
    folders = [tmp_path / name / "lab" for name in ("ada", "bo")] + [tmp_path / "carl"]
    students = []
    for folder in folders:
        make_folder(folder, TASKS)
        save(folder, "+")
        students.append(state_of(folder))
    page = rows(students)
    assert ">ada/lab<" in page
    assert ">bo/lab<" in page
    assert ">carl<" in page
    assert "ada/lab, bo/lab, carl" in page


def endless(folder: Path) -> None:
    """Write an endless loop into every function of the rope."""
    (folder / "rope.py").write_text(
        (folder / "rope.py").read_text("utf-8").replace("    ...\n", "    while True: pass\n"), "utf-8"
    )


def test_the_end_does_not_wait_for_endless_functions(folders: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.lab.process.runners.Runner", functools.partial(Runner, time_limit=600.0))
    monkeypatch.setattr("app.lab.report.classroom.Versions", functools.partial(Versions, time_limit=600.0))
    for folder in folders:
        endless(folder)
    with Classroom(folders, TASKS) as classroom:
        wait_for(lambda: [True for desk in classroom.desks for one in desk.versions.processes.values() if one.starts])
    assert not any(thread.is_alive() for thread in classroom.threads)
    runners = Runners()
    with ThreadPoolExecutor(1) as pool:
        found = pool.submit(check_folder, folders[0], TASKS, curves=False, runners=runners)
        wait_for(lambda: [runner for runner in runners.running if runner.starts])
        runners.abort()
        assert {entry.program.mistake for entry in found.result(60.0).tasks if entry.program} == {"ended"}


def test_a_function_that_could_not_be_checked_is_checked_again(
    folders: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    save(folders[0], "-")
    asked: list[str] = []

    def check(copies: Path, runner: Runner, task: Task, _: Sequence[Task]) -> Verdict:
        asked.append(task.name)
        return Verdict("right") if asked.count(task.name) > 1 else not_checked("the machine is busy")

    monkeypatch.setattr("app.lab.report.classroom.check_program", check)
    with Classroom(folders[:1], TASKS) as classroom:
        wait_for(lambda: classroom.students[folders[0]].results)
        wait_for(lambda: {v.state for v in classroom.students[folders[0]].programs.values()} == {"right"})
        revision = classroom.revision
        wait_for(lambda: classroom.revision == revision)
    assert len(asked) == 2 * len(set(asked))


def test_a_folder_that_is_as_it_was_changes_nothing_on_the_page(
    folders: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    looks: list[Path] = []
    monkeypatch.setattr("app.lab.student.versions.stamps", lambda *of: looks.append(of[0]) or stamps(*of))
    monkeypatch.setattr("app.lab.report.classroom.LOOK_INTERVAL", 0.02)
    with Classroom(folders[:1], TASKS) as classroom:
        wait_for(lambda: classroom.students[folders[0]].results)
        for _ in range(2):  # while the files are read at each look, and for the rewritten answers
            revision, before = classroom.revision, len(looks)
            answers = (folders[0] / "answers.toml").read_bytes()
            (folders[0] / "answers.toml").write_bytes(answers)
            wait_for(lambda before=before: len(looks) > before + 20)
            assert classroom.revision == revision


def test_a_broken_file_is_where_its_line_is(folders: list[Path], state_of) -> None:
    save(folders[0], "-")
    (folders[0] / "rope.py").write_text(
        (folders[0] / "rope.py").read_text("utf-8").replace("    ...\n", "    return 1\n", 1), "utf-8"
    )
    first = state_of(folders[0])
    begun = [name for name, verdict in first.programs.items() if verdict.state != "not begun"]
    assert begun[0] == "spring_force"
    assert len(begun) == 2
    text = (folders[0] / "rope.py").read_text("utf-8").replace("(length - rest_length)", "(length - rest_length")
    (folders[0] / "rope.py").write_text(text, "utf-8")
    second = state_of(folders[0])
    assert second.at == "spring_force"
    states = {name: verdict.state for name, verdict in second.programs.items()}
    assert {states.pop(name) for name in begun} == {"failed"}
    assert set(states.values()) == {"not begun"}
    page = rows([second])
    line = text[: text.index("(length - rest_length")].count("\n") + 1
    assert f"rope.py does not run: line {line}: SyntaxError" in page
    assert page.count("SyntaxError") == 1
    assert "step_leapfrog: " not in page


@contextlib.contextmanager
def serving(folders: list[Path]) -> Iterator[tuple[Classroom, int]]:
    """A class and the port of its page."""
    with Classroom(folders, TASKS) as classroom:
        server = make_server(classroom, "secret", 0)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield classroom, server.server_address[1]
        server.shutdown()
        server.server_close()


@pytest.fixture
def served(folders: list[Path]) -> Iterator[tuple[Classroom, int]]:
    with serving(folders) as found:
        yield found


def asked(port: int, path: str, host: str = "", method: str = "GET") -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request(method, path, headers={"Host": host or f"localhost:{port}"})
    return connection.getresponse()


def test_only_who_has_the_address_reads_the_page(served: tuple[Classroom, int]) -> None:
    _, port = served
    answer = asked(port, "/secret/")
    assert answer.status == 200
    assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
    assert b"Class of 3" in answer.read()
    for path in ("/", "/secre/", "/other/rows", "/secret/x", "/secret/../secret/rows.html"):
        assert asked(port, path).status == 404, path
    assert asked(port, "/secret/", host="evil.example").status == 404
    assert asked(port, "/secret/", method="POST").status == 501


def test_rows_come_once_they_are_new(served: tuple[Classroom, int]) -> None:
    classroom, port = served
    wait_for(lambda: all(student.results for student in classroom.students.values()))
    revision = classroom.revision
    for after in ("", "-5", "x", "99999999999999999999"):
        answer = asked(port, f"/secret/rows?after={after}")
        assert answer.headers["X-Revision"] == str(revision)
        assert b"Class of 3" in answer.read()
    save(next(iter(classroom.students)), "-")
    assert int(asked(port, f"/secret/rows?after={revision}").headers["X-Revision"]) > revision


def test_the_first_rows_come_at_once(folders: list[Path]) -> None:
    """Also where one student has changed once so far."""
    with serving(folders[:1]) as (classroom, port):
        wait_for(lambda: classroom.revision == 1)
        answer = asked(port, "/secret/rows")
        assert answer.headers["X-Revision"] == "1"
        assert b"Class of 1" in answer.read()


def test_a_browser_that_leaves_before_its_answer_prints_nothing(
    served: tuple[Classroom, int], capsys: pytest.CaptureFixture[str]
) -> None:
    classroom, port = served
    wait_for(lambda: all(student.results for student in classroom.students.values()))

    def answers() -> bool:
        return any("process_request" in thread.name for thread in threading.enumerate())

    with socket.create_connection(("127.0.0.1", port)) as browser:
        browser.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # closing it resets it
        asks = f"GET /secret/rows?after={classroom.revision} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"
        browser.sendall(asks.encode())
        wait_for(answers)
    save(next(iter(classroom.students)), "-")
    wait_for(lambda: not answers())
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("options", [["--scene", "cloth"], ["--host", "0.0.0.0"], ["--resume"], ["--set", "points=9"]])
def test_the_page_takes_no_option_of_a_lab(
    options: list[str], folders: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["lab", *map(str, folders), *options]) == 2
    assert f"{options[0]}: the class page takes --port" in capsys.readouterr().err


def test_several_folders_are_a_class(folders: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    served: list[list[Path]] = []
    monkeypatch.setattr("app.commands.lab.serve_class", lambda arguments: served.append(arguments.folders) or 0)
    monkeypatch.setattr("app.lab.student.session.Session", lambda *_: pytest.fail("one folder of several is served"))
    for several in (folders[:2], folders[:3]):
        assert main(["lab", *map(str, several)]) == 0
        assert served[-1] == several


def test_a_class_needs_folders(folders: list[Path], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lab", str(folders[0]), str(folders[0] / "rope.py")]) == 2
    assert "not a folder" in capsys.readouterr().err


def test_the_poses_of_a_picture_are_the_darker_the_later_and_the_last_has_its_points() -> None:
    own = np.zeros((4, 3, 3))
    own[:, :, 0] = 0.2 * np.arange(3)
    own[:, :, 2] = 2.0 - 0.1 * np.arange(4)[:, None]
    text = str(svg(RopePicture(own, own[-1:], "Matches the reference.")))
    assert [float(number) for number in re.findall(r'opacity="([0-9.]+)"', text)] == [0.9, 0.25, 0.5, 0.75, 1.0]
    assert text.count("<circle") == 3


def test_a_folder_without_results_says_why() -> None:
    assert "being checked" in str(student_row(Student(Path("ada")), "ada"))
    row = str(student_row(Student(Path("ada"), error="no such folder"), "ada"))
    assert "no such folder" in row
    assert "being checked" not in row
