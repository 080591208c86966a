"""Sequences of sleep, cuts, dead connections, other networks, new servers and the browser's cache: 20 rows.

After each event the page goes on, or it says why it does not.
"""

import itertools
import math
import re
import time
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import pytest

from app.server.viewer import Viewer
from app.server.web import page as served_page
from tests import coroutines
from tests.app.server.web.test_beat import page as connected
from tests.browser.conftest import CHROMIUM, FLAGS, new_page, surroundings
from tests.browser.page.test_lost import FAST, MAX_BACK, MAX_SILENT, SHOWN, SLOW_MACHINE, wait_shown
from tests.browser.slow_line import slow_line
from tests.stress.clients import CAMERA
from tests.waiting import wait_for

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

SLEEP = 15.0  # [s] of the page
MAX_GHOST = 2.0  # [s] until the lab has let go of the connection that the page has left
MAX_RELOAD = 60.0  # [s] until a page that was loaded again shows the run
# How often the browser took the page from its cache, over the reload that follows.
COUNT_CACHED = """addEventListener("pageshow", (event) => {
    if (event.persisted) sessionStorage.fromCache = 1 + Number(sessionStorage.fromCache ?? 0); });"""
FROM_CACHE = "Number(sessionStorage.fromCache ?? 0)"


@pytest.fixture(scope="module")
def caching(chromium: Any) -> Iterator[Any]:
    """A Chromium that keeps pages that are left, as it does outside of tests."""
    browser = chromium.driver.chromium.launch(
        executable_path=CHROMIUM, args=FLAGS, env=surroundings(), ignore_default_args=["--disable-back-forward-cache"]
    )
    yield browser
    browser.close()


class Sequence:
    """A lab, a line to it, and a page at the other end."""

    def __init__(self, browser: Any, line: Any, lab: Viewer, rename: Callable[[str], None]) -> None:
        """rename: gives the server another name, as another process has."""
        self.line, self.lab, self.rename, self.numbers = line, lab, rename, itertools.count(1)
        self.page = new_page(browser, 480, 320, drawn=False)
        self.page.add_init_script(COUNT_CACHED)
        self.page.goto(f"http://127.0.0.1:{line.port}/?hideViserLogo&fixedDpr=0.2")
        self.devtools = self.page.context.new_cdp_session(self.page)
        self.goes_on(MAX_RELOAD)

    def goes_on(self, seconds: float) -> None:
        """The page shows the run of the present lab, and says nothing else."""
        end, before = time.monotonic() + seconds, math.inf
        while True:
            shown = self.shown()
            found = re.match(r"Running t = ([\d.]+)", shown["status"])
            is_well = found is not None and shown["state"] == "open" and not shown["line"] and not shown["cover"]
            now = float(found[1]) if found is not None and is_well else math.inf
            if before < now < math.inf:
                break
            before = min(before, now) if is_well else math.inf
            assert time.monotonic() < end, shown
            self.page.wait_for_timeout(200)
        end = time.monotonic() + MAX_GHOST
        while len(self.lab.visitors()) != 1:
            assert time.monotonic() < end
            self.page.wait_for_timeout(200)

    def shown(self) -> dict[str, str]:
        """Words of the page; nothing while it is loaded."""
        try:
            return self.page.evaluate(SHOWN)
        except playwright.Error:
            return {"status": "", "state": "loading", "line": "", "cover": ""}

    def says_why(self, words: str, seconds: float) -> None:
        wait_shown(self.page, lambda shown: words in shown["line"] + shown["cover"], seconds)

    # ----- events

    def sleep(self) -> None:
        """The machine sleeps, and no connection ends."""
        self.devtools.send("Page.setWebLifecycleState", {"state": "frozen"})
        self.page.wait_for_timeout(1000.0 * SLEEP)
        self.devtools.send("Page.setWebLifecycleState", {"state": "active"})
        self.goes_on(MAX_BACK + SLOW_MACHINE)

    def sleep_and_dead_line(self) -> None:
        """A connection dies meanwhile."""
        self.devtools.send("Page.setWebLifecycleState", {"state": "frozen"})
        self.line.fall_silent()
        self.page.wait_for_timeout(1000.0 * SLEEP)
        self.devtools.send("Page.setWebLifecycleState", {"state": "active"})
        self.goes_on(MAX_BACK + SLOW_MACHINE + MAX_SILENT)

    def sleep_and_new_server(self) -> None:
        self.devtools.send("Page.setWebLifecycleState", {"state": "frozen"})
        self.replace()
        self.page.wait_for_timeout(1000.0 * SLEEP)
        self.devtools.send("Page.setWebLifecycleState", {"state": "active"})
        self.goes_on(MAX_RELOAD)

    def cut(self) -> None:
        """The connections end, and the next ones pass."""
        self.line.cut()
        self.goes_on(MAX_BACK + SLOW_MACHINE)

    def long_cut(self) -> None:
        self.line.cut(20.0)
        self.says_why("Connecting again", MAX_SILENT)
        self.goes_on(20.0 + MAX_BACK + SLOW_MACHINE)

    def half_open(self) -> None:
        """The connection passes nothing on, and does not end."""
        self.line.fall_silent()
        self.says_why("Nothing arrives from the lab", MAX_SILENT + SLOW_MACHINE)
        self.goes_on(MAX_SILENT + MAX_BACK + SLOW_MACHINE)

    def dead_line(self) -> None:
        """New connections pass nothing on either, for some time."""
        self.line.fall_silent(wholly=True)
        self.says_why("Nothing arrives from the lab", MAX_SILENT + SLOW_MACHINE)
        self.says_why("does not answer", 40.0)
        self.line.come_back()
        self.goes_on(MAX_SILENT + MAX_BACK + SLOW_MACHINE)

    def other_network(self) -> None:
        """The machine is offline, then in another network; old connections never end."""
        self.line.fall_silent()
        self.page.context.set_offline(True)
        self.page.wait_for_timeout(5000)
        self.page.context.set_offline(False)
        self.goes_on(MAX_SILENT + MAX_BACK + SLOW_MACHINE)

    def replace(self) -> None:
        """Another server takes the place of the lab."""
        self.lab.shut()
        self.rename(f"another {next(self.numbers)}")
        self.lab = Viewer("127.0.0.1", 0)
        self.lab.open("rope")
        self.line.lab = self.lab.port

    def new_server(self) -> None:
        self.replace()
        self.goes_on(MAX_RELOAD)

    def half_open_and_new_server(self) -> None:
        """The old connection never ends."""
        self.line.fall_silent()
        self.replace()
        self.goes_on(MAX_SILENT + MAX_RELOAD)

    def server_gone(self) -> None:
        """The lab ends, and no other comes."""
        self.lab.shut()
        self.says_why("has stopped", 40.0)

    def leave_and_come_back(self, meanwhile: Callable[[], None]) -> None:
        """A person leaves the page, and goes back to it: the browser shows the page that it has kept."""
        before = self.page.evaluate(FROM_CACHE)
        self.page.goto("about:blank")
        meanwhile()
        self.page.go_back()
        self.goes_on(MAX_RELOAD)
        assert self.page.evaluate(FROM_CACHE) == before + 1

    def cache(self) -> None:
        self.leave_and_come_back(lambda: self.page.wait_for_timeout(2000))

    def cache_and_new_server(self) -> None:
        self.leave_and_come_back(self.replace)


