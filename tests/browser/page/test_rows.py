"""Each feature of the page in each browser: scenes, controls by mouse and by key, drags, files, failures, windows.

All rows of a browser share one window, and all browsers one lab. If a browser lacks something, the page says so.
"""

import contextlib
import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.commands.lab_class import make_server
from app.lab.course.answers import read_answers
from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.report.classroom import Classroom
from app.lab.student.workbook import Workbook
from app.messages import Pause, Play
from app.render import client_page
from app.render.scripts import before_tags
from app.scenes import NAMES, scene_named
from app.scenes.setups import read_query
from app.scenes.springs.rope_parameters import ROOT
from app.server.replay_file import replay_html
from app.server.viewer import Viewer
from app.server.web import page as served_page
from tests.browser.conftest import HARMLESS_ERRORS, LATE_UPDATE, LOADING_ERRORS, NO_FLOATS, PIXEL
from tests.browser.engines import SIZE, Engine, guarded, make
from tests.browser.page.test_beside import CAMERA
from tests.browser.page.test_engines import BUTTON, FIELD, RUNS, TAB, enter, named, until
from tests.browser.page.test_page import NO_WEBGL, REFUSED

ENGINES = ["chromium", *(pytest.param(name, marks=pytest.mark.long) for name in ("firefox", "webkit"))]
DRAWN = ("rope", "square_sea")  # scenes drawn within seconds; the long tests draw the others
FREE = (110, 520)  # [pixels] of the page, where there is nothing but the floor
# Error messages of the page, including the end of viser's client.
HOOK = """window.noted = [];
for (const kind of ["error", "warn"]) {
    const earlier = console[kind];
    console[kind] = (...all) => { window.noted.push([kind, all.map(String).join(" ")]); earlier.apply(console, all); };
}
addEventListener("error", (event) => window.noted.push(["error", event.message]));
addEventListener("unhandledrejection", (event) => window.noted.push(["error", String(event.reason)]));"""
NUMBERS = """const small = document.createElement("canvas"), pen = small.getContext("2d");
    [small.width, small.height] = [50, 35];
    pen.drawImage(document.querySelector("canvas[data-engine]"), 0, 0, 50, 35);
    const numbers = [...pen.getImageData(0, 0, 50, 35).data].filter((_, k) => k % 4 !== 3);
    const meanOf = (some) => some.reduce((sum, one) => sum + one, 0) / some.length;"""
STANDARD_DEVIATION = f"""{NUMBERS}
    const mean = meanOf(numbers);
    return Math.sqrt(meanOf(numbers.map((one) => (one - mean) ** 2)));"""
SKY_IS_BRIGHT = f"{NUMBERS} return window.__springtide.showsWhole() && meanOf(numbers.slice(0, 3 * 50 * 8)) > 60;"
SCENE_IS_SHOWN = (
    "const cover = document.getElementById('springtide-cover'); return cover.classList.contains('springtide-hidden');"
)
# Firefox has the focus where a window manager runs. Else no control that keys go to hears of it.
HAS_FOCUS = "return Document.prototype.hasFocus.call(document);"
THUMB = """[...document.querySelectorAll(".multi-slider-thumb")].find((one) => one.ariaLabel?.startsWith(NAME))"""
FOLDER = """[...document.querySelectorAll(".mantine-Paper-root > .mantine-Paper-root:first-child")]
    .find((one) => one.textContent.trim() === NAME)"""
CHECKBOX = """[...document.querySelectorAll("label")].find((one) => one.textContent.startsWith(NAME))
    .closest(".mantine-Flex-root").querySelector("input[type=checkbox]")"""
LAST_VERTEX = """window.__viserMutable?.nodeRefFromName?.["/rope"]?.children.find((one) => one.isMesh)
    ?.geometry.attributes.position.array.at(-1)"""
LIST = """[...document.querySelectorAll("label")].find((one) => one.textContent === NAME)
    .closest(".mantine-Flex-root").querySelector("input")"""
OPTION = """[...document.querySelectorAll("[role=option]")]
    .find((one) => one.textContent.trim().endsWith(NAME) && one.offsetHeight)"""
LABELLED = """[...document.querySelectorAll("input, textarea")].find((one) => one.ariaLabel?.startsWith(NAME))"""
PRESET = '[...document.querySelectorAll(".springtide-head .mantine-Select-input")].at(-1)'
SELECTED = """return document.querySelector('[data-dock-area^="gui-tabs-"] [role=tab][aria-selected=true]')
    .textContent.trim();"""


