"""The page that a browser is given: viser's, with a title, a cover for while nothing is drawn, and our own script.

viser serves one HTML file. The cover stands at the top of its body, so that it is seen before the client behind it has
been read; the scripts below it are those of `SCRIPTS` in `app/render/js`. `FIRST_SCRIPTS` run before all others.
"""

import functools
import gzip
from http import HTTPStatus
from importlib import resources

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

ALIVE_PATH = "/springtide-alive"  # what the page asks for, to see whether the server is still there
TITLE = "<title>Springtide</title>"
FIRST_SCRIPTS = ("address.js", "leaving.js")
SCRIPTS = (
    "page.js", "fields.js", "camera.js", "reach.js", "charts.js", "timeline.js", "share.js", "display.js", "access.js",
    "beside.js",
)  # fmt: skip
PANES_PATH = "/beside"  # of the page that shows several labs side by side
COVER = '<div id="springtide-cover"><h1>Springtide</h1><div id="springtide-cover-words">Starting …</div></div>'


def own_answer(request: Request, *, shared: bool) -> Response | None:
    """The answer to a request that viser knows nothing of; None for the others. shared: pages of others may read it."""
    path = request.path.partition("?")[0]
    if path == PANES_PATH:
        body = (resources.files("app.render") / "js" / "beside.html").read_bytes()
        headers = Headers({"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(body))})
        return Response(HTTPStatus.OK, "OK", headers, body)
    if path != ALIVE_PATH:
        return None
    headers = Headers({"Content-Type": "text/plain", "Content-Length": "0"})
    if shared:
        headers["Access-Control-Allow-Origin"] = "*"
    return Response(HTTPStatus.OK, "OK", headers, b"")


def with_cover(request: Request, response: Response | None) -> Response | None:
    """viser's answer; where it is the page, with our title, cover and script."""
    path = request.path.partition("?")[0]
    if response is None or response.status_code != HTTPStatus.OK or path not in ("/", "/index.html"):
        return response
    body = bytes(response.body or b"")
    page = covered(body, response.headers.get("Content-Encoding") == "gzip")
    headers = Headers(response.headers)
    del headers["Content-Length"]
    headers["Content-Length"] = str(len(page))
    return Response(response.status_code, response.reason_phrase, headers, page)


@functools.cache
def covered(sent: bytes, zipped: bool) -> bytes:
    """viser's page with ours around it, compressed again where it was."""
    page = gzip.decompress(sent) if zipped else sent
    folder = resources.files("app.render") / "js"
    style = (folder / "page.css").read_text("utf-8")
    first, script = (
        "".join((folder / name).read_text("utf-8") for name in names) for names in (FIRST_SCRIPTS, SCRIPTS)
    )
    first = f"<script>{first}</script><style>{style}</style>"
    head, _, body = page.decode("utf-8").rpartition("<body>")
    # viser's client is one long script in the head: below the cover it does not delay it.
    start = head.index("<script")
    client, end = head[start : head.rindex("</script>") + len("</script>")], head.rindex("</script>") + len("</script>")
    head = head[:start].replace("<title>Viser</title>", TITLE, 1) + first + head[end:]
    body = body.replace("</body>", f"{client}<script>{script}</script></body>", 1)
    found = f"{head}<body>{COVER}{body}".encode()
    return gzip.compress(found) if zipped else found
