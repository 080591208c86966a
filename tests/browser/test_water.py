"""In a real Chromium: the patch reaches stock viser, and the pixels show it.

These tests fail when one of viser's inner names that `app/patch.py` leans on changes.
"""

import io
import shutil
import time
from collections.abc import Iterator

import numpy as np
import pytest
import viser
from PIL import Image

from app.paint import Painted
from app.patch import patch
from app.water import Look, Water, sky

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the search path"),
]
# Software rendering: slow, and the same everywhere.
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"]
SIZE = 32
LENGTH = 64.0  # [m]


@pytest.fixture(scope="module")
def browser() -> Iterator:
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    server.initial_camera.position = (-20.0, 32.0, 25.0)
    server.initial_camera.look_at = (32.0, 32.0, 0.0)
    yield server
    server.stop()


def visit(browser, server: viser.ViserServer):
    """A page on the server and the list that its errors go to."""
    page = browser.new_page(viewport={"width": 320, "height": 200})
    errors: list[str] = []
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(f"http://127.0.0.1:{server.get_port()}/?hideViserLogo&fixedDpr=1")
    return page, errors


def wait(page, condition, seconds: float = 60.0) -> bool:
    """Whether the condition came true within the time, with the page running meanwhile."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        page.wait_for_timeout(100)
    return False


def pixels(page) -> np.ndarray:
    """What the canvas shows, (height, width, 3), 0..255."""

    page.add_style_tag(content=".mantine-Paper-root, [class*=Notif] { display: none !important }")
    page.wait_for_timeout(700)
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(float)


def surface(phase: float = 0.0, foam: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One sine wave that fits the tile."""
    x = np.arange(SIZE) * LENGTH / SIZE
    x, y = np.meshgrid(x, x, indexing="ij")
    k = 2 * np.pi / LENGTH
    vertices = np.stack([x, y, np.sin(k * x + phase)], -1)
    slopes = np.stack([k * np.cos(k * x + phase), 0 * x], -1)
    return vertices, slopes, np.full((SIZE, SIZE), foam)


def make_water(server: viser.ViserServer, **arguments) -> Water:
    look = sky(server, "park")
    water = Water(server, "/sea", SIZE, SIZE, LENGTH, look=look, **arguments)
    water.set_surface(*surface())
    return water


def materials(page) -> dict[str, str]:
    """What each patched node's material says it was dressed with."""
    return page.evaluate(
        """() => Object.fromEntries(Object.entries(window.__viserMutable?.nodeRefFromName ?? {})
            .map(([name, group]) => [name, group?.children?.find(c => c.isMesh)?.material.userData.springtide])
            .filter(([, key]) => key))"""
    )


def test_the_patch_answers_and_its_programs_link(browser, server):
    water = make_water(server, tiles=3)
    page, errors = visit(browser, server)
    assert wait(page, lambda: water.alive is True)
    assert materials(page) == {"/sea": "springtide-water/sea"}
    assert errors == []
    page.close()


def test_foam_whitens_the_sea_and_plain_viser_does_not_show_the_channel(browser, server):
    water = make_water(server)
    page, errors = visit(browser, server)
    assert wait(page, lambda: water.alive is True)
    calm = pixels(page)
    with server.atomic():
        water.set_surface(*surface(foam=1.0))
    server.flush()
    foamy = pixels(page)
    sea = (slice(120, 200), slice(60, 260))
    assert foamy[sea].mean() > calm[sea].mean() + 60
    assert errors == []
    page.close()


def test_a_new_look_arrives_without_a_new_script(browser, server):
    water = make_water(server)
    page, errors = visit(browser, server)
    assert wait(page, lambda: water.alive is True)
    before = pixels(page)
    water.set_look(Look(deep=(0.6, 0.1, 0.1), scatter=(0.6, 0.1, 0.1), specular=0.0, dome=False))
    server.flush()
    after = pixels(page)
    sea = (slice(120, 200), slice(60, 260))
    red = after[sea][..., 0].mean() - after[sea][..., 2].mean()
    assert red > 20 > before[sea][..., 0].mean() - before[sea][..., 2].mean()
    assert errors == []
    page.close()


def test_a_late_joiner_and_a_reload_are_dressed_too(browser, server):
    water = make_water(server)
    first, _ = visit(browser, server)
    assert wait(first, lambda: water.alive is True)
    second, errors = visit(browser, server)
    assert wait(second, lambda: len(server.get_clients()) == 2 and water.alive is True)
    second.reload()
    assert wait(second, lambda: materials(second) != {})
    assert errors == []
    first.close()
    second.close()


def test_a_material_that_viser_makes_anew_is_dressed_again(browser, server):
    water = make_water(server)
    page, errors = visit(browser, server)
    assert wait(page, lambda: water.alive is True)
    page.evaluate("window.was = window.__viserMutable.nodeRefFromName['/sea'].children[0].material.uuid")
    water.mesh.side = "double"
    server.flush()
    new = "window.__viserMutable.nodeRefFromName['/sea'].children[0].material.uuid !== window.was"
    assert wait(page, lambda: page.evaluate(new))
    assert wait(page, lambda: materials(page) == {"/sea": "springtide-water/sea"}, 10)
    assert errors == []
    page.close()


