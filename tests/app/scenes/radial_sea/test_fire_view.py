"""Flames and smoke as they are handed to viser: what fades, what is dark, and what the browser's script relies on."""

import math
from collections.abc import Iterator
from importlib import resources

import numpy as np
import pytest
import viser

from app.render.material import Material
from app.scenes.radial_sea.drawing.fire_view import MAX_FIRE_SPLATS, Flames
from app.scenes.radial_sea.frame import JetParcels
from sim.particles.plume import soot_made

PLACES = np.full((3, 6), 1e4, np.float32)  # far from the light of the flames
ALONG = np.array([0.1, 0.5, 0.6, 0.8, 0.95, 1.0])
SPREAD = 20.0  # [m]


@pytest.fixture(scope="module")
def flames() -> Iterator[Flames]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield Flames(server, "/flames")
    server.stop()


def drawn(flames: Flames, heat: float, sun: float, spread: float = SPREAD, power: float = 1e6) -> np.ndarray:
    """Red, green, blue and opacity (6, 4), 0..255, of parcels of one heat at ALONG of the plume."""
    rows = np.stack([np.full(6, heat), np.full(6, 0.3), np.full(6, spread), ALONG]).astype(np.float32)
    flames.show((PLACES, rows), None, Material(sun_strength=sun), power)
    return np.asarray(flames.handle.buffer)[:6, 7].copy().view(np.uint8).reshape(6, 4).astype(float)


def test_smoke_is_as_opaque_as_its_soot_until_it_fades_out_towards_the_end(flames: Flames) -> None:
    """The soot of six parcels of 20 s, fewer of which are left as they grow old, over splats of 0.3 of the radius."""
    left = 1.0 - np.sqrt(np.clip((2.76 * ALONG - 0.12) / 2.64, 0.0, 1.0))
    soot = soot_made(1e6) * 20.0 / 6.0 / np.maximum(left, 0.02) / (2.0 * math.pi * (0.3 * 80.0) ** 2)
    fade = np.clip((1.0 - ALONG) / 0.9, 0.0, 1.0) ** 2
    assert drawn(flames, 0.0, 5.0, spread=80.0)[:, 3] == pytest.approx(
        255.0 * np.minimum(1.0 - np.exp(-soot), 0.5) * fade, abs=1.5
    )


def test_smoke_of_a_small_fire_is_thinner_and_grows_thinner_with_its_width(flames: Flames) -> None:
    small, large = (drawn(flames, 0.0, 5.0, spread=40.0, power=power)[0, 3] for power in (1e5, 4e8))
    wide = drawn(flames, 0.0, 5.0, spread=80.0, power=1e5)[0, 3]
    assert wide < 0.5 * small < 0.5 * large
    assert large == int(0.5 * 255)


@pytest.mark.filterwarnings("error")
def test_smoke_of_no_width_yet_is_no_denser_than_the_densest(flames: Flames) -> None:
    assert drawn(flames, 0.0, 5.0, spread=0.0)[0, 3] == int(0.5 * 255)


def test_smoke_is_thinner_at_the_rim_of_its_plume(flames: Flames) -> None:
    """Five parcels of one age: one in the middle, four at a radius of 0.6."""
    places = 1e4 + 0.6 * SPREAD * np.array([(0, 0, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)], np.float32).T
    rows = np.stack([np.zeros(5), np.full(5, 0.3), np.full(5, SPREAD), np.full(5, 0.05)]).astype(np.float32)
    flames.show((places, rows), None, Material(), 4e8)
    opacity = np.asarray(flames.handle.buffer)[:5, 7].copy().view(np.uint8).reshape(5, 4)[:, 3]
    assert opacity[0] == int(0.5 * 255)
    assert opacity[1:] == pytest.approx(0.64 * 0.5 * 255, abs=1.5)


def test_smoke_is_brighter_on_the_side_of_the_sun(flames: Flames) -> None:
    """Four parcels about one middle, far from the flames: towards the sun, away from it, and across."""
    places = 1e4 + 15.0 * np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)], np.float32).T
    rows = np.stack([np.zeros(4), np.full(4, 0.3), np.full(4, SPREAD), np.full(4, 0.2)]).astype(np.float32)
    flames.show((places, rows), None, Material(sun_strength=5.0, sun_direction=(2.0, 0.0, 0.0)), 4e8)
    rgba = np.asarray(flames.handle.buffer)[:4, 7].copy().view(np.uint8).reshape(4, 4)
    shades = rgba[:, 0] / flames.variety[1, :4]
    assert shades[0] / shades[1] == pytest.approx(1.55 / 0.45, rel=0.06)
    assert shades[2] == pytest.approx(shades[3], rel=0.03)


def test_oil_of_the_jet_is_drawn_as_streaks_along_its_way_that_become_thin(flames: Flames) -> None:
    velocity = np.array([(3.0, 4.0, 9.0), (3.0, 4.0, -12.0)], np.float32)
    number = np.flatnonzero(flames.oil_variety[1] > 0.5)[:1].repeat(2)
    flames.show(None, JetParcels(np.zeros((2, 3), np.float32), velocity, number), Material(), 4e8)
    words = np.asarray(flames.handle.buffer)[MAX_FIRE_SPLATS : MAX_FIRE_SPLATS + 2, 4:7].copy()
    widths = []
    for (xx, xy, xz, yy, yz, zz), v in zip(words.view(np.float16).astype(float), velocity, strict=True):
        variances, axes = np.linalg.eigh(np.array([(xx, xy, xz), (xy, yy, yz), (xz, yz, zz)]))
        assert abs(axes[:, 2] @ v) == pytest.approx(np.linalg.norm(v), rel=0.01)
        assert variances[2] > 9.0 * variances[1]
        widths.append(math.sqrt(variances[1]))
    assert widths[1] < 0.5 * widths[0]


def test_smoke_is_dark_at_night_and_flames_are_not(flames: Flames) -> None:
    day, night = drawn(flames, 0.0, 5.0)[:, :3], drawn(flames, 0.0, 0.5)[:, :3]
    assert night == pytest.approx(0.4 * day, abs=1.0)
    assert np.array_equal(drawn(flames, 0.9, 5.0), drawn(flames, 0.9, 0.5))


def test_viser_draws_splats_by_the_lines_that_the_script_changes() -> None:
    """Where one is missing, smoke is drawn by viser's own shader, with round edges (`js/scene/smoke.js`)."""
    source = resources.files("viser") / "client" / "src" / "Splatting" / "GaussianSplatsHelpers.ts"
    client = source.read_text("utf-8")
    script = (resources.files("app.render") / "js" / "scene" / "smoke.js").read_text("utf-8")
    for text in (
        "float B = exp(A) * vRgba.a;",
        "gl_FragColor = vec4(vRgba.rgb, B);",
        "in vec2 vPosition;",
        "out vec2 vPosition;",
        "vPosition = position.xy;",
        "position.x * v1",
        "position.y * v2",
        "vec2 diagonalVector",
        "mat4 T_camera_group",
        "textureT_camera_groups",
        "sortedIndex",
    ):
        assert text in script
        assert text in client
