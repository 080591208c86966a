"""Private names of viser: one file uses them, and the lab runs without any one of them.

Those of its page are held by tests/browser/water/test_water.py and tests/browser/scenes/test_rope.py.
"""

import ast
from pathlib import Path

import pytest

from tests.fresh import of_each

ROOT = Path(__file__).parents[3]
OWN = {"_replace", "_asdict", "_fields", "_exit", "_current_frames"}  # of named tuples, and of the modules os and sys

# Each private name of viser that `app/render/handles/viser_inside.py` uses.
NAMES = (
    "_binary_buffers", "_connected_clients", "_gui_input_handle_from_uuid", "_handle_incoming_message", "_impl",
    "_messages", "_queue_scene_message", "_websock_connection", "_websock_server", "SceneNodeUpdateMessage",
    "atomic_start", "get_message_buffer", "message_event", "on_client_connect", "queue_message",
    "unregister_handler", "window_duration_sec", "window_generator",
)  # fmt: skip
QUIET = {"_connected_clients"}  # a browser that leaves during its arrival may count
SAMPLE = ("_websock_server", "_gui_input_handle_from_uuid")
UNUSED = "unused"  # no name of viser: the unchanged lab

# A changed name of viser is imitated by another spelling in our source. Each is tried in a child of a process that has
# imported viser: a moving scene, a counted browser, a control that it sets, the dark floor, a replay.
WITHOUT = """
import os, re, sys, time, types
from pathlib import Path
import viser, numba, msgspec, websockets
from tests import coroutines
from tests.app.server.test_viser_names import ROOT

def try_lab(name):
    path = ROOT / "app" / "render" / "handles" / "viser_inside.py"
    source = re.sub(rf"\\b{name}\\b", f"{name}_changed", path.read_text("utf-8"))
    inside = types.ModuleType("app.render.handles.viser_inside")
    sys.modules[inside.__name__] = inside
    exec(compile(source, str(path), "exec"), inside.__dict__)
    from app.server.replay_file import replay_html
    from app.server.viewer import Viewer
    from tests.app.server.web.test_guard import PROTOCOL, connect
    from tests.stress.clients import CAMERA
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("race")
    uuid = next(iter(viewer.server.gui._gui_input_handle_from_uuid))

    def is_counted():
        return len(viewer.server.get_clients()) == 1

    async def visit():
        async with connect(f"ws://127.0.0.1:{viewer.port}", subprotocols=[PROTOCOL], max_size=None) as client:
            await client.send(msgspec.msgpack.encode(CAMERA))
            message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": "Race of ropes"}}
            await client.send(msgspec.msgpack.encode(message))
            until = time.monotonic() + 30.0
            while time.monotonic() < until and not (is_counted() and viewer.loop.latest.status.time > 0.1):
                await client.recv()
            for handle in viewer.server.get_clients().values():
                viewer.view.set_dark(handle, True)
            return len(viewer.server.get_clients())

    counted = coroutines.run(visit())
    moves = viewer.loop.latest.status.time > 0.1
    replay = len(replay_html(viewer.panel.kind, viewer.panel.recorder.all_frames(), viewer.panel.plots.plotted()))
    viewer.shut()
    return counted, moves, replay > 10_000, len(inside.LOST)

for name in sys.argv[1:]:
    sys.stdout.flush()
    child = hasattr(os, "fork") and os.fork()  # Windows cannot: there is one name
    if child:
        os.waitpid(child, 0)
        continue
    try:
        print("found", name, *try_lab(name), flush=True)
    except BaseException as error:
        print("found", name, type(error).__name__, error, flush=True)
    os._exit(0)
"""


def run_without(names: tuple[str, ...]) -> dict[str, list[str]]:
    """Browsers counted, whether the scene moved and a replay was made, number of losses; without each of the names."""
    rows = of_each(WITHOUT, names, ROOT, {"PYTHONPATH": str(ROOT)})
    return {row[1]: row[2:] for row in rows if row[0] == "found"}


@pytest.mark.long
@pytest.mark.parametrize(
    "names", [SAMPLE, pytest.param(NAMES, marks=pytest.mark.stress, id="all")], ids=lambda names: names[0]
)
def test_without_an_inner_name_the_lab_runs_and_says_what_it_loses(names: tuple[str, ...]) -> None:
    found = run_without((*names, UNUSED))
    assert list(found) == [*names, UNUSED]
    for name, (browsers, moved, replay, losses) in found.items():
        assert (browsers, moved, replay) == ("1", "True", "True"), name
        assert (int(losses) > 0) is (name not in QUIET | {UNUSED}), name


def test_one_file_uses_inner_names() -> None:
    users = {path.relative_to(ROOT).as_posix() for path in (ROOT / "app").rglob("*.py") if used(path)}
    assert users == {"app/render/handles/viser_inside.py"}


def used(path: Path) -> set[str]:
    """Names with one leading underscore that a source takes from other things than itself."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Attribute) and node.attr[0] == "_" and node.attr[1] != "_":
            asked = node.value.id if isinstance(node.value, ast.Name) else ""
            found |= {node.attr} - OWN if asked not in ("self", "cls") else set()
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("viser"):
            found |= {alias.name for alias in node.names if alias.name.startswith("_")}
            found |= {part for part in (node.module or "").split(".") if part.startswith("_")}
    return found
