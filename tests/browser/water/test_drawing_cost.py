"""Cost of a frame of each scene, in frames of three.js's own ocean.

In a browser that draws in software the cost is the processor time of Chromium's GPU process for one picture of a paused
moment, 640 x 400. Both pages are drawn in turns in one browser, and only their ratio is of use. Where there is a
graphics processor, it is the time until a picture of 1920 x 1080 is drawn. `python -m pytest -m stress
tests/browser/water/test_drawing_cost.py -s` prints both.
"""

import contextlib
import shutil
import statistics
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from app.messages import Pause
from app.server.viewer import Viewer
from tests.browser.conftest import CHOOSE, Chromium, new_page

WIDTH, HEIGHT = 640, 400  # [pixels]
LARGE = 1920, 1080  # [pixels]
TURNS = 5
PICTURES = 200  # timed on a graphics processor
MIN_TIME = 0.4  # [s] of a measurement: the browser counts processor time in hundredths of a second
WARM_UP = 12  # pictures: the first sets the number of pixels, and each compiles a program of the sea
PAGE = Path(__file__).with_name("three_ocean.html")
SCENES = {
    "square sea": ("square_sea", ""),
    "radial sea": ("radial_sea", ""),
    "burning rig": ("radial_sea", "Burning rig"),
    "mooring": ("mooring", ""),
    "rope": ("rope", ""),
    "race": ("race", ""),
    "cloth": ("cloth", ""),
}
# From the next frame on viser's own frames of the scene draw nothing; `drawOne()` draws one, waits for it by reading a
# pixel, and returns the number of its triangles.
TAKE_OVER = """() => { const viewer = window.__viserMutable, scene = viewer.scene, earlier = scene.onBeforeRender;
    scene.onBeforeRender = function (renderer, of, camera, target) {
        if (!window.drawOne && of === scene && camera === viewer.camera) {
            const own = renderer.render.springtideEarlier ?? renderer.render; // frames.js would draw no frame twice
            const draw = own.bind(renderer), gl = renderer.getContext(), pixel = new Uint8Array(4);
            window.drawOne = () => {
                draw(scene, camera);
                const triangles = renderer.info.render.triangles;
                gl.bindFramebuffer(gl.FRAMEBUFFER, null);
                gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
                return triangles;
            };
            renderer.render = (of, ...more) => { if (of !== scene) draw(of, ...more); };
        }
        return earlier.call(this, renderer, of, camera, target);
    };
    viewer.requestRender(); }"""
# Times [ms] of pictures, each waited for; the first ones compile programs.
TIME = """count => { const times = [];
    for (let k = -20; k < count; k++) {
        const start = performance.now();
        drawOne();
        if (k >= 0) times.push(performance.now() - start);
    }
    return times; }"""
RENDERER = """() => { const gl = document.createElement("canvas").getContext("webgl2");
    return gl?.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL) ?? "no WebGL 2"; }"""
# A Chromium without a window takes the graphics processor. On Linux it needs to be told how.
GRAPHICS_FLAGS = ["--no-sandbox", "--disable-background-networking", "--enable-gpu", "--ignore-gpu-blocklist"]
VULKAN_FLAGS = [
    "--use-angle=vulkan",
    "--enable-features=Vulkan,DefaultANGLEVulkan,VulkanFromANGLE",
    "--disable-vulkan-surface",
]
SOFTWARE = ("SwiftShader", "llvmpipe", "Microsoft Basic", "no WebGL 2")


class GraphicsClock:
    """The processor time of the process that draws the pages of a browser."""

    def __init__(self, chromium: Any) -> None:
        self.session = chromium.new_browser_cdp_session()

    def now(self) -> float:
        """Time [s] since that process began."""
        processes = self.session.send("SystemInfo.getProcessInfo")["processInfo"]
        (gpu,) = [process for process in processes if process["type"] == "GPU"]
        return float(gpu["cpuTime"])

    def picture(self, page: Any) -> float:
        """Processor time [s] of one picture of a page that has `drawOne`."""
        count, start, spent = 0, self.now(), 0.0
        while spent < MIN_TIME:
            page.evaluate("drawOne()")
            count += 1
            spent = self.now() - start
        return spent / count


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of three.js, from its package; the test is skipped where it is not to be had."""
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("no npm on the search path")
    folder = tmp_path_factory.mktemp("three")
    command = [npm, "install", "--no-audit", "--no-fund", "--prefix", str(folder), "three"]
    try:
        subprocess.run(command, check=True, capture_output=True, timeout=120, cwd=folder)
    except (subprocess.SubprocessError, OSError) as error:
        pytest.skip(f"npm has no package three: {error}")
    return folder / "node_modules" / "three"


def open_ocean(browser: Any, three: Path, width: int, height: int) -> Any:
    """A page with three.js's ocean; its files come from the package, not from a server."""

    def answer(route: Any) -> None:
        name = route.request.url.removeprefix("http://ocean.invalid/")
        if name == "":
            route.fulfill(body=PAGE.read_text("utf-8"), content_type="text/html")
        elif (three / name).is_file():
            route.fulfill(body=(three / name).read_text("utf-8"), content_type="text/javascript")
        else:
            route.abort()

    page = new_page(browser, width, height, drawn=True)
    page.route("**/*", answer)
    page.goto("http://ocean.invalid/")
    page.wait_for_function("window.drawOne", timeout=60_000)
    return page


