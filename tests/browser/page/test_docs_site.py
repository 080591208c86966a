"""The replays on the front page of the documentation: there while they are in view, and moving."""

import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from shutil import copytree
from typing import Any

import pytest

from docs.make_replays import CLIPS, MAX_BYTES, page_of
from tests.browser.conftest import VERTICES

ROOT = Path(__file__).parents[3]
PAGE = """<!doctype html><link rel="stylesheet" href="static/front.css"><script src="static/replays.js"></script>
<div class="replay"><div class="replay-place" data-replay="rope.html" data-title="rope"></div></div>
<div style="height: 1500px"></div>"""


@pytest.fixture
def site(tmp_path: Path) -> Iterator[str]:
    """The address of a page with the replay of one second of the rope."""
    page = page_of("rope", CLIPS["rope"]._replace(end=1.0)).encode()
    assert len(page) < MAX_BYTES
    (tmp_path / "rope.html").write_bytes(page)
    (tmp_path / "index.html").write_text(PAGE, "utf-8")
    copytree(ROOT / "docs" / "static", tmp_path / "static")

    class Handler(SimpleHTTPRequestHandler):
        def log_message(self, format: str, *args: Any) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(tmp_path))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}/index.html"
        server.shutdown()


@pytest.mark.long
def test_a_replay_moves_while_it_is_in_view(chromium: Any, site: str) -> None:
    page = chromium.new_page(viewport={"width": 600, "height": 400})
    try:
        page.goto(site)
        page.wait_for_selector("iframe.is-drawn", timeout=60_000)
        frame = next(frame for frame in page.frames if frame.url.endswith("rope.html"))
        frame.wait_for_function(VERTICES, arg="/rope", timeout=60_000)
        first = frame.evaluate(VERTICES, "/rope")
        frame.wait_for_function(f"first => ({VERTICES})('/rope') !== first", arg=first, timeout=60_000)
        page.evaluate("window.scrollTo(0, 1400)")
        page.wait_for_selector("iframe", state="detached", timeout=20_000)
    finally:
        page.close()
