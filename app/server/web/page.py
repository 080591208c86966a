"""The page of the lab: viser's, with a title, a cover until something is drawn, and our own scripts.

viser serves one HTML file. If it is not as expected, it is sent unchanged: the lab works with viser's client alone.
"""

import functools
import gzip
import secrets
import sys
from collections.abc import Callable
from http import HTTPStatus
from importlib import resources
from urllib.parse import parse_qs

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.render.client_page import with_ours
from app.render.scripts import BEFORE, BESIDE, PAGE, tags

ALIVE_PATH = "/springtide-alive"  # requested by the page, to check that the server answers
# The answer to that: another name is another server, which knows nothing of the page. A second line is the reason why a
# page may not connect.
SERVER_NAME = secrets.token_hex(8)
PANES_PATH = "/beside"  # of the page that shows several labs side by side
TITLE, STARTING = "Springtide", "Starting …"
STYLES = ("page.css",)


def own_answer(request: Request, *, shared: bool, refused: Callable[[str], str]) -> Response | None:
    """The answer to a request of ours; None for viser's. shared: other pages may read it.

    refused: returns the reason why a page of an origin may not connect, or "".
    """
    path, _, query = request.path.partition("?")
    if path == PANES_PATH:
        body = panes_page()
        headers = Headers({"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(body))})
        return Response(HTTPStatus.OK, "OK", headers, body)
    if path != ALIVE_PATH:
        return None
    reason = refused(parse_qs(query).get("origin", [""])[0])
    body = "\n".join(filter(None, (SERVER_NAME, reason))).encode()
    headers = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))})
    if shared:
        headers["Access-Control-Allow-Origin"] = "*"
    return Response(HTTPStatus.OK, "OK", headers, body)


@functools.cache
def panes_page() -> bytes:
    """The page that shows several labs side by side."""
    page = (resources.files("app.render") / "js" / "beside" / "page.html").read_text("utf-8")
    return page.replace("</body>", f"{tags(BESIDE)}</body>", 1).encode()


def with_cover(request: Request, response: Response | None) -> Response | None:
    """viser's answer; for the page, with our title, cover and scripts."""
    path = request.path.partition("?")[0]
    if response is None or response.status_code != HTTPStatus.OK or path not in ("/", "/index.html"):
        return response
    page = covered(bytes(response.body or b""), response.headers.get("Content-Encoding") == "gzip")
    headers = Headers(response.headers)
    del headers["Content-Length"]
    headers["Content-Length"] = str(len(page))
    return Response(response.status_code, response.reason_phrase, headers, page)


@functools.cache
def covered(sent: bytes, zipped: bool) -> bytes:
    """viser's page with ours around it, compressed again if it was; unchanged if it is not as expected."""
    page = (gzip.decompress(sent) if zipped else sent).decode("utf-8")
    our_page = with_ours(page, title=TITLE, words=STARTING, styles=STYLES, before=BEFORE, entry=PAGE)
    if our_page is None:
        print("springtide: the page of viser has changed: it is shown without cover and scripts", file=sys.stderr)
        return sent
    content = our_page.encode()
    return gzip.compress(content) if zipped else content
