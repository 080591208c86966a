"""What the page says while there is no picture: before, and after the server."""

import time
from typing import Any

from app.server.viewer import Viewer
from tests.browser.conftest import new_page


def shown(page: Any) -> str:
    """The words on the cover; "" where it is not there."""
    return page.evaluate(
        """() => { const cover = document.getElementById("springtide-cover");
           return !cover || cover.classList.contains("springtide-hidden") ? "" : cover.innerText; }"""
    )


def wait_for(page: Any, condition: Any, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition(shown(page)):
        assert time.monotonic() < end, shown(page)
        page.wait_for_timeout(50)


def test_the_cover_goes_with_the_first_scene_and_comes_back_with_the_end(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, shaded=False)
    try:
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2", wait_until="commit")
        wait_for(page, lambda words: "Connecting" in words)  # no scene is open
        assert page.title() == "Springtide"
        viewer.open("rope")
        wait_for(page, lambda words: words == "")
    finally:
        viewer.shut()
    wait_for(page, lambda words: "The lab has stopped. Start it again" in words)
    page.close()


def test_without_webgl_the_page_says_so(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, shaded=False)
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null;")
    try:
        viewer.open("rope")
        page.goto(f"http://127.0.0.1:{viewer.port}/", wait_until="commit")
        page.wait_for_selector("#springtide-notice")
        assert "no WebGL 2" in page.inner_text("#springtide-notice")
    finally:
        viewer.shut()
        page.close()
