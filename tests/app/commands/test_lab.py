"""`springtide lab new` and `springtide lab check`: folders, tables, files, reports, exit status."""

import csv
import html.parser
import inspect
import json
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from app.__main__ import main
from app.lab.course.answers import Answers, read_answers
from app.lab.course.folder import folder_names
from app.lab.course.task import load_tasks
from tests.app.lab.solutions.answers_file import write_answers

ROOT = Path(__file__).parents[3]
TASKS = load_tasks()
EVIL = "<img src=x onerror='alert(1)'></pre><script>alert(2)</script>"
PIXEL = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000049454e44ae426082")


@pytest.fixture
def finished(tmp_path: Path) -> Path:
    folder = tmp_path / "anna"
    assert main(["lab", "new", str(folder), "--solutions"]) == 0
    return folder


@pytest.fixture
def empty(tmp_path: Path) -> Path:
    folder = tmp_path / "bo"
    assert main(["lab", "new", str(folder)]) == 0
    return folder


def error_of(capsys: pytest.CaptureFixture, *arguments: str) -> str:
    """The one line of a bad argument."""
    capsys.readouterr()
    assert main(["lab", *arguments]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def test_a_new_folder_has_every_task_and_no_solution(empty: Path) -> None:
    texts = {path.name: path.read_text("utf-8") for path in empty.iterdir() if path.is_file()}
    files = {"rope.py", "cloth.py", "radial_sea.py", "square_sea.py", "mooring.py"}
    assert set(texts) == files | {"answers.toml", "README.md"}
    for task in TASKS:
        assert f"### {task.item} {task.title}" in texts["README.md"]
        if task.file:
            assert f"def {task.name}({', '.join(task.arguments)}):" in texts[task.file]
            docstring = inspect.getdoc(task.function) or ""  # without its indentation in every Python
            assert textwrap.indent(docstring, "    ").strip() in texts[task.file]
    code = "".join(text for name, text in texts.items() if name.endswith(".py"))
    assert not re.search(r"^\s*(return|for|if)\b", code, re.MULTILINE)
    assert code.count("    ...\n") == sum(task.check is not None for task in TASKS)
    for name in files:
        compile(texts[name], name, "exec")


def test_a_new_folder_is_not_begun_and_a_finished_one_is_right(empty: Path, finished: Path, capsys) -> None:
    capsys.readouterr()
    assert main(["lab", "check", str(empty), "--json"]) == 1
    states = {entry["state"] for entry in json.loads(capsys.readouterr().out)[0]["tasks"]}
    assert states == {"not begun"}
    assert main(["lab", "check", str(finished)]) == 0
    shown = capsys.readouterr().out
    mandatory = sum(not task.optional for task in TASKS)
    assert f"{mandatory} of {mandatory} tasks right" in shown


def test_what_is_optional_need_not_be_done(finished: Path) -> None:
    (finished / "cloth.py").unlink()
    assert main(["lab", "check", str(finished)]) == 0
    (finished / "rope.py").unlink()
    assert main(["lab", "check", str(finished)]) == 1


def test_a_wrong_function_and_a_wrong_answer_are_told(finished: Path, capsys) -> None:
    path = finished / "rope.py"
    path.write_text(path.read_text("utf-8").replace("(length - rest_length) * r", "length * r", 1), "utf-8")
    answers = read_answers(finished)
    write_answers(finished, TASKS, answers._replace(values={**answers.values, ("top_fluid", "on_top"): "water"}))
    capsys.readouterr()
    assert main(["lab", "check", str(finished)]) == 1
    shown = " ".join(re.sub(r"[│┃]", " ", capsys.readouterr().out).split())
    for word in ("rest", "length", "forgotten", "densities"):
        assert word in shown


def test_a_folder_that_holds_something_is_left_alone(tmp_path: Path, capsys) -> None:
    (tmp_path / "mine.txt").write_text("mine", "utf-8")
    assert "a new or empty folder" in error_of(capsys, "new", str(tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    assert "a new or empty folder" in error_of(capsys, "new", str(tmp_path / "mine.txt"))
    assert "lab new" in error_of(capsys, "check", str(tmp_path / "none"))
    assert "--report" in error_of(capsys, "check", str(tmp_path), "--report", str(tmp_path / "no" / "r.html"))
    assert "--tasks" in error_of(capsys, "new", str(tmp_path / "x"), "--tasks", str(tmp_path / "no"))
    assert not (tmp_path / "x").exists()


def test_lab_alone_says_what_there_is(capsys) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["lab"])
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_a_class_makes_one_table_and_one_page(empty: Path, finished: Path, tmp_path: Path, capsys) -> None:
    answers = read_answers(empty)
    write_answers(empty, TASKS, answers._replace(name="=HYPERLINK(1)"))
    table, page = tmp_path / "class.csv", tmp_path / "class.html"
    assert main(["lab", "check", str(empty), str(finished), "--csv", str(table), "--report", str(page)]) == 1
    rows = list(csv.DictReader(table.open(encoding="utf-8-sig")))
    assert [row["folder"] for row in rows] == ["bo", "anna"]
    assert rows[0]["name"] == "'=HYPERLINK(1)"
    assert (rows[0]["complete"], rows[1]["complete"]) == ("no", "yes")
    assert {rows[1][task.name] for task in TASKS} == {"right"}
    optional = sum(task.optional for task in TASKS)
    assert (rows[0]["right"], rows[0]["optional_right"]) == ("0", "0")
    assert (rows[1]["right"], rows[1]["optional_right"]) == (str(len(TASKS) - optional), str(optional))
    text = page.read_text("utf-8")
    rows_of_answers = re.findall(r"<tr>(.*?)</tr>", "".join(re.findall(r'<table class="answers">.*?</table>', text)))
    widths = {sum(map(int, re.findall(r'<t[hd] colspan="(\d)"', row))) for row in rows_of_answers}
    assert widths == {2} | ({0} if "" in rows_of_answers else set())
    assert text.count("<!doctype html>") == 1
    assert 'href="#student-1"' in text
    assert 'id="student-1"' in text


class Tags(html.parser.HTMLParser):
    """Every tag, and whether all that opens is closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag not in ("meta", "img", "path", "line", "circle", "polyline"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in ("path", "line", "circle", "polyline"):
            assert self.open.pop() == tag


def test_folders_of_one_name_are_told_apart(tmp_path: Path, capsys) -> None:
    folders = [tmp_path / name / "lab" for name in ("a", "b")]
    for folder in folders:
        assert main(["lab", "new", str(folder)]) == 0
    capsys.readouterr()
    table, page = tmp_path / "c.csv", tmp_path / "r.html"
    main(["lab", "check", *map(str, folders), "--csv", str(table), "--report", str(page)])
    shown = capsys.readouterr().out
    assert [row[0] for row in csv.reader(table.read_text("utf-8-sig").splitlines())][1:] == ["a/lab", "b/lab"]
    assert "a/lab" in shown
    assert "b/lab" in shown
    assert "folder b/lab" in page.read_text("utf-8")
    assert ">b/lab</a>" in page.read_text("utf-8")


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["a/lab", "b/lab"], ["a/lab", "b/lab"]),
        (["x/ada", "x/bo"], ["ada", "bo"]),
        (["x/a/lab", "y/a/lab", "y/b/lab"], ["x/a/lab", "y/a/lab", "b/lab"]),
        (["lab", "x/lab"], ["here/lab", "x/lab"]),
        ([".", "lab"], ["here", "lab"]),
        (["a/lab", "a/../a/lab", "b"], ["lab", "lab", "b"]),
    ],
)
def test_a_folder_has_the_shortest_name_that_no_other_has(
    paths: list[str], names: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    folders = [Path(path) for path in paths]
    found = folder_names(folders)
    assert [found[folder] for folder in folders] == names


def test_a_file_that_does_not_run_is_one_line(empty: Path, capsys) -> None:
    text = (empty / "rope.py").read_text("utf-8")
    for name in ("spring_force", "step_euler"):
        head, _, rest = text.partition(f"def {name}(")
        text = (
            head
            + f"def {name}("
            + rest.replace("    ...\n", "    return (1\n" if name == "spring_force" else "    return 1\n", 1)
        )
    (empty / "rope.py").write_text(text, "utf-8")
    capsys.readouterr()
    assert main(["lab", "check", str(empty)]) == 1
    shown = " ".join(capsys.readouterr().out.split())
    line = text[: text.index("(1")].count("\n") + 1
    assert shown.count("SyntaxError") == shown.count(f"rope.py does not run: line {line}: SyntaxError") == 1
    assert shown.count(" failed ") == 2


def test_the_report_is_one_page_that_runs_and_fetches_nothing(finished: Path, tmp_path: Path) -> None:
    """Whatever a student writes into name, answers, code, file names and pictures."""
    answers = read_answers(finished)
    values = {key: EVIL if isinstance(value, str) else value for key, value in answers.values.items()}
    write_answers(finished, TASKS, answers._replace(name=EVIL, values=values))
    with (finished / "rope.py").open("a") as file:
        file.write(f"# {EVIL}\ndef spring_force(*a):\n    raise ValueError({EVIL!r})\n")
    name = "a <b> 'c'.png" if os.name == "posix" else "a 'c'.png"  # Windows has no angle brackets in names
    (finished / "pictures" / name).write_bytes(PIXEL)
    (finished / "pictures" / "page.png").write_text(EVIL, "utf-8")
    (finished / "pictures" / "drawing.svg").write_text("<svg onload='alert(1)'/>", "utf-8")
    report = tmp_path / "report.html"
    assert main(["lab", "check", str(finished), "--report", str(report)]) == 1
    text = report.read_text("utf-8")
    tags = Tags()
    tags.feed(text)
    assert tags.open == []
    assert not {"script", "iframe", "object", "embed", "link", "form"} & {tag for tag, _ in tags.found}
    for tag, attributes in tags.found:
        assert not any(name.startswith("on") for name in attributes), (tag, attributes)
        for name in ("src", "href"):
            assert (attributes.get(name) or "#").startswith(("data:image/", "#")), (tag, attributes)
    images = [attributes for tag, attributes in tags.found if tag == "img"]
    assert len(images) == 1
    assert html.escape(Path(name).stem) in text
    assert "onerror=&#39;alert(1)" in text
    assert "<img src=x" not in text


def test_the_report_holds_predictions_answers_and_checks(finished: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    assert main(["lab", "check", str(finished), "--report", str(report)]) == 0
    text = report.read_text("utf-8")
    for task in TASKS:
        assert f"{task.item} " in text
        for question in task.questions:
            assert question.ask[:20].replace("'", "&#39;") in text
    assert "def spring_force" in text
    assert "Reference solutions" in text


def test_the_report_shows_laws_what_was_done_and_pictures_beside_their_task(finished: Path, tmp_path: Path) -> None:
    read = read_answers(finished)
    more = {
        ("spring_force", "done"): "2",
        ("spring_force", "answer_shown"): "yes",
        ("spring_force", "predict"): "It swings for ever.",
    }
    write_answers(finished, TASKS, read._replace(values={**read.values, **more}))
    for name in ("spring_force rope 1.00 s", "my cat"):
        (finished / "pictures" / f"{name}.png").write_bytes(PIXEL)
    report = tmp_path / "report.html"
    assert main(["lab", "check", str(finished), "--report", str(report)]) == 0
    text = report.read_text("utf-8")
    begin = text.index('<h3 id="student-0-spring_force">')
    section = text[begin : text.index("<h3 id=", begin + 1)]
    assert section.count("<math") == 2
    first, second = section.split("<li>")[1:3]
    assert "not seen:" in first
    assert "✓ seen:" in second
    assert "viewed in the panel" in section
    assert text.count("viewed in the panel") == 1
    row = section[section.index("<th") :]
    assert row.index("Predicted") < row.index("Measured") < row.index("It swings for ever.") < row.index("0.1125 m")
    assert "Matches the reference at all inputs of the check. Behaviour: No force at rest" in section
    assert "spring_force rope 1.00 s.png" in section
    assert "my cat.png" not in section
    assert text.index("More pictures") < text.index("my cat.png")


def test_odd_folders_end_with_results_and_no_traceback(finished: Path, empty: Path, tmp_path: Path, capsys) -> None:
    (finished / "answers.toml").write_bytes(b"\xff\xfe broken")
    (finished / "rope.py").write_bytes(b"\xff\xfe\x00 = 1")
    (finished / "cloth.py").write_text("def cloth_links(:", "utf-8")
    (finished / "radial_sea.py").write_text("import os\nos._exit(7)\n", "utf-8")
    (finished / "square_sea.py").unlink()
    (finished / "mooring.py").unlink()
    capsys.readouterr()
    report = tmp_path / "report.html"
    assert main(["lab", "check", str(finished), "--json", "--report", str(report)]) == 1
    result = json.loads(capsys.readouterr().out)[0]
    assert "answers.toml" in result["error"]
    states = {entry["task"]: entry["program"] for entry in result["tasks"] if entry["program"]}
    others = {task.name for task in TASKS if task.file == "cloth.py"} - {"cloth_links"}  # not in the file
    assert {name for name, program in states.items() if program["state"] == "not begun"} == others
    assert {states[name]["state"] for name in states.keys() - others} == {"failed"}
    assert "exit status 7" in states["draft"]["text"]
    assert "SyntaxError" in states["cloth_links"]["text"]
    assert "no such file" in states["gravity"]["text"]


def test_names_of_students_do_not_steer_the_terminal(finished: Path, capsys) -> None:
    answers = read_answers(finished)
    write_answers(finished, TASKS, answers._replace(name="[red]x[/red]\x1b[31m"))
    other = finished.parent / "copy"
    finished.rename(other)
    capsys.readouterr()
    main(["lab", "check", str(other), str(other)])
    shown = capsys.readouterr().out
    assert "\x1b" not in shown


def test_a_check_imports_no_viewer(finished: Path) -> None:
    code = (
        "import sys; from app.__main__ import main;"
        f"status = main(['lab', 'check', {str(finished)!r}]);"
        "print(status, sorted(n for n in sys.modules if n.split('.')[0] in ('viser', 'numba')))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, encoding="locale", check=True)
    assert done.stdout.splitlines()[-1] == "0 []"


def test_a_folder_to_work_on_needs_no_command_before_it(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    served = []
    monkeypatch.setattr("app.commands.serve.serve_lab", lambda *a, **k: served.append((a, k)) or 0)
    folder = tmp_path / "mine"
    assert main(["lab", "new", str(folder)]) == 0
    assert main(["lab", "--no-open", str(folder), "--port", "0"]) == 0
    options = served[0][1]
    assert options["session"].folder == options["workbook"].folder == folder
    assert not options["session"].versions.copies.exists()  # it was closed
    assert "nothing: no such folder" in error_of(capsys, str(tmp_path / "nothing"))


@pytest.mark.parametrize(
    ("options", "scene"),
    [
        ([], "radial_sea"),  # of the first task
        (["--scene", "cloth"], "cloth"),
        (["--set", "points=20"], "rope"),
        (["--preset", "Pendulum"], "rope"),
    ],
)
def test_a_student_s_lab_opens_where_the_work_is(
    empty: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], scene: str
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("app.commands.serve.serve_lab", lambda name, params, **how: opened.append(name) or 0)
    assert main(["lab", str(empty), "--no-open", *options]) == 0
    assert opened == [scene]


def test_a_lab_that_was_begun_opens_with_the_task_after_it(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun = next(task for task in TASKS if task.setup is not None and task.setup.scene == "rope" and task.questions)
    write_answers(empty, TASKS, Answers("Bo", {(begun.name, begun.questions[0].key): "0"}))
    opened: list[tuple[str, object]] = []
    serve = lambda name, params, **how: opened.append((name, params())) or 0  # noqa: E731
    monkeypatch.setattr("app.commands.serve.serve_lab", serve)
    assert main(["lab", str(empty), "--no-open"]) == 0
    assert opened[0][0] == "rope"
    assert vars(opened[0][1])["integrator"] == "rk4"


def test_the_help_of_the_lab_shows_the_options_of_a_folder(capsys: pytest.CaptureFixture) -> None:
    with pytest.raises(SystemExit):
        main(["lab", "--help"])
    said = capsys.readouterr().out
    assert all(option in said for option in ("--port", "--no-open", "--scene", "new", "check"))
