"""What tests of several folders share."""

from collections.abc import Iterator
from typing import Any

import pytest

import app  # noqa: F401  first of all, as numpy's BLAS is to get one thread, as it does when the program runs


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Everything in tests/browser needs a browser, and has a second try, since a page drawn in software can be late.

    Of several processes (`-n`), one runs all tests with a browser, since two browsers would slow each other down. They
    begin first, as no other group takes as long. The tests of another file share their fixtures in one process. The
    longest file comes next, so that the last groups are short, and no process ends long before the others.
    """
    for item in items:
        if "/tests/browser/" in item.path.as_posix():
            item.add_marker(pytest.mark.browser)
        browser = item.get_closest_marker("browser") is not None
        if browser:
            item.add_marker(pytest.mark.flaky(reruns=1))
        item.add_marker(pytest.mark.xdist_group("browser" if browser else item.path.as_posix()))
    items.sort(key=lambda item: (item.get_closest_marker("browser") is None, item.path.name != "test_extension.py"))


@pytest.fixture(scope="session", autouse=True)
def no_own_setups(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The lists of presets are those of the program, whatever the user keeps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SPRINGTIDE_DATA", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.fixture
def lab(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A viewer with the module's SCENE and PARAMS open, or the rope, on a free port of the loopback."""
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    viewer.open(getattr(request.module, "SCENE", "rope"), getattr(request.module, "PARAMS", None))
    yield viewer
    viewer.shut()
