"""The link to a set-up."""

from types import SimpleNamespace

import numpy as np

from app.panel.sharing.scene_switches import SceneSwitch
from app.panel.sharing.share import Share, camera_of
from app.scenes import scene_named
from app.scenes.setups import make_setup


def test_a_link_has_the_camera_of_the_browser_that_asks() -> None:
    camera = SimpleNamespace(position=np.array([1.0, 2.0, 3.0]), look_at=np.array([4.0, 5.0, 6.0]))
    assert camera_of(SimpleNamespace(camera=camera)) == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))  # type: ignore[arg-type]


def test_an_undo_names_the_scene_of_the_first_set_up() -> None:
    kind = scene_named("rope")
    share = SimpleNamespace(settings=SimpleNamespace(kind=kind, params=kind.params(), loaded=""))
    change = Share.change(share, "grids", "a page")  # type: ignore[arg-type]
    assert (change.scene, change.subject, change.before.scene) == ("radial_sea", "grids", "rope")


def test_the_line_of_a_change_has_the_page_that_made_it_and_what_is_shown() -> None:
    setup = make_setup(scene_named("rope"), "Pendulum")
    words = SceneSwitch("a-page", "rope", setup, setup).words()
    assert 'data-page="a-page"' in words
    assert words.count("<b>Rope</b> (Pendulum)") == 2
