"""Links opened in one tab of a browser that keeps the pages it has left, as browsers do that no driver starts."""

from collections.abc import Iterator
from typing import Any

import pytest

from app.panel.sharing.scene_switches import UNDO
from app.server.viewer import Viewer
from tests.browser.conftest import CHROMIUM, FLAGS, Tab, surroundings

NOTE_RETURN = "addEventListener('pageshow', (event) => { if (event.persisted) sessionStorage.kept = 'yes'; });"


@pytest.fixture(scope="module")
def caching_browser(chromium: Any) -> Iterator[Any]:
    """A Chromium with its back/forward cache, which Playwright switches off."""
    browser = chromium.browser_type.launch(
        executable_path=CHROMIUM, args=FLAGS, ignore_default_args=["--disable-back-forward-cache"], env=surroundings()
    )
    yield browser
    browser.close()


@pytest.mark.long  # a browser of its own
@pytest.mark.parametrize("links", [2, pytest.param(20, marks=pytest.mark.stress)])
def test_links_opened_in_one_tab_are_one_visitor_and_no_notice(lab: Viewer, caching_browser: Any, links: int) -> None:
    tab = Tab(caching_browser, lab.port, width=400, height=300)
    tab.page.add_init_script(NOTE_RETURN)
    try:
        tab.wait(lambda: len(lab.visitors()) == 1)
        address = tab.page.url

        def shows(points: int) -> bool:
            assert len(lab.visitors()) <= 1
            return vars(lab.settings.params)["points"] == points and tab.page.locator(".springtide-panel").count() > 0

        for points in range(20, 20 + links):
            tab.page.goto(f"{address}&scene=rope&points={points}")
            tab.wait(lambda points=points: shows(points), 30)
            assert not tab.page.get_by_role("button", name=UNDO).is_visible()
        tab.page.go_back(wait_until="commit")
        tab.wait(lambda: shows(18 + links), 30)
        assert tab.page.evaluate("sessionStorage.kept") == "yes"  # else the cache was off, and nothing was tested
        tab.wait(lambda: len(tab.vertices("/rope")) > 0)
        assert tab.errors == []
    finally:
        tab.page.close()
