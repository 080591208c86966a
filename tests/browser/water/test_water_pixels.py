"""In a real Chromium: the square sea, from near and from far, shows no border of its tile, nor does it repeat.

Foam, materials and colours reach the pixels. The tests share one page, as its programs take a core ten seconds; each
leaves the sea as it was, as they run in any order.
"""

import dataclasses
import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.render.coloured_mesh import ColouredMesh
from app.render.material import Material
from app.render.skies import set_sky
from app.render.water import DrawnWater, Tile
from app.server.web.guard import open_server
from tests.browser.conftest import NO_NOTES, new_page
from tests.browser.water.test_water import PANEL_HIDDEN, wait

N, LENGTH = 64, 256.0  # points and metres along a side of the tile
WIDTH = 160  # [pixels] of the square picture
FIELD_OF_VIEW = 0.65  # [rad]
SHORT_TILE = 16  # [pixels]
TIME = 7.0  # [s]
RED = Material(deep_color=(0.6, 0.1, 0.1), scatter_color=(0.6, 0.1, 0.1), reflection_factor=0.0, draw_sky=False)


def waves(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, slopes and foam of a periodic sea that is Gaussian, of waves of 20 to 80 m."""
    rng = np.random.default_rng(seed)
    kx, ky = np.meshgrid(np.fft.fftfreq(N, LENGTH / N), np.fft.fftfreq(N, LENGTH / N), indexing="ij")
    k = np.hypot(kx, ky)
    spectrum = np.where((k > 1 / 80) & (k < 1 / 20), np.maximum(k, 1e-9) ** -1.5, 0.0)
    wave = np.fft.fft2(rng.normal(size=(N, N))) * spectrum
    height, *slopes = (np.fft.ifft2(part * wave).real for part in (1.0, 2j * np.pi * kx, 2j * np.pi * ky))
    scale = 0.12 / np.std(slopes)
    x, y = np.meshgrid(np.arange(N) * LENGTH / N, np.arange(N) * LENGTH / N, indexing="ij")
    foam = np.clip(height / height.std() - 1.2, 0.0, 1.0)
    return np.stack([x, y, scale * height], -1), scale * np.stack(slopes, -1), foam


def height_over(tile: int) -> float:
    """From which height [m] the tile is this many pixels long."""
    return 0.5 * LENGTH * WIDTH / tile / np.tan(0.5 * FIELD_OF_VIEW)


class Picture:
    """A page that looks straight down at a sea."""

    def __init__(self, chromium: Any, seed: int = 1) -> None:
        self.seen: dict[float, np.ndarray] = {}  # brightness by height
        self.server = open_server("127.0.0.1", 0).server
        self.server.initial_camera.fov = FIELD_OF_VIEW
        sky = set_sky(self.server, "park")
        self.material = dataclasses.replace(sky, haze_distance=1e6, sun_disc=0.0, clouds=0.0)
        self.put_sea(seed)
        self.page = new_page(chromium, WIDTH, WIDTH, drawn=True)
        self.errors: list[str] = []
        self.page.on("console", lambda line: self.errors.append(line.text) if line.type == "error" else None)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(f"http://127.0.0.1:{self.server.get_port()}/?hideViserLogo&fixedDpr=1")
        assert wait(self.page, lambda: self.water.has_shader is True)
        self.page.add_style_tag(content=NO_NOTES + PANEL_HIDDEN)

    def put_sea(self, seed: int = 1) -> None:
        """Draw the waves of this seed."""
        self.water = DrawnWater(self.server, "/sea", Tile(N, N, LENGTH), self.material)
        self.water.set_surface(*waves(seed), TIME)

    def from_height(self, height: float) -> np.ndarray:
        """(WIDTH, WIDTH) brightness, 0 to 255, seen from above the corner of four tiles; rows along x."""
        if height in self.seen:
            return self.seen[height]
        self.rise_to(height)
        shots: list[np.ndarray] = []

        def unchanged() -> bool:
            self.page.wait_for_timeout(400)
            shots.append(self.shot())
            return len(shots) > 2 and bool((shots[-1] == shots[-2]).all() and (shots[-1] == shots[-3]).all())

        assert wait(self.page, unchanged)
        self.seen[height] = shots[-1].mean(-1)
        return self.seen[height]

    def rise_to(self, height: float) -> None:
        (client,) = self.server.get_clients().values()
        client.camera.position = (LENGTH - 1e-3 * height, LENGTH, height)
        client.camera.look_at = (LENGTH, LENGTH, 0.0)

    def shot(self) -> np.ndarray:
        """(WIDTH, WIDTH, 3) colours, 0 to 255, as they are at this moment."""
        return np.asarray(Image.open(io.BytesIO(self.page.screenshot())).convert("RGB")).astype(float)

    def redness(self) -> float:
        """How much more red than blue the picture is."""
        red, _, blue = self.shot().mean((0, 1))
        return float(red - blue)

    def close(self) -> None:
        self.page.close()
        self.server.stop()


@pytest.fixture(scope="module")
def picture(chromium: Any) -> Iterator[Picture]:
    picture = Picture(chromium)
    yield picture
    picture.close()


HEIGHTS = [
    20.0,
    height_over(SHORT_TILE),
    *(pytest.param(height, marks=pytest.mark.stress) for height in (2.0, 300.0, 2e3)),
]


@pytest.mark.long
@pytest.mark.parametrize("height", HEIGHTS)
def test_a_tile_s_border_is_as_any_place_within_it(picture: Picture, height: float) -> None:
    """Borders along x and y cross in the middle of the picture."""
    seen = picture.from_height(height)
    assert seen.std() > 1.0  # there is something to see
    for across in (seen, seen.T):
        difference = np.abs(np.diff(across, axis=0)).mean(axis=1)
        border = difference[WIDTH // 2 - 2 : WIDTH // 2 + 1]
        assert border.max() < difference.mean() + 4.0 * difference.std()


@pytest.mark.long
@pytest.mark.parametrize("tile", [SHORT_TILE, pytest.param(40, marks=pytest.mark.stress)])
def test_the_sea_does_not_repeat(picture: Picture, tile: int) -> None:
    """From so high that the tile is this many pixels long: places a tile apart are not alike."""
    seen = picture.from_height(height_over(tile))
    seen = seen - sum(np.roll(seen, (i, j), (0, 1)) for i in range(-4, 5) for j in range(-4, 5)) / 81
    seen = seen[8:-8, 8:-8]
    for first, second in ((seen[tile:], seen[:-tile]), (seen[:, tile:], seen[:, :-tile])):
        assert abs((first * second).mean() / seen.var()) < 0.15


@pytest.mark.stress  # two more pages, whose shaders take seconds to compile
def test_the_same_seed_gives_the_same_picture(chromium: Any, picture: Picture) -> None:
    shown = {}
    for name, seed in (("again", 1), ("another", 2)):
        other = Picture(chromium, seed)
        shown[name] = other.from_height(20.0)
        other.close()
    first = picture.from_height(20.0)
    assert (shown["again"] == first).all()
    assert np.abs(shown["another"] - first).mean() > 1.0


def test_foam_another_material_and_another_size_reach_the_pixels(picture: Picture) -> None:
    """It puts another sea in its place, and then that of the other tests again."""
    server, water, page = picture.server, picture.water, picture.page
    vertices, slopes, foam = waves(1)

    def show(foam: np.ndarray) -> None:
        with server.atomic():
            water.set_surface(vertices, slopes, foam, TIME)
        server.flush()

    def brightness() -> float:
        return float(picture.shot().mean())

    picture.rise_to(20.0)
    show(0.0 * foam)
    assert wait(page, lambda: picture.redness() < 0.0)
    before = brightness()
    show(np.ones_like(foam))
    assert wait(page, lambda: brightness() > before + 60.0)
    show(0.0 * foam)
    assert wait(page, lambda: brightness() < before + 10.0)

    water.set_material(RED)  # without a new script
    server.flush()
    assert wait(page, lambda: picture.redness() > 20.0)
    water.set_material(picture.material)
    server.flush()
    assert wait(page, lambda: picture.redness() < 0.0)

    with server.atomic():  # viser may keep the material for the new geometry, and with it the uniforms
        water.remove()
        water = DrawnWater(server, "/sea", Tile(N // 2, N // 2, LENGTH), RED)
        water.set_surface(*(field[::2, ::2] for field in (vertices, slopes, foam)), TIME)
    server.flush()
    assert wait(page, lambda: picture.redness() > 20.0)
    assert picture.errors == []  # all programs were linked, that of the sky too

    water.remove()
    picture.put_sea()
    assert wait(page, lambda: picture.water.has_shader is True and picture.redness() < 0.0)


def test_the_sky_is_blue_and_without_gaps_down_to_the_sea(picture: Picture) -> None:
    """Seen across the water, away from the sun: sea and sky are shaded in tiles, those with both of them twice."""
    (client,) = picture.server.get_clients().values()
    client.camera.position = (LENGTH, LENGTH, 30.0)
    client.camera.look_at = (0.0, LENGTH + 40.0, 30.0)

    def is_whole() -> bool:
        rows = picture.shot()[: WIDTH // 2 - 4]  # the horizon is in the middle
        return bool((rows[..., 2] - rows[..., 0]).min() > 5.0 and np.abs(np.diff(rows, axis=0)).max() < 10.0)

    assert wait(picture.page, is_whole)


def test_colours_reach_the_vertices_of_a_streaming_mesh(picture: Picture) -> None:
    """It lies over the sea."""
    picture.rise_to(20.0)
    corners = LENGTH * np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]) + np.array([0.0, 0.0, 10.0])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    red = np.tile([0.5, 0.0, 0.0], (4, 1))
    coloured = ColouredMesh(picture.server, "/quad", corners, faces, red, columns=2, step=1e-3, color=(0, 0, 255))
    assert wait(picture.page, lambda: coloured.has_shader is True)

    def excess(this: int, other: int) -> float:
        middle = picture.shot()[70:90, 70:90].mean((0, 1))
        return float(middle[this] - middle[other])

    assert wait(picture.page, lambda: excess(0, 2) > 40)
    with picture.server.atomic():
        coloured.set(vertices=corners + np.array([0.0, 0.0, 1.0]), colors=np.tile([0.0, 0.5, 0.0], (4, 1)))
    picture.server.flush()
    assert wait(picture.page, lambda: excess(1, 0) > 40)
    coloured.remove()
    assert picture.errors == []
