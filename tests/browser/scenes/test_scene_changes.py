"""Scenes that are opened after each other on one page look as in a fresh start: light, shadow, haze, floor, labels."""

import contextlib
import io
import itertools
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.scenes import NAMES, scene_named
from app.scenes.contract import AnyScene
from app.scenes.rope.view import RopeView
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests.browser.conftest import NO_NOTES, Tab
from tests.browser.water.test_water import PANEL_HIDDEN

WIDTH, HEIGHT = 240, 160  # [pixels]
SMALL: dict[str, dict[str, Any]] = {
    "square_sea": {"size": "64", "mesh": "32"},
    "radial_sea": {"rings": 32, "spokes": 32, "cutaway": True},  # it has labels
    "cloth": {"rows": 8, "cols": 8},
}
SAMPLE = ("radial_sea", "rope")
WATER = "roughMirror"  # a word of its shader
# Mean of all pixels, of 255. At most 0.011 was seen; without its shadow alone the rope
# differs by 0.073, without the lamps by 0.091.
MAX_DIFFERENCE = 0.02


# All words that the cover of the page has from here on.
COVERS = """() => { window.covers = []; const words = document.getElementById("springtide-cover-words");
    new MutationObserver(() => window.covers.push(words.textContent)).observe(words,
        { childList: true, subtree: true, characterData: true }); }"""


def all_orders() -> list[str]:
    """A walk through the scenes that goes from each to each other one exactly once (Hierholzer's method)."""
    left = {name: [other for other in NAMES if other != name] for name in NAMES}
    path, walk = [NAMES[0]], list[str]()
    while path:
        if left[path[-1]]:
            path.append(left[path[-1]].pop())
        else:
            walk.append(path.pop())
    return walk[::-1]


class Page:
    """A server and a page of its own, in which scenes are opened one after the other."""

    def __init__(self, open_tab: Callable[..., Tab], flat: str) -> None:
        self.lab = Viewer("127.0.0.1", 0)
        self.tab = open_tab(self.lab.port, width=WIDTH, height=HEIGHT, drawn=True, flat=flat, ratio=1.0)
        self.tab.page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN)

    def open(self, scene: str) -> None:
        """Have a scene drawn at its start."""
        self.lab.open(scene, check_record(scene_named(scene).params, SMALL.get(scene, {})), paused=True)
        self.tab.wait_for_panel(self.lab)
        self.tab.page.mouse.move(1, 1)
        self.tab.page.screenshot(timeout=120_000)

    def picture(self) -> np.ndarray:
        """The picture (HEIGHT, WIDTH, 3), 0 to 255, as soon as it does not change."""
        shots: list[np.ndarray] = []

        def unchanged() -> bool:
            self.tab.page.wait_for_timeout(700)
            png = self.tab.page.screenshot(timeout=120_000)
            shots.append(np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float))
            return len(shots) > 2 and bool((shots[-1] == shots[-2]).all() and (shots[-1] == shots[-3]).all())

        self.tab.wait(unchanged, 300.0)
        return shots[-1]


@contextlib.contextmanager
def opened(open_tab: Callable[..., Tab], flat: str, scene: str) -> Iterator[Page]:
    """A page with a scene, which is drawn no longer than it is needed."""
    page = Page(open_tab, flat)
    try:
        page.open(scene)
        yield page
    finally:
        page.tab.page.close()
        page.lab.shut()


@pytest.mark.long
@pytest.mark.timeout(1500)  # on two busy cores all orders take twelve minutes
@pytest.mark.parametrize("walk", [SAMPLE, pytest.param(all_orders(), marks=pytest.mark.stress)], ids=["few", "all"])
def test_a_scene_after_another_looks_as_in_a_fresh_start(open_tab: Callable[..., Tab], walk: list[str]) -> None:
    """In the short walk no picture of water is looked at; without its shader, which takes long, it has one colour."""
    flat = WATER if walk == SAMPLE else ""
    fresh, found = dict[str, np.ndarray](), dict[tuple[str, str], float]()
    for scene in dict.fromkeys(walk[1:]):
        with opened(open_tab, flat, scene) as alone:
            fresh[scene] = alone.picture()
    with opened(open_tab, flat, walk[0]) as page:
        for before, scene in itertools.pairwise(walk):
            page.open(scene)
            found[before, scene] = float(np.abs(page.picture() - fresh[scene]).mean())
        assert all(shown.std() > 5.0 for shown in fresh.values())  # there is something to see
        assert {pair: value for pair, value in found.items() if value > MAX_DIFFERENCE} == {}
        # The measure sees a missing shadow.
        page.open("rope")
        view = page.lab.view
        assert isinstance(view, RopeView)
        view.surroundings.sun.cast_shadow = False
        page.tab.wait(lambda: np.abs(page.picture() - fresh["rope"]).mean() > 2.0 * MAX_DIFFERENCE)


@pytest.mark.long
@pytest.mark.parametrize("names", [("square_sea", "rope"), pytest.param((*NAMES, NAMES[0]), marks=pytest.mark.long)])
def test_the_page_says_what_is_opened_and_not_that_it_connects(
    open_tab: Callable[..., Tab], monkeypatch: pytest.MonkeyPatch, names: tuple[str, ...]
) -> None:
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open("rope")
        tab = open_tab(lab.port)
        tab.wait(lambda: lab.served.shown_serial > 5 and tab.page.locator(".springtide-panel").count())
        tab.page.evaluate(COVERS)
        is_said, make_scene = threading.Event(), lab.make_scene

        def make_scene_later(*arguments: Any) -> AnyScene:
            is_said.wait(60)  # else a scene that opens at once leaves a slow page nothing to say
            is_said.clear()
            return make_scene(*arguments)

        monkeypatch.setattr(lab, "make_scene", make_scene_later)
        for name in names:
            kind = scene_named(name)
            lab.want(name, check_record(kind.params, SMALL.get(name, {})))
            tab.wait(lambda kind=kind: f"Opening {kind.title} …" in tab.page.evaluate("covers"))
            is_said.set()
            tab.wait(lambda name=name: lab.is_open and lab.panel.kind.name == name and lab.served.shown_serial > 5)
            tab.wait(lambda: tab.page.locator(".springtide-panel").count())
            tab.page.wait_for_timeout(500)
        assert not any("Connecting" in words for words in tab.page.evaluate("covers"))
    finally:
        lab.shut()
