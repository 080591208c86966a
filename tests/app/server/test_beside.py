"""Labs side by side without a browser: one port, one sky, what differs in words, and one lab again at the end."""

import asyncio
import dataclasses
import http.client
import json
import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
import viser
import websockets
from websockets.asyncio.client import connect

from app.messages import StepOnce
from app.panel.settings import SceneSettings
from app.scenes import scene_named
from app.scenes.comparisons import COMPARISONS
from app.scenes.rope.parameters import PRESETS, RopeParams
from app.scenes.setups import read_query
from app.server.beside import ComparedLabs, SharedRecord
from app.server.preparation import Preparation
from app.server.viewer import Viewer
from app.server.web.access import OWN_PAGES_ONLY, Access
from tests import coroutines
from tests.app import channels
from tests.app.server.web.test_guard import say
from tests.app.server.web.test_transport import decoded
from tests.waiting import wait_for

KEY = "k-3_" * 5
HUB = "https://hub.example.org"
PATH = f"/lab/{KEY}"
READY = ", ".join(COMPARISONS)


def opened(*queries: str, access: Access = OWN_PAGES_ONLY) -> Viewer:
    """A lab with others beside it."""
    viewer = Viewer("127.0.0.1", 0, access=access)
    viewer.comparing.begin([read_query(f"?scene={query}") for query in queries], True)
    return viewer


@pytest.fixture(scope="module")
def pair() -> Iterator[Viewer]:
    """Two ropes behind a proxy's path and a key."""
    viewer = opened("rope&show_points=false", "rope&stiffness=2000", access=Access("/lab", (HUB,), KEY))
    yield viewer
    viewer.shut()


def status_of(port: int, path: str) -> int:
    connection = http.client.HTTPConnection("127.0.0.1", port)
    connection.request("GET", path)
    return connection.getresponse().status


def test_panes_are_at_paths_of_the_one_port_and_protected_with_it(pair: Viewer) -> None:
    for path in ("/", "/index.html", "/pane/2/index.html", "/pane/2/springtide-alive", "/beside"):
        assert status_of(pair.port, PATH + path) == 200
        assert status_of(pair.port, f"/lab{path}") == 403
        assert status_of(pair.port, path) == 404
    for path in ("/pane/3/index.html", "/pane/1/", "/pane/2/nothing.js", "/pane/2/../pane/2/x"):
        assert status_of(pair.port, PATH + path) == 404
    for path in ("/lab/pane/2/index.html", f"{PATH}/pane/3/index.html"):
        with pytest.raises(websockets.exceptions.InvalidStatus) as refusal:
            coroutines.run(say(pair.port, [], HUB, path))
        assert refusal.value.response.status_code in (403, 404)


def test_a_foreign_page_is_refused_by_a_pane_too() -> None:
    viewer = opened("rope", "rope&stiffness=2000")
    try:
        with pytest.raises(websockets.exceptions.InvalidStatus) as refusal:
            coroutines.run(say(viewer.port, [], "http://evil.example", "/pane/2/index.html"))
        assert refusal.value.response.status_code == 403
        coroutines.run(say(viewer.port, [], f"http://127.0.0.1:{viewer.port}", "/pane/2/index.html"))
    finally:
        viewer.shut()


async def nodes_until(port: int, path: str, last: str) -> set[str]:
    """The names of the scene nodes that a page is sent, up to this one."""
    protocol = websockets.Subprotocol(f"viser-v{viser.__version__}")
    address = f"ws://127.0.0.1:{port}{path}"
    names: set[str] = set()
    async with asyncio.timeout(30.0), connect(address, origin=HUB, subprotocols=[protocol], max_size=None) as client:
        while last not in names:
            names |= {str(message.get("name")) for message in decoded(bytes(await client.recv()))}
    return names


