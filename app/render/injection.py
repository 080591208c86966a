"""Shaders that stock viser does not have: scripts of the page replace them in the browser.

viser 1.1 draws an ordinary mesh in one colour with one rough material. The scripts in `js/scene` and `js/sea` use
`window.__viserMutable` (`nodeRefFromName`, `scene`, `requestRender`, `sendMessage`);
`tests/browser/water/test_water.py` fails when these change.

Everything that changes travels as vertices of hidden meshes (`add_data_mesh`), because viser keeps only the newest
vertices of a mesh. Displacements of a drawn mesh travel packed (`app/formats/packing.py`), in a fifth of the bytes;
the drawn mesh's own vertices are sent only where a browser does not say that it has the shader. A hidden mesh named
"<node>/<suffix>" makes the script replace the shader of "<node>"; each file in `js/` names its suffix.

Each page reports whether that worked: the script sends the names of the nodes that it has drawn with their shader
through a hidden field, whenever they change.
"""

import time
import weakref

import numpy as np
import viser

from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import Html, fill

LAST = 1e9  # place in the panel
MAX_ANSWER_TIME = 20.0  # [s] after which a browser counts as one without shaders; its first frame compiles them
CONTACT_SHADOW = "contact_shadow"
WHOLE = " whole"  # end of a page's word once its first picture is whole (`js/scene/main.js`)

_injectors: "weakref.WeakKeyDictionary[viser.ViserServer, ShaderInjector]" = weakref.WeakKeyDictionary()
_disabled: "weakref.WeakSet[viser.ViserServer]" = weakref.WeakSet()


class ShaderInjector:
    """The shaders of one server: the nodes that should have one, and which browsers draw them so.

    Made by `injector_of(server)`. The viewer's thread watches nodes; reports come on viser's event loop.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = weakref.ref(server)
        self._watched: dict[str, float] = {}  # node -> since when it is watched [s]
        self._sky = ""  # name of the sky that lights the scene; "" before the first picture
        self._seen: dict[int, float] = {}  # client id -> when it was first looked for [s]
        self._drawn: dict[int, frozenset[str]] = {}  # client id -> nodes that it draws with their shader
        self.whole: set[int] = set()  # clients that have shown a whole picture of the scene
        self.is_recorded = False  # True if drawing is only recorded, for pages that have the script
        server.on_client_disconnect(self._forget)
        self.restart(server)

    def restart(self, server: viser.ViserServer) -> None:
        """Begin a scene: a new hidden field through which pages report, so nothing is left of an earlier one."""
        self._watched.clear()
        self._drawn.clear()
        self.whole.clear()
        self._sky = ""
        inbox: GuiHandle = server.gui.add_text("Shaders", "", multiline=True, visible=False)
        self._inbox = uuid_of(inbox)
        self._field: GuiHandle = server.gui.add_html(str(self._words()), order=LAST)

        @inbox.on_update
        async def _(event: ViserEvent) -> None:
            # The page's own word comes first: two pages may report the same.
            first, *names = inbox.value.split("\n")
            self._drawn[event.client_id] = frozenset(names)
            if first.endswith(WHOLE):
                self.whole.add(event.client_id)

    def _words(self) -> Html:
        """The field of the page: where it reports to, and the parts of a whole picture."""
        return fill('<span data-springtide-shaders="{}">{}</span>', self._inbox, self.whole_picture())

    def whole_picture(self) -> Html:
        """The sky and the nodes that a whole picture has, as the page reads them (`js/scene/frames.js`)."""
        names = "\n".join(self._watched)
        return fill('<span data-springtide-sky="{}" data-springtide-nodes="{}"></span>', self._sky, names)

    def _tell(self) -> None:
        """Show the page other parts of a whole picture."""
        words = str(self._words())
        if self._field.content != words:
            self._field.content = words

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
        server = self._server()
        clients = list(server.get_clients()) if server is not None else []
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
    _disabled.add(server)


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
    if server in _disabled:
        return None
    if server not in _injectors:
        _injectors[server] = ShaderInjector(server)
    return _injectors[server]


def reset_page(server: viser.ViserServer) -> None:
    """Remove every node from the scene of a server and every element from its panel."""
    server.gui.reset()
    server.scene.reset()
    if server in _injectors:
        _injectors[server].restart(server)


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
