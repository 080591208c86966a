"""The material patch: a short script, sent once per server, that dresses stock viser's meshes in the browser.

viser 1.1 draws an ordinary mesh in one colour with one rough material. Three of its private names open the way to
more; they are used in this file and in `patch.js` alone, and `tests/browser/test_water.py` fails when they change:

- `server._websock_server.queue_message`: the public API has no call that sends a script. What is queued here is
  replayed to late joiners and kept in recordings.
- `viser._messages.RunJavascriptMessage`: the message itself. viser never culls it from its buffer, therefore one per
  server and never one per frame.
- `window.__viserMutable` in the page: `nodeRefFromName`, `scene`, `requestRender`.

Everything that changes travels as vertices, of hidden meshes or behind a mesh's own, which viser culls and replaces
like any others. A hidden mesh named "<node>/<suffix>" is what makes the script dress "<node>".

Whether it worked is asked of each browser: the script writes which nodes it has drawn into the page's local storage,
where `ClientHandle.local_storage` (public) reads it.
"""

import secrets
import threading
import time
import weakref
from importlib import resources

import numpy as np
import viser
from viser import _messages

KEY = "springtide-patch"  # the local storage key the script answers under
ASK_EVERY = 0.5  # [s] between two questions to a browser that has not answered
GRACE = 20.0  # [s] until a browser without an answer counts as plain; the first frame compiles shaders
SCRIPTS = ("injection.js", "water_shader.js", "water.js", "rain.js")
LONGEST_ANSWER = 10_000  # [characters] what a browser sends is bounded before it is read

_patches: "weakref.WeakKeyDictionary[viser.ViserServer, ShaderInjector]" = weakref.WeakKeyDictionary()
_plain: "weakref.WeakSet[viser.ViserServer]" = weakref.WeakSet()


class ShaderInjector:
    """The patch of one server: what it dresses, and which browsers have answered. Made by `patch(server)`."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = weakref.ref(server)
        self._token = secrets.token_hex(8)
        self._names: dict[str, float] = {}  # node -> when it was first expected [s]
        self._since: dict[int, float] = {}  # client id -> time it was first asked [s]
        self._drawn: dict[int, frozenset[str]] = {}  # client id -> the nodes it says it draws dressed
        self._work = threading.Event()
        server._websock_server.queue_message(_messages.RunJavascriptMessage(source=self.script()))
        server.on_client_connect(lambda client: self._work.set())
        threading.Thread(target=self._ask, name="water patch answers", daemon=True).start()

    def script(self) -> str:
        """The script as it is sent: one function scope, the token first, the hook last."""
        parts = [(resources.files("app.render") / "js" / name).read_text("utf-8") for name in SCRIPTS]
        return f'(() => {{ "use strict"; const TOKEN = "{self._token}";\n' + "\n".join(parts) + "\ninstall(); })();"

    def expect(self, name: str) -> None:
        """Ask every browser for an answer about this node, whatever it said of an earlier one of that name."""
        self.forget(name)
        self._names[name] = time.monotonic()
        self._work.set()

    def forget_all(self) -> None:
        """Stop asking: every node is gone. Each question makes a browser draw anew."""
        for name in list(self._names):
            self.forget(name)

    def forget(self, name: str) -> None:
        """Stop asking about a removed node."""
        self._names.pop(name, None)
        self._drawn = {client: drawn - {name} for client, drawn in self._drawn.items()}

    def alive(self, name: str) -> bool | None:
        """True if every connected browser draws the node dressed, False if one does not, None while not yet known."""
        server = self._server()
        clients = list(server.get_clients()) if server is not None else []
        if not clients:
            return None
        if all(name in self._drawn.get(client, frozenset()) for client in clients):
            return True
        now = time.monotonic()
        expected = self._names.get(name, now)
        slow = [client for client in clients if name not in self._drawn.get(client, frozenset())]
        return False if any(now - max(expected, self._since.get(client, now)) > GRACE for client in slow) else None

    def _ask(self) -> None:
        """Ask each connected browser until it has answered for every name. The one thread of this module."""
        while True:
            self._work.wait(timeout=60.0)  # a server that is gone wakes nobody
            self._work.clear()
            server = self._server()
            if server is None:
                return
            clients = server.get_clients()
            waiting = False
            for number, client in clients.items():
                # With others slow to answer this one may have left since.
                if number not in server.get_clients() or set(self._names) <= self._drawn.get(number, frozenset()):
                    continue
                self._since.setdefault(number, time.monotonic())
                waiting = True
                try:
                    answer = client.local_storage.get_item(KEY, timeout=5.0)
                except (RuntimeError, TimeoutError):
                    continue  # gone, or too busy to answer: asked again
                self._drawn[number] = self._read(answer)
            for number in set(self._drawn) | set(self._since):
                if number not in clients:
                    self._drawn.pop(number, None)
                    self._since.pop(number, None)
            if waiting:
                self._work.set()
            del server, clients
            time.sleep(ASK_EVERY)

    def _read(self, answer: str | None) -> frozenset[str]:
        """The known names in an answer that carries this server's token."""
        token, *names = (answer or "")[:LONGEST_ANSWER].split("\n")
        return frozenset(names) & frozenset(self._names) if token == self._token else frozenset()


def decline(server: viser.ViserServer) -> None:
    """Draw everything on this server by the public API alone; to be said before anything is drawn."""
    _plain.add(server)


def patch(server: viser.ViserServer) -> ShaderInjector | None:
    """The patch of a server, sent on the first call; None where it was declined."""
    if server in _plain:
        return None
    if server not in _patches:
        _patches[server] = ShaderInjector(server)
    return _patches[server]


def reset(server: viser.ViserServer) -> None:
    """Remove every node from a server's scene, and what is expected of them."""
    server.scene.reset()
    if server in _patches:
        _patches[server].forget_all()


def hidden(server: viser.ViserServer, name: str, values: np.ndarray) -> viser.MeshHandle:
    """A hidden mesh whose vertices carry numbers to the script. values: (n, 3), n >= 1.

    Its one degenerate face keeps the browser from computing normals for what is not drawn.
    """
    face = np.zeros((1, 3), np.uint32)
    return server.scene.add_mesh_simple(
        name, np.asarray(values, np.float32), face, visible=False, cast_shadow=False, receive_shadow=False
    )
