"""Shaders that stock viser does not have: scripts of the page replace them in the browser.

viser 1.1 draws an ordinary mesh in one colour with one rough material. The scripts in `js/scene` and `js/sea` use
`window.__viserMutable` (`nodeRefFromName`, `scene`, `requestRender`, `sendMessage`);
`tests/browser/water/test_water.py` fails when these change.

Everything that changes travels as vertices of hidden meshes (`add_data_mesh`), because viser keeps only the newest
vertices of a mesh. Displacements of a drawn mesh travel packed (`app/formats/packing.py`), in a fifth of the bytes;
the drawn mesh's own vertices are sent only where a browser does not say that it has the shader. A hidden mesh named
"<node>/<suffix>" makes the script replace the shader of "<node>"; each file in `js/` names its suffix.

Each page reports whether that worked: the script says on topic "drawn" which nodes it has drawn with their shader,
whenever these change.
"""

import time
from typing import cast

import numpy as np
import viser

from app.render.handles.channel import Message, channel_of, topic_html
from app.render.markup.html import Html

MAX_ANSWER_TIME = 20.0  # [s] after which a browser counts as one without shaders; its first frame compiles them
CONTACT_SHADOW = "contact_shadow"

# Attribute of a server with its injector, None if shaders are disabled. A dictionary outside would keep both for good,
# as the injector refers to the server.
SHADERS = "springtide_shaders"


class ShaderInjector:
    """The shaders of one server: the nodes that should have one, and which browsers draw them so.

    Made by `injector_of(server)`. The viewer's thread watches nodes; reports come on viser's event loop.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._scene = 0  # number of the scene
        self._watched: dict[str, float] = {}  # node -> since when it is watched [s]
        self._sky = ""  # name of the sky that lights the scene; "" before the first picture
        self._seen: dict[int, float] = {}  # client id -> when it was first looked for [s]
        self._drawn: dict[int, frozenset[str]] = {}  # client id -> nodes that it draws with their shader
        self.whole: set[int] = set()  # clients that have shown a whole picture of the scene
        self.is_recorded = False  # True if drawing is only recorded, for pages that have the script
        server.on_client_disconnect(self._forget)
        self._channel = channel_of(server)
        self.restart()

    def restart(self) -> None:
        """Begin a scene in a new panel."""
        self._watched.clear()
        self._drawn.clear()
        self.whole.clear()
        self._sky = ""
        self._scene += 1
        self._channel.listen("drawn", dict, self._take)
        self._tell()

    def _take(self, message: Message[dict[str, object]]) -> None:
        """A page says which nodes it draws with their shader, and whether it has shown a whole picture of the scene."""
        client, names = message.client.client_id, message.value.get("nodes")
        if not isinstance(names, list) or message.value.get("scene") != self._scene:
            return  # of the scene before
        self._drawn[client] = frozenset(map(str, cast(list[object], names)))
        if message.value.get("isWhole") is True:
            self.whole.add(client)

    def _state(self) -> dict[str, object]:
        """A name of the scene, and the sky and the nodes that its whole picture has (`js/scene/frames.js`)."""
        return {"scene": self._scene, "sky": self._sky, "nodes": list(self._watched)}

    def whole_picture(self) -> Html:
        """The same for the page of a replay, which has no panel."""
        return topic_html("picture", self._state())

    def _tell(self) -> None:
        """Tell the pages the parts of a whole picture."""
        self._channel.tell("picture", self._state())

    async def _forget(self, client: viser.ClientHandle) -> None:
        """A browser has left."""
        self._drawn.pop(client.client_id, None)
        self.whole.discard(client.client_id)
        self._seen.pop(client.client_id, None)

    def expect_sky(self, name: str) -> None:
        """Expect this sky over the scene; called before it is sent, since a page names its skies as they arrive."""
        self._sky = name
        self._tell()

    def watch(self, name: str) -> None:
        """Expect every browser to draw this node with its shader from now on."""
        self._watched[name] = time.monotonic()
        self._tell()

    def unwatch(self, name: str) -> None:
        """A node is removed."""
        if self._watched.pop(name, None) is not None:
            self._tell()

    def is_active(self, name: str) -> bool | None:
        """True if every connected browser draws the node with its shader, False if one does not, None while unknown."""
        if self.is_recorded:
            return True
        clients = list(self._server.get_clients())
        if not clients:
            return None
        now = time.monotonic()
        without = [
            self._seen.setdefault(client, now) for client in clients if name not in self._drawn.get(client, frozenset())
        ]
        if not without:
            return True
        waited = now - max(self._watched.get(name, now), min(without))
        return False if waited > MAX_ANSWER_TIME else None


def disable_shaders(server: viser.ViserServer) -> None:
    """Draw everything on this server by viser's public API alone; to be called before anything is drawn."""
    setattr(server, SHADERS, None)


def record_shaders(server: viser.ViserServer) -> ShaderInjector:
    """Leave out vertices for browsers without shaders: this server's messages are recorded, with the script.

    Returns the server's shaders.
    """
    injector = injector_of(server)
    assert injector is not None
    injector.is_recorded = True
    return injector


def injector_of(server: viser.ViserServer) -> ShaderInjector | None:
    """The shader injector of a server, made on the first call; None if shaders are disabled."""
    if not hasattr(server, SHADERS):
        setattr(server, SHADERS, ShaderInjector(server))
    return cast("ShaderInjector | None", getattr(server, SHADERS))


def reset_page(server: viser.ViserServer) -> None:
    """Remove every node from the scene of a server and every element from its panel."""
    server.gui.reset()
    server.scene.reset()
    channel_of(server).restart()
    injector = getattr(server, SHADERS, None)
    if injector is not None:
        injector.restart()


def add_data_mesh(server: viser.ViserServer, name: str, values: np.ndarray) -> viser.MeshHandle:
    """A hidden mesh. Its vertices carry numbers to the script. values: (n, 3), n >= 1.

    Its only face is degenerate, so that the browser computes no normals for it.
    """
    face = np.zeros((1, 3), np.uint32)
    return server.scene.add_mesh_simple(
        name, np.asarray(values, np.float32), face, visible=False, cast_shadow=False, receive_shadow=False
    )


def add_contact_shadow(server: viser.ViserServer, name: str) -> None:
    """Darken the floor where the mesh `name` is near to it (`js/scene/contact.js`), in browsers with shaders."""
    if injector_of(server) is not None:
        add_data_mesh(server, f"{name}/{CONTACT_SHADOW}", np.zeros((1, 3)))