ROWS = (
    "sleep", "sleep sleep", "sleep_and_dead_line", "sleep_and_dead_line sleep", "sleep_and_new_server",
    "cut", "cut cut cut", "long_cut", "long_cut sleep", "half_open", "half_open half_open", "dead_line cut",
    "other_network", "other_network half_open", "new_server", "half_open_and_new_server cut", "cache",
    "cache half_open", "cache_and_new_server sleep_and_dead_line", "cut other_network server_gone",
)  # fmt: skip


@pytest.mark.stress
@pytest.mark.timeout(600)
@pytest.mark.parametrize("row", ROWS)
def test_a_page_goes_on_after_a_sequence_or_says_why(caching: Any, monkeypatch: pytest.MonkeyPatch, row: str) -> None:
    lab = Viewer("127.0.0.1", 0)
    lab.open("rope")
    with slow_line(lab.port, FAST, 0.0) as line:
        sequence = Sequence(caching, line, lab, lambda name: monkeypatch.setattr(served_page, "SERVER_NAME", name))
        try:
            for event in row.split():
                getattr(sequence, event)()
        finally:
            sequence.page.close()
            sequence.lab.shut()


@pytest.mark.parametrize("is_dead", [False, True])
def test_the_line_tells_the_lab_of_an_end_unless_the_connection_is_dead(is_dead: bool) -> None:
    lab = Viewer("127.0.0.1", 0)
    with slow_line(lab.port, FAST, 0.0) as line:

        async def leave() -> None:
            """As a browser whose process ends."""
            async with connected(line.port, "/") as client:
                await client.send(msgspec.msgpack.encode(CAMERA))
                while not lab.visitors():
                    await client.recv()
                if is_dead:
                    line.fall_silent()
                client.transport.abort()

        try:
            coroutines.run(leave())
            if is_dead:
                time.sleep(MAX_GHOST)
                assert lab.visitors()
            else:
                wait_for(lambda: not lab.visitors(), MAX_GHOST)
        finally:
            lab.shut()
