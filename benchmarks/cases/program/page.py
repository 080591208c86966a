"""Processor time of the page in a browser that draws nothing: at rest, and while a scene runs."""

import importlib.util
import shutil
from typing import Any

from app.messages import Pause
from benchmarks.labs import viewer_here

BROWSER_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NO_PIXELS = """const calls = ["clear", "drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"];
for (const call of calls)
    WebGL2RenderingContext.prototype[call] = () => {};"""
# Ends all drawing of the scene, after the next frame; the page takes what the lab sends as before.
DRAW_NO_MORE = """() => { const { scene } = window.__viserMutable, earlier = scene.onBeforeRender;
    scene.onBeforeRender = function (renderer, ...others) {
        scene.onBeforeRender = earlier;
        earlier.call(this, renderer, ...others);
        renderer.render = () => {};
    }; }"""
SETTLING = 5000  # [ms] after the page is there, or a pause


def chromium_path() -> str | None:
    """Path of Chromium; None if it or its driver is not installed."""
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    return found if importlib.util.find_spec("playwright") else None


def measured(viewer: Any, page: Any, seconds: float) -> dict[str, float]:
    """Processor time of the page's thread in each second, over `seconds` [s].

    All tasks: also what the browser paints, and what it spends between tasks.
    """
    tools = page.context.new_cdp_session(page)
    tools.send("Performance.enable", {"timeDomain": "threadTicks"})

    def read() -> dict[str, float]:
        return {one["name"]: one["value"] for one in tools.send("Performance.getMetrics")["metrics"]}

    before, shown = read(), viewer.served.shown
    page.wait_for_timeout(1000 * seconds)
    after = read()
    tools.detach()
    spent = {name: (after[name] - before[name]) / seconds for name in before}
    return {
        "scripts [ms/s]": 1e3 * spent["ScriptDuration"],
        "style, layout [ms/s]": 1e3 * (spent["RecalcStyleDuration"] + spent["LayoutDuration"]),
        "all tasks [ms/s]": 1e3 * spent["TaskDuration"],
        "styles [1/s]": spent["RecalcStyleCount"],
        "frames [1/s]": (viewer.served.shown - shown) / seconds,
    }


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """The rope, running and paused. Without Chromium no row. Quick: 2 s."""
    path, seconds = chromium_path(), 2.0 if quick else 10.0
    if path is None:
        return []
    from playwright.sync_api import sync_playwright  # type: ignore[import-not-found]

    with viewer_here(shaders=True) as viewer, sync_playwright() as driver:
        viewer.open("rope")
        browser = driver.chromium.launch(executable_path=path, args=BROWSER_FLAGS)
        page = browser.new_page(viewport={"width": 1000, "height": 700})
        page.add_init_script(NO_PIXELS)
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2")
        page.wait_for_selector("#springtide-cover.springtide-hidden", state="attached")
        page.wait_for_timeout(SETTLING)
        found = [{"state": "running", **measured(viewer, page, seconds)}]
        page.evaluate(DRAW_NO_MORE)
        page.wait_for_timeout(SETTLING)
        found.append({"state": "running, nothing drawn", **measured(viewer, page, seconds)})
        page.reload()
        page.wait_for_selector("#springtide-cover.springtide-hidden", state="attached")
        viewer.loop.commands.put(Pause())
        page.wait_for_timeout(SETTLING)
        found.append({"state": "paused", **measured(viewer, page, seconds)})
        browser.close()
    return found