class Visit:
    """One browser on the lab."""

    def __init__(self, page: Engine, viewer: Viewer, address: str) -> None:
        self.page, self.viewer, self.address = page, viewer, address
        self.marks = 0
        self.is_shown = False  # False after a scene that the page did not show: the next try loads the page anew

    def open(self, query: str = "&fixedDpr=0.2") -> None:
        """Load the page of the lab."""
        self.page.open(f"{self.address}?hideViserLogo{query}")
        self.wait_for_panel()

    def follow(self, scene: str, params: Any = None) -> None:
        """Open a scene, and wait until the page has it."""
        self.viewer.open(scene, params)
        self.wait_for_panel()
        self.until(lambda: self.viewer.loop.run.counts["steps"] > 0, "the scene does not run")

    def distance(self) -> float:
        """From the camera to its target [m]."""
        numbers = np.array(self.camera())
        return float(np.linalg.norm(numbers[:3] - numbers[3:6]))

    def wait_for_panel(self) -> None:
        self.marks += 1
        mark = self.viewer.server.gui.add_html(f'<i class="springtide-mark-{self.marks}"></i>')
        try:
            self.page.wait(f"return document.querySelector('.springtide-mark-{self.marks}') !== null;")
        except AssertionError as error:
            buffer = self.viewer.server._websock_server.get_message_buffer()
            error.add_note(f"Last message by browser: {buffer.generator_cursors}, of {buffer.message_counter}")
            raise
        mark.remove()
        self.page.wait(SCENE_IS_SHOWN)

    def pixel(self, point: Any) -> list[float]:
        """Position on the page [pixels] of a point of the scene [m]."""
        return self.page.run(f"return ({PIXEL})({json.dumps([float(at) for at in point])});")

    def camera(self) -> list[float]:
        """Position and target of the camera [m], and its field of view."""
        return self.page.run(f"return ({CAMERA})();")

    def errors(self) -> list[str]:
        """Errors that the page has reported since the last call."""
        noted = self.page.run("return window.noted.splice(0);")
        harmless = (*HARMLESS_ERRORS, LATE_UPDATE)
        return [text for kind, text in noted if kind == "error" and not any(words in text for words in harmless)]

    def until(self, condition: Callable[[], Any], words: str) -> None:
        until(self.page, condition, words)

    def show(self, tab: str) -> None:
        """Choose one of the panel's tabs by the mouse; repeated if a slow page takes the press for a drag."""
        for _ in range(3):
            self.page.press_on(named(TAB, tab))
            for _ in range(30):
                if self.page.run(SELECTED) == tab:
                    return
                self.page.run("await new Promise((done) => setTimeout(done, 100));")
        raise AssertionError(f"the tab {tab} is not shown")

    def set(self, name: str, value: Any) -> None:
        self.viewer.settings.set(name, value)

    def param(self, name: str) -> Any:
        return getattr(self.viewer.settings.params, name)

    def drag(self, point: Any, by: tuple[float, float], done: Callable[[], Any], kind: str = "mouse") -> None:
        """Drag the object at a point of the scene [m] until something has happened; repeated on a slow page.

        point: a function for an object that moves.
        """
        for _ in range(4):
            x, y = self.pixel(point() if callable(point) else point)
            if kind == "mouse":
                self.page.move((x - 3, y), (x, y))
                self.page.run("await new Promise((done) => setTimeout(done, 400));")
            line = [(x + by[0] * k / 8, y + by[1] * k / 8) for k in range(9)]
            self.page.hold(*line, kind=kind)
            for _ in range(20):
                if done():
                    return self.page.release(kind=kind)
                self.page.run("await new Promise((done) => setTimeout(done, 100));")
            self.page.release(kind=kind)
        raise AssertionError("the drag moves nothing")


@pytest.fixture(scope="module")
def first_scripts() -> Iterator[list[str]]:
    """Scripts that run before all others in the page of each browser."""
    scripts = [HOOK]
    with pytest.MonkeyPatch.context() as patch:
        ours = lambda names: f"<script>{';'.join(scripts)}</script>{before_tags(names)}"  # noqa: E731
        patch.setattr(client_page, "before_tags", ours)
        served_page.covered.cache_clear()
        yield scripts
    served_page.covered.cache_clear()


@pytest.fixture
def with_script(first_scripts: list[str]) -> Iterator[Callable[[str], None]]:
    """Makes the page run one more script before all others, until the test ends."""

    def add(script: str) -> None:
        first_scripts.append(script)
        served_page.covered.cache_clear()

    yield add
    del first_scripts[1:]
    served_page.covered.cache_clear()


@pytest.fixture(scope="module")
def visits(first_scripts: list[str], chromium: Any) -> Iterator[Callable[[str], Visit]]:
    """A visit by the name of its browser; the page of the browser before is left."""
    viewer = Viewer("127.0.0.1", 0)
    found: dict[str, Visit] = {}

    def visit(name: str) -> Visit:
        for other, one in found.items():
            if other != name and not one.page.is_closed:
                one.page.open("about:blank")
        if name not in found or found[name].page.is_closed:
            found[name] = Visit(make(name, chromium), viewer, f"http://127.0.0.1:{viewer.port}/")
        return found[name]

    yield visit
    for one in found.values():
        one.page.close()
    viewer.shut()


@pytest.fixture(params=ENGINES)
def visit(request: pytest.FixtureRequest, visits: Callable[[str], Visit]) -> Iterator[Visit]:
    """The page of a browser with the rope."""
    found = visits(request.param)
    with guarded(found.page):
        href = found.page.run("return location.href;")
        is_usable = found.is_shown and href.startswith(f"{found.address}?") and "without=" not in href
        found.is_shown = False
        if is_usable and found.page.run("return !!window.noted;"):
            found.page.run("window.drawsPixels = false;")
            found.errors()
        else:
            found.viewer.open("rope")
            found.open()
        found.follow("rope")
        found.is_shown = True
        place, target = (np.array(at) for at in found.viewer.view.first_view(found.viewer.settings.params))
        away = pytest.approx(float(np.linalg.norm(place - target)), rel=1e-3)
        found.until(lambda: found.distance() == away, "the camera is not placed")  # later than the panel
        yield found
        found.viewer.loop.commands.put(Pause())


