"""A real Chromium for the browser tests, rendering in software: slow, but the same everywhere."""

import base64
import contextlib
import faulthandler
import gc
import os
import shutil
import sys
import tempfile
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import psutil
import pytest

from app.messages import Pause
from app.server.viewer import Viewer

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
MAX_TEMPORARY = 50  # characters of the path of a folder for temporary files
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-gpu-compositing",  # the page around the picture is put together without it: a third less
]
PIXEL_RATIO = 0.2  # drawn pixels per pixel of the page, in each direction
# A software renderer takes most of the processor. If a test reads no pixel, shaders are trivial, as those of a sea take
# seconds to compile, and nothing is drawn; the rest of the page works as usual. If it reads the pixels of one kind of
# object, only fragment shaders with a word of this kind are real, and all others return one colour; or only those
# with a word of no interest do. A page without drawing draws once it sets `drawsPixels`.
FLAT_SHADERS = """const put = WebGL2RenderingContext.prototype.shaderSource;
WebGL2RenderingContext.prototype.shaderSource = function (shader, source) {
    const fragment = this.getShaderParameter(shader, this.SHADER_TYPE) === this.FRAGMENT_SHADER;
    const flat = "#version 300 es\\nout lowp vec4 color; void main() { color = vec4(0.3, 0.5, 0.6, 1.0); }";
    put.call(this, shader, fragment && IS_FLAT ? flat : source);
};"""
NO_PIXELS = """
for (const call of ["clear", "drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
    const draw = WebGL2RenderingContext.prototype[call];
    WebGL2RenderingContext.prototype[call] = function (...all) { if (window.drawsPixels) draw.apply(this, all); };
}"""
# The drawn vertices of a mesh, as the bytes of single-precision numbers in base 64: a list of 50,000 numbers would take
# seconds to arrive.
VERTICES = """name => { const ref = window.__viserMutable?.nodeRefFromName?.[name]; let found = null;
    if (ref) ref.traverse(o => { if (o.isMesh && !found) found = o; });
    if (!found) return "";
    const bytes = new Uint8Array(new Float32Array(found.geometry.attributes.position.array).buffer);
    let text = "";
    for (let at = 0; at < bytes.length; at += 4096) text += String.fromCharCode(...bytes.subarray(at, at + 4096));
    return btoa(text); }"""
# Position on the page [pixels] of a point of the scene [m].
PIXEL = """point => { const viewer = window.__viserMutable, camera = viewer.camera;
    const nodes = Object.entries(viewer.nodeRefFromName);
    const top = nodes.find(([name, node]) => node && name.split("/").length === 2)[1];
    const box = viewer.canvas.getBoundingClientRect(), place = camera.position.clone().set(...point);
    top.parent.localToWorld(place).project(camera);
    return [box.left + box.width * (1 + place.x) / 2, box.top + box.height * (1 - place.y) / 2]; }"""
# Choose a quality, as another tab of the browser does.
CHOOSE = """quality => { localStorage.setItem("springtide-quality", quality);
    window.dispatchEvent(new StorageEvent("storage", { key: "springtide-quality" })); }"""
# As if the browser drew with a graphics card: the parameter is UNMASKED_RENDERER_WEBGL.
WITH_CARD = """const get = WebGL2RenderingContext.prototype.getParameter;
WebGL2RenderingContext.prototype.getParameter = function (name) {
    return name === 0x9246 ? "A graphics card" : get.call(this, name); };"""
# The notes of viser and of the lab on slow drawing, and the time line, which cover the picture.
NO_NOTES = "[class*=Notif], #springtide-slow, #springtide-time { display: none !important }"
STALLED = 60.0  # [s] without data after which a page is reloaded, with a warning
# Harmless logs of viser itself: its drag layer at each drag of a node.
HARMLESS_ERRORS = ("preventDefault inside passive",)
# The same when one scene or preset follows another: viser 1.1's client collects the updates of a frame and applies them
# after its removals, if a slow page takes both in one frame (MessageHandler.tsx). The server sends no update after a
# removal.
LATE_UPDATE = "Tried to update non-existent component"
# Removes float targets from a browser. viser's client still tries to draw into them, once with each photograph.
NO_FLOATS = """for (const name of ["getExtension", "getSupportedExtensions"]) {
    const get = WebGL2RenderingContext.prototype[name], isFloat = (one) => /color_buffer|texture_float/.test(one);
    WebGL2RenderingContext.prototype[name] = function (...all) {
        const found = isFloat(all[0]) ? null : get.apply(this, all);
        return Array.isArray(found) ? found.filter((one) => !isFloat(one)) : found; };
}"""
LOADING_ERRORS = "renderTarget is not in UnsignedByteType"
HOLD_TIME = 5.0  # [s] after which a drag that grabs nothing is repeated
STUCK = 0.6  # of the time of a test, after which its browser is ended


