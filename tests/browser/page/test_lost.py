"""What a page has lost and finds again: its graphics context, its connection, its server."""

import base64
import functools
import io
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from app.messages import Pause
from app.notebook.output import Output
from app.render import surroundings
from app.scenes import NAMES
from app.scenes.setups import read_query
from app.server.viewer import Viewer
from app.server.web import page as served_page
from app.server.web.access import Access, make_key
from tests.browser.conftest import NO_FLOATS, Tab, new_page, vertices_of
from tests.browser.slow_line import slow_line

FAST = 1e9  # [bytes/s]
MAX_DIFFERENCE = 2.0  # of 255, in the mean
CUTS = 5
HOUR = 3_600_000  # [ms]
# Listeners of window and document, observers, and objects of WebGL that a page has made and not given up.
COUNTED = """const count = window.counted = { listeners: 0, observers: 0, textures: 0, framebuffers: 0 };
const { addEventListener: add, removeEventListener: remove } = EventTarget.prototype;
const isCounted = (target) => target === window || target === document || target === undefined;
EventTarget.prototype.addEventListener = function (...all) {
    if (isCounted(this)) {
        count.listeners += 1;
        all[2]?.signal?.addEventListener("abort", () => (count.listeners -= 1));
    }
    return add.apply(this, all);
};
EventTarget.prototype.removeEventListener = function (...all) {
    if (isCounted(this)) count.listeners -= 1;
    return remove.apply(this, all);
};
for (const Observer of [MutationObserver, ResizeObserver]) {
    const { observe, disconnect } = Observer.prototype, open = new WeakSet();
    Observer.prototype.observe = function (...all) {
        // viser's own end with their elements.
        if (!open.has(this) && new Error().stack.includes("springtide/")) { open.add(this); count.observers += 1; }
        return observe.apply(this, all);
    };
    Observer.prototype.disconnect = function () {
        if (open.delete(this)) count.observers -= 1;
        return disconnect.call(this);
    };
}
for (const [kind, name] of [["Texture", "textures"], ["Framebuffer", "framebuffers"]]) {
    const P = WebGL2RenderingContext.prototype, make = P[`create${kind}`], give = P[`delete${kind}`];
    P[`create${kind}`] = function () { count[name] += 1; return make.call(this); };
    P[`delete${kind}`] = function (object) { if (object) count[name] -= 1; return give.call(this, object); };
}"""
LOSE = """() => { const gl = document.querySelector("canvas[data-engine]").getContext("webgl2");
    window.graphics = gl.getExtension("WEBGL_lose_context");
    window.graphics.loseContext(); }"""


def picture(tab: Tab) -> NDArray[np.float64]:
    """What the canvas of the scene shows (height, width, 3), 0 to 255."""
    data = tab.page.evaluate("document.querySelector('canvas[data-engine]').toDataURL()")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data.partition(",")[2]))).convert("RGB"), float)


def final_picture(tab: Tab) -> NDArray[np.float64]:
    """The picture once it no longer changes, with the programs of the sea."""
    shots = [picture(tab)]

    def is_final() -> bool:
        tab.page.wait_for_timeout(1500)
        shots.append(picture(tab))
        return bool(np.array_equal(shots[-1], shots[-2]))

    tab.wait(is_final)
    return shots[-1]


@pytest.mark.long
@pytest.mark.parametrize(("scene", "floats"), [("square_sea", True), ("square_sea", False), ("radial_sea", True)])
def test_a_lost_context_comes_back_with_its_picture(open_tab: Callable[..., Tab], scene: str, floats: bool) -> None:
    """floats: whether the browser draws into floats; without them the sky is a formula."""
    viewer = Viewer("127.0.0.1", 0)
    viewer.open(scene)
    viewer.loop.commands.put(Pause())
    tab = open_tab(viewer.port, width=480, height=320, drawn=True)
    try:
        if not floats:
            tab.page.add_init_script(NO_FLOATS)
            tab.page.reload()
        tab.wait(lambda: tab.page.evaluate("window.__springtide?.showsWhole?.()"))
        before = final_picture(tab)
        assert (tab.page.evaluate("window.__springtide.skiesDrawn") > 0) is floats
        contexts = tab.page.evaluate("window.__springtide.contexts")
        tab.page.evaluate(LOSE)
        tab.page.wait_for_timeout(500)
        tab.page.evaluate("window.graphics.restoreContext()")
        tab.wait(lambda: tab.page.evaluate("window.__springtide.contexts") > contexts)
        difference = np.abs(final_picture(tab) - before)
        assert difference.mean() < MAX_DIFFERENCE
        assert np.quantile(difference, 0.999) < 20.0  # a small thing that is missing
    finally:
        viewer.shut()