@pytest.fixture(scope="module")
def ocean(chromium: Any, three: Path) -> Iterator[Any]:
    page = open_ocean(chromium, three, WIDTH, HEIGHT)
    yield page
    page.close()


@pytest.fixture(scope="module")
def graphics(chromium: Any, three: Path) -> Iterator[tuple[Any, float]]:
    """A Chromium that draws on a graphics processor, and its time [ms] of a picture of three.js's ocean."""
    flags = GRAPHICS_FLAGS + (VULKAN_FLAGS if sys.platform == "linux" else [])
    browser = Chromium(chromium.driver, flags)
    try:
        page = browser.new_page()
        name = page.evaluate(RENDERER)
        page.close()
        if any(software in name for software in SOFTWARE):
            pytest.skip(f"no graphics processor: {name}")
        page = open_ocean(browser, three, *LARGE)
        time = statistics.median(page.evaluate(TIME, PICTURES))
        page.close()
        print(f"\n{name}, three.js's ocean: {1000 / time:.0f} frames a second", end="")
        yield browser, time
    finally:
        browser.close()


@contextlib.contextmanager
def paused(browser: Any, name: str, width: int, height: int) -> Iterator[Any]:
    """A page with a moment of a scene, and with `drawOne`; what it draws is without errors."""
    errors: list[str] = []
    scene, preset = SCENES[name]
    lab = Viewer("127.0.0.1", 0)
    page = new_page(browser, width, height, drawn=True)
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.add_init_script("localStorage.setItem('springtide-quality', 'low')")
    try:
        lab.open(scene)
        if preset:
            lab.settings.load(preset)
        page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo")
        page.wait_for_function("window.__viserMutable?.scene?.environment", timeout=120_000)
        while lab.loop.scene.time < 1.0:
            page.wait_for_timeout(200)
        lab.loop.commands.put(Pause())
        page.evaluate(TAKE_OVER)
        page.evaluate(CHOOSE, "high")  # a frame that shows the moment already is not drawn again
        page.wait_for_function("window.drawOne", timeout=300_000)
        yield page
        assert errors == []  # such as a program that does not compile on this graphics processor
    finally:
        page.close()
        lab.shut()


@pytest.mark.stress  # minutes of drawing
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", SCENES)
def test_a_picture_costs_as_many_pictures_of_three_s_ocean(name: str, chromium: Any, ocean: Any) -> None:
    clock = GraphicsClock(chromium)
    with paused(chromium, name, WIDTH, HEIGHT) as page:
        for quality in ("high", "low"):
            page.evaluate(CHOOSE, quality)
            triangles = [page.evaluate("drawOne()") for _ in range(WARM_UP)][-1]
            turns = [clock.picture(page) / clock.picture(ocean) for _ in range(TURNS)]
            print(
                f"\n{name}, {quality}: {statistics.median(turns):.2f} of three.js's ocean, {triangles} triangles",
                end="",
            )
            assert triangles > 0


@pytest.mark.stress  # it needs a graphics processor
@pytest.mark.parametrize("name", SCENES)
def test_pictures_a_second_on_a_graphics_processor(name: str, graphics: tuple[Any, float]) -> None:
    browser, ocean = graphics
    with paused(browser, name, *LARGE) as page:
        for quality in ("high", "low"):
            page.evaluate(CHOOSE, quality)
            time = statistics.median(page.evaluate(TIME, PICTURES))
            print(
                f"\n{name}, {quality}: {1000 / time:.0f} frames a second, {time / ocean:.2f} of three.js's ocean",
                end="",
            )
