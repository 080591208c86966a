"""Flames and smoke as they are handed to viser: what fades, what is dark, and what the browser's script relies on."""

from collections.abc import Iterator
from importlib import resources

import numpy as np
import pytest
import viser

from app.scenes.radial_sea.fire_view import Flames

PLACES = np.zeros((3, 6), np.float32)
ALONG = np.array([0.1, 0.5, 0.6, 0.8, 0.95, 1.0])
SPREAD = 20.0  # [m]


@pytest.fixture(scope="module")
def flames() -> Iterator[Flames]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield Flames(server, "/flames")
    server.stop()


def drawn(flames: Flames, heat: float, sun: float) -> np.ndarray:
    """Red, green, blue and opacity (6, 4), 0..255, of parcels of one heat at ALONG of the plume."""
    rows = np.stack([np.full(6, heat), np.full(6, 0.3), np.full(6, SPREAD), ALONG]).astype(np.float32)
    flames.show((PLACES, rows), None, sun)
    return np.asarray(flames.handle.buffer)[:6, 7].copy().view(np.uint8).reshape(6, 4).astype(float)


def test_smoke_fades_out_towards_the_end_of_the_plume(flames: Flames) -> None:
    opacity = drawn(flames, heat=0.0, sun=5.0)[:, 3]
    assert opacity[0] == opacity[1] == opacity[2] > 100
    assert opacity[3:] == pytest.approx(opacity[0] * np.array([0.5, 0.125, 0.0]), abs=1.0)


def test_smoke_is_dark_at_night_and_flames_are_not(flames: Flames) -> None:
    day, night = drawn(flames, 0.0, 5.0)[:, :3], drawn(flames, 0.0, 0.5)[:, :3]
    assert night == pytest.approx(0.4 * day, abs=1.0)
    assert np.array_equal(drawn(flames, 0.9, 5.0), drawn(flames, 0.9, 0.5))


def test_viser_draws_splats_by_the_lines_that_the_script_changes() -> None:
    """Where one is missing, smoke is drawn by viser's own shader, with round edges (`js/smoke.js`)."""
    source = resources.files("viser") / "client" / "src" / "Splatting" / "GaussianSplatsHelpers.ts"
    client = source.read_text("utf-8")
    script = (resources.files("app.render") / "js" / "smoke.js").read_text("utf-8")
    for text in (
        "float B = exp(A) * vRgba.a;",
        "in vec2 vPosition;",
        "out vec2 vPosition;",
        "vPosition = position.xy;",
        "textureT_camera_groups",
        "sortedIndex",
    ):
        assert text in script
        assert text in client