def new_page(chromium: Any, width: int, height: int, drawn: bool | str, flat: str = "", **device: Any) -> Any:
    """drawn: True with pixels, or a word in the fragment shaders that are kept. flat: with `drawn` True, a word in
    those that are replaced. device: options of Playwright's."""
    page = chromium.new_page(viewport={"width": width, "height": height}, **device)
    if drawn is not True or flat:
        word = flat or drawn or "no shader has this"
        page.add_init_script(FLAT_SHADERS.replace("IS_FLAT", f'{"" if flat else "!"}source.includes("{word}")'))
    if drawn is False:
        page.add_init_script(NO_PIXELS)
    return page


def surroundings() -> dict[str, str]:
    """The environment of a browser: its socket lies in the folder for temporary files, and has a name of 108 bytes."""
    is_long = os.name == "posix" and len(tempfile.gettempdir()) > MAX_TEMPORARY
    return {**os.environ, "TMPDIR": "/tmp"} if is_long else {**os.environ}


@pytest.fixture(autouse=True)
def released_where_it_waits(request: pytest.FixtureRequest) -> Iterator[None]:
    """Print where a test waits for its browser, and end the browser, so that the test fails and is repeated.

    A call of Playwright that waits for a page has no limit, and no traceback of threads shows greenlets.
    """
    greenlet = pytest.importorskip("greenlet", reason="playwright is not installed").greenlet
    mark = request.node.get_closest_marker("timeout")
    limit = float(mark.args[0] if mark else request.config.getini("timeout"))

    def release() -> None:
        with request.config.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
            print(f"{request.node.nodeid} waits:", file=sys.stderr)
            for one in gc.get_objects():
                if isinstance(one, greenlet) and one.gr_frame is not None:
                    traceback.print_stack(one.gr_frame, limit=8, file=sys.stderr)
            faulthandler.dump_traceback(file=sys.__stderr__)
        for process in psutil.Process().children(recursive=True):
            with contextlib.suppress(psutil.Error):
                if "--remote-debugging-pipe" in process.cmdline():
                    process.kill()

    timer = threading.Timer(STUCK * limit, release)
    timer.start()
    yield
    timer.cancel()


class Chromium:
    """A browser of Playwright's, with all its methods. One that has ended is started anew."""

    def __init__(self, driver: Any, flags: list[str] = FLAGS) -> None:
        self.driver, self.flags = driver, flags
        self.browser = self.start()

    def start(self) -> Any:
        return self.driver.chromium.launch(executable_path=CHROMIUM, args=self.flags, env=surroundings())

    def __getattr__(self, name: str) -> Any:
        if not self.browser.is_connected():
            self.browser = self.start()
        return getattr(self.browser, name)


@pytest.fixture(scope="package")
def chromium() -> Iterator[Any]:
    """A running Chromium; the test is skipped without one.

    It ends with the tests of this folder, as Playwright's event loop would disturb others.
    """
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no Chromium on the search path")
    with playwright.sync_playwright() as driver:
        browser = Chromium(driver)
        yield browser
        browser.close()


def vertices_of(page: Any, node: str) -> np.ndarray:
    """The drawn vertices (n, 3) of a mesh in a page; empty without them."""
    numbers = base64.b64decode(page.evaluate(VERTICES, node))
    return np.frombuffer(numbers, np.float32).astype(float).reshape(-1, 3)


