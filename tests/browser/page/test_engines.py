"""One visit to the lab in each browser: the panel, numbers, keys, the time line, undo."""

import json
from typing import Any

import pytest

from app.server.viewer import Viewer
from tests.browser.engines import Engine, opened

VISITS = ["firefox", *(pytest.param(name, marks=pytest.mark.long) for name in ("chromium", "webkit"))]
RUNS = """const cover = document.querySelector("#springtide-cover.springtide-hidden");
    const isRunning = document.querySelector(".springtide-panel")?.dataset.state === "running";
    return cover !== null && isRunning && window.__springtide.quality !== undefined;"""
FIELD = """[...document.querySelectorAll("label")].find((one) => one.textContent.startsWith(NAME))
    .closest(".mantine-Flex-root").querySelector("input.mantine-TextInput-input")"""
TAB = """[...document.querySelectorAll('[role="tab"]')].find((one) => one.textContent.trim() === NAME)"""
BUTTON = """[...document.querySelectorAll("button")].find((one) => one.textContent.trim() === NAME)"""


def named(expression: str, name: str) -> str:
    return expression.replace("NAME", f'"{name}"')


def until(engine: Engine, condition: Any, words: str) -> None:
    """Wait for something in the lab."""
    for _ in range(300):
        if condition():
            return
        engine.run("await new Promise((done) => setTimeout(done, 100));")
    raise AssertionError(words)


def enter(engine: Engine, name: str, text: str) -> None:
    """Replace the text of a field of the panel. The next key is pressed once the page has taken the one before."""
    field = named(FIELD, name)
    engine.press_on(field)
    engine.wait(f"return document.activeElement === {field};")
    engine.type(*text)
    engine.wait(f"return {field}.value === {json.dumps(text)};", 20.0)
    engine.type("Enter")


@pytest.mark.parametrize("name", VISITS)
def test_a_visit(chromium: Any, name: str) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    try:
        with opened(name, chromium) as page:
            page.open(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2")
            page.wait(RUNS)
            assert page.run("return document.querySelector('.springtide-notice')?.textContent;") is None
            params = lambda: viewer.settings.params  # noqa: E731
            # What is typed replaces the text of a field, in either order of two fields, the second time too.
            for field, text, read in [
                ("Stiffness", "1234,5", lambda: params().stiffness == 1234.5),
                ("Points", "9", lambda: params().points == 9),
                ("Stiffness", "2k", lambda: params().stiffness == 2000.0),
            ]:
                enter(page, field, text)
                until(page, read, f"{field} is {params()}")
            page.type("u")
            until(page, lambda: params().stiffness == 1234.5, "undo by key")
            page.press_on('document.querySelector("[data-springtide-icon=Undo]")')
            until(page, lambda: params().points == 10, "undo by mouse")
            page.type("Space")
            until(page, lambda: not viewer.loop.run.running, "pause by key")
            page.press_on('document.querySelector("[data-springtide-icon=Play]")')
            until(page, lambda: viewer.loop.run.running, "play by mouse")
            page.press_on(named(TAB, "View"))
            page.press_on(named(BUTTON, "Dark"))
            page.wait('return document.documentElement.classList.contains("springtide-dark");')
            page.wait('return document.querySelector("#springtide-time input:enabled") !== null;')  # there are frames
            left, middle, width = page.run(
                """const box = document.querySelector("#springtide-time input").getBoundingClientRect();
                   return [box.left, box.top + box.height / 2, box.width];"""
            )
            page.press((left + 0.95 * width, middle), (left + 0.7 * width, middle), (left + 0.5 * width, middle))
            page.wait('return document.querySelector("#springtide-time.springtide-is-past") !== null;')
            page.press_on('document.querySelector("#springtide-time [data-act=live]")')
            page.wait('return document.querySelector("#springtide-time.springtide-is-past") === null;')
    finally:
        viewer.shut()
