"""A sea waits for its programs without stopping the page, and shows plain water or its last programs meanwhile.

The browser of these tests blocks the page while it compiles; KHR_parallel_shader_compile is imitated.
"""

import contextlib
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from app.render.injection import injector_of
from app.server.viewer import Viewer
from tests.browser.conftest import CHOOSE, WITH_CARD, new_page

# Mark the programs of the sea, and that of plain water.
MARKED = """(() => { const P = WebGL2RenderingContext.prototype, { shaderSource, attachShader } = P;
    P.shaderSource = function (shader, text) {
        [shader.isOfSea, shader.isPlain] = [/uniform highp sampler2D (sea|sky)/.test(text), text.includes("standIn")];
        shaderSource.call(this, shader, text); };
    P.attachShader = function (program, shader) {
        program.isOfSea ||= shader.isOfSea;
        program.isPlain ||= shader.isPlain;
        attachShader.call(this, program, shader); };
})();"""
# A browser with the extension, in which the programs of the sea are ready when `held` says so: all but that of plain
# water.
BESIDE = """(() => { const P = WebGL2RenderingContext.prototype, COMPLETION_STATUS = 0x91B1;
    const { getExtension, getProgramParameter } = P;
    window.held = true;
    P.getExtension = function (name) {
        const isAsked = name === "KHR_parallel_shader_compile";
        return isAsked ? { COMPLETION_STATUS_KHR: COMPLETION_STATUS } : getExtension.call(this, name); };
    P.getProgramParameter = function (program, what) {
        const isHeld = window.held && program.isOfSea && !program.isPlain && !program.isDone;
        if (what === COMPLETION_STATUS) return !isHeld && (program.isDone = true);
        if (isHeld) window.hasWaited = true;
        return getProgramParameter.call(this, program, what); };
})();"""
# For each frame of the browser in which programs of the sea are used for the first time, how many; and whether the very
# first one is that of plain water.
FIRST_USES = """(() => { const P = WebGL2RenderingContext.prototype, { useProgram } = P;
    let frame = 0;
    const known = new Set(), count = () => { frame += 1; requestAnimationFrame(count); };
    requestAnimationFrame(count);
    window.firstUses = {};
    P.useProgram = function (program) {
        if (program?.isOfSea && !known.has(program)) window.firstUses[frame] = (window.firstUses[frame] ?? 0) + 1;
        if (program?.isOfSea) window.isPlainFirst ??= program.isPlain;
        known.add(program);
        useProgram.call(this, program); };
})();"""
# The shaders of the sea with which the page draws.
DRAWN = """() => { const found = [];
    window.__viserMutable?.scene?.traverseVisible(({ material }) => {
        const key = material?.userData?.springtide;
        if (key?.startsWith("springtide-water") || key?.startsWith("springtide-dome")) found.push(key); });
    return found.sort(); }"""
# The words on the cover; "" if it is not there.
COVER = """() => document.getElementById("springtide-cover").classList.contains("springtide-hidden") ? ""
    : document.getElementById("springtide-cover-words").innerText"""
# The colour behind a sea whose sky is not ready; empty if there is none.
STAND_IN = """() => { const color = document.documentElement.style.getPropertyValue("--springtide-sky");
    return (color.match(/[0-9]+/g) ?? []).map(Number); }"""


@contextlib.contextmanager
def open_sea(chromium: Any, script: str) -> Iterator[tuple[Viewer, Any]]:
    """A server and a page without pixels, with this script, on a square sea at quality low."""
    lab = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 400, 300, drawn=False)
    page.add_init_script(f"{MARKED} {script} localStorage.setItem('springtide-quality', 'low');")
    try:
        lab.open("square_sea")
        page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo")
        yield lab, page
    finally:
        page.close()
        lab.shut()


def wait_for(page: Any, shaders: list[str]) -> None:
    page.wait_for_function(f"shaders => ({DRAWN})().join() === shaders.join()", arg=shaders, timeout=60_000)


