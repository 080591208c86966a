"""The panel for everyone: texts of enough contrast, light and dark; controls that Tab reaches, and that have a name.

With large text a mouse reaches the last control, too.
"""

from collections.abc import Iterator
from typing import Any

import pytest

from app.lab.course.task import load_tasks
from app.lab.student.workbook import Workbook
from app.messages import Pause
from app.scenes import NAMES
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

MIN_CONTRAST = 4.5  # WCAG 2.2, 1.4.3, level AA
CONTRAST = """() => {
  const numbers = (css) => [...css.match(/[\\d.]+/g).map(Number), 1].slice(0, 4);
  const over = (top, under) => [0, 1, 2].map((i) => top[i] * top[3] + under[i] * (1 - top[3]));
  const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  function background(element) {
    const layers = [];
    for (let node = element; node; node = node.parentElement) {
      const colour = numbers(getComputedStyle(node).backgroundColor);
      if (colour[3] > 0) layers.push(colour);
      if (colour[3] === 1) return layers.reverse().reduce((under, top) => over(top, under), [255, 255, 255]);
    }
    return null; // it stands before the picture
  }
  function contrast(element) {
    const under = background(element);
    if (under === null) return Infinity;
    const colour = numbers(getComputedStyle(element).color);
    for (let node = element; node; node = node.parentElement) colour[3] *= Number(getComputedStyle(node).opacity);
    const [dark, light] = [luminance(over(colour, under)), luminance(under)].sort((a, b) => a - b);
    return (light + 0.05) / (dark + 0.05);
  }
  const texts = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement, text = walker.currentNode.textContent.trim();
    if (text && !element.closest("script, style, svg, #springtide-cover, [inert]")) texts.push([element, text]);
  }
  for (const field of document.querySelectorAll("input[type=text]")) texts.push([field, field.value]);
  const shown = (element) => !element.closest("[inert]") && element.checkVisibility({ visibilityProperty: true });
  return texts.filter(([element]) => shown(element) && element.offsetHeight > 0)
    .map(([element, text]) => [text.slice(0, 60), contrast(element)]);
}"""
# What a mouse can press or move in the panel, and whether the keyboard reaches it under which name.
CONTROLS = """() => [...document.querySelectorAll(
    "button, input:not([type=file]), [role=button], [role=slider], .multi-slider-thumb, " +
    ".mantine-Paper-root > .mantine-Paper-root:first-child")]
  .filter((element) => !element.closest("[inert], [data-springtide-icon]") && element.checkVisibility())
  .filter((element) => element.getBoundingClientRect().width > 0)
  .map((element) => [
    element.getAttribute("aria-label") || [...(element.labels ?? [])].map((label) => label.textContent).join(" ") ||
      element.textContent.trim(),
    element.tabIndex, element.tagName + "." + element.className])"""
# The last control of the panel, where it is [pixels], and whether the mouse would press it there.
LAST_CONTROL = """() => {
  const content = document.querySelector(".mantine-ScrollArea-content:has(.springtide-panel)");
  const last = [...content.querySelectorAll("button, select, input, [role=button]")]
    .filter((element) => !element.closest('[inert], .mantine-Tabs-root:has(> [aria-label$=" panel Plots"])'))
    .filter((element) => element.checkVisibility() && element.offsetHeight > 0).at(-1);
  const { left, right, top, bottom } = last.getBoundingClientRect();
  const seen = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
  return { top, bottom, inside: top >= 0 && bottom <= innerHeight, pressed: Boolean(seen) && last.contains(seen) }; }"""
SCROLLED = """() => [...document.querySelectorAll(".mantine-ScrollArea-viewport")].map((area) => area.scrollTop)"""
FOLDED = ".mantine-Paper-root > .mantine-Paper-root[aria-expanded=false]"


@pytest.mark.long
def test_folders_and_sliders_obey_the_keyboard(one_page: tuple[Viewer, Tab]) -> None:
    viewer, tab = one_page
    tab.follow(viewer, "rope")
    slider = tab.page.get_by_role("slider", name="Stiffness [N/m]")
    tab.wait(lambda: slider.count() == 1)
    slider.focus()
    tab.page.keyboard.press("ArrowRight")
    tab.wait(lambda: vars(viewer.settings.params)["stiffness"] == 810.0)
    folder = tab.page.get_by_role("button", name="Surroundings", exact=True)
    folder.focus()
    tab.page.keyboard.press("Enter")
    tab.wait(lambda: folder.get_attribute("aria-expanded") == "true")
    tab.wait(lambda: viewer.loop.run.running)
    tab.page.get_by_role("button", name="Pause").focus()
    tab.page.keyboard.press("Space")  # presses the button, and is not also the key that plays
    tab.wait(lambda: not viewer.loop.run.running)
    tab.page.wait_for_timeout(500)
    assert not viewer.loop.run.running


