"""The JavaScript of the page: the modules in `js/`, as they are written into a page.

A page holds all of them in an import map, each as a `data:` address under a name such as "springtide/sea/water.js". So
a page needs no further request, works at any path of a proxy, and a replay opens from a file. `shared.js` is made here:
it has the constants that Python and JavaScript share. The scripts in `js/before` are no modules: they run before
viser's client, each by itself.
"""

import functools
import json
import posixpath
import re
from collections.abc import Iterable
from importlib import resources
from urllib.parse import quote

from app.render.brightness import DARK_LIFT, LUMA
from app.render.markup.html import Html
from app.render.material import MAX_WATERLINES, RAIN_UNIFORMS, WATER_UNIFORMS

ROOMS = ("beside", "core", "page", "panel", "scene", "sea", "shading", "sharing")
BEFORE = ("failures.js", "address.js", "connection.js")  # of a lab
BEFORE_REPLAY = ("failures.js", "replay.js")
# The modules that start a lab, a replay, and the page with the panes.
PAGE, REPLAY, BESIDE = "page/main.js", "page/replay.js", "beside/main.js"
SHARED = {
    "WATER_UNIFORMS": WATER_UNIFORMS,
    "RAIN_UNIFORMS": RAIN_UNIFORMS,
    "MAX_WATERLINES": MAX_WATERLINES,
    "DARK_LIFT": DARK_LIFT,
    "LUMA": LUMA,
}
IMPORTED = re.compile(r'(\bfrom |\bimport[ (])"(\.{1,2}/[^"]+)"')
KEPT = " !\"$&'()*+,/:;=?@[]^`{|}~\\"  # characters that a data: address may have


@functools.cache
def modules() -> dict[str, str]:
    """Source of each module by its path in `js`."""
    folder = resources.files("app.render") / "js"
    sources = {
        f"{room}/{file.name}": file.read_text("utf-8")
        for room in ROOMS
        for file in (folder / room).iterdir()
        if file.name.endswith(".js")
    }
    shared = "".join(f"export const {name} = {json.dumps(value)};\n" for name, value in SHARED.items())
    return {**sources, "shared.js": shared}


def name_of(path: str) -> str:
    """The name by which a page imports a module."""
    return f"springtide/{path}"


def import_map(sources: dict[str, str]) -> Html:
    """An import map with these modules, whose imports of each other use its names."""

    def address(path: str, source: str) -> str:
        def renamed(match: re.Match[str]) -> str:
            return f'{match[1]}"{name_of(posixpath.normpath(posixpath.join(posixpath.dirname(path), match[2])))}"'

        text = f"{IMPORTED.sub(renamed, source)}\n//# sourceURL={name_of(path)}\n"
        return f"data:text/javascript;charset=utf-8,{quote(text, KEPT)}"

    addresses = {name_of(path): address(path, source) for path, source in sources.items()}
    return Html(f'<script type="importmap">{json.dumps({"imports": addresses})}</script>')


def tags(entry: str) -> Html:
    """Tags with all modules; a page starts this one."""
    return Html(f'{import_map(modules())}<script type="module">import "{name_of(entry)}";</script>')


def before_tags(names: Iterable[str]) -> Html:
    """Scripts in `js/before`, which run before viser's client."""
    folder = resources.files("app.render") / "js" / "before"
    return Html("".join(f"<script>{(folder / name).read_text('utf-8')}</script>" for name in names))
