"""The page on the course lab: it lists the sections of the tasks, and the teacher's example works."""

import re
import shlex
from pathlib import Path

import pytest

from app.__main__ import main
from app.lab import checking
from app.lab.course.live_values import LiveNumber, fill_in
from app.lab.course.task import QUESTION_KINDS, load_tasks
from app.render.markup.formula import formula
from app.scenes.rope.parameters import RopeParams
from sim.parameters import parameters_of
from tests.docs.pages import ROOT, text_of

PAGE = text_of(ROOT / "docs" / "lab.md")
EXAMPLES = ROOT / "docs" / "examples"
FILES = {path: text_of(EXAMPLES / path) for path in re.findall(r"\]\(examples/(my_tasks/[^)]+)\)", PAGE)}
COMMANDS = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def test_the_page_lists_every_section_of_the_lab() -> None:
    sections = re.findall(r"^- \*\*(\d\.\d) ", PAGE, re.MULTILINE)
    assert sections == list(dict.fromkeys(task.item.partition("-")[0] for task in load_tasks()))


@pytest.fixture
def teacher(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_teacher_s_example_works(teacher: Path) -> None:
    assert set(FILES) == {"my_tasks/pendulum_period.toml", "my_tasks/pendulum_period.py"}
    new, check = (shlex.split(line)[1:] for line in COMMANDS[-1].splitlines())
    assert main(new) == 0
    stub = (teacher / "course" / "pendulum.py").read_text("utf-8")
    assert "def pendulum_period(length, gravity):" in stub
    task = next(task for task in load_tasks(teacher / "my_tasks") if task.name == "pendulum_period")
    assert task.guide is not None
    assert "<mfrac>" in formula(task.guide.law[0])
    scene = {name: LiveNumber(1.0, p.unit, name) for name, p in parameters_of(RopeParams()).items()}
    assert "On a thread of 1 m, under 1 m/s²" in fill_in(task.guide.answer, scene).replace("\xa0", " ")
    assert "np.sqrt" not in stub
    assert main(check) == 1
    assert main(["lab", "new", "solved", "--solutions", "--tasks", "my_tasks"]) == 0
    assert main(["lab", "check", "solved", "--tasks", "my_tasks", "--report", "report.html"]) == 0
    assert "The period of a pendulum" in (teacher / "report.html").read_text("utf-8")
    assert "period [s]" in (teacher / "report.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("2 * np.pi * np.sqrt(gravity / length)", "ratio upside down"),
        ("2 * np.pi * length / gravity", "root forgotten"),
        ("np.sqrt(length / gravity)", "constant factor"),
        pytest.param("2 * np.pi * np.sqrt(length / 9.81)", "gravity not used", marks=pytest.mark.long),
    ],
)  # fmt: skip
def test_the_mistakes_of_the_example_are_named(teacher: Path, capsys, body: str, said: str) -> None:
    main(["lab", "new", "solved", "--solutions", "--tasks", "my_tasks"])
    (teacher / "solved" / "pendulum.py").write_text(
        f"import numpy as np\ndef pendulum_period(length, gravity):\n    return {body}\n",
        "utf-8",
    )
    capsys.readouterr()
    assert main(["lab", "check", "solved", "--tasks", "my_tasks", "--json"]) == 1
    assert f'"mistake": "{said}"' in capsys.readouterr().out


def test_the_page_lists_every_entry_of_a_task() -> None:
    for word in ("item", "title", "file", "optional", "order", "statement", "setup", "question", "typical_error"):
        assert re.search(rf"`[\[]*(question\.)?{word}[\]]*`", PAGE), word
    for kind in QUESTION_KINDS:
        assert f'`"{kind}"`' in PAGE


def test_the_docstring_of_the_check_lists_every_name_that_a_task_may_have() -> None:
    sources = [path.read_text("utf-8") for path in (ROOT / "app" / "lab" / "course" / "tasks").rglob("*.py")]
    names = {"inputs", *re.findall(r"^([A-Z]{5,}) = ", "".join(sources), re.MULTILINE)}
    assert {"MISTAKES", "CURVE", "METHOD", "TERMS"} <= names
    assert "`python -m pydoc app.lab.checking`" in PAGE
    for name in names:
        assert f"`{name}" in (checking.__doc__ or ""), name
