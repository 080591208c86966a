"""One screen of 1280 x 800 pixels: texts and controls are visible together, for each scene and each task."""

import functools
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.lab.course.folder import make_folder
from app.lab.course.task import Task, load_tasks
from app.lab.student.workbook import Workbook
from app.messages import Pause
from app.panel.workbook.guide import SET_UP, label_of
from app.render.markup.html import Html
from app.scenes import NAMES
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SCENE = "rope"
SAMPLE = ("rope",)  # the other scenes are tested under -m long
TASKS = load_tasks()
MIN_SLIDERS = 5
MAX_HEAD = 150  # [pixels] of the permanent block
MAX_WORDS = 92  # with the line of help
MAX_STOPS = 9  # of Tab before the first control; one of them is the folder of scenes in pictures
# The names of the sliders that are whole in the window, the height of the block above the tabs [pixels], and the words.
FIRST_VIEW = """() => {
    const panel = document.querySelector(".mantine-ScrollArea-viewport:has(.springtide-panel)");
    const foot = panel.getBoundingClientRect().bottom;
    const seen = (element) => element.checkVisibility({ visibilityProperty: true }) && !element.closest("[inert]") &&
        element.getBoundingClientRect().height > 0 && element.getBoundingClientRect().bottom <= foot + 1;
    let said = "";
    const walker = document.createTreeWalker(panel, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const element = walker.currentNode.parentElement;
        if (["STYLE", "SCRIPT", "OPTION"].includes(element.tagName) || !seen(element)) continue;
        if (element.closest("div[class*=Flex-root] > div")?.offsetHeight === 1) continue; // it is only listened to
        said += (walker.currentNode.previousSibling?.tagName === "WBR" ? "" : " ") + walker.currentNode.textContent;
    }
    const fields = [...panel.querySelectorAll("input[type=text], input:not([type])")].filter(seen);
    said = [said, ...fields.map((field) => field.value)].join(" ");
    const sliders = [...panel.querySelectorAll(".multi-slider-thumb")].filter(seen);
    const words = said.split(/\\s+/).filter((word) => /[\\p{L}\\p{N}]/u.test(word));
    return { sliders: sliders.length, words, head: document.querySelector(".springtide-lab").offsetHeight }; }"""
# Whether the focus is on a control in the tab that is shown; and names of the stops of Tab before such a control.
IN_TAB = """:is([data-dock-area^="gui-tabs-"] :is(input, textarea, [role=slider]))"""
HAS_FOCUS = f"document.activeElement.matches(`{IN_TAB}`)"
STOPS = f"""() => {{
    const all = [...document.querySelectorAll("a[href], button, input, select, textarea, [tabindex]")];
    const shown = all.filter((one) => one.checkVisibility({{ visibilityProperty: true }}) && !one.closest("[inert]"));
    const stops = shown.filter((one) => one.tabIndex >= 0 && !one.disabled);
    const before = stops.slice(0, stops.findIndex((one) => one.matches(`{IN_TAB}`)));
    const label = (one) => one.labels?.[0]?.textContent || one.textContent.slice(0, 40);
    return before.map((one) => one.getAttribute("aria-label") || one.title || label(one)); }}"""
# The rows of the task from its list to its last question: names of their fields and buttons, and by how much [pixels]
# the last row is cut off; null while the panel is scrolled.
ROWS = """() => {
    const panel = document.querySelector(".mantine-ScrollArea-viewport:has(.springtide-panel)");
    const readings = document.querySelector(".springtide-readings");
    if (!readings || panel.scrollTop) return null;
    const foot = panel.getBoundingClientRect().bottom, names = [];
    let over = -Infinity;
    for (const row of readings.parentElement.parentElement.children) {
        const labels = [...row.querySelectorAll(":scope > .mantine-Flex-root label")].map((label) => label.textContent);
        const buttons = [...row.querySelectorAll(":scope > .mantine-Flex-root button")].map((one) => one.textContent);
        if (labels.includes("Your name")) break; // the next row after the questions
        names.push(...labels, ...buttons);
        over = Math.max(over, row.getBoundingClientRect().bottom - foot);
    }
    return { names, over }; }"""

# In a large window [pixels]: the panel, its text, and what the charts leave of the height of their pane.
LARGE = """() => {
    const panel = document.querySelector("[data-floating-window]")?.getBoundingClientRect();
    const pane = document.querySelector(".mantine-ScrollArea-viewport:has(.uplot)");
    if (!panel || !pane) return { left_over: -1 };
    const text = Number.parseFloat(getComputedStyle(document.querySelector(".springtide-panel")).fontSize);
    return { width: panel.width, right: panel.right, text,
        left_over: pane.clientHeight - pane.firstElementChild.offsetHeight }; }"""


def pause(lab: Viewer, tab: Tab) -> None:
    """Pause the scene, and wait until the page shows it.

    A line of the head names the compilation, and another one says that a busy machine is slower than set.
    """
    tab.wait(lambda: not any(lab.compiling.progress()), 200)
    lab.loop.commands.put(Pause())
    tab.wait(lambda: tab.page.locator('.springtide-panel[data-state="paused"]').count(), 20)


@pytest.fixture(params=[pytest.param(name, marks=() if name in SAMPLE else pytest.mark.long) for name in NAMES])
def opened(
    request: pytest.FixtureRequest, one_page: tuple[Viewer, Tab], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Viewer, Tab]]:
    """Each scene with a student's workbook, in a window of this size."""
    lab, tab = one_page
    size = tab.page.viewport_size
    tab.page.set_viewport_size({"width": 1280, "height": 800})
    folder: Path = tmp_path_factory.mktemp("one_screen") / "mylab"
    make_folder(folder, TASKS)
    lab.workbook = Workbook(TASKS, folder)
    lab.first_params.pop(request.param, None)
    lab.changes.latest = None  # a line of the head says for 5 s that another browser has opened a scene
    tab.follow(lab, request.param)
    tab.wait(lambda: tab.page.locator(".springtide-guide").count())
    pause(lab, tab)
    yield lab, tab
    lab.workbook = None
    lab.loop.commands.put(Pause())
    tab.page.set_viewport_size(size)


