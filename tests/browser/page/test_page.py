"""What the page says while there is no picture: before, and after the server."""

import socket
import time
from typing import Any

import pytest

from app.render import scripts
from app.render.injection import injector_of
from app.server.viewer import Viewer
from app.server.web.access import Access
from app.server.web.page import covered
from tests.browser.conftest import new_page


def shown(page: Any) -> str:
    """The words on the cover; "" if it is not there."""
    return page.evaluate(
        """() => { const cover = document.getElementById("springtide-cover");
           return !cover || cover.classList.contains("springtide-hidden") ? "" : cover.innerText; }"""
    )


def wait_for(page: Any, condition: Any, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition(shown(page)):
        assert time.monotonic() < end, shown(page)
        page.wait_for_timeout(50)


@pytest.mark.long
def test_the_cover_goes_with_the_first_scene_and_comes_back_with_the_end(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, drawn=False)
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


@pytest.mark.long
def test_the_cover_stays_until_all_nodes_of_the_scene_are_there(chromium: Any) -> None:
    """On a slow page the sky may be there long before the vertices of a sea."""
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, drawn=False)
    try:
        viewer.open("race")
        injector = injector_of(viewer.server)
        assert injector is not None
        injector.watch("/late")
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2", wait_until="commit")
        wait_for(page, lambda words: "Preparing the picture" in words)
        page.wait_for_timeout(5000)  # longer than the things of a scene are waited for without the list
        assert "Preparing the picture" in shown(page)
        viewer.server.scene.add_frame("/late")
        wait_for(page, lambda words: words == "", 20.0)
    finally:
        viewer.shut()
        page.close()


@pytest.mark.parametrize(
    ("path", "words"),
    [
        pytest.param("/", "with the command: springtide", marks=pytest.mark.long),
        ("/user/ada/springtide/", "Reload this page to start it again."),
    ],
)
def test_a_page_behind_a_proxy_names_no_command(chromium: Any, path: str, words: str) -> None:
    """Its user has no terminal where the lab runs: on a JupyterHub a page that is loaded again starts the lab."""
    viewer = Viewer("127.0.0.1", 0, access=Access(path.removesuffix("/")))
    page = new_page(chromium, 640, 400, drawn=False)
    try:
        page.goto(f"http://127.0.0.1:{viewer.port}{path}", wait_until="commit")
        wait_for(page, lambda said: "Connecting" in said)
    finally:
        viewer.shut()
    wait_for(page, lambda said: "The lab has stopped." in said)
    assert words in shown(page)
    page.close()


NO_WEBGL = "HTMLCanvasElement.prototype.getContext = () => null;"
OLD = "delete Element.prototype.checkVisibility;"
REFUSED = """for (const name of ["localStorage", "sessionStorage"])
    Object.defineProperty(window, name, { get() { throw new DOMException("blocked", "SecurityError"); } });"""
BAD_LANGUAGE = "Object.defineProperty(navigator, 'language', { value: 'C', configurable: true });"


@pytest.mark.parametrize(
    ("script", "words"),
    [
        (NO_WEBGL, "WebGL 2 is missing or switched off. Switch on hardware acceleration"),
        (OLD, "This browser is too old for the lab. The oldest supported versions are Chrome or Edge 120, Firefox 121"),
    ],
)
def test_a_page_that_cannot_start_says_why(chromium: Any, script: str, words: str) -> None:
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, drawn=False)
    page.add_init_script(script)
    try:
        page.goto(f"http://127.0.0.1:{viewer.port}/", wait_until="commit")
        wait_for(page, lambda said: words in said, 10.0)
    finally:
        viewer.shut()
        page.close()


@pytest.mark.long
def test_the_cover_names_the_error_of_a_client_that_ends(chromium: Any) -> None:
    """viser's client runs in the page, and anything in it may fail in a browser that nobody has tried."""
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, drawn=False)
    page.add_init_script("WebAssembly.Module = WebAssembly.instantiate = () => { throw new RangeError('no wasm'); };")
    try:
        page.goto(f"http://127.0.0.1:{viewer.port}/", wait_until="commit")
        wait_for(page, lambda said: "The page could not start: no wasm. Load it again" in said, 15.0)
    finally:
        viewer.shut()
        page.close()


