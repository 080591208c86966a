"""Pictures of the page for the README and the docs, as a browser draws them.

    python assets/pictures/make_pictures.py [NAME ... | gallery]

takes those that are named, or all; `gallery` is a small one of each preset. It needs playwright and a Chromium on the
search path. A frame takes seconds where there is no graphics card.
"""

import inspect
import shutil
import sys
import tempfile
from collections.abc import Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import Any, NamedTuple

from PIL import Image
from playwright.sync_api import sync_playwright

from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.student.session import Session
from app.lab.student.workbook import Workbook
from app.messages import Advance
from app.scenes import NAMES, scene_named
from app.scenes.setups import make_setup
from app.server.viewer import Viewer

FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 30.0  # [s] for the shaders of the page, and for its last frame
NO_NOTES = "[class*=Notif], #springtide-slow { display: none !important }"
FOLDER, SMALL = Path(__file__).with_name("presets"), (480, 300)  # of the gallery; [pixels]
# Picture of the gallery by which each scene is chosen in the panel, the part of it, and its size [pixels].
CHOSEN = {**{name: f"{name}_1" for name in NAMES}, "rope": "rope_7"}
PART, SMALLEST = (40, 25, 440, 275), (160, 100)
SETTLED = 14.0  # [s] for the page of a preset, and for its last frame
NO_PANEL = ".mantine-Paper-root, #springtide-time { display: none !important }"
# Scene or preset -> time [s] of its picture in the gallery.
MOMENTS = {
    "rope": 1.2, "race": 6.0, "cloth": 2.0, "square_sea": 20.0, "radial_sea": 20.0, "mooring": 10.0,
    "Storm arriving": 60.0, "Burning rig": 40.0, "Peregrine breather": 327.0, "Draupner": 59.4, "Steep storm": 21.7,
    "Steep waves split into groups": 200.0,
}  # fmt: skip


class Mistake(NamedTuple):
    """A function of a student in which an expression is another one."""

    file: str
    task: str
    right: str
    wrong: str


class Picture(NamedTuple):
    """A moment of a scene, and what the page shows of it.

    values: parameters beside those of the preset. mistake: of a student, which the panel names. tab: of the panel.
    """

    scene: str
    preset: str
    t: float  # [s]
    size: tuple[int, int] = (1280, 720)  # [pixels]
    values: Mapping[str, Any] = {}
    mistake: Mistake | None = None
    tab: str = ""


RK4 = {"integrator": "rk4"}
NO_DAMPING = Mistake("rope.py", "spring_force", " - damping * (np.asarray(v1) - np.asarray(v2))", "")
FEW_LINKS = Mistake("cloth.py", "cloth_links", "((0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0))", "((0, 1), (1, 0))")
PICTURES = {
    "rope": Picture("rope", "Over the sphere", 1.1),
    "race": Picture("race", "Undamped until chaos", 17.0, (1300, 700)),
    "cloth": Picture("cloth", "Drape over the sphere", 1.9, (1000, 560)),
    "spill": Picture("radial_sea", "Light crude spill 0.2 m", 17.0, (1000, 560)),
    "breather": Picture("square_sea", "Peregrine breather", 327.0, (1100, 620)),
    "draupner": Picture("square_sea", "Draupner", 59.4, (1100, 620)),
    "share": Picture("rope", "Over the sphere", 5.0, (1200, 760), {"plot_energy": True}, tab="Share"),
    "lab": Picture("rope", "Lab code: 10 points", 2.0, (1100, 760), RK4, NO_DAMPING),
    "lab_cloth": Picture("cloth", "Curtain", 4.0, (1100, 760), RK4, FEW_LINKS),
}


def session_with(mistake: Mistake, folder: Path) -> Session:
    """The lab of a student who has written one function, with a mistake."""
    tasks = load_tasks()
    make_folder(folder, tasks)
    source = inspect.getsource(next(task.function for task in tasks if task.name == mistake.task))
    assert mistake.right in source, f"{mistake.task} has no {mistake.right!r}"
    (folder / mistake.file).write_text(
        f"import numpy as np\n\n\n{source.replace(mistake.right, mistake.wrong)}", "utf-8"
    )
    return Session(folder, tasks)


def take(picture: Picture, browser: Any, folder: Path, path: Path) -> None:
    """Open a page at a moment of a scene, and write its picture."""
    session = session_with(picture.mistake, folder) if picture.mistake else None
    lab = Viewer("127.0.0.1", 0, session=session, workbook=Workbook(session.tasks, folder) if session else None)
    kind = scene_named(picture.scene)
    lab.open(kind.name, make_setup(kind, picture.preset, picture.values).params, paused=True)
    width, height = picture.size
    page = browser.new_page(viewport={"width": width, "height": height})
    page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo&fixedDpr=1")
    page.add_style_tag(content=NO_NOTES)
    page.wait_for_timeout(1e3 * PATIENCE)
    run_to(lab, page, picture.t)
    if picture.tab:
        page.get_by_role("tab", name=picture.tab, exact=True).click()
    if picture.mistake:
        verdict = page.locator(f"[data-function={picture.mistake.task}]")
        verdict.first.evaluate("one => one.scrollIntoView({ block: 'center' })")
    page.wait_for_timeout(1e3 * PATIENCE)
    page.screenshot(path=path, type="jpeg", quality=85, timeout=120_000)
    page.close()
    lab.shut()
    if session:
        session.close()


def run_to(lab: Viewer, page: Any, t: float) -> None:
    """Run for t seconds, or until the run diverges."""
    answer: Future[float] = Future()
    assert lab.loop is not None
    lab.loop.commands.put(Advance(t, answer))
    while not answer.done():
        page.wait_for_timeout(200)


def take_gallery(browser: Any) -> None:
    """Take a picture of each preset, without the panel."""
    FOLDER.mkdir(exist_ok=True)
    lab = Viewer("127.0.0.1", 0)
    page = browser.new_page(viewport={"width": SMALL[0], "height": SMALL[1]})
    for scene in NAMES:
        kind = scene_named(scene)
        for number, preset in enumerate(kind.presets, 1):
            values = {name: False for name in kind.plots if name in vars(kind.params())}
            lab.open(scene, make_setup(kind, preset, values).params, paused=True)
            page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo&fixedDpr=1&preset={number}")
            page.add_style_tag(content=NO_NOTES + NO_PANEL)
            page.wait_for_timeout(1e3 * SETTLED)
            run_to(lab, page, MOMENTS.get(preset, MOMENTS[scene]))
            page.wait_for_timeout(1e3 * SETTLED)
            page.screenshot(path=FOLDER / f"{scene}_{number}.jpg", type="jpeg", quality=80, timeout=120_000)
    page.close()
    lab.shut()
    for scene, name in CHOSEN.items():
        part = Image.open(FOLDER / f"{name}.jpg").crop(PART).resize(SMALLEST)
        part.save(FOLDER.parents[1] / "scenes" / f"{scene}.jpg", quality=70, optimize=True)


def main() -> None:
    """Take the pictures that are named, or all."""
    names = sys.argv[1:] or list(PICTURES)
    browser_path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))
    with sync_playwright() as driver, tempfile.TemporaryDirectory() as folder:
        browser = driver.chromium.launch(executable_path=browser_path, args=FLAGS)
        if names == ["gallery"]:
            take_gallery(browser)
        for name in () if names == ["gallery"] else names:
            take(PICTURES[name], browser, Path(folder) / name, Path(__file__).with_name(f"{name}.jpg"))
        browser.close()


if __name__ == "__main__":
    main()
