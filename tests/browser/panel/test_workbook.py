"""A student does one task of the workbook in a real browser: predict, set up, measure, explain, return."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.lab.course.answers import read_answers
from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.student.workbook import Workbook
from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

TASKS = load_tasks()
TASK = next(task for task in TASKS if task.name == "spring_force")


@pytest.fixture
def student(one_page: tuple[Viewer, Tab], tmp_path: Path) -> Iterator[tuple[Viewer, Tab, Path]]:
    """The page that all modules share, with the workbook of a new folder."""
    lab, tab = one_page
    folder = tmp_path / "mylab"
    make_folder(folder, TASKS)
    tab.errors.clear()
    lab.workbook = Workbook(TASKS, folder)
    tab.follow(lab, "rope")
    yield lab, tab, folder
    lab.workbook = None
    lab.loop.commands.put(Pause())


def test_a_task_is_done_and_survives_a_reload(student: tuple[Viewer, Tab, Path]) -> None:
    lab, tab, folder = student
    page = tab.page
    tab.wait(lambda: page.locator(".springtide-guide").count())

    def kept(key: str) -> object:
        return read_answers(folder).values.get((TASK.name, key), "")

    page.get_by_label("Task", exact=True).click()
    page.get_by_role("option", name="3.2-1 The force of a damped spring").click()
    text = page.get_by_role("textbox", name="Predict: What will the rope do")
    tab.wait(text.count)
    page.get_by_role("button", name="Show the answer").click()
    tab.wait(lambda: "prediction first" in page.locator(".springtide-refusal").inner_text())

    text.click()
    page.keyboard.type("It swings for ever, r n space and all.")  # none of its keys may play, step or reset the lab
    tab.wait(lambda: kept("predict") == "It swings for ever, r n space and all.")
    assert lab.loop.latest.status.run.number == 1
    assert lab.loop.run.running

    page.get_by_role("button", name="Set this up").click()
    tab.wait(lambda: lab.panel.head.preset.value == "Lab code: 10 points")
    lab.settings.set("stiffness", 8000.0)
    lab.settings.set("time_step", 1 / 500)

    number = page.get_by_role("textbox", name="A rope of 9 springs")
    number.fill("much")
    number.press("Enter")
    tab.wait(lambda: "was not saved" in page.locator(".springtide-refusal").inner_text())
    number.fill("5625e-4")
    number.press("Enter")
    tab.wait(lambda: "stretch of the whole rope" in page.locator(".springtide-verdict").last.inner_text())
    page.get_by_role("button", name="Read off").click()
    tab.wait(lambda: isinstance(kept("stretch"), float) and kept("stretch") != 0.5625)
    # The page shows it before the next is typed. A rope that has not begun to swing gives 0, which is kept as 0.0.
    tab.wait(lambda: number.input_value() not in ("", "5625e-4") and float(number.input_value()) == kept("stretch"))
    number.fill("0,1125")
    number.press("Enter")
    tab.wait(lambda: kept("stretch") == 0.1125)
    page.get_by_role("button", name="Show the answer").click()
    tab.wait(lambda: page.locator(".springtide-answer math").count())

    address = page.url
    page.goto(f"{address}&scene=rope&stiffness=900&task=3.2-1")
    tab.wait(lambda: page.locator(".springtide-guide").count())
    tab.wait(lambda: vars(lab.settings.params)["stiffness"] == 900.0)
    tab.wait(lambda: page.get_by_role("textbox", name="A rope of 9 springs").input_value() == "0.1125")
    assert (
        page.get_by_role("textbox", name="Predict: What will the rope do").input_value()
        == "It swings for ever, r n space and all."
    )
    assert page.get_by_role("textbox", name="Predict: What will the rope do").is_disabled()
    assert page.locator(".springtide-answer math").count() == 2
    assert "The top spring carries all nine points" in page.locator(".springtide-verdict").last.inner_text()
    assert tab.errors == []
    page.evaluate("address => history.replaceState(null, '', address)", address)


@pytest.mark.long
def test_a_link_to_a_task_shows_its_tab_until_another_is_chosen(one_page: tuple[Viewer, Tab]) -> None:
    """In a lab without a folder, whose first tab is another, also where the link opens another scene."""
    lab, tab = one_page
    lab.workbook = Workbook(TASKS)
    tab.follow(lab, "rope")
    address = tab.page.url
    chosen = tab.page.locator('[role="tab"][aria-selected="true"]')
    try:
        tab.page.goto(f"{address}&task=3.3-3")
        tab.wait(lambda: lab.panel.kind.name == "cloth" and chosen.all_inner_texts() == ["Lab"])
        tab.show("View")
        tab.page.wait_for_timeout(500)  # for new frames to reach the page
        assert chosen.all_inner_texts() == ["View"]
    finally:
        tab.page.evaluate("address => history.replaceState(null, '', address)", address)
        lab.workbook = None
        lab.loop.commands.put(Pause())
