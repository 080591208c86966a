"""Each scene of the program has a small picture to choose it by; an added one need not have any."""

import base64
import contextlib
import io
from importlib import resources
from types import SimpleNamespace
from typing import Any

import pytest
from PIL import Image

from app.panel.controls.scene_pictures import add_scene_pictures, picture
from app.scenes import NAMES
from sim.parameters import in_words

PICTURES = sorted(file.name for file in (resources.files("assets") / "scenes").iterdir())


def test_all_scenes_but_added_ones_have_a_picture() -> None:
    assert len(PICTURES) == 6
    assert {name.removesuffix(".jpg") for name in PICTURES} <= set(NAMES)
    assert picture("pendulum") == ""


@pytest.mark.parametrize("file", PICTURES)
def test_a_scene_has_a_small_picture(file: str) -> None:
    content = base64.b64decode(str(picture(file.removesuffix(".jpg"))).split(",")[1].removesuffix('">'))
    assert len(content) < 6000  # each page is sent all of them
    assert Image.open(io.BytesIO(content)).size == (160, 100)


def test_each_button_names_its_scene_and_shows_its_picture() -> None:
    found: list[str] = []
    gui: Any = SimpleNamespace(add_folder=lambda *_, **__: contextlib.nullcontext(), add_html=found.append)
    add_scene_pictures(gui, tuple(NAMES))
    for name in NAMES:
        content = f"{picture(name)}{in_words(name)}"
        assert f'<button type="button" data-springtide-act="scene" value="{name}">{content}</button>' in found[0]
