"""How finely a browser draws: by the length of its frames (tests/js/judge.test.js), or as its user has chosen."""

from collections.abc import Iterator
from typing import Any

import pytest

from app.server.viewer import Viewer
from tests.browser.conftest import WITH_CARD, new_page

STATE = """() => ({ ...window.__springtide?.quality?.now(), width: document.querySelector("canvas[data-engine]")?.width,
    line: document.querySelector("#springtide-slow")?.innerText ?? "",
    now: document.querySelector(".springtide-quality")?.innerText ?? null,
    detail: (window.__viserMutable?.nodeRefFromName?.["/sea"]?.children
        ?.find(c => c.isMesh && c.visible && c.layers.mask)?.material.userData.springtide ?? "") })"""
# As if drawing took so long in each frame [ms], whatever this machine can do. The page waits, as a loop that runs so
# long takes a core.
SLOW_FRAMES = """const next = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = callback => next(() => setTimeout(() => callback(performance.now()), 150));"""


@pytest.fixture(scope="module")
def page(chromium: Any) -> Iterator[Any]:
    """A page without "fixedDpr", which would keep all pixels."""
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("square_sea")
    page = new_page(chromium, 420, 300, drawn=False)
    page.add_init_script(WITH_CARD + SLOW_FRAMES)
    page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo")
    page.wait_for_function("() => window.__springtide?.quality")
    page.get_by_role("tab", name="View", exact=True).click(timeout=60_000)
    yield page
    page.close()
    viewer.shut()


def wait_for(page: Any, condition: str) -> dict[str, Any]:
    """The state of the page once the condition on its state holds."""
    page.wait_for_function(f"() => {{ const s = ({STATE})(); return {condition}; }}", timeout=120_000)
    return page.evaluate(STATE)


@pytest.mark.long
def test_without_a_graphics_card_a_page_starts_at_low(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("square_sea")
    page = new_page(chromium, 420, 300, drawn=False)
    try:
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo")
        page.wait_for_function("() => window.__springtide?.quality")
        first = page.evaluate(STATE)
        assert (first["quality"], first["step"], first["width"]) == ("low", 4, 210)
        assert first["line"].startswith("Graphics are slow here, so quality was reduced.")
        # viser's own monitor and its resizing set the pixels too; the choice of the page holds.
        page.set_viewport_size({"width": 440, "height": 300})
        wait_for(page, "s.width === 220")
    finally:
        page.close()
        viewer.shut()


@pytest.mark.long
def test_quality_falls_where_drawing_is_slow_and_the_page_says_so(page: Any) -> None:
    drawn = "s.width === Math.round(420 * s.pixels) && s.detail.endsWith(' lit')"
    lowered = wait_for(page, f"s.step >= 2 && {drawn}")
    assert lowered["line"].startswith("Graphics are slow here, so quality was reduced.")
    assert lowered["now"] == f"now {lowered['quality']}"
    assert "quality" not in page.evaluate("location.search")
    # The page opens with it the next time.
    page.reload()
    page.wait_for_function("() => window.__springtide?.quality")
    assert page.evaluate(STATE)["step"] >= 2
    page.get_by_role("tab", name="View", exact=True).click(timeout=60_000)
    page.get_by_role("button", name="Keep high quality").click()
    high = wait_for(page, "s.width === 420 && s.detail === 'springtide-water/sea lit'")
    assert (high["step"], high["line"], high["now"]) == (0, "", "")
    assert page.locator("[data-springtide-choice=quality]").input_value() == "high"
    page.wait_for_timeout(4000)  # longer than the automatic choice takes to fall
    assert page.evaluate(STATE)["step"] == 0
    page.locator("[data-springtide-choice=quality]").select_option("low")
    low = wait_for(page, "s.width === 210 && s.details === 0")
    assert (low["quality"], low["line"]) == ("low", "")