def test_the_first_view_of_a_scene_has_what_one_changes(opened: tuple[Viewer, Tab]) -> None:
    _, tab = opened
    tab.show("Controls")
    tab.wait(lambda: tab.page.evaluate(FIRST_VIEW)["sliders"] >= MIN_SLIDERS, 20)
    found = tab.page.evaluate(FIRST_VIEW)
    assert found["head"] <= MAX_HEAD, (found, tab.page.locator(".springtide-lab").first.inner_text())
    assert len(found["words"]) <= MAX_WORDS, " ".join(found["words"])
    tab.page.keyboard.press("c")
    assert tab.page.evaluate(HAS_FOCUS)
    tab.page.evaluate("document.activeElement.blur()")
    assert 1 < len(stops := tab.page.evaluate(STOPS)) <= MAX_STOPS, stops


def names_of(lab: Viewer, task: Task) -> set[str]:
    """Names of the widgets of a task: buttons, controls, and fields of its questions."""
    guide = lab.panel.guide
    assert guide is not None
    hidden = lab.panel.kind.hidden(lab.settings.params)
    controls = {lab.panel.controls[name].field.label for name in guide.controls_of(task) if name not in hidden}
    return {SET_UP, *controls, *map(label_of, task.questions)}


def answer_at_length(book: Workbook, task: Task) -> int:
    """Give the answers with the longest explanations; returns the number of explanations."""
    for question in task.questions:
        any_answer = {"choice": (*question.choices, "")[0], "number": 1, "text": "It was so."}[question.kind]
        right = str(any_answer if question.right is None else question.right)
        said = {right: question.why, **{str(error.answer): error.text for error in question.typical_errors}}
        answer = max(said, key=lambda one: len(said[one]))
        book.answer(task, question, f"{answer} {question.unit}" if question.kind == "number" else answer)
    return sum(question.right is not None or question.kind == "text" for question in task.questions)


def over_of(lab: Viewer, tab: Tab, task: Task, verdicts: int) -> tuple[float, ...]:
    """Height [pixels] by which a task is cut off; empty while the page does not show it, or this many verdicts."""
    assert lab.panel.guide is not None
    if tab.page.locator(".springtide-verdict").count() != verdicts:
        return ()
    rows = tab.page.evaluate(ROWS) if lab.panel.guide.shown_task is task else None
    return (rows["over"],) if rows and names_of(lab, task) <= set(rows["names"]) else ()


def test_each_task_of_a_scene_fits_the_screen_with_its_controls_and_explanations(opened: tuple[Viewer, Tab]) -> None:
    lab, tab = opened
    guide = lab.panel.guide
    assert guide is not None
    tab.show("Lab")
    book, cut = guide.workbook, {}
    tasks = [task for task in TASKS if book.set_up_of(task).scene == lab.panel.kind.name]
    if not tasks:
        return  # a scene for itself
    lab.panel.head.show_code(Html("Your code: this scene uses none of your functions yet"))
    tab.wait(lambda: tab.page.get_by_text("Your code:").count())
    assert tab.page.evaluate(FIRST_VIEW)["head"] <= MAX_HEAD
    for task in tasks:
        lab.settings.set_up(book.set_up_of(task))
        book.go(book.tasks.index(task))
        verdicts = answer_at_length(book, task)
        pause(lab, tab)
        end = time.monotonic() + 5.0  # the head may show for a moment longer what was compiled
        shown = functools.partial(over_of, lab, tab, task, verdicts)
        while (over := tab.wait(shown, 20)[0]) > 0 and time.monotonic() < end:
            tab.page.wait_for_timeout(100)
        if over > 0:
            cut[task.name] = over
    assert cut == {}


def test_a_large_window_has_a_wide_panel_with_larger_text_and_charts_that_fill_their_pane(
    one_page: tuple[Viewer, Tab],
) -> None:
    lab, tab = one_page
    size = tab.page.viewport_size
    tab.page.set_viewport_size({"width": 1920, "height": 1080})
    tab.follow(lab, "rope")
    if not lab.panel.plots.open:
        lab.settings.toggle_plots()
    try:
        tab.wait(lambda: 0 <= tab.page.evaluate(LARGE)["left_over"] < 40, 20)
        found = tab.page.evaluate(LARGE)
        assert found["width"] == 420
        assert found["right"] <= 1920
        assert found["text"] >= 14
    finally:
        lab.loop.commands.put(Pause())
        tab.page.set_viewport_size(size)


def test_display_opens_the_settings_of_the_viewer_without_a_dark_mode_of_their_own(shown: tuple[Viewer, Tab]) -> None:
    _, tab = shown
    size = tab.page.viewport_size
    tab.page.set_viewport_size({"width": 1280, "height": 800})
    assert not tab.page.locator("button:has(.tabler-icon-adjustments)").is_visible()
    tab.show("View")
    tab.page.get_by_role("button", name="Display …").click()
    tab.page.get_by_text("Dev Settings").click()
    tab.wait(tab.page.get_by_text("WebGL Stats").is_visible, 20)
    tab.wait(lambda: not tab.page.get_by_text("Dark Mode").is_visible(), 20)
    tab.page.get_by_role("button", name="Back to the panel").click()
    tab.wait(tab.page.get_by_role("tab", name="View").is_visible, 20)
    tab.page.set_viewport_size(size)
