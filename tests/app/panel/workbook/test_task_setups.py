"""Links that open a task of the lab."""

import itertools
from pathlib import Path
from types import SimpleNamespace

import pytest

from app.lab.course.task import Task, load_tasks
from app.lab.student.workbook import Workbook
from app.panel.sharing.share import Share
from app.panel.workbook.task_setups import read_link, setup_of_task
from app.server.viewer import Viewer
from tests.app.channels import say
from tests.waiting import wait_for

NUMBERS = itertools.count()  # of texts from a page
TASKS = load_tasks(with_checks=False)
BOOK = Workbook(TASKS, Path("none"))


@pytest.mark.parametrize("task", BOOK.tasks, ids=lambda task: task.name)
def test_a_link_opens_each_task_in_its_own_set_up(task: Task) -> None:
    own = BOOK.set_up_of(task)
    found = setup_of_task(own)
    for query in (f"?task={task.name}", f"?scene={own.scene}&task={task.name}"):
        setup = read_link(query, BOOK)
        assert setup == found._replace(task=task.name)
    first = next(other for other in BOOK.tasks if other.item == task.item)
    assert BOOK.named(task.item) is first


def test_parameters_of_a_link_go_before_those_of_its_task() -> None:
    setup = read_link("?scene=rope&task=3.2-1&stiffness=500", BOOK)
    assert (vars(setup.params)["stiffness"], setup.task) == (500.0, "3.2-1")
    assert read_link("?scene=rope&stiffness=500", BOOK) == setup._replace(task="")


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("?scene=rope&task=3.2-9", "task: '3.2-9' is not allowed; allowed: one of 1.1-1, "),
        ("?task=step_eule", "task: 'step_eule' is not allowed"),
        ("?task=3.2-1&task=3.2-2", "'task': given more than once"),
        ("?scene=cloth&task=3.2-1", "scene: 'cloth' is not allowed; allowed: rope, that of task 3.2-1"),
        ("?scene=rope&task=3.2-1&stifness=5", "stifness: no such parameter"),
    ],
)
def test_a_link_to_no_task_is_refused_in_one_line(query: str, words: str) -> None:
    with pytest.raises(ValueError, match=r"\w") as caught:
        read_link(query, BOOK)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_lab_without_tasks_opens_none() -> None:
    with pytest.raises(ValueError, match=r"task: '3\.2-1' is not allowed; allowed: none in this lab"):
        read_link("?task=3.2-1", None)


def test_a_page_with_a_link_is_turned_to_its_task() -> None:
    """In the open scene, in the same set-up, and in another scene."""
    lab = Viewer("127.0.0.1", 0, workbook=Workbook(TASKS))
    try:
        lab.open("rope")
        for query, name in (
            ("?scene=rope&task=3.2-3", "step_rk4"),
            ("?scene=rope&task=3.2-2", "step_euler"),
            ("?scene=rope&preset=Pendulum&task=3.2-1", "spring_force"),
            ("?scene=rope&preset=Pendulum&task=3.2-3", "step_rk4"),
            ("?task=3.3-3", "cloth_links"),
        ):
            follow(lab.panel.share, query)
            wait_for(lambda name=name: shown_task(lab) == name)
        assert lab.panel.kind.name == "cloth"
    finally:
        lab.shut()


def shown_task(lab: Viewer) -> str:
    """Name of the task in the panel, once its scene is open."""
    guide = lab.panel.guide if lab.is_open else None
    if guide is None or guide.shown_task is None or not guide.is_set_up_here(guide.shown_task):
        return ""
    return guide.shown_task.name


def follow(share: Share, query: str) -> None:
    """Do what a page does that has this query in its address."""
    client = SimpleNamespace(client_id=1, add_notification=lambda title, body, **how: pytest.fail(body))
    say(share.channel, "open", query, client=client)