@pytest.mark.long
def test_a_page_never_waits_for_a_program_of_the_sea(chromium: Any) -> None:
    with open_sea(chromium, BESIDE) as (lab, page):
        wait_for(page, ["springtide-water/sea plain"])
        # The cover stays until the picture is complete, with the mean colour of the sky below it.
        page.wait_for_function(f"({COVER})() === 'Preparing the picture …'", timeout=60_000)
        page.wait_for_timeout(1500)
        assert page.evaluate(COVER) == "Preparing the picture …"
        red, _, blue = page.evaluate(STAND_IN)
        assert blue > red
        page.evaluate("window.held = false")
        wait_for(page, ["springtide-dome in tiles with details 0", "springtide-water/sea lit"])
        page.wait_for_function(f"({COVER})() === ''", timeout=60_000)
        # Other programs are needed for another quality: until they are ready, the last ones draw.
        page.evaluate("window.held = true")
        page.evaluate(CHOOSE, "high")
        page.wait_for_function("window.__springtide.quality.details() === 2")
        page.wait_for_timeout(1000)
        assert page.evaluate(DRAWN) == ["springtide-dome in tiles with details 0", "springtide-water/sea lit"]
        assert page.evaluate(COVER) == ""
        page.evaluate("window.held = false")
        wait_for(page, ["springtide-dome in tiles", "springtide-water/sea lit"])
        assert not page.evaluate("window.hasWaited === true")
        lab.settings.load("Storm arriving")
        page.wait_for_function(f"(([red, green, blue]) => red === green && green === blue)(({STAND_IN})())")
        lab.open("rope")  # it has the page's own sky
        page.wait_for_function(f"({STAND_IN})().length === 0")


@pytest.mark.long
def test_a_browser_that_waits_for_programs_gets_one_in_a_frame(chromium: Any) -> None:
    with open_sea(chromium, FIRST_USES) as (_, page):
        wait_for(page, ["springtide-dome in tiles with details 0", "springtide-water/sea lit"])
        page.wait_for_timeout(500)
        uses = page.evaluate("Object.values(window.firstUses)")
        assert sum(uses) >= 6
        assert max(uses) <= 2  # the surface and the sky are first drawn together
        assert page.evaluate("window.isPlainFirst")


@pytest.mark.long
def test_plain_water_does_not_wait_for_the_photograph_of_the_sky(chromium: Any) -> None:
    late = """(() => { let photograph = null;
        window.held = true;
        const wait = () => { const scene = window.__viserMutable?.scene;
            if (!scene) return void setTimeout(wait, 1);
            photograph = scene.environment;
            Object.defineProperty(scene, "environment", {
                get: () => (window.held ? null : photograph), set: (value) => { photograph = value; } }); };
        wait(); })();"""
    with open_sea(chromium, late) as (_, page):
        wait_for(page, ["springtide-water/sea plain"])
        page.evaluate("window.held = false")
        wait_for(page, ["springtide-dome in tiles with details 0", "springtide-water/sea lit"])


@pytest.mark.long
@pytest.mark.parametrize(("script", "width"), [("", 256), (WITH_CARD, 1024)])
def test_the_photograph_of_the_sky_is_small_without_a_graphics_card(chromium: Any, script: str, width: int) -> None:
    """It is blurred before it is first drawn: in software four seconds for the whole one."""
    with open_sea(chromium, script) as (_, page):
        wait_for(page, ["springtide-dome in tiles with details 0", "springtide-water/sea lit"])
        assert page.evaluate("window.__viserMutable.scene.environment.image.width") == width


@pytest.mark.long
def test_an_image_for_the_server_waits_for_the_whole_sea(chromium: Any) -> None:
    with open_sea(chromium, BESIDE) as (lab, page):
        page.wait_for_function("window.__viserMutable?.scene?.environment")
        wait_for(page, ["springtide-water/sea plain"])
        (client,) = lab.server.get_clients().values()
        image = threading.Thread(target=client.get_render, args=(30, 40))
        image.start()
        while image.is_alive():
            page.wait_for_timeout(50)
        assert page.evaluate("window.hasWaited")
        assert "springtide-water/sea lit" in page.evaluate(DRAWN)


@pytest.mark.long
@pytest.mark.parametrize("script", [BESIDE.replace("window.held = true;", "window.held = false;"), FIRST_USES])
def test_the_server_learns_that_the_sea_is_drawn_by_its_shader(chromium: Any, script: str) -> None:
    with open_sea(chromium, script) as (lab, page):
        injector = injector_of(lab.server)
        assert injector is not None
        while not injector.is_active("/sea"):
            page.wait_for_timeout(50)
        assert page.evaluate(DRAWN) == ["springtide-dome in tiles with details 0", "springtide-water/sea lit"]