def counted_page(chromium: Any) -> Any:
    """A page without pixels, which counts."""
    page = new_page(chromium, 480, 320, drawn=False)
    page.add_init_script(COUNTED)
    return page


def settled_counts(page: Any) -> dict[str, int]:
    """Counts of the objects that a page holds, once they are constant."""
    page.wait_for_selector(".springtide-panel[data-state]")
    page.wait_for_selector("#springtide-cover.springtide-hidden", state="attached")
    found, again = {}, {"": 0}
    while found != again:
        found = page.evaluate("counted")
        page.wait_for_timeout(1500)
        again = page.evaluate("counted")
    return found


@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "seconds", "cuts"),
    [
        ("square_sea", 0.0, CUTS),
        ("rope", 0.0, CUTS),
        ("rope", 10.0, 1),
        pytest.param("rope", 60.0, 1, marks=pytest.mark.timeout(900)),
    ],
)
def test_a_page_that_connects_again_has_nothing_twice(chromium: Any, scene: str, seconds: float, cuts: int) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open(scene)
    viewer.loop.commands.put(Pause())
    with slow_line(viewer.port, FAST, 0.0) as line:
        page = counted_page(chromium)
        page.add_init_script("Document.prototype.hasFocus = () => false;")  # as on a projector
        page.emulate_media(color_scheme="dark")

        def dark() -> list[bool | None]:
            """Whether the server draws dark, for each browser."""
            return [surroundings._dark.get(client) for client in viewer.server.get_clients().values()]

        try:
            page.goto(f"http://127.0.0.1:{line.port}/?hideViserLogo&fixedDpr=0.2")
            page.wait_for_function("window.__springtide?.quality")
            page.evaluate("window.isFirst = true")
            held = [settled_counts(page)]
            clients = set(viewer.server.get_clients())
            for _ in range(cuts):
                line.cut(seconds)
                while not set(viewer.server.get_clients()) - clients:
                    page.wait_for_timeout(100)
                clients |= set(viewer.server.get_clients())
                held.append(settled_counts(page))
                if scene == "rope":
                    while dark() != [True]:
                        page.wait_for_timeout(100)
            assert page.evaluate("window.isFirst") is True
            assert min(held[0].values()) > 0
            for name in ("listeners", "observers"):
                assert {counts[name] for counts in held} == {held[0][name]}
            assert held[1:] == [held[1]] * cuts  # viser may make one texture more with the first
            assert page.evaluate("document.querySelectorAll('#springtide-slow').length") == 0
        finally:
            page.close()
            viewer.shut()


TELL = """state => { Object.defineProperty(document, "visibilityState", { value: state, configurable: true });
    document.dispatchEvent(new Event("visibilitychange")); }"""


