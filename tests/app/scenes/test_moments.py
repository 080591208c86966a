"""A scene resumes from a checkpoint exactly as it continued then, to the last bit."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Place, Release
from app.scenes import scene_named
from app.scenes.checkpoints import arrays_in

CASES = {
    "rope": ({"points": 8, "integrator": "rk4", "sphere": True}, 40),
    "race": ({"ropes": 2, "points": 6}, 10),
    "cloth": ({"rows": 8, "cols": 9, "sphere": True}, 10),
    "square_sea": ({"size": "64", "mesh": "64", "length": 20.0, "rain": 100.0}, 4),
    "mooring": ({"lines": 2, "segments": 8}, 10),
    "radial_sea": ({"bodies": 3, "rings": 20, "spokes": 24, "jet": True, "fire": True}, 24),
}


def run(scene: Any, frames: int, steps: int) -> dict[str, np.ndarray]:
    for _ in range(frames):
        scene.advance(steps)
        scene.frame()
    sphere = getattr(scene.frame(), "sphere", None)
    found = {name: array.copy() for name, (array, _) in scene.arrays().items()}
    return found | {"sphere": np.array(sphere or ())}


@pytest.mark.parametrize("name", CASES)
def test_a_kept_state_is_gone_on_from_twice_to_the_last_bit(name: str) -> None:
    values, steps = CASES[name]
    kind = scene_named(name)
    scene = kind.make(kind.params(**values))
    run(scene, 3, steps)
    scene.handle(Place("sphere", (0.0, 0.0, 1.2)))  # under way when the state is kept, where the scene has one
    run(scene, 1, steps)
    time, kept = scene.time, scene.keep()
    first = run(scene, 5, steps)
    for _ in range(2):
        scene.resume(kept)
        assert scene.time == time
        again = run(scene, 5, steps)
        for key, array in first.items():
            np.testing.assert_array_equal(again[key], array, err_msg=key)
    assert any(not np.array_equal(run(scene, 1, steps)[key], array) for key, array in first.items())
    assert arrays_in(kept)


def test_what_was_held_is_let_go_of() -> None:
    kind = scene_named("rope")
    scene = kind.make(kind.params(points=6))
    scene.handle(GrabTo(4, (0.5, 0.5, 2.0), client=3))
    run(scene, 2, 10)
    kept = scene.keep()
    scene.handle(Release(3))
    scene.resume(kept)
    assert scene.handles.grab.grabbed is None  # type: ignore[attr-defined]
    run(scene, 1, 10)
    assert scene.net.grab is None  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("square_sea", {"wind_speed": 20.0, "transition": 0.5}),
        ("radial_sea", {"wind_speed": 15.0, "spill": "layer"}),
        ("rope", {"points": 12, "stiffness": 500.0}),
        ("cloth", {"rows": 12, "pinned": "rim"}),
    ],
)
def test_a_change_of_parameters_leaves_a_kept_state_alone(name: str, change: dict[str, Any]) -> None:
    values, steps = CASES[name]
    kind = scene_named(name)
    params = kind.params(**values)
    scene = kind.make(params)
    run(scene, 3, steps)
    kept = scene.keep()
    first = run(scene, 4, steps)
    scene.change_forces(dataclasses.replace(params, **change))
    run(scene, 4, steps)
    scene.params = params
    scene.resume(kept)
    for key, array in run(scene, 4, steps).items():
        np.testing.assert_array_equal(array, first[key], err_msg=key)