@pytest.fixture
def another_lab() -> Iterator[Callable[..., Viewer]]:
    """Opens labs, which end with the test."""
    viewers: list[Viewer] = []

    def new(port: int = 0) -> Viewer:
        viewers.append(Viewer("127.0.0.1", port))
        return viewers[-1]

    yield new
    for viewer in viewers:
        viewer.shut()


# Scenes


@pytest.mark.parametrize(
    "scene", [pytest.param(name, marks=() if name in DRAWN else pytest.mark.long) for name in NAMES]
)
def test_a_scene_runs_and_is_drawn_without_error(visit: Visit, scene: str) -> None:
    visit.page.run(
        """const put = WebGL2RenderingContext.prototype.linkProgram; window.programs = [];
        WebGL2RenderingContext.prototype.linkProgram = function (program) {
            window.programs.push([this, program]);
            put.call(this, program); };"""
    )
    visit.follow(scene)
    visit.page.run("window.drawsPixels = true;")
    time = visit.viewer.loop.scene.time
    visit.page.wait(f"const found = (() => {{ {STANDARD_DEVIATION} }})(); return found > 5;", 200)
    visit.page.run("window.drawsPixels = false;")
    visit.until(lambda: visit.viewer.loop.scene.time > time, "it does not run on")
    links = """return window.programs.filter(([gl, program]) => gl.isProgram(program))
        .map(([gl, program]) => gl.getProgramParameter(program, gl.LINK_STATUS));"""
    linked = visit.page.run(links)
    assert linked
    assert all(linked)
    assert visit.errors() == []


# The camera


def test_the_camera_turns_moves_and_comes_back(visit: Visit) -> None:
    first = visit.camera()
    visit.page.press(FREE, (150, 530), (190, 540))
    visit.until(lambda: not np.allclose(visit.camera()[:3], first[:3], atol=0.05), "no turn")
    assert visit.camera()[3:6] == pytest.approx(first[3:6], abs=1e-3)
    if visit.page.releases_right:
        visit.page.press(FREE, (150, 530), (190, 540), button=2)
        visit.until(lambda: not np.allclose(visit.camera()[3:6], first[3:6], atol=0.05), "no shift")
    visit.page.type("v")
    visit.until(lambda: np.allclose(visit.camera(), first, atol=0.02), "the camera does not come back")


def test_the_wheel_zooms(visit: Visit) -> None:
    first = visit.distance()
    visit.page.turn_wheel(FREE, 100)
    visit.until(lambda: 1.002 * first < visit.distance() < 1.2 * first, "no zoom")


def test_a_touchpad_zooms(visit: Visit) -> None:
    first = visit.distance()
    visit.page.turn_wheel(FREE, 12)
    visit.until(lambda: 1.002 * first < visit.distance() < 1.2 * first, "no zoom")


# Drags


def settled(visit: Visit, time: float = 1.5) -> None:
    """Have the scene run to a time [s], and pause."""
    visit.set("speed", 4.0)
    visit.until(lambda: visit.viewer.loop.scene.time > time, "it does not run")
    visit.viewer.loop.commands.put(Pause())
    visit.set("speed", 0.2)
    visit.until(lambda: not visit.viewer.loop.run.running, "it does not pause")
    visit.until(
        lambda: visit.viewer.served.shown_serial == visit.viewer.loop.latest.serial, "the last picture is not shown"
    )


def test_a_point_of_the_rope_is_marked_and_pulled(visit: Visit) -> None:
    settled(visit)
    before = visit.camera()
    scene = visit.viewer.scene
    point = scene.state.x[:, 0, 6].copy()
    x, y = visit.pixel(point)
    visit.page.move((x - 4, y), (x, y))
    visit.page.wait("return document.querySelector('#springtide-ring').hidden === false;")
    visit.viewer.loop.commands.put(Play())
    visit.drag(point, (60, -30), lambda: scene.handles.grab.grabbed is not None)
    visit.until(lambda: scene.handles.grab.grabbed is None, "it is not let go")
    assert visit.camera() == pytest.approx(before, abs=1e-6)
    assert visit.errors() == []


@pytest.mark.long
def test_a_point_of_the_cloth_is_pulled(visit: Visit) -> None:
    visit.follow("cloth")
    settled(visit, 0.5)
    point = visit.viewer.scene.state.x[:, 16, 10].copy()
    visit.viewer.loop.commands.put(Play())
    visit.drag(point, (-60, -30), lambda: visit.viewer.scene.grab.grabbed is not None)
    visit.until(lambda: visit.viewer.scene.grab.grabbed is None, "it is not let go")
    assert visit.errors() == []


def test_the_arrows_move_the_root(visit: Visit) -> None:
    root = lambda: visit.viewer.scene.handles.root.position[2]  # noqa: E731
    visit.drag(np.array(ROOT) + (0.0, 0.0, 0.2), (0, -50), lambda: root() > ROOT[2] + 0.1)
    assert visit.errors() == []