def test_one_file_with_an_error_is_named_and_the_others_work(chromium: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = {**scripts.modules(), "panel/charts.js": "this is no JavaScript"}
    monkeypatch.setattr(scripts, "modules", lambda: broken)
    covered.cache_clear()
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 640, 400, drawn=False)
    try:
        viewer.open("rope")
        page.goto(f"http://127.0.0.1:{viewer.port}/", wait_until="commit")
        page.wait_for_selector("#springtide-missing", timeout=10_000)
        notice = page.inner_text("#springtide-missing")
        assert "A part of this page did not start: charts, share. The rest works." in notice
        wait_for(page, lambda words: words == "")
        page.get_by_role("button", name="Close", exact=True).click()
        page.wait_for_selector("[data-springtide-icon=Pause]")  # fields.js has dressed the buttons
    finally:
        covered.cache_clear()
        viewer.shut()
        page.close()


def test_without_storage_and_language_the_page_works(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    page, errors = new_page(chromium, 640, 400, False), []
    page.add_init_script(REFUSED + BAD_LANGUAGE)
    page.on("pageerror", lambda error: errors.append(str(error)))
    try:
        page.goto(f"http://127.0.0.1:{viewer.port}/")
        page.get_by_role("tab", name="View", exact=True).click(timeout=60_000)
        dark = page.get_by_role("button", name="Dark", exact=True)
        for pressed in ("true", "false"):
            dark.click()
            page.wait_for_function(
                "is => document.querySelector('[data-springtide-act=dark]').ariaPressed === is", arg=pressed
            )
        assert page.locator("[role=slider][tabindex='0']").count() > 0  # accessibility.js has described them
        assert page.evaluate("Object.keys(window).filter(name => /springtide/i.test(name))") == ["__springtide"]
        assert errors == []
    finally:
        page.close()
        viewer.shut()


@pytest.mark.long
def test_no_link_leads_the_page_to_another_server(chromium: Any) -> None:
    """What viser's client gets from there may be JavaScript, which would run as if it were ours."""
    key = "k" * 16
    viewer = Viewer("127.0.0.1", 0, access=Access(key=key))
    page = new_page(chromium, 640, 400, drawn=False)
    with socket.create_server(("127.0.0.1", 0)) as other:
        there = f"localhost:{other.getsockname()[1]}"
        asked = f"websocket=ws://{there}&playbackPath=http://{there}/x&scene=rope&stiffness=3000"
        try:
            viewer.open("rope")
            page.goto(f"http://127.0.0.1:{viewer.port}/{key}/?{asked}&fixedDpr=0.2", wait_until="commit")
            page.wait_for_selector(".springtide-panel[data-state]")
            page.wait_for_function("!location.search.includes('websocket')")
            assert page.evaluate("location.href").endswith(f"{key}/index.html?scene=rope&stiffness=3000&fixedDpr=0.2")
            end = time.monotonic() + 30.0
            while viewer.settings.params.stiffness != 3000.0:  # the rest of the link counts
                assert time.monotonic() < end
                page.wait_for_timeout(50)
            other.setblocking(False)
            with pytest.raises(BlockingIOError):
                other.accept()
        finally:
            viewer.shut()
            page.close()


@pytest.mark.long
def test_without_viser_s_inner_object_the_page_still_works(chromium: Any) -> None:
    """The page's own scripts find nothing: plain water, and no error."""
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("square_sea")
        page, errors = new_page(chromium, 480, 320, False), []
        page.add_init_script("Object.defineProperty(window, '__viserMutable', {get: () => undefined, set: () => {}})")
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(f"http://127.0.0.1:{viewer.port}/")
        page.get_by_role("button", name="Pause", exact=True).click()
        until = time.monotonic() + 30.0
        while viewer.loop.run.running and time.monotonic() < until:
            page.wait_for_timeout(50)
        assert not viewer.loop.run.running
        assert errors == []
        page.close()
    finally:
        viewer.shut()
