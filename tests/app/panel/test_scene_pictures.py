"""Each scene has a small picture to choose it by."""

import base64
import io

import pytest
from PIL import Image

from app.panel.controls.scene_pictures import picture
from app.scenes import NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_has_a_small_picture(name: str) -> None:
    content = base64.b64decode(picture(name))
    assert len(content) < 6000  # each page is sent all of them
    assert Image.open(io.BytesIO(content)).size == (160, 100)
