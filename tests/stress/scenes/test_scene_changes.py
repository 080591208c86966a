"""Scene after scene on one server: what a scene registered goes with it."""

import gc
import threading
from collections.abc import Iterator

import psutil
import pytest

from app.scenes import NAMES
from app.scenes.ahead.compiling import prepare
from app.server.viewer import Viewer
from tests.stress.clients import clients_of, until
from tests.stress.memory import GROWTH, resident
from tests.stress.tally import Tally

FIRST, CHANGES = 40, 200  # until caches and pools are full, and then counted


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    """A viewer without a scene."""
    for name in NAMES:
        prepare(name)
    viewer = Viewer("127.0.0.1", 0)
    yield viewer
    viewer.shut()


def callbacks(viewer: Viewer) -> int:
    """How many callbacks viser keeps for this server: of clients, of the scene and of the panel."""
    scene, gui, connection = viewer.server.scene, viewer.server.gui, viewer.server._websock_server
    tables = (
        viewer.server._client_connect_cb, viewer.server._client_disconnect_cb, connection._client_connect_cb,
        connection._client_disconnect_cb, gui._gui_input_handle_from_uuid, gui._command_handle_from_uuid,
        scene._handle_from_node_name, scene._scene_pointer_cb, *connection._incoming_handlers.values(),
    )  # fmt: skip
    return sum(len(table) for table in tables)


def test_200_scene_changes_leave_nothing_behind(viewer: Viewer, tally: Tally) -> None:
    process = psutil.Process()

    def change(count: int) -> None:
        for number in range(count):
            viewer.open(NAMES[number % len(NAMES)])
            until(lambda: viewer.served.shown_serial > 0, "it is shown")

    with clients_of(viewer.port) as clients, tally.fault("scene changed", FIRST + CHANGES):
        clients.join()
        change(FIRST)
        before = resident(), threading.active_count(), process.num_fds(), callbacks(viewer)
        change(CHANGES)
        gc.collect()
        after = resident(), threading.active_count(), process.num_fds(), callbacks(viewer)
    tally.notes.append(f"{CHANGES} scene changes: (MB, threads, descriptors, callbacks) {before} then {after}")
    assert after[0] < GROWTH * before[0]
    assert after[1] <= before[1]
    assert after[2] <= before[2]
    assert after[3] <= before[3]
