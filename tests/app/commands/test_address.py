"""The address that a command prints and opens leads to its own server, whatever else this machine serves."""

import contextlib
import errno
import os
import signal
import socket
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock
from urllib.parse import urlsplit

import pytest

from app.__main__ import main
from app.commands import lab_class, serve
from app.scenes import scene_named
from app.scenes.setups import make_setup


def has_ipv6() -> bool:
    """True if this machine has the address ::1."""
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET6) as trial:
        trial.bind(("::1", 0))
        return True
    return False


needs_ipv6 = pytest.mark.skipif(not has_ipv6(), reason="this machine has no ::1")


class FakeServer:
    """A server that only listens."""

    def __init__(self, host: str, port: int) -> None:
        self.listener = socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
        self.gui = SimpleNamespace(add_html=lambda text: None)

    def get_port(self) -> int:
        """The port that is bound."""
        port: int = self.listener.getsockname()[1]
        return port

    def stop(self) -> None:
        """Listen no more."""
        self.listener.close()


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, int], str]:
    """The host of the address that the lab opens in the browser, bound to a host and port."""
    addresses: list[str] = []
    monkeypatch.setattr(serve, "open_server", lambda host, port, _: SimpleNamespace(server=FakeServer(host, port)))
    monkeypatch.setattr(serve.Opening, "start", lambda _: None)
    monkeypatch.setattr(serve, "wait_until", lambda *_: None)
    monkeypatch.setattr(serve.SetupSaver, "store", lambda _: pytest.fail("the set-up is kept without --resume"))
    monkeypatch.setattr(serve.webbrowser, "open", addresses.append)

    def opened_by(host: str, port: int) -> str:
        assert serve.serve_lab("rope", None, host, port, browser=True, paused=False, plain=True) == 0
        return str(urlsplit(addresses[-1]).hostname)

    return opened_by


@pytest.mark.parametrize("before", [signal.default_int_handler, signal.SIG_IGN], ids=["terminal", "background job"])
def test_ctrl_c_ends_the_lab_but_in_a_background_job(
    opened: Callable[[str, int], str], monkeypatch: pytest.MonkeyPatch, before: Any
) -> None:
    """A shell has its background jobs ignore it."""
    seen: list[Any] = []
    monkeypatch.setattr(serve.Opening, "start", lambda _: seen.append(signal.getsignal(signal.SIGINT)))
    usual = signal.signal(signal.SIGINT, before)
    try:
        opened("127.0.0.1", 0)
        assert signal.getsignal(signal.SIGINT) is before
    finally:
        signal.signal(signal.SIGINT, usual)
    assert (seen == [before]) is (before is signal.SIG_IGN)


def test_set_ups_beside_a_scene_leave_it_as_it_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[serve.Opening] = []
    monkeypatch.setattr(serve, "open_server", lambda host, port, _: SimpleNamespace(server=FakeServer(host, port)))
    monkeypatch.setattr(serve, "show_until_ended", lambda opening, *_, **__: shown.append(opening) or 0)
    others = [make_setup(scene_named("cloth"), "", {})]
    serve.serve_lab("rope", None, "127.0.0.1", 0, browser=False, paused=True, plain=True, others=others)
    viewer = Mock()
    shown[0].show(viewer)
    viewer.open.assert_called_once_with("rope", None, paused=True, first_look=True)
    viewer.comparing.begin.assert_called_once_with(others, False)
    shown[0].opened.server.stop()


@pytest.fixture
def other_program() -> Iterator[int]:
    """The port at which another program serves ::1 alone, as servers of other tools do."""
    with socket.create_server(("::1", 0), family=socket.AF_INET6) as listener:
        yield listener.getsockname()[1]


@needs_ipv6
def test_beside_another_program_at_localhost_the_address_is_that_of_the_lab(
    opened: Callable[[str, int], str], other_program: int, capsys: pytest.CaptureFixture[str]
) -> None:
    for host in ("127.0.0.1", "localhost"):
        assert opened(host, other_program) == "127.0.0.1"
        said = capsys.readouterr().out
        assert f"Springtide is on http://127.0.0.1:{other_program}" in said
        assert f"Another program also answers on localhost:{other_program}" in said


@pytest.mark.parametrize(
    ("host", "shown"),
    [
        ("127.0.0.1", "localhost"),
        ("localhost", "localhost"),
        ("127.0.0.2", "127.0.0.2"),
        pytest.param("::1", "::1", marks=needs_ipv6),
    ],
)
def test_the_address_is_the_one_that_is_bound(opened: Callable[[str, int], str], host: str, shown: str) -> None:
    with contextlib.suppress(OSError):  # macOS has no 127.0.0.2 unless it is set up
        assert opened(host, 0) == shown


@needs_ipv6
def test_localhost_is_kept_from_other_programs_while_it_is_shown(other_program: int) -> None:
    with serve.reached_host("127.0.0.1", other_program) as reached:
        assert reached == "127.0.0.1"
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        with serve.reached_host("127.0.0.1", port) as reached:
            assert reached == "localhost"
            with socket.create_connection((reached, port), timeout=10) as connection:
                assert connection.getpeername()[0] == "127.0.0.1"
            with socket.socket(socket.AF_INET6) as late:
                if os.name == "posix":  # where it means less than on Windows
                    late.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                with pytest.raises(OSError, match=r".") as refused:
                    late.bind(("::1", port))
            assert refused.value.errno in (errno.EADDRINUSE, errno.EACCES)


@needs_ipv6
def test_the_page_of_a_class_opens_itself_too(
    monkeypatch: pytest.MonkeyPatch, other_program: int, capsys: pytest.CaptureFixture[str]
) -> None:
    addresses: list[str] = []
    monkeypatch.setattr(lab_class, "wait_until", lambda *_: None)
    monkeypatch.setattr(lab_class.webbrowser, "open", addresses.append)
    monkeypatch.setattr(lab_class, "Classroom", lambda *_: contextlib.nullcontext())
    assert lab_class.serve_class([], [], other_program, browser=True) == 0
    assert addresses[0].startswith(f"http://127.0.0.1:{other_program}/")
    assert addresses[0] in capsys.readouterr().out


def test_the_scene_of_the_command_line_is_served(monkeypatch: pytest.MonkeyPatch) -> None:
    served: list[Any] = []
    monkeypatch.setattr(serve, "serve_lab", lambda name, params, *_, **options: served.append((name, params)) or 0)
    assert main(["--scene", "race"]) == 0
    assert served == [("race", None)]