@pytest.mark.long
def test_the_arrows_move_the_sphere(visit: Visit) -> None:
    visit.viewer.settings.load("Over the sphere")
    visit.until(lambda: visit.viewer.loop.latest.frame.sphere is not None, "no sphere")
    arrows = visit.viewer.view.sphere.arrows.handle
    visit.until(lambda: arrows.visible, "no arrows")
    visit.wait_for_panel()
    sphere = lambda: visit.viewer.scene.handles.sphere.target  # noqa: E731
    before = sphere()
    place = np.array(arrows.position) + (0.0, 0.0, 0.4 * arrows.scale)
    visit.drag(place, (0, -50), lambda: sphere()[2] > before[2] + 0.1)
    assert visit.errors() == []


@pytest.mark.long
def test_the_buoy_is_pulled(visit: Visit) -> None:
    visit.follow("mooring")
    visit.viewer.settings.load("The lab's buoy")
    visit.until(lambda: visit.viewer.loop.scene.params.body == "buoy", "no buoy")
    visit.until(lambda: visit.viewer.loop.scene.time > 0.2, "it does not run")
    visit.wait_for_panel()
    visit.set("speed", 0.2)
    frame = lambda: visit.viewer.loop.latest.frame  # noqa: E731
    visit.drag(lambda: frame().body[:3], (-60, 0), lambda: frame().grab is not None)
    assert visit.errors() == []


def test_a_finger_pulls_the_rope(visit: Visit) -> None:
    settled(visit)
    scene = visit.viewer.scene
    point = scene.state.x[:, 0, 6].copy()
    before = visit.camera()
    visit.viewer.loop.commands.put(Play())
    visit.drag(point, (60, -30), lambda: scene.handles.grab.grabbed is not None, kind="touch")
    visit.until(lambda: scene.handles.grab.grabbed is None, "it is not let go")
    assert visit.camera() == pytest.approx(before, abs=1e-6)


# Controls, each by mouse and by key


@pytest.mark.long
def test_numbers(visit: Visit) -> None:
    """A click selects the old number, and Tab does."""
    enter(visit.page, "Stiffness", "1234,5")
    visit.until(lambda: visit.param("stiffness") == 1234.5, "by mouse")
    if not visit.page.run(HAS_FOCUS):
        return
    visit.page.type("c")
    is_at = f"return document.activeElement === {named(FIELD, 'Damping')};"
    for _ in range(12):
        if visit.page.run(is_at):
            break
        visit.page.type("Tab")
    visit.page.type(*"8,5", "Enter")
    visit.until(lambda: visit.param("damping") == 8.5, "by key")


def test_a_slider(visit: Visit) -> None:
    before = visit.param("stiffness")
    visit.page.press_on(named(THUMB, "Stiffness"))
    x, y = visit.page.run(
        f"""const box = {named(THUMB, "Stiffness")}.getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2];"""
    )
    visit.page.press((x, y), (x + 8, y), (x + 16, y))
    visit.until(lambda: visit.param("stiffness") > 1.2 * before, "by mouse")
    visit.until(lambda: not visit.viewer.settings.history.hands, "it is not let go")
    values: list[float] = []

    def rests() -> bool:
        values.append(visit.param("stiffness"))
        visit.page.run("await new Promise((done) => setTimeout(done, 400));")  # viser sends the last value later
        return values[-1] == visit.param("stiffness")

    visit.until(rests, "it does not rest")
    dragged = values[-1]
    visit.page.run(f"{named(THUMB, 'Stiffness')}.focus();")
    visit.page.type("ArrowRight")
    visit.until(lambda: dragged < visit.param("stiffness") < 1.2 * dragged, "by key")


def test_a_checkbox_and_a_folder(visit: Visit) -> None:
    for expected in (True, False):
        visit.page.press_on(named(CHECKBOX, "Sphere"))
        visit.until(lambda expected=expected: visit.param("sphere") is expected, "by mouse")
    if visit.page.run(HAS_FOCUS):
        visit.page.run(f"{named(CHECKBOX, 'Sphere')}.focus();")
        visit.page.type("Space")
        visit.until(lambda: visit.param("sphere"), "by key")
        assert visit.viewer.loop.run.running  # the key was not that of the lab
    is_open = f"return {named(FOLDER, 'Surroundings')}.ariaExpanded"
    visit.page.press_on(named(FOLDER, "Surroundings"))
    visit.page.wait(f"{is_open} === 'true';")
    visit.page.run(f"{named(FOLDER, 'Surroundings')}.focus();")
    visit.page.type("Enter")
    visit.page.wait(f"{is_open} === 'false';")


@pytest.mark.long
def test_a_list(visit: Visit) -> None:
    visit.page.press_on(PRESET)
    visit.page.press_on(named(OPTION, "Pendulum"))
    visit.until(lambda: visit.viewer.settings.loaded == "Pendulum", "by mouse")
    visit.page.run(f"{PRESET}.focus();")
    visit.page.wait(f"return {PRESET}.value === 'Pendulum';")
    visit.page.type("ArrowDown", "ArrowDown", "Enter")
    visit.until(lambda: visit.viewer.settings.loaded not in ("Pendulum", None), "by key")


def test_tabs(visit: Visit) -> None:
    first = visit.page.run(SELECTED)
    visit.show("View")
    visit.page.run(f"{named(TAB, 'View')}.focus();")
    visit.page.type("ArrowLeft")
    visit.page.wait(f"const now = (() => {{ {SELECTED} }})(); return now !== 'View';")
    visit.show(first)


