"""The inner names of viser that are used: each is listed here, and exists in the viser that is installed.

Those of its page are held by tests/browser/test_water.py and test_rope.py.
"""

import ast
from pathlib import Path

from viser import _messages

from app.server.viewer import Viewer

ROOT = Path(__file__).parents[3]
OWN = {"_replace", "_asdict", "_fields", "_exit", "_HAS_NOALIAS"}  # of named tuples and of the os module
NAMES = {
    "_binary_buffers",
    "_websock_server",
    "_websock_connection",
    "_connected_clients",
    "_gui_input_handle_from_uuid",
    "_handle_incoming_message",
    "_impl",
    "_queue_scene_message",
}


def used(path: Path) -> set[str]:
    """Names with one leading underscore that a source asks of other things than itself."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Attribute) and node.attr[0] == "_" and node.attr[1] != "_":
            asked = node.value.id if isinstance(node.value, ast.Name) else ""
            found |= {node.attr} - OWN if asked not in ("self", "cls") else set()
    return found


def test_no_other_inner_name_is_used() -> None:
    assert set().union(*(used(path) for path in (ROOT / "app").rglob("*.py"))) == NAMES


def test_viser_has_the_inner_names(lab: Viewer) -> None:
    server = lab.server
    connection = server._websock_server
    assert callable(connection.queue_message)
    assert callable(connection.unregister_handler)
    assert callable(connection.on_client_connect)
    assert callable(connection.on_client_disconnect)
    assert hasattr(connection, "_handle_incoming_message")
    assert isinstance(connection._incoming_handlers, dict)
    assert isinstance(connection.get_message_buffer().window_duration_sec, float)
    assert isinstance(server._connected_clients, dict)
    assert isinstance(server.get_scene_serializer()._binary_buffers, list)
    uuid, handle = next(iter(server.gui._gui_input_handle_from_uuid.items()))
    assert handle._impl.uuid == uuid
    node = server.scene.add_frame("/named")
    assert callable(node._impl.api._queue_scene_message)
    assert (node._impl.name, node._impl.removed, node._impl.props.axes_length) == ("/named", False, node.axes_length)
    assert _messages.HotkeyKey
    assert _messages.RunJavascriptMessage(source="").source == ""