def test_sizes_change_live_and_nothing_is_left_behind(browser, server):
    look = sky(server, "park")
    page, errors = visit(browser, server)
    counts = []
    for size in (64, 16, 64, 16, 64):
        water = Water(server, "/sea", size, size, LENGTH, tiles=3, look=look)
        x = np.arange(size) * LENGTH / size
        x, y = np.meshgrid(x, x, indexing="ij")
        water.set_surface(np.stack([x, y, 0 * x], -1), np.zeros((size, size, 2)), np.zeros((size, size)))
        server.flush()
        assert wait(page, lambda water=water: water.alive is True)
        page.wait_for_timeout(1500)
        counts.append(page.evaluate("window.__springtide.memory()"))
        water.remove()
        server.flush()
        page.wait_for_timeout(1500)
    # The first round also loads what stays: the sky's textures.
    assert counts[1] == counts[3]
    assert counts[2] == counts[4]
    assert errors == []
    page.close()


def test_a_mesh_of_any_shape_is_water_too(browser, server):
    rings, spokes = 8, 24
    r, a = np.meshgrid(np.linspace(1, 60, rings), np.arange(spokes) * 2 * np.pi / spokes, indexing="ij")
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rings - 1), np.arange(spokes), indexing="ij"))
    near, far, turn = i * spokes, (i + 1) * spokes, (j + 1) % spokes
    faces = np.concatenate(
        [np.stack([near + j, far + j, far + turn], 1), np.stack([near + j, far + turn, near + turn], 1)]
    )
    water = Water(server, "/disc", rings, spokes, 60.0, faces=faces, look=sky(server, "park"))
    vertices = np.stack([r * np.cos(a), r * np.sin(a), 0 * r], -1)
    water.set_surface(vertices, np.zeros((rings, spokes, 2)), np.ones((rings, spokes)))
    page, errors = visit(browser, server)
    assert wait(page, lambda: water.alive is True)
    assert materials(page) == {"/disc": "springtide-water/disc"}
    assert errors == []
    page.close()


def test_colours_reach_the_vertices_of_a_streaming_mesh(browser, server):
    corners = np.array([[0, 0, 0], [64, 0, 0], [64, 64, 0], [0, 64, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    red = np.tile([0.5, 0.0, 0.0], (4, 1))
    painted = Painted(server, "/quad", corners, faces, red, color=(0, 0, 255))
    page, errors = visit(browser, server)
    assert wait(page, lambda: painted.alive is True)
    middle = (slice(90, 110), slice(150, 170))
    r, _, b = pixels(page)[middle].mean((0, 1))
    assert r > b + 40
    with server.atomic():
        painted.set(vertices=corners + np.array([0.0, 0.0, 1.0]), colors=np.tile([0.0, 0.5, 0.0], (4, 1)))
    server.flush()
    r, g, b = pixels(page)[middle].mean((0, 1))
    assert g > r + 40
    assert errors == []
    page.close()


def test_without_an_answer_the_plain_foam_is_drawn(browser, server, monkeypatch):
    monkeypatch.setattr("app.patch.GRACE", 1.0)
    monkeypatch.setattr("app.patch.Patch.script", lambda self: "/* a viser whose inner names have changed */")
    water = make_water(server)
    page, errors = visit(browser, server)
    assert wait(page, lambda: water.alive is False)
    before = pixels(page)
    water.set_surface(*surface(foam=1.0))
    server.flush()
    after = pixels(page)
    assert after[130:190, 60:260].mean() > before[130:190, 60:260].mean() + 30
    assert errors == []
    page.close()


def test_plain_water_sends_no_script(browser, server):
    water = make_water(server, plain=True)
    page, errors = visit(browser, server)
    assert wait(page, lambda: len(server.get_clients()) == 1)
    page.wait_for_timeout(2000)
    assert water.alive is False
    assert materials(page) == {}
    assert errors == []
    page.close()


def test_the_exported_page_is_dressed_without_a_server(browser, server, tmp_path):
    make_water(server, tiles=3)
    file = tmp_path / "sea.html"
    file.write_text(server.get_scene_serializer().as_html(), encoding="utf-8")
    page = browser.new_page(viewport={"width": 320, "height": 200})
    errors: list[str] = []
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.goto(file.as_uri())
    assert wait(page, lambda: materials(page) == {"/sea": "springtide-water/sea"})
    assert errors == []
    page.close()


def test_the_script_is_sent_once_however_many_nodes_ask(server):
    first = patch(server)
    make_water(server)
    make_water(server)
    scripts = [
        message
        for message in server._websock_server._broadcast_buffer.message_from_id.values()
        if type(message).__name__ == "RunJavascriptMessage"
    ]
    assert patch(server) is first
    assert len(scripts) == 1
