"""Who is let in behind a proxy: by a path, an origin or a key, each only where it was set."""

import http.client

import pytest
import websockets
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.server.web.access import KEY_HEADER, Access, admitted, make_key, read_base_path, read_key, read_origin
from app.server.web.guard import may_connect, open_server
from tests import coroutines
from tests.app.server.web.test_guard import say

KEY = "k-3_" * 5
HUB = "https://hub.example.org"


def asked(access: Access, path: str, **headers: str) -> str | int:
    """The path that a request is admitted with, or the status of the answer."""
    found = admitted(access, Request(path, Headers({name.replace("_", "-"): text for name, text in headers.items()})))
    return found.status_code if isinstance(found, Response) else found.path


@pytest.mark.parametrize("path", ["/", "/lab", "/user/ada/lab", "/user/ada%40kth.se/lab", "/a.b~c_d-e@f", ""])
def test_a_base_path_is_read_with_and_without_its_last_slash(path: str) -> None:
    assert read_base_path(path) == read_base_path(path.rstrip("/") + "/") == path.rstrip("/")


@pytest.mark.parametrize(
    "path",
    [
        "lab", "//", "//evil.example", "/lab//x", "/../x", "/a/..", "/./a", "/a?b", "/a#b", "/a b", "/a\n", "/%",
        "/%zz", "/<script>alert(1)</script>", '/"onload=', "https://hub.example.org/lab", "/\u00e5", "/" + "a" * 600,
    ],
)  # fmt: skip
def test_what_is_no_base_path_is_refused_in_one_line(path: str) -> None:
    with pytest.raises(ValueError, match=r"^--base-path: .* is not allowed; allowed: a path such as /lab") as error:
        read_base_path(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "origin"),
    [
        (HUB, HUB),
        (HUB + "/", HUB),
        ("https://Hub.Example.org:443", HUB),
        ("http://hub:80", "http://hub"),
        ("http://127.0.0.1:8888", "http://127.0.0.1:8888"),
        ("http://[::1]:8888", "http://[::1]:8888"),
    ],
)
def test_an_origin_is_read_as_browsers_write_it(text: str, origin: str) -> None:
    assert read_origin(text) == origin


@pytest.mark.parametrize(
    "text",
    [
        "*", "", "null", "hub.example.org", "file://", "https://", "https://*.example.org", "https://a@b.example",
        "https://hub.example.org/lab", "https://hub.example.org?x", "https://hub.example.org:99999", "https://a:b",
        "javascript:alert(1)", "https://<script>", "https://hub\n.org", "https://[::1", "https://" + "a" * 600,
    ],
)  # fmt: skip
def test_what_is_no_origin_is_refused_in_one_line(text: str) -> None:
    with pytest.raises(ValueError, match=r"--allowed-origin: .* is not allowed; allowed: an address such as") as error:
        read_origin(text)
    assert "\n" not in str(error.value)


def test_a_key_that_could_be_guessed_is_refused_and_not_shown() -> None:
    assert read_key(made := make_key()) == made
    assert made != make_key()
    for bad in ("secret", "x" * 15, "x" * 201, "x" * 16 + "/", "{port}" * 4):
        with pytest.raises(ValueError, match="SPRINGTIDE_KEY") as error:
            read_key(bad)
        assert bad not in str(error.value)


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("/user/ada/", "/"),
        ("/user/ada/index.html?scene=race", "/index.html?scene=race"),
        ("/user/ada", 302),
        ("/user/ada?scene=race", 302),
        ("/", 404),
        ("/user/adam/", 404),
        ("/user/Ada/", 404),
        ("/lab/user/ada/", 404),
        ("/user/ada/../bob/", "/../bob/"),  # viser answers such a path with 404
    ],
)
def test_with_a_base_path_only_what_is_below_it_is_answered(path: str, found: str | int) -> None:
    assert asked(Access("/user/ada"), path) == found
    assert asked(Access(), path) == path


