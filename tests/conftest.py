"""What tests of several folders share."""

import gc
import hashlib
import signal
from collections.abc import Generator, Iterator
from typing import Any

import pytest

import app  # noqa: F401  first of all, as numpy's BLAS is to get one thread, as it does when the program runs
from tests.reruns import pytest_configure  # noqa: F401  a hook

# A shell's background job ignores Ctrl-C, and so do its child processes; tests of both send it.
signal.signal(signal.SIGINT, signal.default_int_handler)

# See `pytest_collection_modifyitems`.
EARLY = ("test_shader_functions.py", "test_water.py", "test_water_pixels.py", "test_extension.py")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--shuffle", metavar="SEED", help="run the files, and the tests of each, in a random order")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Without the garbage collector, which takes two fifths of the time to collect 8,000 tests.

    Afterwards it looks at none of what is there by then, which stays until the end.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Everything in tests/browser needs a browser, and has a second try, since a page drawn in software can be late.

    These tests begin first, as no other group takes as long: at first those that call no kernel, so that the others
    find kernels that another process has compiled. The longest file comes next, so that the last groups are short, and
    no process ends long before the others.

    `--shuffle SEED` shuffles each of the groups. A seed gives the tests of a few files the order that they have among
    all tests, so that a failure can be repeated with less.
    """
    seed = config.getoption("--shuffle")
    if seed is not None:
        items.sort(key=lambda item: (digest(seed, item.nodeid.split("::")[0]), digest(seed, item.nodeid)))
    for item in items:
        if "/tests/browser/" in item.path.as_posix():
            item.add_marker(pytest.mark.browser)
        if item.get_closest_marker("browser") is not None:
            item.add_marker(pytest.mark.flaky(reruns=1))
    items.sort(key=lambda item: (item.get_closest_marker("browser") is None, item.path.name not in EARLY))


def digest(seed: str, name: str) -> str:
    return hashlib.sha256(f"{seed} {name}".encode()).hexdigest()


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist, which is asked for with `-n`
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Of several processes, one runs tests/browser, since two browsers would slow each other down.

    The tests of another file share their fixtures in one process. Marks of groups would say the same, but pytest-xdist
    3.8 does not see them with pytest 9.2 (its issue 1386).
    """
    from xdist.scheduler import LoadScopeScheduling

    class Groups(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.split("::")[0]
            return "browser" if file.startswith("tests/browser/") else file

    return Groups(config, log)


@pytest.fixture(scope="session", autouse=True)
def no_surroundings(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The lists of presets are those of the program, whatever the user keeps, and the terminal has 80 columns."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SPRINGTIDE_DATA", str(tmp_path_factory.mktemp("data")))
        patch.setenv("COLUMNS", "80")
        patch.delenv("FORCE_COLOR", raising=False)  # Rich would colour what is no terminal
        yield


@pytest.fixture
def server() -> Iterator[Any]:
    """A viser server without a browser, on a free port of the loopback."""
    import viser

    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def lab(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A viewer with the module's SCENE and PARAMS open, or the rope, on a free port of the loopback."""
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    viewer.open(getattr(request.module, "SCENE", "rope"), getattr(request.module, "PARAMS", None))
    yield viewer
    viewer.shut()