@pytest.mark.long
def test_a_tab_that_was_hidden_for_an_hour_goes_on(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    page = counted_page(chromium)
    try:
        page.clock.install()
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2")
        page.wait_for_function("window.__springtide?.quality")
        page.evaluate("window.isFirst = true")
        held, step = settled_counts(page), page.evaluate("__springtide.quality.now().step")
        for _ in range(2):
            page.evaluate(TELL, "hidden")
            began = page.evaluate("performance.now()")
            page.clock.fast_forward(HOUR)
            assert page.evaluate("performance.now()") - began >= HOUR
            page.evaluate(TELL, "visible")
            before = vertices_of(page, "/rope")
            while np.array_equal(vertices_of(page, "/rope"), before):
                page.wait_for_timeout(100)
            assert settled_counts(page) == held
        assert page.evaluate("window.isFirst") is True
        assert page.evaluate("__springtide.quality.now().step") == step
        assert len(viewer.visitors()) == 1
    finally:
        page.close()
        viewer.shut()


@pytest.mark.long
def test_a_page_that_goes_round_all_scenes_holds_as_much_as_before(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    page = counted_page(chromium)
    try:
        viewer.open(NAMES[0])
        page.goto(f"http://127.0.0.1:{viewer.port}/?hideViserLogo&fixedDpr=0.2")
        held: dict[str, list[dict[str, int]]] = {}
        for scene in (*NAMES, *NAMES, *NAMES):
            viewer.open(scene)
            viewer.loop.commands.put(Pause())
            held.setdefault(scene, []).append(settled_counts(page))
        for scene, (_, second, third) in held.items():
            # viser leaves a texture of 8 x 8 numbers behind with the instances of a race.
            assert third.pop("textures") <= second.pop("textures") + 1, (scene, held[scene])
            assert third == second, (scene, held[scene])
    finally:
        page.close()
        viewer.shut()


@pytest.mark.long
def test_a_page_reloads_for_another_server_only_and_not_while_it_records(
    chromium: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = Viewer("127.0.0.1", 0)
    page = new_page(chromium, 480, 320, drawn=False)
    with slow_line(viewer.port, FAST, 0.0) as line:
        try:
            viewer.open("rope")
            page.goto(f"http://127.0.0.1:{line.port}/?hideViserLogo&fixedDpr=0.2")
            page.wait_for_selector(".springtide-panel[data-state]")
            page.wait_for_selector("#springtide-cover.springtide-hidden", state="attached")
            page.evaluate("window.isFirst = true")
            line.cut(HOUR)
            page.wait_for_function(
                "document.querySelector('#springtide-cover-words').innerText.includes('has stopped')"
            )
            line.cut(0.0)  # back, with the same server
            page.wait_for_selector("#springtide-cover.springtide-hidden", state="attached")
            page.evaluate("window.__springtide.isRecording = true")
            monkeypatch.setattr(served_page, "SERVER_NAME", "another")
            line.cut(3.0)
            with page.expect_response("**/springtide-alive*"):
                pass
            page.wait_for_timeout(500)
            assert page.evaluate("window.isFirst") is True
            page.evaluate("window.__springtide.isRecording = false")
            line.cut(3.0)
            page.wait_for_function("window.isFirst === undefined")
        finally:
            page.close()
            viewer.shut()


SHOWN = """() => { const at = (selector) => document.querySelector(selector)?.innerText.trim() ?? "";
    const state = document.querySelector(".springtide-state");
    const word = () => state && getComputedStyle(state, "::before").content;
    const cover = document.querySelector("#springtide-cover:not(.springtide-hidden) #springtide-cover-words");
    return { cover: cover?.innerText ?? "", line: at("#springtide-line"), status: at(".springtide-panel"), word: word(),
             state: document.documentElement.dataset.springtideLine ?? "open" }; }"""
MAX_SILENT = 12.0  # [s] until a page says that nothing comes, and connects again
MAX_BACK = 5.0  # [s] until a page goes on once the line is back
SLOW_MACHINE = 3.0  # [s] more for a page that draws in software


def wait_shown(frame: Any, condition: Callable[[dict[str, str]], bool], seconds: float) -> dict[str, str]:
    """The words of a page, or of a frame in it, once they are as expected."""
    end = time.monotonic() + seconds
    while not condition(found := frame.evaluate(SHOWN)):
        assert time.monotonic() < end, found
        frame.wait_for_timeout(50)
    return found


@pytest.mark.long
@pytest.mark.parametrize("wholly", [False, True])
def test_a_connection_that_dies_without_an_end_is_told_and_made_again(chromium: Any, wholly: bool) -> None:
    """wholly: no new connection passes either, for some time."""
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    page = new_page(chromium, 480, 320, drawn=False)
    wait = functools.partial(wait_shown, page)
    with slow_line(viewer.port, FAST, 0.0) as line:
        try:
            page.goto(f"http://127.0.0.1:{line.port}/?hideViserLogo&fixedDpr=0.2")
            page.wait_for_selector("#springtide-cover.springtide-hidden", state="attached")
            wait(lambda shown: shown["status"].startswith("Running"), 60.0)
            page.wait_for_timeout(6000)
            assert page.evaluate(SHOWN)["state"] == "open"
            line.fall_silent(wholly=wholly)
            said = wait(lambda shown: shown["state"] != "open", MAX_SILENT)
            assert said["line"] == "Nothing arrives from the lab: this picture is old."
            assert said["word"] == '"Last seen at"'
            assert said["status"].startswith("t = ")
            if wholly:
                wait(lambda shown: shown["state"] == "closed" and "Connecting again" in shown["line"], MAX_SILENT)
                wait(lambda shown: "does not answer" in shown["cover"], 30.0)
                line.come_back()
            back = MAX_BACK + SLOW_MACHINE + (0.0 if wholly else MAX_SILENT)
            shown = wait(lambda shown: shown["state"] == "open" and shown["status"].startswith("Running"), back)
            assert shown["line"] == shown["cover"] == ""
            assert len(viewer.visitors()) == 1
        finally:
            page.close()
            viewer.shut()


def check_silence(page: Any, line: Any, labs: tuple[Viewer, ...]) -> None:
    """All frames of a page with labs say that their line has died, and each goes on over a new one."""
    while len(frames := [frame for frame in page.frames if "index.html" in frame.url]) < len(labs):
        page.wait_for_timeout(50)
    for frame in frames:
        wait_shown(frame, lambda shown: "Running" in shown["status"] and not shown["cover"], 60.0)
    page.wait_for_timeout(3000)
    line.fall_silent()
    end = time.monotonic() + MAX_SILENT
    for frame in frames:
        said = wait_shown(frame, lambda shown: shown["state"] != "open", end - time.monotonic())
        assert said["line"] == "Nothing arrives from the lab: this picture is old."
    for frame in frames:
        back = MAX_SILENT + MAX_BACK + SLOW_MACHINE
        wait_shown(frame, lambda shown: shown["state"] == "open" and "Running" in shown["status"], back)
    times = [lab.scene.time for lab in labs]
    while any(lab.scene.time <= before for lab, before in zip(labs, times, strict=True)):
        page.wait_for_timeout(50)
    assert [len(lab.visitors()) for lab in labs] == [1] * len(labs)


@pytest.mark.long
def test_two_panes_whose_connections_die_say_so_and_go_on(chromium: Any) -> None:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    viewer.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
    assert viewer.comparison is not None
    page = new_page(chromium, 900, 400, drawn=False)
    with slow_line(viewer.port, FAST, 0.0) as line:
        try:
            page.goto(f"http://127.0.0.1:{line.port}/beside?hideViserLogo&fixedDpr=0.2")
            check_silence(page, line, viewer.comparison.viewers)  # type: ignore[arg-type]
            page.wait_for_function("/t = /.test(document.querySelector('#clock').textContent)")
        finally:
            page.close()
            viewer.shut()


@pytest.mark.long
def test_the_lab_of_a_notebook_whose_connection_dies_says_so_and_goes_on(chromium: Any) -> None:
    key = make_key()
    viewer = Viewer("127.0.0.1", 0, access=Access(key=key))
    viewer.open("rope")
    page = new_page(chromium, 600, 400, drawn=False)
    with slow_line(viewer.port, FAST, 0.0) as line:
        try:
            page.goto(f"http://127.0.0.1:{line.port}/{key}/springtide-alive")
            page.set_content(Output(line.port, key, 320).html())
            check_silence(page, line, (viewer,))
        finally:
            page.close()
            viewer.shut()
