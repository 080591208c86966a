"""A reset puts what a browser has moved back to where a new scene has it (`Scene.reset`)."""

from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Place, PointAlong
from app.scenes import NAMES, scene_named

SMALL: dict[str, dict[str, Any]] = {
    "rope": {"points": 6, "sphere": True},
    "race": {"points": 5, "ropes": 2},
    "cloth": {"rows": 5, "cols": 6, "sphere": True},
    "square_sea": {"size": "64", "mesh": "64", "plot_wave_gauge": True},
    "radial_sea": {"bodies": 2, "rings": 20, "spokes": 24},
}
MOVES = (
    *(Place(thing, (0.4, 0.3, 1.7)) for thing in ("root", "sphere", "pin a", "pin b", "camera")),
    PointAlong((40.0, 60.0, 8.0), (0.9, 0.3, -0.12)),
    GrabTo(1, (0.5, 0.5, 2.0)),
)


def numbers(part: object) -> list[np.ndarray]:
    """All numbers of a frame, in order."""
    if isinstance(part, tuple):
        return [array for one in part for array in numbers(one)]
    return [np.asarray(part)] if isinstance(part, np.ndarray | float | int) else []


@pytest.mark.parametrize("name", NAMES)
def test_what_a_browser_has_moved_goes_back(name: str) -> None:
    kind = scene_named(name)
    params = kind.params(**SMALL.get(name, {}))
    scene, new = kind.make(params), kind.make(params)
    for move in MOVES:
        scene.handle(move)
    for _ in range(10):
        scene.advance(2)
        scene.frame()
    scene.reset()
    for found, wanted in zip(numbers(scene.frame()), numbers(new.frame()), strict=True):
        np.testing.assert_array_equal(found, wanted)
