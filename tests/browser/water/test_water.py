"""In a real Chromium: the shaders reach stock viser, and the pixels show it.

These tests fail when one of viser's inner names that `app/render/injection.py` uses changes.
"""

import dataclasses
import io
import time
from collections.abc import Iterator

import numpy as np
import pytest
import viser
from PIL import Image

from app.render.scripts import tags
from app.render.skies import set_sky
from app.render.water import DrawnWater, Tile
from app.server.viewer import Viewer
from app.server.web.guard import open_server
from app.server.web.page import covered
from sim.ocean.radial.radial_grid import RadialGrid
from tests.browser.conftest import NO_NOTES, new_page, vertices_of

SIZE = 32
LENGTH = 64.0  # [m]
PANEL_HIDDEN = ".mantine-Paper-root, #springtide-cover { display: none !important }"


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    server = open_server("127.0.0.1", 0).server
    server.initial_camera.position = (-20.0, 32.0, 25.0)
    server.initial_camera.look_at = (32.0, 32.0, 0.0)
    yield server
    server.stop()


def visit(chromium, server: viser.ViserServer, drawn: bool = True):
    """A page on the server and the list that its errors go to."""
    page = new_page(chromium, 320, 200, drawn)
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
    page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN)
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(float)


def final_pixels(page) -> np.ndarray:
    """The pixels when they no longer change: viser fades its canvas in while the sky loads."""
    shots = [pixels(page)]

    def unchanged() -> bool:
        page.wait_for_timeout(700)
        shots.append(pixels(page))
        return bool(np.abs(shots[-1] - shots[-2]).max() < 2)

    assert wait(page, unchanged)
    return shots[-1]


