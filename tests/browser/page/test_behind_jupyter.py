"""All browser tests of the rope again, through the proxy of a real Jupyter server with a token and a path."""

import functools
import importlib.util
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from app.server.viewer import Viewer
from app.server.web.access import Access, make_key
from tests.browser.conftest import Tab
from tests.browser.scenes import test_rope
from tests.jupyter import Jupyter, jupyter

if importlib.util.find_spec("jupyter_server_proxy") is None:  # importing it takes seconds
    pytest.skip("the extra jupyter is not installed", allow_module_level=True)
pytestmark = [pytest.mark.stress, pytest.mark.timeout(1200)]
OPTIONS = ("--ServerApp.jpserver_extensions={'jupyter_server_proxy': True}",)
SCENE = test_rope.SCENE
ACCESS = Access(key=make_key())
globals().update({name: test for name, test in vars(test_rope).items() if name.startswith("test_")})


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Jupyter]:
    with jupyter(tmp_path_factory.mktemp("jupyter"), "/user/ada/", *OPTIONS) as server:
        yield server


def proxied_tab(chromium: Any, server: Jupyter, port: int, **how: Any) -> Tab:
    """A page of the lab on a port, at its address behind Jupyter."""
    return Tab(chromium, port, address=server.address(f"proxy/{port}/{ACCESS.key}/"), **how)


@pytest.fixture(autouse=True)
def viewers_of_the_tests_have_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(test_rope, "Viewer", functools.partial(Viewer, access=ACCESS))


@pytest.fixture
def lab() -> Iterator[Viewer]:
    viewer = Viewer("127.0.0.1", 0, access=ACCESS)
    viewer.open(SCENE)
    yield viewer
    viewer.shut()


@pytest.fixture(scope="module")
def one_page(chromium: Any, server: Jupyter) -> Iterator[tuple[Viewer, Tab]]:
    viewer = Viewer("127.0.0.1", 0, access=ACCESS)
    tab = proxied_tab(chromium, server, viewer.port)
    yield viewer, tab
    tab.page.close()
    viewer.shut()


@pytest.fixture
def open_tab(chromium: Any, server: Jupyter) -> Iterator[Callable[..., Tab]]:
    tabs: list[Tab] = []

    def new(port: int, **how: Any) -> Tab:
        tabs.append(proxied_tab(chromium, server, port, **how))
        return tabs[-1]

    yield new
    for tab in tabs:
        tab.page.close()


def test_the_page_is_the_one_behind_jupyter(shown: tuple[Viewer, Tab], server: Jupyter) -> None:
    viewer, tab = shown
    path = f"{server.base}proxy/{viewer.port}/{ACCESS.key}/index.html"
    assert tab.page.evaluate("location.pathname") == path
    assert "websocket" not in tab.page.evaluate("location.href")
    assert tab.errors == []


def test_the_entry_in_the_launcher_opens_a_lab(chromium: Any, server: Jupyter) -> None:
    tab = Tab(chromium, 0, address=server.address("springtide/"))
    tab.wait(lambda: len(tab.vertices("/rope")) > 0)
    first = tab.vertices("/rope")
    tab.wait(lambda: abs(tab.vertices("/rope") - first).max() > 0.2)
    assert tab.page.evaluate("location.pathname") == f"{server.base}springtide/index.html"
    assert tab.errors == []
    tab.page.reload()
    tab.wait(lambda: len(tab.vertices("/rope")) > 0)
    tab.page.close()
