"""The lab behind the login of a real Jupyter server: who gets through, and who does not."""

import http.client
import importlib.util
import re
from collections.abc import Iterator

import psutil
import pytest

from app.server.access import Access
from app.server.guard import open_server, quiet
from tests.jupyter import Jupyter, join, jupyter

if importlib.util.find_spec("jupyter_server_proxy") is None:  # importing it takes seconds
    pytest.skip("the extra jupyter is not installed", allow_module_level=True)
OPTIONS = ("--ServerApp.jpserver_extensions={'jupyter_server_proxy': True}", "--ServerApp.allow_remote_access=True")
PAGE = "springtide/index.html"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Jupyter]:
    with jupyter(tmp_path_factory.mktemp("jupyter"), "/user/ada/", *OPTIONS) as server:
        yield server


def get(port: int, path: str, **headers: str) -> tuple[int, str, str]:
    """Status, body and cookies of a page."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    cookies = "; ".join(re.findall(r"(?:^|, )([^=;, ]+=[^;]+);", answer.getheader("Set-Cookie") or ""))
    return answer.status, answer.read().decode("utf-8", "replace"), cookies


def test_the_lab_opens_with_the_token_and_for_nobody_else(server: Jupyter) -> None:
    below, own = f"{server.base}{PAGE}", f"http://127.0.0.1:{server.port}"
    assert get(server.port, below)[0] in (302, 403)
    status, page, cookies = get(server.port, f"{below}?token={server.token}")
    assert (status, "springtide-cover" in page) == (200, True)
    assert join(server.port, below, own, Cookie=cookies) == 101
    assert join(server.port, below, own) == 403
    assert join(server.port, below, "http://evil.example", Cookie=cookies) == 403
    # One lab for this student, however many pages; without the key its own port answers nobody.
    labs = [p for p in psutil.Process(server.process.pid).children(recursive=True) if "--no-open" in p.cmdline()]
    assert len(labs) == 1
    port = int(labs[0].cmdline()[-1])
    assert get(port, "/")[0] == get(port, "/", Cookie=cookies)[0] == 403
    for origin in (own, f"http://127.0.0.1:{port}", "http://evil.example"):
        assert join(port, "/", origin) == 403


@pytest.mark.parametrize(
    ("access", "status"),
    [
        (Access(), 0),
        (Access(origins=("http://hub.example.org",)), 0),
        (Access(origins=("http://hub.example.org:{port}",)), 101),
        (Access(key="k" * 16), 101),
    ],
)
def test_a_lab_behind_a_proxy_of_another_name_takes_a_setting(server: Jupyter, access: Access, status: int) -> None:
    origins = tuple(origin.format(port=server.port) for origin in access.origins)
    host = f"hub.example.org:{server.port}"  # by which Jupyter names its cookie
    cookies = get(server.port, f"{server.base}api/status?token={server.token}", Host=host)[2]
    own, _ = open_server("127.0.0.1", 0, access._replace(origins=origins))
    try:
        path = f"{server.base}proxy/{own.get_port()}/{access.key and access.key + '/'}index.html"
        assert join(server.port, path, f"http://{host}", "hub.example.org", Cookie=cookies) == status
        assert join(server.port, path, "http://evil.example", "hub.example.org", Cookie=cookies) == 403
    finally:
        with quiet():
            own.stop()