def test_buttons_and_keys_of_the_lab(visit: Visit) -> None:
    run = visit.viewer.loop.run
    icon = lambda name: f'document.querySelector("[data-springtide-icon={name}]")'  # noqa: E731
    visit.page.press_on(icon("Pause"))
    visit.until(lambda: not run.running, "pause by mouse")
    steps = run.counts["steps"]
    visit.page.press_on(icon("Step"))
    visit.until(lambda: run.counts["steps"] == steps + 1, "step by mouse")
    visit.page.type("n")
    visit.until(lambda: run.counts["steps"] == steps + 2, "step by key")
    number = run.identity.number
    visit.page.press_on(icon("Reset"))
    visit.until(lambda: run.identity.number == number + 1, "reset by mouse")
    visit.page.type("Meta+r")
    visit.page.type("r")
    visit.until(lambda: run.identity.number == number + 2, "reset by key, and not with Meta")
    visit.page.type("Space")
    visit.until(lambda: run.running, "play by key")
    visit.page.type("g")
    visit.until(lambda: not visit.param("grid"), "grid by key")
    visit.page.type("2")
    visit.until(lambda: visit.param("points") == 50, "a preset by key")
    visit.page.type("u")
    visit.until(lambda: visit.param("points") == 10, "undo by key")
    visit.page.press_on(icon("Plots"))
    visit.page.wait("return document.querySelector('.uplot') !== null;")
    visit.page.type("p")
    visit.page.wait("return document.querySelector('.uplot') === null;")
    visit.page.type("c")
    visit.page.wait("return document.activeElement.matches('input, textarea, .multi-slider-thumb, button');")
    visit.page.type("Escape")
    visit.page.run("document.activeElement.blur();")
    visit.page.type("l")
    visit.page.wait("return document.documentElement.classList.contains('springtide-projecting');")
    visit.page.type("Escape")
    visit.page.wait("return !document.documentElement.classList.contains('springtide-projecting');")
    visit.page.type("Control+k")
    visit.page.wait("return document.body.innerText.includes('Single step');")
    visit.page.type("Escape")
    assert visit.errors() == []


@pytest.mark.long
def test_undo(visit: Visit) -> None:
    for press in (
        lambda: visit.page.type("u"),
        lambda: visit.page.press_on('document.querySelector("[data-springtide-icon=Undo]")'),
    ):
        enter(visit.page, "Points", "12")
        visit.until(lambda: visit.param("points") == 12, "a change")
        press()
        visit.until(lambda: visit.param("points") == 10, "undone")


@pytest.mark.long
def test_the_time_line(visit: Visit) -> None:
    visit.until(lambda: visit.viewer.loop.scene.time > 2.0, "it does not run")
    visit.page.wait('return document.querySelector("#springtide-time input:enabled")?.max > 1.0;')  # the page knows it
    left, middle, width = visit.page.run(
        """const box = document.querySelector("#springtide-time input").getBoundingClientRect();
        return [box.left, box.top + box.height / 2, box.width];"""
    )
    visit.page.press((left + 0.95 * width, middle), (left + 0.7 * width, middle), (left + 0.5 * width, middle))
    visit.page.wait('return document.querySelector("#springtide-time.springtide-is-past") !== null;')
    line = 'const line = document.querySelector("#springtide-time"); return Number(line.dataset.moment)'
    visit.page.wait(f'{line} - line.querySelector("input").valueAsNumber < 0.02;')  # at the end of the drag
    shown = visit.page.run(f"{line};")
    visit.page.run('document.querySelector("#springtide-time input").focus();')
    visit.page.type("ArrowRight")
    visit.page.wait(f"{line} > {shown};")
    visit.page.press_on('document.querySelector("#springtide-time [data-act=live]")')
    visit.page.wait('return document.querySelector("#springtide-time.springtide-is-past") === null;')


# Links and files


@pytest.mark.parametrize("allowed", [True, False])
def test_each_press_copies_the_link_or_the_page_says_how(visit: Visit, allowed: bool) -> None:
    visit.show("Share")
    # As a browser that takes no content which arrives later, and has or has not the permission.
    visit.page.run(
        """window.texts = [];
        navigator.clipboard.write = async () => { throw new DOMException("refused", "NotAllowedError"); };
        navigator.clipboard.writeText = async (text) => {
            if (!ALLOWED) throw new DOMException("refused", "NotAllowedError");
            window.texts.push(text); };""".replace("ALLOWED", str(allowed).lower())
    )
    said = "document.querySelector('.springtide-copied')"
    for press in (1, 2):
        visit.page.run(f"{said}?.remove();")
        visit.page.press_on(named(BUTTON, "Copy link"))
        if allowed:
            visit.page.wait(
                f"return {said}?.innerText === 'Copied to the clipboard:' && window.texts.length === {press};"
            )
        else:
            selected = "String(getSelection()).includes('scene=rope')"
            visit.page.wait(f"return {said}?.innerText.includes('to copy this link') && {selected};")
    visit.page.run("return window.texts.every((text) => text.includes('scene=rope'));")


