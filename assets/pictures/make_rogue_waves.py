"""Pictures of the breather and of the Draupner wave at their highest, as a browser draws them.

    python assets/pictures/make_rogue_waves.py

needs playwright and a Chromium on the search path. A frame takes seconds where there is no graphics card.
"""

import shutil
from concurrent.futures import Future
from pathlib import Path

from playwright.sync_api import sync_playwright

from app.messages import Advance
from app.scenes.square_sea.parameters import PRESETS, SquareSeaParams
from app.server.viewer import Viewer

MOMENTS = {"Peregrine breather": ("breather", 301.7), "Draupner": ("draupner", 58.6)}  # preset -> file, time [s]
SIZE = {"width": 1100, "height": 620}  # [pixels]
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 40.0  # [s] for the shaders of the page, and for its last frame
NO_NOTES = "[class*=Notif], #springtide-slow, #springtide-time { display: none !important }"


def main() -> None:
    """Take both pictures."""
    browser_path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))
    lab = Viewer("127.0.0.1", 0)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=browser_path, args=FLAGS)
        page = browser.new_page(viewport=SIZE)  # type: ignore[arg-type]
        for number, (preset, (name, t)) in enumerate(MOMENTS.items()):
            lab.open("square_sea", SquareSeaParams(**PRESETS[preset]), paused=True)
            page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo&fixedDpr=1&picture={number}")
            page.add_style_tag(content=NO_NOTES)
            page.wait_for_timeout(1e3 * PATIENCE)
            answer: Future[float] = Future()
            assert lab.loop is not None
            lab.loop.commands.put(Advance(t, answer))
            while not answer.done():
                page.wait_for_timeout(200)
            page.wait_for_timeout(1e3 * PATIENCE)
            page.screenshot(path=Path(__file__).with_name(f"{name}.jpg"), type="jpeg", quality=85, timeout=120_000)
        browser.close()
    lab.shut()


if __name__ == "__main__":
    main()