class Tab:
    """One page on a server, drawn or without pixels, and the errors on it."""

    def __init__(
        self,
        chromium: Any,
        port: int,
        width: int = 900,
        height: int = 560,
        drawn: bool | str = False,
        flat: str = "",
        query: str = "",
        address: str = "",
        ratio: float = PIXEL_RATIO,
        **device: Any,
    ) -> None:
        """drawn, flat, device: as of `new_page`. address: of the page where a proxy shows it, with a "?". ratio: drawn
        pixels per pixel of the page, in each direction."""
        self.new_page = lambda: new_page(chromium, width, height, drawn, flat, **device)
        self.address = f"{address or f'http://127.0.0.1:{port}/?'}&hideViserLogo&fixedDpr={ratio:g}{query}"
        self.followed = 0  # number of scenes that were opened for it
        self.open()

    def open(self) -> None:
        """Open the page."""
        self.page = self.new_page()
        self.errors: list[str] = []
        self.page.on("console", self.note)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(self.address)

    def note(self, message: Any) -> None:
        if message.type == "error" and not any(harmless in message.text for harmless in HARMLESS_ERRORS):
            self.errors.append(message.text)

    def wait(self, condition: Callable[[], Any], seconds: float = 120.0) -> Any:
        """Run the page until the condition holds, and return its value; fail if it does not in time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            self.page.wait_for_timeout(50)
        pytest.fail(f"not within {seconds:g} s; page errors: {self.errors}")

    def follow(self, viewer: Viewer, scene: str, params: Any = None) -> None:
        """Open a scene instead of the open one, and wait until the page has all of it, its keys too."""
        if self.page.is_closed():
            self.open()
        viewer.open(scene, params)
        self.wait_for_panel(viewer)

    def wait_for_panel(self, viewer: Viewer) -> None:
        """Wait until the page has all of the open scene."""
        self.followed += 1
        mark = viewer.server.gui.add_html(f'<i class="springtide-mark-{self.followed}"></i>')
        is_there = lambda: self.page.locator(f".springtide-mark-{self.followed}").count()  # noqa: E731
        end = time.monotonic() + STALLED
        while not is_there() and time.monotonic() < end:
            self.page.wait_for_timeout(50)
        if not is_there():
            state = self.page.evaluate("[document.visibilityState, document.body.innerText.slice(0, 200)]")
            clients = len(viewer.server.get_clients())
            warnings.warn(f"a page of {clients} got nothing for {STALLED} s: {state}; {self.errors}", stacklevel=2)
            self.page.reload()
        self.wait(is_there)
        self.wait(self.page.locator("#springtide-cover.springtide-hidden").count)  # it lies over panel and picture
        mark.remove()
        self.errors = [error for error in self.errors if LATE_UPDATE not in error]

    def show(self, name: str) -> None:
        """Open one of the panel's tabs."""
        name_of_tab = self.page.get_by_role("tab", name=name, exact=True)
        self.wait(name_of_tab.is_visible, 20)
        name_of_tab.click()

    def vertices(self, node: str) -> np.ndarray:
        """The drawn vertices (n, 3) of a mesh in the page; empty without them."""
        return vertices_of(self.page, node)

    def pixel(self, point: Any) -> tuple[float, float]:
        """Position of a point [m] on the page."""
        x, y = self.page.evaluate(PIXEL, [float(c) for c in point])
        return x, y

    def drag(self, start: tuple[float, float], end: tuple[float, float], pause: int = 50) -> None:
        """Press at one pixel, move to another in steps, and hold; `release` ends the drag."""
        mouse = self.page.mouse
        mouse.move(*start)
        self.page.wait_for_timeout(500)  # a slow page must notice what is under the mouse
        mouse.down()
        for step in range(1, 9):
            mouse.move(start[0] + (end[0] - start[0]) * step / 8, start[1] + (end[1] - start[1]) * step / 8)
            self.page.wait_for_timeout(pause)

    def hold(
        self,
        start: Callable[[], tuple[float, float]],
        by: tuple[float, float],
        held: Callable[[], Any],
        pause: int = 50,
    ) -> None:
        """Drag from a pixel by some pixels until something is held; `release` lets it go.

        Repeated from the new position, if a slow page had not yet noticed the object under the mouse.
        """

        def is_held() -> bool:
            x, y = start()
            self.drag((x, y), (x + by[0], y + by[1]), pause)
            end = time.monotonic() + HOLD_TIME
            while not held():
                if time.monotonic() > end:
                    self.release()
                    return False
                self.page.wait_for_timeout(50)
            return True

        self.wait(is_held)

    def release(self) -> None:
        self.page.mouse.up()


@pytest.fixture(scope="package")
def one_page(chromium: Any) -> Iterator[tuple[Viewer, Tab]]:
    viewer = Viewer("127.0.0.1", 0)
    tab = Tab(chromium, viewer.port)
    yield viewer, tab
    tab.page.close()
    viewer.shut()


@pytest.fixture
def shown(request: pytest.FixtureRequest, one_page: tuple[Viewer, Tab]) -> Iterator[tuple[Viewer, Tab]]:
    """One viewer and one page for all modules, because a page is slow to load; each test's scene is opened on it."""
    viewer, tab = one_page
    tab.errors.clear()
    tab.follow(viewer, request.module.SCENE, getattr(request.module, "PARAMS", None))
    tab.wait(lambda: viewer.loop.run.counts["steps"] > 0)
    yield viewer, tab
    viewer.loop.commands.put(Pause())  # so that it takes no processor time from tests with pages of their own


@pytest.fixture
def open_tab(chromium: Any) -> Iterator[Callable[..., Tab]]:
    """Opens tabs and closes them after the test."""
    tabs: list[Tab] = []

    def new(port: int, **how: Any) -> Tab:
        tabs.append(Tab(chromium, port, **how))
        return tabs[-1]

    yield new
    for tab in tabs:
        tab.page.close()
