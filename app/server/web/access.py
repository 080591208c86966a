"""Access beyond the browsers of this machine, and the path of the lab. Without either by default.

Behind a proxy the page has an address that is not the server's own. The settings describe the proxy:

- `base_path`: the path that the proxy adds before every path. A proxy that removes it again needs none.
- `origins`: the addresses of pages that may connect, as the browser sees them.
- `key`: a secret that every request must have, as the first part of its path or in the header `KEY_HEADER`. Anyone
  who has it may connect, whatever the address of the page, and nobody else, not even another user of the machine.
"""

import re
import secrets
from dataclasses import replace
from hmac import compare_digest
from http import HTTPStatus
from typing import NamedTuple
from urllib.parse import urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from sim.validation import argument_error

KEY_VARIABLE = "SPRINGTIDE_KEY"  # of the environment: other users of the machine can read a command line
KEY_HEADER = "X-Springtide-Key"
BASE_PATH = re.compile(r"(/(?!\.+(/|$))([A-Za-z0-9._~@-]|%[0-9A-Fa-f]{2})+)+")
KEY = re.compile(r"[A-Za-z0-9_-]{16,200}")
MAX_LENGTH = 500  # characters of a base path or an origin
DEFAULT_PORTS = {"http": 80, "https": 443}


class Access(NamedTuple):
    """The settings."""

    base_path: str = ""
    origins: tuple[str, ...] = ()
    key: str = ""


OWN_PAGES_ONLY = Access()


def make_key() -> str:
    """A new secret of 128 bits."""
    return secrets.token_urlsafe(16)


def read_base_path(text: str) -> str:
    """A base path without its last slash; "" for "/". Raises ValueError if it is not one."""
    path = text.removesuffix("/")
    if len(text) > MAX_LENGTH or (path and not BASE_PATH.fullmatch(path)):
        allowed = "a path such as /lab or /user/ada/lab, of letters, digits and . _ ~ @ - %"
        raise argument_error("--base-path", text[:MAX_LENGTH], allowed)
    return path


def read_origin(text: str) -> str:
    """An origin as browsers write it. Raises ValueError if it is not one."""
    error = argument_error("--allowed-origin", text[:MAX_LENGTH], "an address such as https://hub.example.org, no path")
    if len(text) > MAX_LENGTH:
        raise error
    try:
        page = urlsplit(text)
        port = page.port
    except ValueError:
        raise error from None
    name = page.hostname or ""
    if page.scheme not in DEFAULT_PORTS or not re.fullmatch(r"[a-z0-9._-]+|[0-9a-f:.]+", name):
        raise error
    host = f"[{name}]" if ":" in name else name
    netloc = host if port in (None, DEFAULT_PORTS[page.scheme]) else f"{host}:{port}"
    if text.lower().removesuffix("/") not in (f"{page.scheme}://{host}", f"{page.scheme}://{host}:{port}"):
        raise error
    return f"{page.scheme}://{netloc}"


def read_key(text: str) -> str:
    """A key from the environment, or "". Raises ValueError for one that could be guessed."""
    if text and not KEY.fullmatch(text):
        raise argument_error(KEY_VARIABLE, f"{len(text)} characters", "16 to 200 letters, digits, _ and -")
    return text


def admitted(access: Access, request: Request) -> Request | Response:
    """The request with the server's own path, or the answer to a refused one."""
    path, mark, query = request.path.partition("?")
    base = access.base_path
    if path == base != "" and request.headers.get("Upgrade") is None:
        headers = {"Location": f"{base.rpartition('/')[2]}/{mark}{query}", "Content-Length": "0"}
        return Response(HTTPStatus.FOUND, "Found", Headers(headers), b"")
    if not f"{path}/".startswith(f"{base}/"):
        return refusal(HTTPStatus.NOT_FOUND, f"The lab is at {base}/")
    path = path.removeprefix(base) or "/"
    if access.key and not is_same(request.headers.get(KEY_HEADER, ""), access.key):
        start = f"/{access.key}/"
        if not is_same(path[: len(start)], start):
            return refusal(HTTPStatus.FORBIDDEN, "This lab opens only at the address that its owner was given.")
        path = path[len(start) - 1 :]
    return replace(request, path=path + mark + query)


def is_same(text: str, expected: str) -> bool:
    """True if two texts are equal, in a time that does not depend on how much of them is."""
    return compare_digest(text.encode("utf-8", "replace"), expected.encode())


def refusal(status: HTTPStatus, line: str) -> Response:
    """An answer of one line."""
    body = f"{line}\n".encode()
    headers = {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))}
    return Response(status, status.phrase, Headers(headers), body)