def scroll(tab: Tab, by: float) -> None:
    """Turn the mouse wheel over the panel until it moves nothing any more."""
    width, height = (tab.page.viewport_size[side] for side in ("width", "height"))
    tab.page.mouse.move(width - 60, height - 40)
    before = None
    while (now := tab.page.evaluate(SCROLLED)) != before:
        before = now
        tab.page.mouse.wheel(0, by)
        tab.page.wait_for_timeout(100)


def check_both_ends(tab: Tab) -> None:
    """At the start both switches can be pressed; the wheel brings the last control to where it can be."""
    scroll(tab, -3000)
    for switch in ("dark", "large"):
        tab.page.locator(f"[data-springtide-act={switch}]").click(trial=True, timeout=5000)
    assert not any(tab.page.evaluate(SCROLLED))  # the trial has scrolled nothing
    scroll(tab, 3000)
    last = tab.page.evaluate(LAST_CONTROL)
    assert last["inside"], last
    assert last["pressed"], last


@pytest.mark.long
def test_the_wheel_reaches_the_last_control_with_large_text(one_page: tuple[Viewer, Tab]) -> None:
    viewer, tab = one_page
    size = tab.page.viewport_size
    tab.follow(viewer, "square_sea")
    viewer.loop.commands.put(Pause())
    switches = [tab.page.locator(f"[data-springtide-act={name}]") for name in ("large", "dark")]
    try:
        for width, height in ((1280, 800), (390, 844)):
            tab.page.set_viewport_size({"width": width, "height": height})
            tab.wait(lambda: tab.page.locator(".springtide-panel").count())
            tab.show("View")
            for switch in switches:  # large; large and dark
                switch.click()
                check_both_ends(tab)
                scroll(tab, -3000)
            for switch in switches:
                switch.click()
    finally:
        tab.page.evaluate("localStorage.clear()")
        tab.page.reload()
        tab.page.set_viewport_size(size)


SAMPLE = ("rope",)  # all scenes under -m stress


@pytest.fixture(params=[pytest.param(name, marks=[] if name in SAMPLE else pytest.mark.stress) for name in NAMES])
def opened(request: pytest.FixtureRequest, one_page: tuple[Viewer, Tab]) -> Iterator[tuple[Viewer, Tab]]:
    """Each scene with every folder of its panel open, paused, in a window that shows all of it."""
    viewer, tab = one_page
    size = tab.page.viewport_size
    tab.page.set_viewport_size({"width": 1100, "height": 2600})
    viewer.workbook = Workbook(load_tasks(with_checks=False))  # the guide is part of what everyone gets
    viewer.workbook.go_to_scene(request.param)
    viewer.workbook.show_answer(viewer.workbook.task)
    tab.follow(viewer, request.param)
    tab.wait(lambda: tab.page.locator(".springtide-panel").count())
    viewer.loop.commands.put(Pause())
    tab.wait(lambda: tab.page.locator(FOLDED).count() > 3)

    def unfold() -> bool:
        tab.show("Controls")  # a slow page places the tabs late, and can end at another
        tab.page.evaluate("folded => document.querySelectorAll(folded).forEach(title => title.click())", FOLDED)
        tab.page.wait_for_timeout(500)  # folders that come late are folded, too
        is_shown = tab.page.get_by_role("tab", name="Controls", exact=True).get_attribute("aria-selected") == "true"
        return is_shown and not tab.page.locator(FOLDED).count()

    tab.wait(unfold)
    yield viewer, tab
    viewer.workbook = None
    tab.page.set_viewport_size(size)


def low_contrasts(tab: Tab) -> list[Any]:
    found = tab.page.evaluate(CONTRAST)
    assert len(found) > 40
    return [(text, round(ratio, 2)) for text, ratio in found if ratio is not None and ratio < MIN_CONTRAST]


@pytest.mark.long
def test_every_text_has_enough_contrast_light_and_dark(opened: tuple[Viewer, Tab]) -> None:
    _, tab = opened
    assert low_contrasts(tab) == []
    tab.show("View")
    switch = tab.page.locator("[data-springtide-act=dark]")
    switch.click()
    tab.wait(lambda: tab.page.locator("html[data-mantine-color-scheme=dark]").count())
    tab.show("Controls")
    try:
        tab.wait(lambda: low_contrasts(tab) == [], 20)  # colours change gradually
    finally:
        tab.show("View")
        switch.click()
        tab.wait(lambda: tab.page.locator("html[data-mantine-color-scheme=light]").count())
        tab.show("Controls")


def test_every_control_is_reached_by_tab_and_has_a_name(opened: tuple[Viewer, Tab]) -> None:
    _, tab = opened
    controls = tab.page.evaluate(CONTROLS)
    assert len(controls) > 20
    assert [control for control in controls if not control[0] or control[1] < 0] == []
    names = [name for name, _, _ in controls]
    assert "Main" in names
    assert sum("multi-slider-thumb" in kind for _, _, kind in controls) > 7
