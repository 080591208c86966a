"""Browsers that come in numbers, stop reading, or die in mid-drag."""

import gc
from collections.abc import Iterator
from typing import Any

import psutil
import pytest
import viser

from app.messages import Play
from app.scenes import NAMES
from app.scenes.ahead.compiling import prepare
from app.server.viewer import Viewer
from tests.stress.clients import Clients, clients_of, until
from tests.stress.memory import GROWTH, resident
from tests.stress.tally import Tally

MANY = 20
BRIEF, VISITORS, CROWD = 50, 200, 10  # killed before the count begins, then counted, and so many at a time
HANDLES = {
    "cloth": ("/cloth", None),
    "rope": ("/points", 6),
    "radial_sea": ("/handles", 1),
}  # what can be dragged, and which one of it


@pytest.fixture(params=NAMES)
def viewer(request: pytest.FixtureRequest) -> Iterator[Viewer]:
    """Each scene, served, on its own threads."""
    prepare(request.param)
    viewer = Viewer("127.0.0.1", 0)
    viewer.open(request.param)
    yield viewer
    viewer.shut()


@pytest.fixture
def clients(viewer: Viewer) -> Iterator[Clients]:
    with clients_of(viewer.port) as clients:
        yield clients


def runs(viewer: Viewer) -> None:
    """Whatever came before: the scene runs on, and both threads live."""
    viewer.loop.commands.put(Play())
    before, shown = viewer.loop.scene.time, viewer.served.shown_serial
    until(lambda: viewer.loop.scene.time > before and viewer.served.shown_serial > shown + 2, "the scene runs on")
    assert not viewer.loop.run.halted
    assert all(thread.is_alive() for thread in viewer.served.threads)


def test_twenty_clients_at_once_all_are_served(viewer: Viewer, clients: Clients, tally: Tally) -> None:
    with tally.fault("client joins", MANY):
        for _ in range(MANY):
            clients.join()
        until(lambda: viewer.audience() == MANY, "all are there")
        runs(viewer)
        so_far = dict(clients.received)
        until(lambda: all(clients.received[c] > so_far[c] for c in clients.open), "each gets pictures")
    with tally.fault("client killed", MANY):
        for client in list(clients.open):
            clients.kill(client)
        until(lambda: viewer.audience() == 0, "all are gone")
    clients.join()
    runs(viewer)


def test_a_client_that_stops_reading_holds_up_nobody(viewer: Viewer, clients: Clients, tally: Tally) -> None:
    with tally.fault("client stops reading"):
        clients.join(reads=False)
        good = clients.join()
        runs(viewer)
        process = psutil.Process()
        until(lambda: clients.received[good] > 2_000_000 or viewer.served.shown_serial > 300, "some traffic", 120.0)
        gc.collect()
        before, served = process.memory_info().rss, clients.received[good]
        until(lambda: clients.received[good] > 2 * served, "as much again", 120.0)
        runs(viewer)
        assert process.memory_info().rss < 1.05 * before + 5e6
        pending = viewer.server._websock_server._broadcast_buffer.message_from_id
        assert len(pending) < 5000


def is_pulled(viewer: Viewer) -> bool:
    """Whether something is drawn as pulled: one thing, or in the radial sea any number of bodies."""
    frame: Any = viewer.loop.latest.frame
    return bool(frame.grabs) if viewer.panel.kind.name == "radial_sea" else frame.grab is not None


def test_a_browser_killed_in_mid_drag_lets_go(viewer: Viewer, clients: Clients, tally: Tally) -> None:
    name = viewer.panel.kind.name
    if name not in HANDLES:
        pytest.skip("nothing to be dragged")
    node, instance = HANDLES[name]
    clients.join()  # somebody else looks on
    with tally.fault("killed in mid-drag"):
        hand = clients.join()
        runs(viewer)

        def held() -> bool:
            for phase in ("start", "update"):  # again, where the first came before the thing was drawn
                clients.drag(hand, node, phase, instance, (-1.0, 0.5, 2.0))
            return is_pulled(viewer)

        until(held, "it is held")
        clients.kill(hand)
        until(lambda: not is_pulled(viewer), "it is let go")
        runs(viewer)


def left_of_clients(viewer: Viewer) -> set[int]:
    """How many there are of all that viser and we keep of each client: handles, connections, cursors."""
    gc.collect()
    server = viewer.server._websock_server
    handles = [o for o in gc.get_objects() if isinstance(o, viser.ClientHandle) and o._viser_server is viewer.server]
    return {len(handles), len(server._client_state_from_id), len(server._broadcast_buffer.generator_cursors)}


def test_visitors_that_are_killed_leave_nothing_behind(viewer: Viewer, clients: Clients, tally: Tally) -> None:
    process = psutil.Process()
    stays = clients.join()
    runs(viewer)

    def visits(count: int) -> None:
        for _ in range(count // CROWD):
            for _ in range(CROWD):
                clients.join()
            until(lambda: viewer.audience() == 1 + CROWD, "all are there")
            until(lambda: all(clients.received[c] > 0 for c in clients.open), "all have got something")
            for client in [c for c in clients.open if c is not stays]:
                clients.kill(client)
            until(lambda: viewer.audience() == 1, "all visitors are gone")
        until(lambda: left_of_clients(viewer) == {1}, "only who stays is kept")

    with tally.fault("visitor killed", BRIEF + VISITORS):
        visits(BRIEF)  # until caches and pools are full
        before, descriptors = resident(), process.num_fds()
        visits(VISITORS)
        after = resident()
    name = viewer.panel.kind.name
    tally.notes.append(f"{name}: {VISITORS} visitors were killed, {before:.0f} MB then {after:.0f} MB")
    assert after < GROWTH * before
    assert process.num_fds() <= descriptors
    assert len(viewer.server._websock_server._broadcast_buffer.message_from_id) < 5000
    runs(viewer)


def test_the_server_stops_under_load(viewer: Viewer, clients: Clients, tally: Tally) -> None:
    with tally.fault("server stopped under load"):
        for number in range(MANY // 2):
            clients.join(reads=number % 4 > 0)
        runs(viewer)
        viewer.shut()
        assert viewer.served.threads == []
        reading = [client for client in clients.open if clients.received[client] > 0]
        until(lambda: all(client.close_code is not None for client in reading), "connections are closed")
