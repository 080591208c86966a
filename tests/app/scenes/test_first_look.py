"""What a scene shows where nothing is asked for: something that still moves after half a minute."""

import numpy as np
import pytest

from app.panel.recording.recording_files import arrays_of
from app.render.staff import HEIGHT, PLACE
from app.scenes import NAMES, scene_named, view_named
from app.scenes.contract import AnyKind
from app.scenes.mooring.arrangement import first_places
from app.scenes.setups import make_setup
from app.scenes.square_sea.parameters import DRAUPNER, PRESETS, SquareSeaParams, gauge_home
from app.scenes.square_sea.view import SquareSeaView, camera_of
from tests.app.render.test_cameras import in_picture

DURATION, LATER = 30.0, 0.5  # [s] of simulated time
LOOKS = 5  # within LATER
SHORT = 8.0  # [s] of the cloth, which takes half as long to compute as it lasts
MIN_MOVE = 0.01  # [m]
SMALL_ASPECT = 0.93  # width over height of the part of a window of 760 x 475 that panel and time line leave free
SHOWN_ASPECT = 1.05  # width over height of what js/page/camera.js shows beside the panel


def drawn(kind: AnyKind, frame: object) -> np.ndarray:
    """The points (n, 3) [m] that a scene draws: of its frame, the first array that it declares in metres."""
    name = next(name for name, unit in kind.frame_units.items() if unit.partition(",")[0] == "m")
    return np.array(dict(arrays_of(frame))[name]).reshape(-1, 3)


@pytest.mark.long  # half a minute of each scene
@pytest.mark.parametrize(
    ("name", "duration"),
    [
        ("cloth", SHORT),
        *(pytest.param(name, DURATION, marks=pytest.mark.stress if name == "cloth" else []) for name in NAMES),
    ],
)
def test_the_first_look_still_moves_after_half_a_minute(name: str, duration: float) -> None:
    kind = scene_named(name)
    scene = kind.make(make_setup(kind).params)
    while scene.time < duration:
        scene.advance(max(1, round(1 / 60 / scene.step)))
    before = drawn(kind, scene.frame())
    moved = []
    for _ in range(LOOKS):  # what swings may be where it was after one of them
        scene.advance(round(LATER / LOOKS / scene.step))
        moved.append(np.abs(drawn(kind, scene.frame()) - before).max())
    assert max(moved) > MIN_MOVE


@pytest.mark.parametrize("name", ["rope", "race", "cloth"])
def test_what_hangs_takes_about_half_of_the_picture_s_height(name: str) -> None:
    kind, view = scene_named(name), view_named(name)
    params = make_setup(kind).params
    scene = kind.make(params)
    position, target = np.array(view.first_view(object.__new__(view), params))
    ahead = (target - position) / np.linalg.norm(target - position)
    right = np.cross(ahead, (0.0, 0.0, 1.0)) / np.hypot(*ahead[:2])
    shares = []
    for _ in range(10):
        scene.advance(round(0.5 / scene.step))
        seen = drawn(kind, scene.frame()) - position
        picture = 2.0 * np.tan(0.5 * view.FIELD_OF_VIEW) * (seen @ ahead)
        shares.append(np.ptp(seen @ np.cross(right, ahead) / picture))
        assert (abs(seen @ right) < 0.59 * picture).all()  # at 1280 x 800 the panel covers the rest
    assert 0.4 < max(shares) < 0.75, shares


@pytest.mark.parametrize(
    ("name", "preset", "duration"),
    [
        ("rope", "Pendulum", 2.2),
        ("rope", "Lab code: 10 points", 2.2),
        ("rope", "Over the sphere", 1.0),
        ("rope", "Stiff rope", 0.2),
        ("rope", "Shaken at the root", 2.0),
        ("cloth", "Trampoline", 0.8),
        ("cloth", "Drape over the sphere", 0.6),
    ],
)
def test_the_first_view_holds_the_whole_motion(name: str, preset: str, duration: float) -> None:
    """A period of the pendulum, ropes from their start, half the stroke of a sphere, a fall on a sphere."""
    kind, view = scene_named(name), view_named(name)
    params = make_setup(kind, preset).params
    scene = kind.make(params)
    position, target = view.first_view(object.__new__(view), params)
    seen = []
    while scene.time < duration:
        frame = scene.frame()
        points = [drawn(kind, frame)]
        if frame.sphere is not None:
            center, radius = np.array(frame.sphere[:3]), frame.sphere[3]
            points.append(center + radius * np.concatenate([np.eye(3), -np.eye(3)]))
        seen.append(in_picture(position, target, view.FIELD_OF_VIEW, np.concatenate(points)))
        scene.advance(round(0.1 / scene.step))
    x, y = abs(np.concatenate(seen)).max(axis=0)
    assert 0.6 < x < SMALL_ASPECT
    assert y < 0.95


@pytest.mark.parametrize(
    ("preset", "trough", "crest"),
    [("Draupner", -8.0, DRAUPNER.crest), ("Peregrine breather", -1.5, 2.5), ("Steep storm", -2.5, 5.6)],
)
def test_the_first_view_holds_the_wave_beside_the_staff_from_trough_to_crest(
    preset: str, trough: float, crest: float
) -> None:
    """In [m] over still water. The crest stands against the sky."""
    params = SquareSeaParams(**PRESETS[preset])
    position, target = camera_of(params)
    staff = np.array([(*gauge_home(params), height) for height in (trough, 0.0, crest)])
    x, y = in_picture(position, target, SquareSeaView.FIELD_OF_VIEW, staff).T
    assert abs(x).max() < SMALL_ASPECT
    assert abs(y).max() < 0.9
    assert y[2] - y[0] > 0.6
    assert crest > position[2]


@pytest.mark.parametrize("name", ["rope", "race", "cloth"])
def test_the_staff_of_one_metre_is_in_the_first_picture(name: str) -> None:
    kind, view = scene_named(name), view_named(name)
    position, target = view.first_view(object.__new__(view), make_setup(kind).params)
    staff = np.array([(*PLACE, 0.0), (*PLACE, HEIGHT)])
    assert HEIGHT == 1.0
    assert (abs(in_picture(position, target, view.FIELD_OF_VIEW, staff)) < (SHOWN_ASPECT, 1.0)).all()


@pytest.mark.parametrize("preset", scene_named("mooring").presets)
def test_body_and_anchors_fill_the_first_picture_of_a_mooring(preset: str) -> None:
    kind, view = scene_named("mooring"), view_named("mooring")
    params = make_setup(kind, preset).params
    position, target = view.first_view(object.__new__(view), params)
    box = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.3, 0.8)]) * params.size
    points = np.concatenate([kind.make(params).frame().body + box, first_places(params).anchors])
    x, y = in_picture(position, target, view.FIELD_OF_VIEW, points).T
    assert abs(x).max() < SHOWN_ASPECT
    assert abs(y).max() < 1.0
    assert np.ptp(x) > 1.6 or np.ptp(y) > 1.1
    horizon = in_picture(position, target, view.FIELD_OF_VIEW, np.array([(0.0, 1e7, 0.0)]))[0, 1]
    assert 0.6 < horizon < 0.9


@pytest.mark.parametrize("name", NAMES)
def test_the_first_look_is_a_preset_and_each_preset_has_one_sentence_of_its_own(name: str) -> None:
    kind = scene_named(name)
    assert kind.opening in ("", *kind.presets)
    assert list(kind.about) == list(kind.presets)
    for sentence in kind.about.values():
        assert sentence.endswith(".")
        assert len(sentence.split()) <= 20
    assert len(set(kind.about.values())) == len(kind.about)
