"""The documentation as a site: its gallery has all presets."""

from app.scenes import NAMES, scene_named
from tests.docs.pages import ROOT


def test_the_gallery_has_a_picture_of_every_preset() -> None:
    wanted = {f"{name}_{number}.jpg" for name in NAMES for number in range(1, len(scene_named(name).presets) + 1)}
    assert {path.name for path in (ROOT / "assets" / "pictures" / "presets").iterdir()} == wanted
    page = (ROOT / "docs" / "gallery.md").read_text("utf-8")
    assert [name for name in NAMES if f"{{gallery}} {name}\n" not in page] == []