def test_a_websocket_at_the_base_path_itself_is_not_sent_elsewhere() -> None:
    assert asked(Access("/user/ada"), "/user/ada", Upgrade="websocket") == "/"


def test_a_key_opens_in_the_path_or_in_a_header_and_nothing_else_does() -> None:
    access = Access("/lab", key=KEY)
    assert asked(access, f"/lab/{KEY}/index.html?a=b") == "/index.html?a=b"
    assert asked(access, "/lab/index.html", X_Springtide_Key=KEY) == "/index.html"
    for path in (
        "/lab/",
        f"/lab/{KEY}",
        f"/lab/{KEY}x/",
        f"/lab/{KEY[:-1]}/",
        f"/lab//{KEY}/",
        f"/lab/?{KEY}/",
        "/lab/\u00e5/",
    ):
        assert asked(access, path) == 403
    assert asked(access, "/lab/", X_Springtide_Key=KEY[:-1]) == 403
    assert KEY_HEADER == "X-Springtide-Key"


@pytest.mark.parametrize("origin", [HUB, "http://evil.example", "null"])
def test_a_foreign_origin_is_let_in_only_where_it_is_set_or_a_key_was_brought(origin: str) -> None:
    request = Request("/", Headers({"Host": "127.0.0.1:8080"}))
    assert not may_connect(request, "127.0.0.1", Access("/user/ada"), origin)
    assert may_connect(request, "127.0.0.1", Access(origins=("https://other.example", HUB)), origin) == (origin == HUB)
    assert may_connect(request, "127.0.0.1", Access(key=KEY), origin)  # `admitted` has asked for it


def test_a_page_without_origin_and_our_own_are_let_in_as_before() -> None:
    access = Access("/lab", (HUB,))
    for headers in ({}, {"Origin": "http://localhost:8080", "Host": "localhost:8080"}):
        assert may_connect(Request("/", Headers(headers)), "127.0.0.1", access, headers.get("Origin"))


def answer(port: int, path: str) -> tuple[int, str]:
    connection = http.client.HTTPConnection("127.0.0.1", port)
    connection.request("GET", path)
    found = connection.getresponse()
    return found.status, found.getheader("Access-Control-Allow-Origin", "")


def test_a_served_lab_with_path_origin_and_key(capsys: pytest.CaptureFixture[str]) -> None:
    server = open_server("127.0.0.1", 0, Access("/lab", (HUB,), KEY)).server
    try:
        port = server.get_port()
        assert [answer(port, path)[0] for path in ("/", "/lab", "/lab/", f"/lab/{KEY}/")] == [404, 302, 403, 200]
        assert answer(port, f"/lab/{KEY}/springtide-alive") == (200, "*")
        coroutines.run(say(port, [], HUB, f"/lab/{KEY}/index.html"))
        for path in ("/", "/lab/", "/lab/index.html"):
            with pytest.raises(websockets.exceptions.InvalidStatus) as refusal:
                coroutines.run(say(port, [], HUB, path))
            assert refusal.value.response.status_code in (403, 404)
        said = capsys.readouterr().err
        assert [line for line in said.splitlines() if line.startswith("springtide: ")] == [
            "springtide: refused a page outside of /lab/, where --base-path puts the lab",
            "springtide: refused a page without the key. Open the address that was printed at the start, or start the "
            "lab without SPRINGTIDE_KEY",
        ]
        assert KEY not in said
    finally:
        server.stop()


def test_a_served_lab_with_an_origin_lets_in_that_one_only() -> None:
    server = open_server("127.0.0.1", 0, Access(origins=(HUB,))).server
    try:
        coroutines.run(say(server.get_port(), [], HUB))
        with pytest.raises(websockets.exceptions.InvalidStatus):
            coroutines.run(say(server.get_port(), [], HUB + ":8443"))
        assert answer(server.get_port(), "/springtide-alive") == (200, "")
    finally:
        server.stop()
