"""State of one browser and state shared by all, in two real browsers: docs/architecture.md has the table."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import Tab

WIDTH, HEIGHT = 800, 460  # [pixels]
# What a browser has for itself.
OWN = """() => { const { x, y, z } = window.__viserMutable.camera.position, { classList } = document.documentElement;
    const tabs = [...document.querySelectorAll("[role=tab]")];
    const folders = [...document.querySelectorAll("[role=button][aria-expanded]")];
    return { camera: [-z, -x, y], tab: tabs.find(tab => tab.ariaSelected === "true")?.innerText,
        dark: classList.contains("springtide-dark"), large: classList.contains("springtide-large"),
        scheme: document.documentElement.dataset.mantineColorScheme,
        quality: window.__springtide.quality.now().quality,
        open: folders.find(folder => folder.innerText.trim() === "Surroundings")?.ariaExpanded }; }"""
PRESET, OTHER_PRESET = "Lab code: 10 points", "Pendulum"
Pair = tuple[Viewer, tuple[Tab, Tab]]


@pytest.fixture(scope="module")
def pair(chromium: Any) -> Iterator[Pair]:
    """A lab, and two browsers on it that share nothing."""
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    viewer.loop.commands.put(Pause())
    tabs = Tab(chromium, viewer.port, WIDTH, HEIGHT), Tab(chromium, viewer.port, WIDTH, HEIGHT)
    yield viewer, tabs
    for tab in tabs:
        tab.page.close()
    viewer.shut()


@pytest.fixture(params=[0, pytest.param(1, marks=pytest.mark.long)], ids=["", "swapped"])
def two(request: pytest.FixtureRequest, pair: Pair) -> tuple[Viewer, Tab, Tab]:
    """The lab, the browser that acts first, and the other one; both look at a rope that stands still."""
    viewer, tabs = pair
    viewer.open("rope")
    viewer.settings.history.settings.clear()  # of the tests before: the choice of a scene is an act
    viewer.settings.tell()
    viewer.loop.commands.put(Pause())
    for tab in tabs:
        tab.errors.clear()
        tab.wait_for_panel(viewer)
        tab.show("Controls")
        tab.wait(lambda tab=tab: np.allclose(own(tab)["camera"], first_view(viewer), atol=1e-3))
    return viewer, tabs[request.param], tabs[1 - request.param]


def own(tab: Tab) -> dict[str, Any]:
    return tab.page.evaluate(OWN)


def first_view(viewer: Viewer) -> Any:
    return viewer.view.first_view(viewer.settings.params)[0]


def turn(tab: Tab, by: float = 90.0) -> None:
    """Turn the camera by a drag on the free part of the picture."""
    before = own(tab)["camera"]
    tab.drag((80.0, 380.0), (80.0 + by, 360.0), pause=20)
    tab.release()
    tab.wait(lambda: not np.allclose(own(tab)["camera"], before, atol=0.1))
    tab.page.wait_for_timeout(300)  # the last part of the drag has arrived


def meet(acts: Tab, other: Tab) -> None:
    """Wait until all messages of one browser have reached the other: a step, which is shared, is shown there."""
    time = clock(other)
    key("n")(acts)
    other.wait(lambda: clock(other) != time, 20)


def clock(tab: Tab) -> str:
    return tab.page.locator(".springtide-panel[data-state]").inner_text()


def choose(tab: Tab, label: str, option: str) -> None:
    tab.page.get_by_label(label, exact=True).first.click()
    tab.page.get_by_role("option", name=option, exact=True).click()


def switch(name: str) -> Callable[[Tab], None]:
    def press(tab: Tab) -> None:
        tab.show("View")
        tab.page.locator(f"[data-springtide-act={name}]").click()
        tab.show("Controls")

    return press


def set_quality(tab: Tab, quality: str) -> None:
    tab.show("View")
    tab.page.locator("[data-springtide-choice=quality]").select_option(quality)
    tab.show("Controls")


OWN_ACTS: dict[str, Callable[[Tab], None]] = {
    "camera": turn,
    "tab": lambda tab: tab.show("Share"),
    "dark": switch("dark"),
    "large": switch("large"),
    "quality": lambda tab: set_quality(tab, "medium"),
    "open": lambda tab: tab.page.get_by_role("button", name="Surroundings", exact=True).click(),
}
TAKE_BACK: dict[str, Callable[[Tab], None]] = {
    **OWN_ACTS,
    "camera": lambda tab: tab.page.get_by_role("button", name="Camera", exact=True).click(),
    "tab": lambda tab: tab.show("Controls"),
    "quality": lambda tab: set_quality(tab, "automatic"),
}


@pytest.mark.long
def test_an_act_that_is_a_browsers_changes_nothing_in_another(two: tuple[Viewer, Tab, Tab]) -> None:
    viewer, acts, other = two
    params = viewer.settings.params
    turn(other)  # so that a camera that is placed there shows
    for act in OWN_ACTS:
        before, elsewhere = own(acts), own(other)
        for change, again in ((OWN_ACTS[act], False), (TAKE_BACK[act], True)):
            change(acts)
            is_back = lambda act=act, acts=acts, before=before: own(acts)[act] == pytest.approx(before[act], abs=1e-3)  # noqa: E731
            acts.wait(lambda again=again, is_back=is_back: is_back() is again, 20)
            meet(acts, other)
            assert own(other) == elsewhere, act
        acts, other = other, acts
    assert viewer.settings.params == params
    assert not viewer.settings.history.settings
    assert not acts.errors
    assert not other.errors


def field(tab: Tab, label: str) -> str:
    return tab.page.get_by_label(label, exact=True).first.input_value()


def type_stiffness(tab: Tab) -> None:
    place = tab.page.get_by_role("textbox", name="Stiffness [N/m]", exact=True)
    place.fill("1234")
    place.press("Enter")


def move_slider(tab: Tab) -> None:
    tab.page.get_by_role("slider", name="Stiffness [N/m]", exact=True).focus()
    for _ in range(3):
        tab.page.keyboard.press("ArrowRight")


def tick_floor(tab: Tab) -> None:
    floor = tab.page.get_by_label("Floor", exact=True).first
    if not floor.is_visible():
        tab.page.get_by_role("button", name="Surroundings", exact=True).click()
        tab.wait(floor.is_visible, 10)
    floor.click()


def press(name: str) -> Callable[[Tab], None]:
    return lambda tab: tab.page.get_by_role("button", name=name, exact=True).click()


def key(name: str) -> Callable[[Tab], None]:
    def type_it(tab: Tab) -> None:
        tab.page.evaluate("document.activeElement?.blur()")  # Space would press the tab that was clicked last
        tab.page.keyboard.press(name)

    return type_it


def shared(tab: Tab) -> dict[str, Any]:
    """The shared state that a page shows."""
    charts = tab.page.locator(".u-wrap").count()
    return {
        "stiffness": field(tab, "Stiffness [N/m]"),
        "slider": tab.page.get_by_role("slider", name="Stiffness [N/m]", exact=True).get_attribute("aria-valuetext"),
        "method": field(tab, "Method"),
        "floor": tab.page.get_by_label("Floor", exact=True).first.is_checked(),
        "preset": field(tab, "Preset"),
        "plays": tab.page.get_by_role("button", name="Pause", exact=True).count(),
        "charts": charts,
        "time": clock(tab).split("·")[0],
    }


# The act, and what it changes on the page. What has an undo is undone in the other browser.
SHARED_ACTS: dict[str, tuple[Callable[[Tab], None], str]] = {
    "field": (type_stiffness, "stiffness"),
    "slider": (move_slider, "slider"),
    "list": (lambda tab: choose(tab, "Method", "Runge-Kutta 4 (RK4)"), "method"),
    "checkbox": (tick_floor, "floor"),
    "preset": (lambda tab: choose(tab, "Preset", OTHER_PRESET), "preset"),
    "plots": (press("Plots"), "charts"),
    "step": (press("Step"), "time"),
    "play": (press("Play"), "plays"),
    "key of a preset": (key("2"), "preset"),
    "key of the plots": (key("p"), "charts"),
    "key of the clock": (key("Space"), "plays"),
}


@pytest.mark.long
def test_an_act_that_is_everybodys_shows_in_both_browsers(two: tuple[Viewer, Tab, Tab]) -> None:
    viewer, acts, other = two
    for act, (does, changes) in SHARED_ACTS.items():
        before = shared(acts)
        assert shared(other) == before
        does(acts)
        for tab in (acts, other):
            tab.wait(lambda tab=tab, name=changes, before=before: shared(tab)[name] != before[name], 20)
        viewer.loop.commands.put(Pause())
        if viewer.settings.history.settings:
            key("u")(other)
            viewer.loop.commands.put(Pause())
            for tab in (acts, other):
                tab.wait(lambda tab=tab, name=changes, before=before: shared(tab)[name] == before[name], 20)
            assert not viewer.settings.history.settings, act
        acts.wait(lambda acts=acts, other=other: shared(acts) == shared(other) and not shared(acts)["plays"], 20)
        acts, other = other, acts
    assert not acts.errors
    assert not other.errors


@pytest.mark.long
def test_a_reset_begins_the_run_of_all_and_leaves_each_camera_which_a_preset_places(
    two: tuple[Viewer, Tab, Tab],
) -> None:
    viewer, acts, other = two
    turn(acts)
    turn(other, 60.0)
    places = [own(tab)["camera"] for tab in (acts, other)]
    for reset in (press("Reset"), key("r")):
        meet(acts, other)
        reset(acts)
        for tab in (acts, other):
            tab.wait(lambda tab=tab: "t = 0.00 s" in clock(tab), 20)
        assert [own(tab)["camera"] for tab in (acts, other)] == [pytest.approx(one, abs=1e-3) for one in places]
    choose(acts, "Preset", OTHER_PRESET)
    for tab in (acts, other):
        tab.wait(lambda tab=tab: np.allclose(own(tab)["camera"], first_view(viewer), atol=1e-3), 20)
    key("u")(other)
    for tab, place in zip((acts, other), places, strict=True):
        tab.wait(lambda tab=tab, place=place: np.allclose(own(tab)["camera"], place, atol=1e-3), 20)


@pytest.mark.long
def test_a_scene_is_everybodys_and_leaves_to_each_browser_what_is_its_own(two: tuple[Viewer, Tab, Tab]) -> None:
    viewer, acts, other = two
    switch("dark")(acts)
    set_quality(acts, "medium")
    try:
        kept = {name: [own(tab)[name] for tab in (acts, other)] for name in ("dark", "large", "quality")}
        assert kept["dark"] == [True, False]
        assert kept["quality"][0] == "medium" != kept["quality"][1]
        choose(acts, "Scene", "Race")
        for tab in (acts, other):
            tab.wait(lambda: viewer.panel.kind.name == "race")
            tab.wait_for_panel(viewer)
            assert field(tab, "Scene") == "Race"
        for name, values in kept.items():
            assert [own(tab)[name] for tab in (acts, other)] == values
    finally:
        switch("dark")(acts)
        set_quality(acts, "automatic")


@pytest.mark.long
def test_acts_of_two_pages_are_undone_in_either_page(two: tuple[Viewer, Tab, Tab]) -> None:
    viewer, acts, other = two
    rope = lambda: acts.pixel(viewer.scene.state.x[:, 0, 6])  # type: ignore[attr-defined]  # noqa: E731

    def drag(tab: Tab) -> None:
        tab.hold(rope, (40, -20), lambda: viewer.scene.handles.grab.grabbed is not None)  # type: ignore[attr-defined]
        tab.release()

    def hint(tab: Tab) -> str:
        return tab.page.locator('[data-springtide-icon="Undo"]').get_attribute("title") or ""

    def values(tab: Tab) -> dict[str, Any]:
        found = shared(tab)
        return {name: found[name] for name in ("stiffness", "floor", "preset", "charts")}

    done: list[dict[str, Any]] = []
    for act, words in (
        (type_stiffness, "Stiffness, back to 800"),
        (drag, "a pull"),
        (tick_floor, "Floor, back to"),
        (lambda tab: choose(tab, "Preset", OTHER_PRESET), f"preset {OTHER_PRESET}, back to"),
        (press("Plots"), "new values"),
    ):
        done.append(values(acts))
        act(acts)
        for tab in (acts, other):
            tab.wait(lambda tab=tab, words=words: hint(tab).startswith(f"Undo: {words}"), 20)
        other.wait(lambda acts=acts, other=other: values(other) == values(acts), 20)
        viewer.loop.commands.put(Pause())
        acts, other = other, acts
    for number, before in enumerate(reversed(done)):
        (key("Control+z") if number % 2 else press("Undo"))(acts)
        viewer.loop.commands.put(Pause())
        for tab in (acts, other):
            tab.wait(lambda tab=tab, before=before: values(tab) == before, 20)
        acts, other = other, acts
    for tab in (acts, other):
        tab.wait(lambda tab=tab: hint(tab).startswith("There is nothing to undo. Redo: "), 20)
        assert tab.page.locator('[data-springtide-icon="Undo"]').is_disabled()