def test_each_page_is_sent_its_own_lab(pair: Viewer) -> None:
    assert pair.comparison is not None
    for viewer, name in zip(pair.comparison.viewers, ("/first", "/second"), strict=True):
        viewer.server.scene.add_frame(name)
    assert "/second" not in coroutines.run(nodes_until(pair.port, f"{PATH}/index.html", "/first"))
    assert "/first" not in coroutines.run(nodes_until(pair.port, f"{PATH}/pane/2/index.html", "/second"))


def test_one_sky_one_speed_and_only_what_differs_is_said(pair: Viewer) -> None:
    assert pair.comparison is not None
    first, second = pair.comparison.viewers
    assert second.settings.params.show_points is False  # type: ignore[attr-defined]
    assert [pane.heading for pane in pair.pane_words()] == ["Stiffness: 800 N/m", "Stiffness: 2\u202f000 N/m"]
    run(second, lambda: second.settings.set("speed", 0.25))
    wait_for(lambda: first.settings.params.speed == 0.25)
    run(first, lambda: first.settings.set("grid", False))
    wait_for(lambda: second.settings.params.grid is False)
    run(first, lambda: first.settings.set("damping", 3.0))
    said = ["Stiffness: 800 N/m · Damping: 3 N·s/m", "Stiffness: 2\u202f000 N/m · Damping: 7 N·s/m"]
    assert [pane.heading for pane in pair.pane_words()] == said
    wait_for(lambda: "Damping: 3" in line_of(pair))


def run(viewer: Any, action: Callable[[], None]) -> None:
    """Call what only viser's event loop may call."""
    done = threading.Event()
    viewer.server.get_event_loop().call_soon_threadsafe(lambda: (action(), done.set()))
    assert done.wait(10.0)