def saved(visit: Visit, press: Callable[[], None], ending: str, begin: bytes) -> bytes:
    """Press something, and wait for the file that the browser saves."""
    for earlier in visit.page.files():
        earlier.unlink()
    press()
    files = lambda: [file for file in visit.page.files() if file.name.endswith(ending)]  # noqa: E731

    def is_there() -> bool:
        return any(file.read_bytes().startswith(begin) and file.stat().st_size > len(begin) for file in files())

    visit.until(is_there, f"no {ending}")
    return files()[0].read_bytes()


@pytest.mark.parametrize(
    ("button", "ending", "begin"),
    [
        ("Data (.npz)", ".npz", b"PK"),
        pytest.param("Replay (last 20 s)", ".html", b"<!", marks=pytest.mark.long),
        ("Picture", ".png", b"\x89PNG"),
        pytest.param("Save set-up", ".json", b"{", marks=pytest.mark.long),
        ("Save plots", ".csv", b"\xef\xbb\xbft [s],"),
    ],
)
def test_a_file_is_saved(visit: Visit, button: str, ending: str, begin: bytes) -> None:
    visit.set("plot_tip", True)
    visit.show("Share")
    visit.until(lambda: len(visit.viewer.panel.recorder.frames) > 10, "nothing is recorded")
    visit.page.run("window.drawsPixels = true;")  # an empty picture is refused
    assert saved(visit, lambda: visit.page.press_on(named(BUTTON, button)), ending, begin)


def test_a_clip_is_recorded_or_the_page_says_that_it_cannot(visit: Visit) -> None:
    visit.show("Share")
    visit.page.run("window.drawsPixels = true;")
    types = "['video/webm', 'video/mp4']"
    records = visit.page.run(f"return {types}.some((type) => window.MediaRecorder?.isTypeSupported(type));")
    press = lambda: visit.page.press_on('document.querySelector("[data-springtide-act=clip]")')  # noqa: E731
    press()
    if not records:
        visit.page.wait("return document.body.innerText.includes('This browser cannot record clips');")
        visit.page.press_on(named(BUTTON, "Close"))
        return
    visit.page.wait("return /Stop clip .[1-9]/.test(document.querySelector('[data-springtide-act=clip]').textContent);")
    is_mp4 = visit.page.run("return MediaRecorder.isTypeSupported('video/mp4;codecs=avc1.640028');")
    clip = saved(visit, press, ".mp4" if is_mp4 else ".webm", b"" if is_mp4 else b"\x1a\x45\xdf\xa3")
    assert len(clip) > 1000
    assert is_mp4 or b"\x44\x89\x88" in clip[:500]  # a duration
    assert visit.errors() == []


@pytest.mark.long
def test_a_set_up_is_chosen_from_a_file(visit: Visit, tmp_path: Path) -> None:
    path = tmp_path / "set-up.json"
    for points in (23, 24):
        path.write_text(json.dumps({"scene": "rope", "parameters": {"points": points}}), "utf-8")
        visit.show("Share")
        visit.page.choose_file(".springtide-load input", path)
        visit.until(lambda points=points: visit.param("points") == points, "the file is not read")


