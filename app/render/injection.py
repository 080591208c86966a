"""Shaders that stock viser does not have: a short script, sent once per server, replaces them in the browser.

viser 1.1 draws an ordinary mesh in one colour with one rough material. Its public API has no call that sends a script:
`app.render.viser_inside.run_script` does. In the page the scripts in `js/` use `window.__viserMutable`
(`nodeRefFromName`, `scene`, `requestRender`); `tests/browser/test_water.py` fails when these change.

Everything that changes travels as vertices of hidden meshes (`add_data_mesh`), because viser keeps only the newest
vertices of a mesh. Displacements of a drawn mesh travel packed (`app/formats/packing.py`), in a fifth of the bytes;
the drawn mesh's own vertices are sent only where a browser does not say that it has the shader. A hidden mesh named
"<node>/<suffix>" makes the script replace the shader of "<node>"; each file in `js/` names its suffix.

Each browser is asked whether that worked: the script writes the names of the nodes that it has drawn into the page's
local storage, where `ClientHandle.local_storage` (public) reads them.
"""

import json
import math
import secrets
import threading
import time
import weakref
from importlib import resources

import numpy as np
import viser

from app.render.colormap import DARK_LIFT, LUMA
from app.render.material import MAX_WATERLINES, RAIN_UNIFORMS, WATER_UNIFORMS
from app.render.viser_inside import run_script

STORAGE_KEY = "springtide-shaders"  # of the page's local storage, under which the script answers
ASK_INTERVAL = 0.5  # [s] between two questions to a browser that has not answered for every node
QUESTION_TIMEOUT = 5.0  # [s] after which a question is given up, and asked again later
MAX_QUESTIONS = 16  # open at the same time, a thread each: browsers that are stuck do not delay the others
MAX_ANSWER_TIME = 20.0  # [s] after which a browser counts as one without shaders; its first frame compiles them
MAX_ANSWER_LENGTH = 10_000  # [characters] that are read of an answer
SCRIPTS = ("quality.js", "injection.js", "packed.js", "water_shader.js", "water.js", "rain.js", "smoke.js", "dark.js")

_injectors: "weakref.WeakKeyDictionary[viser.ViserServer, ShaderInjector]" = weakref.WeakKeyDictionary()
_disabled: "weakref.WeakSet[viser.ViserServer]" = weakref.WeakSet()
_storage_keys: "weakref.WeakKeyDictionary[viser.ViserServer, str]" = weakref.WeakKeyDictionary()


