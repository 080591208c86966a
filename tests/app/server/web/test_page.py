"""The page that a browser is given."""

import gzip
import http.client
import re
from importlib import resources

import pytest

from app.render.client_page import COVER_STYLE, cover, style_sheet
from app.server.viewer import Viewer
from app.server.web.page import ALIVE_PATH, SERVER_NAME, STARTING, STYLES, TITLE, covered

MAX_START = 32_000  # characters before the end of the cover; viser's client has 800,000


def get(port: int, path: str, **headers: str) -> tuple[int, bytes, dict[str, str]]:
    """Status, body and headers of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port)
    connection.request("GET", path, headers={key.replace("_", "-"): value for key, value in headers.items()})
    answer = connection.getresponse()
    return answer.status, answer.read(), dict(answer.getheaders())


@pytest.mark.parametrize("zipped", [False, True])
def test_the_page_has_our_title_and_its_cover_before_anything_long(lab: Viewer, zipped: bool) -> None:
    status, body, headers = get(lab.port, "/?scene=rope", **({"Accept_Encoding": "gzip"} if zipped else {}))
    assert status == 200
    assert int(headers["Content-Length"]) == len(body)
    page = (gzip.decompress(body) if zipped else body).decode()
    assert f"<title>{TITLE}</title>" in page[:MAX_START]
    assert cover(STARTING) in page[:MAX_START]
    assert "<title>Viser" not in page
    assert page.index(cover(STARTING)) < page.index('<div id="root">') < page.rindex("<script")


@pytest.mark.parametrize("name", [COVER_STYLE, *STYLES])
def test_the_style_sheet_has_all_its_rules_and_no_comment(name: str) -> None:
    source = (resources.files("app.render") / "js" / name).read_text("utf-8")
    assert "/*" in source
    assert "/*" not in style_sheet(name)
    assert "*/" not in style_sheet(name)
    assert style_sheet(name).count("{") == re.sub(r"(?m)/\*[^*]*\*/", "", source).count("{")
    assert style_sheet(name).count("}") == style_sheet(name).count("{")


def test_the_page_can_ask_whether_the_server_is_there(lab: Viewer) -> None:
    assert get(lab.port, ALIVE_PATH)[:2] == (200, SERVER_NAME.encode())
    assert get(lab.port, "/nothing")[0] == 404


@pytest.mark.parametrize("page", [b"<html><body></body></html>", b"<html><script></script></html>", b"<body><script>"])
def test_a_page_of_viser_that_has_changed_is_sent_as_it_is(page: bytes, capsys: pytest.CaptureFixture[str]) -> None:
    for sent, zipped in ((page, False), (gzip.compress(page), True)):
        assert covered(sent, zipped) == sent
        assert "the page of viser has changed" in capsys.readouterr().err


def test_a_foreign_page_may_not_ask(lab: Viewer) -> None:
    assert get(lab.port, ALIVE_PATH, Origin="http://evil.example")[0] == 403