def test_a_file_that_is_chosen_while_the_lab_changes_scenes_is_read(
    visit: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "set-up.json"
    path.write_text(json.dumps({"scene": "rope", "parameters": {"points": 25}}), "utf-8")
    visit.show("Share")
    made, closed, goes_on = visit.viewer.make_scene, threading.Event(), threading.Event()

    def make_late(*wanted: Any) -> Any:
        closed.set()
        goes_on.wait(60.0)
        return made(*wanted)

    monkeypatch.setattr(visit.viewer, "make_scene", make_late)
    opening = threading.Thread(target=visit.viewer.open, args=["rope"])
    opening.start()
    try:
        visit.until(closed.is_set, "the old scene is not closed")
        sent: list[Any] = []
        monkeypatch.setitem(visit.viewer.panel.share.channel._listeners, "open", (str, sent.append))
        visit.page.choose_file(".springtide-load input", path)
        visit.until(lambda: sent, "nothing is sent")
    finally:
        goes_on.set()
        opening.join()
    visit.until(lambda: visit.param("points") == 25, "the file is lost")


def test_a_replay_plays_from_a_file(visit: Visit, tmp_path: Path) -> None:
    visit.until(lambda: len(visit.viewer.panel.recorder.frames) > 30, "nothing is recorded")
    recorder, plots = visit.viewer.panel.recorder, visit.viewer.panel.plots
    path = tmp_path / "replay.html"
    path.write_text(replay_html(scene_named("rope"), recorder.all_frames(), plots.plotted()), "utf-8")
    visit.page.open(path.as_uri())
    visit.page.wait(f"window.vertex ??= {LAST_VERTEX}; return window.vertex !== undefined;")
    visit.page.wait(f"return {LAST_VERTEX} !== window.vertex;")
    assert visit.page.run("return window.__springtide.quality !== undefined;")


# Sessions


@pytest.mark.long
def test_a_task_of_the_workbook(visit: Visit, tmp_path: Path) -> None:
    tasks = load_tasks()
    folder = tmp_path / "mylab"
    make_folder(folder, tasks)
    visit.viewer.workbook = Workbook(tasks, folder)
    try:
        visit.follow("rope")
        visit.show("Lab")
        kept = lambda key: read_answers(folder).values.get(("spring_force", key), "")  # noqa: E731
        visit.page.press_on(named(LIST, "Task"))
        visit.page.press_on(named(OPTION, "3.2-1 The force of a damped spring"))
        visit.page.press_on(named(LABELLED, "Predict"))
        visit.page.type(*"It swings, r n and all.")
        visit.until(lambda: kept("predict") == "It swings, r n and all.", "the answer is not kept")
        assert visit.viewer.loop.run.running
        visit.page.press_on(named(BUTTON, "Set this up"))
        visit.page.press_on(named(LABELLED, "A rope of 9 springs"))
        visit.page.type(*"0,1125", "Enter")
        visit.until(lambda: kept("stretch") == 0.1125, "the number is not kept")
        assert visit.errors() == []
    finally:
        visit.viewer.workbook = None


@pytest.mark.long
def test_the_teacher_s_page(visit: Visit, tmp_path: Path) -> None:
    tasks = load_tasks()
    folders = [tmp_path / name for name in ("ada", "bo")]
    for folder in folders:
        make_folder(folder, tasks)
    with Classroom(folders, tasks) as classroom:
        server = make_server(classroom, "secret", 0)
        threading.Thread(target=server.serve_forever, args=(0.1,), daemon=True).start()
        try:
            visit.page.open(f"http://127.0.0.1:{server.server_address[1]}/secret/")
            visit.page.wait("return document.body.innerText.includes('Class of 2');")
            revision = classroom.revision
            visit.page.run("document.querySelector('main').innerHTML = '';")
            (folders[0] / "rope.py").write_text("1 +", "utf-8")
            visit.until(lambda: classroom.revision > revision, "the file is not read")
            visit.page.wait("return document.querySelector('main').innerText.includes('ada');")
        finally:
            server.shutdown()
            server.server_close()


@pytest.mark.long
def test_two_labs_side_by_side(visit: Visit, another_lab: Callable[..., Viewer]) -> None:
    viewer = another_lab()
    viewer.open("rope")
    viewer.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
    visit.page.open(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2")
    visit.page.wait("return location.pathname === '/beside' && document.querySelectorAll('iframe').length === 2;")
    assert viewer.comparison is not None
    second = viewer.comparison.viewers[1]
    visit.until(lambda: min(viewer.scene.time, second.scene.time) > 0.2, "they do not run")
    camera = f"""(k) => {{ const window = document.querySelectorAll("iframe")[k].contentWindow;
        return ({CAMERA})(); }}"""
    cameras = lambda: [visit.page.run(f"return ({camera})({k});") for k in (0, 1)]  # noqa: E731
    visit.until(lambda: np.allclose(*cameras(), atol=1e-3), "the cameras differ")
    before = cameras()[0]
    for _ in range(3):  # repeated if a slow page was not ready
        visit.page.press_in_frame(1, (70, 300), (100, 310), (130, 320))
        with contextlib.suppress(AssertionError):
            visit.until(lambda: not np.allclose(cameras()[0], before, atol=0.05), "the other camera stands")
            break
    assert not np.allclose(cameras()[0], before, atol=0.05)
    visit.until(lambda: np.allclose(*cameras(), atol=1e-3), "the cameras differ")
    visit.page.press_on('document.querySelector("#play")')
    visit.until(lambda: not viewer.loop.run.running and not second.loop.run.running, "both do not pause")


# Losses and missing features


def test_a_lost_context_comes_back(visit: Visit) -> None:
    contexts = visit.page.run("return window.__springtide.contexts;")
    visit.page.run(
        """const gl = document.querySelector("canvas[data-engine]").getContext("webgl2");
        window.graphics = gl.getExtension("WEBGL_lose_context");
        window.graphics.loseContext();
        await new Promise((done) => setTimeout(done, 500));
        window.graphics.restoreContext();"""
    )
    visit.page.wait(f"return window.__springtide.contexts > {contexts};")
    visit.page.run("window.drawsPixels = true;")
    visit.page.wait(f"const found = (() => {{ {STANDARD_DEVIATION} }})(); return found > 5;")


def test_a_server_that_ends_and_begins_again(visit: Visit, another_lab: Callable[..., Viewer]) -> None:
    viewer = another_lab()
    viewer.open("rope")
    visit.page.open(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2")
    visit.page.wait(RUNS)
    visit.page.run("window.isFirst = true;")
    viewer.shut()
    visit.page.wait("return document.getElementById('springtide-cover').innerText.includes('The lab has stopped');")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(served_page, "SERVER_NAME", "another")
        another_lab(viewer.port).open("rope")
        visit.page.wait(f"if (window.isFirst) return false; {RUNS}")


@pytest.mark.long
def test_a_page_is_loaded_again_left_and_come_back_to(visit: Visit) -> None:
    visit.page.run("window.isFirst = true; setTimeout(() => location.reload());")
    visit.page.wait(f"if (window.isFirst) return false; {RUNS}")
    visit.page.open(f"{visit.address}springtide-alive")
    visit.page.run("setTimeout(() => history.back());")
    visit.page.wait(f"if (location.pathname !== '/') return false; {RUNS}")
    visit.until(lambda: len(visit.viewer.visitors()) == 1, "a page that was left is still there")


def test_a_hidden_page_goes_on_once_it_is_shown(visit: Visit) -> None:
    tell = """state => { Object.defineProperty(document, "visibilityState", { value: state, configurable: true });
        document.dispatchEvent(new Event("visibilitychange")); }"""
    visit.page.run(f"({tell})('hidden'); await new Promise((done) => setTimeout(done, 1500)); ({tell})('visible');")
    visit.page.run(f"window.vertex = {LAST_VERTEX};")
    visit.page.wait(f"return {LAST_VERTEX} !== window.vertex;")
    assert visit.errors() == []


@pytest.mark.long
def test_without_webgl_the_page_says_so(visit: Visit, with_script: Callable[[str], None]) -> None:
    with_script(NO_WEBGL)
    visit.page.open(f"{visit.address}?without=webgl")
    visit.page.wait("return document.getElementById('springtide-cover').innerText.includes('WebGL 2 is missing');", 10)
    visit.page.open("about:blank")


@pytest.mark.long
def test_without_storage_the_page_works(visit: Visit, with_script: Callable[[str], None]) -> None:
    with_script(REFUSED)
    visit.open("&fixedDpr=0.2&without=storage")
    visit.show("View")
    for pressed in ("true", "false"):
        visit.page.press_on(named(BUTTON, "Dark"))
        visit.page.wait(f"return document.querySelector('[data-springtide-act=dark]').ariaPressed === '{pressed}';")
    assert visit.page.run("return document.querySelectorAll(\"[role=slider][tabindex='0']\").length;") > 0
    assert visit.errors() == []
    visit.page.open("about:blank")


@pytest.mark.long
def test_a_browser_that_hides_what_it_is(visit: Visit, with_script: Callable[[str], None]) -> None:
    """As Firefox does with resistFingerprinting: small textures, no name, and another ratio of pixels."""
    with_script(
        """const get = WebGL2RenderingContext.prototype.getParameter;
        WebGL2RenderingContext.prototype.getParameter = function (name) {
            return { 0x9246: "Mozilla", 0x1f01: "Mozilla", 0x0d33: 2048 }[name] ?? get.call(this, name); };
        Object.defineProperty(window, "devicePixelRatio", { value: 2, configurable: true });"""
    )
    visit.open("&without=fingerprint")
    visit.until(lambda: visit.viewer.loop.scene.time > 0.5, "it does not run")
    assert not any("too big" in text for _, text in visit.page.run("return window.noted;"))
    assert visit.errors() == []
    visit.page.open("about:blank")


@pytest.mark.long
def test_without_float_targets_the_sea_has_a_sky(visit: Visit, with_script: Callable[[str], None]) -> None:
    with_script(NO_FLOATS)
    visit.open("&fixedDpr=0.2&without=floats")
    visit.follow("square_sea")
    visit.page.run("window.drawsPixels = true;")
    visit.page.wait(SKY_IS_BRIGHT, 200)
    visit.page.run("window.drawsPixels = false;")
    assert [error for error in visit.errors() if LOADING_ERRORS not in error] == []
    visit.page.open("about:blank")


# Windows


@pytest.mark.parametrize(
    ("width", "height", "ratio"),
    [
        pytest.param(800, 600, 1.0, marks=pytest.mark.long),
        pytest.param(390, 844, 1.0, marks=pytest.mark.long),
        (667, 467, 1.5),
        pytest.param(1000, 700, 2.0, marks=pytest.mark.long),
    ],
)
def test_a_window_of_another_size_or_zoom(visit: Visit, width: int, height: int, ratio: float) -> None:
    """Also at a zoom of 150 %."""
    run = visit.viewer.loop.run
    try:
        visit.page.resize(width, height, ratio)
        shown = visit.page.run("return [innerWidth, innerHeight, devicePixelRatio];")
        assert shown[1:] == [height, ratio]
        assert width <= shown[0] < 450 or shown[0] == width
        visit.page.press_on('document.querySelector("[data-springtide-icon=Pause]")')
        visit.until(lambda: not run.running, "pause")
        visit.page.press_on('document.querySelector("[data-springtide-icon=Play]")')
        visit.until(lambda: run.running, "play")
        assert visit.page.run("return document.documentElement.scrollWidth;") <= shown[0]
        point = visit.viewer.scene.state.x[:, 0, 0].copy()
        x, y = visit.pixel(point)
        # Beside the note on a file that an earlier row has saved.
        there = f"document.elementsFromPoint({x}, {y}).find((one) => !one.closest('[class*=Notif]'))"
        assert visit.page.run(f"return {there}.matches('canvas');")
        assert visit.errors() == []
    finally:
        visit.page.resize(*SIZE)


def test_less_motion_where_the_user_asks_for_it(visit: Visit) -> None:
    """Only Playwright can set the preference: for other drivers the rules are made to apply always."""
    moving = """const cover = document.getElementById("springtide-cover");
        cover.classList.remove("springtide-hidden");
        const times = getComputedStyle(cover, "::after").animationIterationCount;
        cover.classList.add("springtide-hidden");
        return times;"""
    assert visit.page.run(moving) == "infinite"
    visit.page.run(
        """for (const sheet of document.styleSheets) for (const rule of sheet.cssRules)
            if (rule.media?.mediaText.includes("prefers-reduced-motion")) rule.media.mediaText = "all";"""
    )
    assert visit.page.run(moving) == "1"
    visit.page.open("about:blank")
