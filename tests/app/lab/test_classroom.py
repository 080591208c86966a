"""The teacher's page: folders that are checked as files are saved, ropes, and who may read the page."""

import http.client
import socket
import struct
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from app.commands.lab_class import make_server
from app.lab.answers import change_answer, read_answers
from app.lab.class_page import mistakes, page, rows
from app.lab.classroom import Classroom, Student, checked
from app.lab.folder import make_folder
from app.lab.rope_picture import rope_picture, svg
from app.lab.runner import Runner
from app.lab.saved import keep, read_files
from app.lab.task import load_tasks
from tests.waiting import wait_for

TASKS = tuple(task for task in load_tasks() if task.item.startswith("3.2"))
FORCE = """import numpy as np


def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):
    r = x2 - x1
    length = np.linalg.norm(r)
    return stiffness * (length - rest_length) * r / length {} damping * (v1 - v2)
"""
EVIL = "<img src=x onerror=alert(1)>"


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    """Three folders of a class, of which one has a name that is HTML."""
    found = [tmp_path / "class" / name for name in ("ada", "bo", "<b>")]
    for folder in found:
        make_folder(folder, TASKS)
    return found


def state_of(folder: Path, tmp_path: Path, before: Student | None = None) -> Student:
    number = 1 if before is None or before.saved is None else before.saved.number + 1
    copies = tmp_path / "copies" / folder.name / str(number)
    copies.mkdir(parents=True, exist_ok=True)
    with Runner(copies) as runner:
        return checked(before or Student(folder), keep(read_files(folder), copies, number, TASKS), TASKS, runner)


def save(folder: Path, sign: str, more: str = "") -> None:
    """Write the function in place of its three dots. more: lines above it."""
    head, name, rest = (folder / "rope.py").read_text().partition("\ndef spring_force(")
    body = FORCE.format(sign).partition("\n\n\ndef spring_force(")[2].partition(":\n")[2]
    (folder / "rope.py").write_text(more + head + name + rest.replace("    ...\n", body, 1))


@pytest.mark.parametrize(
    ("code", "text", "poses"),
    [
        (FORCE.format("-"), "As the reference.", 5),
        (FORCE.format("- 0.9 *"), " m from the reference.", 5),
        (FORCE.format("+"), "Apart within ", None),
        (FORCE.format("- nothing *"), "Does not run.", 0),
        ("import numpy as np\n\n\ndef spring_force(x1):\n    ...\n", "", 0),
    ],
)
def test_a_rope_is_drawn_as_far_as_it_gets(code: str, text: str, poses: int | None, tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text(code)
    with Runner(tmp_path) as runner:
        picture = rope_picture(runner, keep(read_files(tmp_path), tmp_path, 1, TASKS))
    assert text in picture.text
    assert (picture.text == "") == (text == "")
    assert len(picture.own) == poses if poses is not None else 0 < len(picture.own) < 5
    assert np.isfinite(picture.own).all()
    assert svg(picture).count("<polyline") == len(picture.own) + bool(text)


def test_a_rope_falls_from_the_level_and_hangs_in_the_end(tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text(FORCE.format("-"))
    with Runner(tmp_path) as runner:
        picture = rope_picture(runner, keep(read_files(tmp_path), tmp_path, 1, TASKS))
    tips = picture.own[:, -1, 2]
    assert tips[0] > 1.7
    assert tips[-1] < 0.3
    assert np.all(np.diff(tips) < 0.0)


def test_a_saved_file_changes_its_tasks_and_the_one_the_student_is_at(folders: list[Path], tmp_path: Path) -> None:
    first = state_of(folders[0], tmp_path)
    assert (first.at, first.changed_at, first.rope.text) == ("", "", "")
    save(folders[0], "+")
    second = state_of(folders[0], tmp_path, first)
    assert second.at == "spring_force"
    assert second.changed_at
    assert second.programs["spring_force"].mistake == "sign of the damping reversed"
    change_answer(folders[0], TASKS, read_answers(folders[0]), "step_euler", "predict", "It explodes after a while.")
    third = state_of(folders[0], tmp_path, second)
    assert third.at == "step_euler"
    assert third.programs["spring_force"] is second.programs["spring_force"]  # not checked again
    assert state_of(folders[0], tmp_path, third).changed_at == third.changed_at


def test_mistakes_are_counted_by_students_and_a_file_that_does_not_run_once(
    folders: list[Path], tmp_path: Path
) -> None:
    save(folders[0], "+")
    save(folders[1], "+")
    (folders[2] / "rope.py").write_text("def spring_force(:\n")
    change_answer(folders[1], TASKS, read_answers(folders[1]), "spring_force", "stretch", 0.5625)
    found = mistakes([state_of(folder, tmp_path) for folder in folders])
    assert [(mistake.place, mistake.folders) for mistake in found] == [
        ("3.2-1 spring_force", ("ada", "bo")),
        ("3.2-1 Stretch", ("bo",)),
        ("rope.py", ("<b>",)),
    ]
    assert "stretch of the whole rope" in found[1].text


def test_the_page_has_folders_and_no_names_and_escapes_all(folders: list[Path], tmp_path: Path) -> None:
    save(folders[2], "+")
    (folders[2] / "answers.toml").write_text(f'name = "Ada Lovelace"\n\n[spring_force]\npredict = "{EVIL}"\n')
    text = page([state_of(folders[2], tmp_path)], 7, "word")
    assert "&lt;b&gt;" in text
    assert "Lovelace" not in text
    assert "<b><" not in text
    assert EVIL not in text
    assert "http" not in text.replace("http-equiv", "")
    assert 'data-revision="7"' in text


def test_a_class_is_followed_and_nothing_is_written(folders: list[Path], tmp_path: Path) -> None:
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
        copies = classroom.copies
    assert not copies.exists()


@pytest.fixture
def served(folders: list[Path]) -> Iterator[tuple[Classroom, int]]:
    with Classroom(folders, TASKS) as classroom:
        server = make_server(classroom, "secret", 0)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield classroom, server.server_address[1]
        server.shutdown()
        server.server_close()


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
    assert f"{options[0]}: the page of a class takes --port" in capsys.readouterr().err


def test_a_class_needs_folders(folders: list[Path], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lab", str(folders[0]), str(folders[0] / "rope.py")]) == 2
    assert "not a folder" in capsys.readouterr().err