class ShaderInjector:
    """The shaders of one server: the nodes that should have one, and which browsers draw them so.

    Made by `injector_of(server)`. The viewer's thread watches nodes; threads of this class ask the browsers.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = weakref.ref(server)
        self._storage_key = _storage_keys.get(server, STORAGE_KEY)
        self._token = secrets.token_hex(8)  # tells answers to this server from those that an earlier one left behind
        self._lock = threading.Lock()  # for what follows
        self._watched: dict[str, float] = {}  # node -> since when it is watched [s]
        self._asked: dict[int, float] = {}  # client id -> when it was first asked [s]
        self._last_asked: dict[int, float] = {}  # client id -> when it was last asked [s]
        self._drawn: dict[int, frozenset[str]] = {}  # client id -> the watched nodes that it draws with their shader
        self._open: set[int] = set()  # client ids of the questions that wait for an answer
        self._unanswered = threading.Event()
        self.is_recorded = False  # whether what is drawn is only recorded, for pages that have the script
        run_script(server, self.script())
        server.on_client_connect(lambda client: self._unanswered.set())
        threading.Thread(target=self._ask_clients, name="shader questions", daemon=True).start()

    def script(self) -> str:
        """The script as it is sent: one function scope, the constants shared with Python first, the hook last."""
        constants = {
            "TOKEN": self._token,
            "STORAGE_KEY": self._storage_key,
            "WATER_UNIFORMS": WATER_UNIFORMS,
            "RAIN_UNIFORMS": RAIN_UNIFORMS,
            "MAX_WATERLINES": MAX_WATERLINES,
            "DARK_LIFT": DARK_LIFT,
            "LUMA": LUMA,
        }
        shared = [f"const {name} = {json.dumps(value)};" for name, value in constants.items()]
        files = [(resources.files("app.render") / "js" / name).read_text("utf-8") for name in SCRIPTS]
        return "\n".join(['(() => { "use strict";', *shared, *files, "install(); })();"])

    def watch(self, name: str) -> None:
        """Ask every browser about this node, whatever it said of an earlier node of that name."""
        self.unwatch(name)
        with self._lock:
            self._watched[name] = time.monotonic()
        self._unanswered.set()

    def unwatch(self, name: str) -> None:
        """Stop asking about a removed node."""
        with self._lock:
            self._watched.pop(name, None)
            self._drawn = {client: drawn - {name} for client, drawn in self._drawn.items()}

    def unwatch_all(self) -> None:
        """Stop asking: every node is removed. Each question makes a browser draw a frame."""
        with self._lock:
            self._watched.clear()
            self._drawn = dict.fromkeys(self._drawn, frozenset())

    def is_active(self, name: str) -> bool | None:
        """True if every connected browser draws the node with its shader, False if one does not, None while unknown."""
        if self.is_recorded:
            return True
        server = self._server()
        clients = list(server.get_clients()) if server is not None else []
        if not clients:
            return None
        with self._lock:
            without = [client for client in clients if name not in self._drawn.get(client, frozenset())]
            if not without:
                return True
            now = time.monotonic()
            since = self._watched.get(name, now)
            waited = max(now - max(since, self._asked.get(client, now)) for client in without)
        return False if waited > MAX_ANSWER_TIME else None

    def _ask_clients(self) -> None:
        """Ask each connected browser until it draws every watched node, or has left."""
        while True:
            self._unanswered.wait(timeout=60.0)  # ends in time where the server is gone and nothing sets the event
            self._unanswered.clear()
            server = self._server()
            if server is None:
                return
            if self._start_questions(server.get_clients()):
                self._unanswered.set()
            del server
            time.sleep(ASK_INTERVAL)

    def _start_questions(self, clients: dict[int, viser.ClientHandle]) -> bool:
        """Ask the browsers that have not answered for every node; False where there are none."""
        now = time.monotonic()
        with self._lock:
            for gone in (set(self._drawn) | set(self._asked)) - set(clients):
                self._drawn.pop(gone, None)
                self._asked.pop(gone, None)
                self._last_asked.pop(gone, None)
            unanswered = [client for client in clients if not self._watched.keys() <= self._drawn.get(client, set())]
            for client in unanswered:
                self._asked.setdefault(client, now)
            ready = [client for client in unanswered if client not in self._open]
            ready.sort(key=lambda client: self._last_asked.get(client, 0.0))  # who has waited longest comes first
            ready = ready[: max(MAX_QUESTIONS - len(self._open), 0)]
            self._last_asked.update(dict.fromkeys(ready, now))
            self._open.update(ready)
        for client in ready:
            arguments = client, clients[client], now
            threading.Thread(target=self._ask, args=arguments, name="shader question", daemon=True).start()
        return bool(unanswered)

    def _ask(self, client: int, handle: viser.ClientHandle, now: float) -> None:
        """Ask one browser once; now [s]: the time of asking."""
        try:
            answer = handle.local_storage.get_item(self._storage_key, timeout=QUESTION_TIMEOUT)
        except (RuntimeError, TimeoutError):  # it has left, or it is too busy and will be asked again
            answer = None
        with self._lock:
            self._open.discard(client)
            if answer is not None and client in self._asked:
                self._drawn[client] = self._read(answer, now)

    def _read(self, answer: str, asked: float) -> frozenset[str]:
        """The watched nodes in an answer that carries the token of this server.

        A node that is watched since after `asked` [s] is left out: the answer may mean an earlier node of that name.
        """
        token, *names = answer[:MAX_ANSWER_LENGTH].split("\n")
        if token != self._token:
            return frozenset()
        return frozenset(name for name in names if self._watched.get(name, math.inf) <= asked)


def disable_shaders(server: viser.ViserServer) -> None:
    """Draw everything on this server by viser's public API alone; to be called before anything is drawn."""
    _disabled.add(server)


def answer_apart(server: viser.ViserServer, name: str) -> None:
    """Have pages of this server answer under a name of their own: two servers at one address share the local storage.

    To be called before anything is drawn.
    """
    _storage_keys[server] = f"{STORAGE_KEY}-{name}"


def record_shaders(server: viser.ViserServer) -> None:
    """Leave out what only browsers without shaders need: this server's messages are recorded, with the script."""
    injector = injector_of(server)
    assert injector is not None
    injector.is_recorded = True


def injector_of(server: viser.ViserServer) -> ShaderInjector | None:
    """The shader injector of a server, made on the first call; None where shaders are disabled."""
    if server in _disabled:
        return None
    if server not in _injectors:
        _injectors[server] = ShaderInjector(server)
    return _injectors[server]


def reset_scene(server: viser.ViserServer) -> None:
    """Remove every node from the scene of a server, and stop asking about them."""
    server.scene.reset()
    if server in _injectors:
        _injectors[server].unwatch_all()


def add_data_mesh(server: viser.ViserServer, name: str, values: np.ndarray) -> viser.MeshHandle:
    """A hidden mesh. Its vertices carry numbers to the script. values: (n, 3), n >= 1.

    Its only face is degenerate, so that the browser computes no normals for it.
    """
    face = np.zeros((1, 3), np.uint32)
    return server.scene.add_mesh_simple(
        name, np.asarray(values, np.float32), face, visible=False, cast_shadow=False, receive_shadow=False
    )