def surface(phase: float = 0.0, foam: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One sine wave that fits the tile."""
    x = np.arange(SIZE) * LENGTH / SIZE
    x, y = np.meshgrid(x, x, indexing="ij")
    k = 2 * np.pi / LENGTH
    vertices = np.stack([x, y, np.sin(k * x + phase)], -1)
    slopes = np.stack([k * np.cos(k * x + phase), 0 * x], -1)
    return vertices, slopes, np.full((SIZE, SIZE), foam)


def make_water(server: viser.ViserServer) -> DrawnWater:
    material = dataclasses.replace(set_sky(server, "park"), draw_sky=False)
    water = DrawnWater(server, "/sea", Tile(SIZE, SIZE, LENGTH), material)
    water.set_surface(*surface())
    return water


def materials(page) -> dict[str, str]:
    """The key of the shader that each node's material has."""
    return page.evaluate(
        """() => Object.fromEntries(Object.entries(window.__viserMutable?.nodeRefFromName ?? {})
            .map(([name, group]) => [name, group?.children?.find(c => c.isMesh && c.visible && c.layers.mask)
                ?.material.userData.springtide])
            .filter(([, key]) => key))"""
    )


def test_the_script_answers_and_what_is_drawn_is_where_it_should_be(chromium, server):
    water = make_water(server)
    page, errors = visit(chromium, server, drawn=False)
    assert wait(page, lambda: water.has_shader is True)
    assert materials(page) == {"/sea": "springtide-water/sea lit"}
    assert errors == []
    moved, slopes, foam = surface(phase=1.0)
    moved += [0.3, -0.2, 0.1]
    water.set_surface(moved, slopes, foam)
    closed = np.concatenate([moved, moved[:1] + [LENGTH, 0.0, 0.0]])
    closed = np.concatenate([closed, closed[:, :1] + [0.0, LENGTH, 0.0]], axis=1).reshape(-1, 3)
    # No drawn point is off by half a pixel of a picture with 1080 rows, seen from the camera.
    pixel = 2.0 * np.tan(np.radians(75.0) / 2.0) / 1080 * (25.0 - 1.1)
    assert wait(page, lambda: np.abs(vertices_of(page, "/sea") - closed).max() < 0.5 * pixel)
    page.close()


@pytest.mark.long
def test_a_later_page_and_a_reloaded_one_have_the_shader_too(chromium, server):
    water = make_water(server)
    first, _ = visit(chromium, server, drawn=False)
    assert wait(first, lambda: water.has_shader is True)
    second, errors = visit(chromium, server, drawn=False)
    assert wait(second, lambda: len(server.get_clients()) == 2 and water.has_shader is True)
    second.reload()
    assert wait(second, lambda: materials(second) != {})
    assert errors == []
    first.close()
    second.close()


def test_a_sea_whose_material_viser_makes_anew_keeps_its_shader(chromium, server):
    water = make_water(server)
    page, errors = visit(chromium, server, drawn=False)
    assert wait(page, lambda: water.has_shader is True)
    page.evaluate("window.was = window.__viserMutable.nodeRefFromName['/sea'].children[0].material.uuid")
    water.mesh.side = "double"
    server.flush()
    new = "window.__viserMutable.nodeRefFromName['/sea'].children[0].material.uuid !== window.was"
    assert wait(page, lambda: page.evaluate(new))
    assert wait(page, lambda: materials(page) == {"/sea": "springtide-water/sea lit"}, 10)
    assert errors == []
    page.close()


def test_sizes_change_live_and_nothing_is_left_behind(chromium, server):
    material = set_sky(server, "park")
    page, errors = visit(chromium, server, drawn=False)
    assert wait(page, lambda: page.evaluate("window.__viserMutable?.scene?.environment != null"))

    def held() -> dict[str, int]:
        return page.evaluate("window.__springtide?.memory() ?? {}")

    def settled() -> dict[str, int] | None:
        before = held()
        page.wait_for_timeout(700)
        return before if held() == before else None

    empty: dict[str, int] | None = None
    for size in (64, 16, 64, 16):
        water = DrawnWater(server, "/sea", Tile(size, size, LENGTH), material)
        x = np.arange(size) * LENGTH / size
        x, y = np.meshgrid(x, x, indexing="ij")
        water.set_surface(np.stack([x, y, 0 * x], -1), np.zeros((size, size, 2)), np.zeros((size, size)))
        server.flush()
        assert wait(page, lambda water=water: water.has_shader is True)
        full = held()
        water.remove()
        server.flush()
        assert wait(page, lambda full=full: held()["geometries"] < full["geometries"])
        if empty is None:
            page.wait_for_timeout(300)
            assert wait(page, lambda: settled() is not None)
            empty = held()
        assert wait(page, lambda empty=empty: held() == empty, 10)
    assert errors == []
    page.close()


def test_a_sea_of_rings_is_water_too(chromium, server):
    grid = RadialGrid(rings=8, spokes=24, inner=1.0, radius=60.0)
    water = DrawnWater(server, "/disc", grid, set_sky(server, "park"))
    vertices = np.column_stack([grid.x, grid.y, 0.0 * grid.x])[None]
    water.set_surface(vertices, np.zeros((1, len(grid), 2)), np.ones((1, len(grid))))
    page, errors = visit(chromium, server, drawn=False)
    assert wait(page, lambda: water.has_shader is True)
    assert materials(page) == {"/disc": "springtide-water/disc RINGS lit"}
    assert errors == []
    page.close()


@pytest.fixture
def no_answer(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As with a viser of another page."""
    monkeypatch.setattr("app.render.injection.MAX_ANSWER_TIME", 1.0)
    monkeypatch.setattr("app.render.client_page.tags", lambda entry: "")
    covered.cache_clear()
    yield
    covered.cache_clear()


def test_without_an_answer_the_page_has_the_plain_foam(chromium, server, no_answer):
    water = make_water(server)
    page, errors = visit(chromium, server, drawn=False)
    assert wait(page, lambda: water.has_shader is False)

    def foam_height() -> float:
        """Of the foam over the sea [m]; foam that is not shown is under it."""
        foam, sea = (vertices_of(page, name) for name in ("/sea/plain_foam", "/sea"))
        return float((foam - sea)[:, 2].min()) if foam.shape == sea.shape else -np.inf

    assert foam_height() < 0.0
    for amount, shown in ((1.0, True), (0.0, False)):
        water.set_surface(*surface(foam=amount))
        server.flush()
        assert wait(page, lambda shown=shown: (foam_height() > 0.0) is shown)
    assert errors == []
    page.close()


@pytest.mark.stress  # a page that is drawn, whose shaders take seconds to compile
def test_without_an_answer_the_plain_foam_is_drawn(chromium, server, no_answer):
    water = make_water(server)
    page, errors = visit(chromium, server)
    assert wait(page, lambda: water.has_shader is False)
    before = final_pixels(page)[130:190, 60:260].mean()
    water.set_surface(*surface(foam=1.0))
    server.flush()
    assert wait(page, lambda: pixels(page)[130:190, 60:260].mean() > before + 30)
    assert errors == []
    page.close()


@pytest.mark.long
def test_plain_water_is_drawn_by_viser_alone(chromium):
    viewer = Viewer("127.0.0.1", 0, plain=True)
    viewer.open("square_sea")
    page, errors = visit(chromium, viewer.server, drawn=False)
    assert wait(page, lambda: page.locator(".springtide-panel[data-state]").count())
    assert wait(page, lambda: len(vertices_of(page, "/sea")) > 0)
    page.wait_for_timeout(500)
    assert materials(page) == {}
    assert errors == []
    page.close()
    viewer.shut()


def test_an_exported_page_has_the_shader_without_a_server(chromium, server, tmp_path):
    make_water(server)
    file = tmp_path / "sea.html"
    page_of_viser = server.get_scene_serializer().as_html()
    file.write_text(page_of_viser.replace("</body>", f"{tags('scene/main.js')}</body>", 1), encoding="utf-8")
    page = new_page(chromium, 320, 200, drawn=False)
    errors: list[str] = []
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.goto(f"{file.as_uri()}?fixedDpr=1")
    assert wait(page, lambda: materials(page) == {"/sea": "springtide-water/sea lit"})
    assert errors == []
    page.close()