def test_a_change_in_a_pane_follows_the_first_lab_s_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the event loop of the first lab is busy as the panes open."""
    seat = ComparedLabs.seat

    def seat_slowly(labs: ComparedLabs, viewer: Any) -> None:
        if viewer is labs.first:
            viewer.call(lambda: time.sleep(0.5))
        seat(labs, viewer)

    monkeypatch.setattr(ComparedLabs, "seat", seat_slowly)
    viewer = opened("rope", "rope&stiffness=2000")
    try:
        assert viewer.comparison is not None
        second = viewer.comparison.viewers[1]
        run(second, lambda: second.settings.set("speed", 0.25))
        quiet(viewer, second)
        assert viewer.settings.params.speed == second.settings.params.speed == 0.25
    finally:
        viewer.shut()


class Pane:
    """A lab of a comparison with an event loop and settings, and nothing else."""

    is_open = True

    def __init__(self, labs: list["Pane"]) -> None:
        self.events = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.events.run_forever)
        self.thread.start()
        self.server = SimpleNamespace(get_clients=dict, get_event_loop=lambda: self.events)
        self.settings = SceneSettings(self.server, scene_named("rope"), RopeParams(), lambda command: None)  # type: ignore[arg-type]
        self.changes: list[float] = []
        self.settings.watchers.append(lambda: self.changes.append(self.settings.params.speed))
        labs.append(self)

    call = Viewer.call

    def end(self) -> None:
        self.call(self.events.stop)
        self.thread.join()
        self.events.close()


@pytest.fixture
def panes() -> Iterator[tuple[SharedRecord, Any, Any]]:
    """Two labs with one record."""
    labs: list[Any] = []
    record = SharedRecord(lambda: tuple(labs))
    first, second = Pane(labs), Pane(labs)
    for lab in labs:
        lab.settings.watchers.append(lambda lab=lab: record.take(lab, lab.settings.params))
        record.join(lab)
        run(lab, lambda: None)
    yield record, first, second
    for lab in labs:
        if not lab.events.is_closed():
            lab.end()


def quiet(*labs: Any) -> None:
    """Wait until nothing is under way."""
    for _ in range(3):
        for lab in labs:
            run(lab, lambda: None)


@pytest.mark.parametrize("who", [0, 1])
def test_the_first_lab_brings_its_parameters_and_another_takes_those_that_there_are(panes: Any, who: int) -> None:
    record, *labs = panes
    labs[who].settings.params = dataclasses.replace(labs[who].settings.params, speed=0.3)
    record.enter(labs[who])
    quiet(*labs)
    speeds = [lab.settings.params.speed for lab in labs]
    assert speeds == ([0.3, 0.3] if who == 0 else [RopeParams().speed] * 2)


def test_a_change_is_recorded_alone(panes: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    record, first, second = panes
    written: list[Any] = []
    monkeypatch.setattr(record, "write", lambda source, values: written.append((source, dict(values))))
    changes = [(first, "speed", 0.5), (second, "stiffness", 450.0), (first, "stiffness", 450.0), (second, "speed", 0.5)]
    for lab, name, value in changes:
        run(lab, lambda lab=lab, name=name, value=value: lab.settings.set(name, value))
    assert written == [(lab, {name: value}) for lab, name, value in changes]


@pytest.mark.parametrize("hand", [0, 1])
def test_a_slider_under_the_hand_is_never_moved_by_the_other_lab(panes: Any, hand: int) -> None:
    """60 changes a second, while the event loop of the other lab is held up."""
    moved, other = panes[1 + hand], panes[2 - hand]
    for number in range(60):
        if number % 6 == 0:
            other.call(lambda: time.sleep(0.06))
        moved.call(lambda number=number: moved.settings.set("speed", 0.1 + 0.01 * number))
        time.sleep(1 / 60)
    quiet(moved, other)
    assert moved.changes == pytest.approx([0.1 + 0.01 * number for number in range(60)])
    assert moved.settings.params.speed == other.settings.params.speed == pytest.approx(0.69)
    assert len(other.changes) <= 60
    assert len(other.settings.history.settings) == 1  # one act here, too


def test_two_hands_at_once_end_at_one_value(panes: Any) -> None:
    _, first, second = panes
    for number in range(40):
        for lab, value in ((first, 0.1 + 0.01 * number), (second, 3.0 + 0.01 * number)):
            lab.call(lambda lab=lab, value=value: lab.settings.set("speed", value))
    quiet(first, second)
    assert first.settings.params.speed == second.settings.params.speed
    assert first.settings.params.speed == pytest.approx(0.49) or first.settings.params.speed == pytest.approx(3.39)
    assert max(len(first.changes), len(second.changes)) <= 80


def test_a_lab_that_is_being_shut_is_not_called(panes: Any) -> None:
    _, first, second = panes
    second.end()
    shown: list[bool] = []
    first.settings.watchers.append(lambda: shown.append(True))
    run(first, lambda: first.settings.set("speed", 0.5))
    assert shown == [True]  # the watchers after it are called


def test_a_scene_that_is_asked_for_ends_a_comparison_that_is_being_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    viewer = Viewer("127.0.0.1", 0)
    compiling = threading.Event()

    def compile_slowly(kind: Any, params: Any, *, covers: bool, given_up: Callable[[], bool]) -> bool:
        if kind.name != "cloth":
            return True
        compiling.set()
        wait_for(given_up)
        return False

    try:
        viewer.open("rope")
        monkeypatch.setattr(Preparation, "compile", lambda self, *given, **how: compile_slowly(*given, **how))
        for with_first in (True, False):
            compiling.clear()
            setups = [read_query("?scene=cloth")] * 2
            viewer.comparing.want(setups[: 1 + with_first], with_first)
            assert compiling.wait(10.0)
            viewer.want("race" if with_first else "rope")
            wait_for(lambda name="race" if with_first else "rope": viewer.settings.kind.name == name)
            with viewer.comparing.lock:
                assert viewer.comparison is None
            assert not viewer.panes.servers
    finally:
        viewer.shut()


def line_of(viewer: Viewer) -> str:
    """What the page with the panes reads."""
    assert viewer.panel.compare is not None
    return json.dumps(viewer.panel.compare.channel.state_of("panes"), ensure_ascii=False)


def test_another_scene_in_a_pane_keeps_the_clock() -> None:
    viewer = opened("rope&grid=false", "rope&stiffness=2000", "rope&stiffness=300")
    try:
        assert viewer.comparison is not None
        second = viewer.comparison.viewers[1]
        assert len(viewer.comparison.clock.seats) == 3
        second.open("cloth", read_query("?scene=cloth&rows=8&cols=8").params)
        assert len(viewer.comparison.clock.seats) == 3
        seats = viewer.comparison.clock.seats
        wait_for(lambda: second.loop.run.seat is seats[1])
        assert [pane.heading.split(" · ")[0] for pane in viewer.pane_words()] == ["Rope", "Cloth", "Rope"]
        wait_for(lambda: second.settings.params.grid is False)
        with pytest.raises(ValueError, match="nothing"):
            second.open("nothing")
        assert len(viewer.comparison.clock.seats) == 2  # the others do not wait for it
    finally:
        viewer.shut()


def test_the_lab_goes_on_from_where_it_was_when_it_is_alone_again() -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("rope", paused=True)
        viewer.loop.commands.put(StepOnce(5))
        time_before = pytest.approx(5 * viewer.loop.scene.step)
        wait_for(lambda: viewer.loop.scene.time == time_before)
        viewer.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
        wait_for(lambda: viewer.loop.latest.status.time == 0.0)
        pane = viewer.comparison.viewers[1] if viewer.comparison else None
        viewer.comparing.end_now()
        wait_for(lambda: viewer.loop.latest.status.time == time_before)
        assert pane is not None
        assert pane.ended
        assert not viewer.panes.servers
        assert viewer.pane_words() == ()
        assert status_of(viewer.port, "/pane/2/index.html") == 404
    finally:
        viewer.shut()


def test_an_address_and_the_panel_open_a_comparison() -> None:
    viewer = Viewer("127.0.0.1", 0)
    said: list[str] = []
    client = SimpleNamespace(client_id=1, add_notification=lambda title, reason, **how: said.append(reason))

    def inbox(text: str) -> None:
        channels.say(viewer.panel.share.channel, "open", text, client=client)

    try:
        viewer.open("rope")
        inbox("?compare=nothing")
        inbox("?compare=<script>")
        assert said == [
            f"compare: '{name}' is not allowed; allowed: one of {READY}" for name in ("nothing", "<script>")
        ]
        assert viewer.comparison is None
        inbox("?compare=methods")
        wait_for(lambda: viewer.comparison is not None)
        assert ["Leapfrog" in pane.heading for pane in viewer.pane_words()] == [True, False]
        wait_for(lambda: "Leapfrog" in line_of(viewer))
        compare = viewer.panel.compare
        assert compare is not None
        channels.say(viewer.panel.share.channel, "panes", "end")
        wait_for(lambda: viewer.comparison is None and "[]" in line_of(viewer))
        compare.choice.value = "Stiff rope"
        coroutines.run(compare.on_start(SimpleNamespace(client_id=1)))
        wait_for(lambda: viewer.comparison is not None)
        assert viewer.comparison is not None
        second = viewer.comparison.viewers[1]
        assert second.settings.params.units == PRESETS["Stiff rope"]["units"] == "material"  # type: ignore[attr-defined]
    finally:
        viewer.shut()


def test_what_cannot_be_opened_leaves_the_lab_alone() -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open("rope")
        four = [read_query("?scene=rope")] * 4
        with pytest.raises(ValueError, match=r"^set-ups side by side: 4 is not allowed; allowed: 2 to 3$"):
            viewer.comparing.begin(four, True)
        with pytest.raises(ValueError, match="nothing"):
            viewer.comparing.begin([four[0]._replace(scene="nothing")], False)
        assert viewer.comparison is None
        assert not viewer.panes.servers
    finally:
        viewer.shut()
