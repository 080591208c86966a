"""The choice of scenes as pictures, in addition to the list of names."""

import base64
import functools
from importlib import resources

import viser

from app.render.markup.html import Html, fill, join
from sim.parameters import in_words

TITLE = "Scenes in pictures"


def add_scene_pictures(gui: viser.GuiApi, scenes: tuple[str, ...]) -> None:
    """Add a folder with a picture of each scene; a press opens the scene (js/panel/buttons.js)."""
    with gui.add_folder(TITLE, expand_by_default=False):
        buttons = join(
            fill(
                '<button type="button" data-springtide-act="scene" value="{}">{}{}</button>',
                name,
                picture(name),
                in_words(name),
            )
            for name in scenes
        )
        gui.add_html(str(fill('<div class="springtide-scenes">{}</div>', buttons)))


@functools.cache
def picture(scene: str) -> Html:
    """A small picture of a scene; nothing for one without a file in `assets/scenes`."""
    file = resources.files("assets") / "scenes" / f"{scene}.jpg"
    if not file.is_file():
        return Html("")
    return fill('<img alt="" src="data:image/jpeg;base64,{}">', base64.b64encode(file.read_bytes()).decode())
