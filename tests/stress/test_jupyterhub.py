"""A real JupyterHub with two students: each has a lab, and neither reaches the other's."""

import http.client
import importlib.util
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.parse
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from tests.jupyter import join

PROXY = shutil.which("configurable-http-proxy")
if importlib.util.find_spec("jupyterhub") is None or PROXY is None:
    pytest.skip("jupyterhub or configurable-http-proxy is not installed", allow_module_level=True)
PAGE = "springtide/index.html"
KEY_VARIABLE = "SPRINGTIDE_KEY"
MAX_START = 120.0  # [s] of a hub, or of a student's server
CONFIG = """
c.JupyterHub.bind_url = "http://127.0.0.1:{port}/"
c.JupyterHub.hub_port = {hub}
c.ConfigurableHTTPProxy.command = [{proxy!r}]
c.ConfigurableHTTPProxy.api_url = "http://127.0.0.1:{api}"
c.JupyterHub.authenticator_class = "dummy"
c.Authenticator.allowed_users = {{"ada", "bo"}}
c.JupyterHub.spawner_class = "simple"
c.SimpleLocalProcessSpawner.home_dir_template = {home!r}
c.Spawner.args = ["--allow-root"]
c.Spawner.default_url = "/springtide/"
c.Spawner.environment = {{"SPRINGTIDE_LAB": "~/springtide"}}
c.JupyterHub.log_level = "DEBUG"
"""


class Hub:
    """A running hub."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        ports = [free_port() for _ in range(3)]
        self.port = ports[0]
        home = str(folder / "home" / "{username}")
        config = CONFIG.format(port=ports[0], hub=ports[1], api=ports[2], proxy=PROXY, home=home)
        (folder / "config.py").write_text(config, "utf-8")
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("JUPYTER", "SPRINGTIDE_"))}
        self.log = (folder / "hub.log").open("w")
        self.process = subprocess.Popen(
            [sys.executable, "-m", "jupyterhub", "-f", str(folder / "config.py")],
            cwd=folder, env=kept, stdout=self.log, stderr=self.log,
        )  # fmt: skip

    def text(self) -> str:
        """All that hub and students' servers have logged."""
        return (self.folder / "hub.log").read_text("utf-8", "replace")

    def labs(self) -> list[psutil.Process]:
        """The processes of labs."""
        mine = psutil.Process(self.process.pid).children(recursive=True)
        return [process for process in mine if "--no-open" in process.cmdline()]

    def lab_of(self, name: str) -> psutil.Process:
        """The lab of a student."""
        (found,) = (p for p in self.labs() if str(self.folder / "home" / name) in p.environ().get("HOME", ""))
        return found

    def end(self) -> None:
        for process in [*psutil.Process(self.process.pid).children(recursive=True), psutil.Process(self.process.pid)]:
            if process.is_running():
                process.terminate()
        self.process.wait(30)
        self.log.close()


class Browser:
    """A student's browser, without pictures: it keeps cookies and follows redirects."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.cookies: dict[str, tuple[str, str]] = {}  # name -> value, path

    def header(self, path: str) -> str:
        """The cookies for a path."""
        return "; ".join(f"{name}={value}" for name, (value, below) in self.cookies.items() if path.startswith(below))

    def ask(self, path: str, form: dict[str, str] | None = None, follows: int = 12) -> tuple[int, str, str]:
        """Status, address and text of a page. form: is posted."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        headers = {"Cookie": self.header(path)}
        body = None
        if form is not None:
            body = urllib.parse.urlencode(form)
            headers["Content-Type"] = "application/x-www-form-urlencoded"
        connection.request("GET" if form is None else "POST", path, body, headers)
        answer = connection.getresponse()
        text = answer.read().decode("utf-8", "replace")
        for line in answer.headers.get_all("Set-Cookie") or ():
            name, _, value = line.partition(";")[0].partition("=")
            below = re.search(r"[Pp]ath=([^;]*)", line)
            self.cookies[name] = value, below[1] if below else "/"
        if follows and answer.status in (301, 302, 303, 307):
            place = urllib.parse.urlsplit(urllib.parse.urljoin(path, answer.headers["Location"]))
            return self.ask(place._replace(scheme="", netloc="").geturl(), follows=follows - 1)
        return answer.status, path, text

    def log_in(self, name: str) -> None:
        _, _, page = self.ask("/hub/login")
        token = re.search(r'name="_xsrf"\s+value="([^"]+)"', page)
        assert token is not None, page[:500]
        form = {"username": name, "password": "x", "_xsrf": token[1]}
        assert self.ask("/hub/login", form)[0] in (200, 302, 404)

    def open(self, path: str) -> tuple[int, str, str]:
        """A page of a student's server, once that has started."""
        end = time.monotonic() + MAX_START
        found = self.ask(path)
        while "spawn-pending" in found[1] or found[0] in (424, 503) or "/hub/spawn" in found[1]:
            assert time.monotonic() < end, found
            time.sleep(0.5)
            found = self.ask(path)
        return found

    def join(self, path: str) -> int:
        """Connect as viser's client does: 101 where it is let in, 0 where it is closed at once, else the status."""
        return join(self.port, path, f"http://127.0.0.1:{self.port}", Cookie=self.header(path))


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@pytest.fixture(scope="module")
def hub(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hub]:
    hub = Hub(tmp_path_factory.mktemp("hub"))
    try:
        end = time.monotonic() + MAX_START
        while "JupyterHub is now running" not in hub.text():
            assert time.monotonic() < end, hub.text()
            assert hub.process.poll() is None, hub.text()
            time.sleep(0.2)
        yield hub
    finally:
        hub.end()


@pytest.fixture(scope="module")
def students(hub: Hub) -> dict[str, Browser]:
    """Two browsers, each logged in and with its lab open."""
    found = {name: Browser(hub.port) for name in ("ada", "bo")}
    for name, browser in found.items():
        browser.log_in(name)
        browser.ask("/hub/spawn")
        status, address, page = browser.open(f"/user/{name}/{PAGE}")
        assert (status, "springtide-cover" in page) == (200, True), (address, page[:300])
        assert browser.join(f"/user/{name}/{PAGE}") == 101
    return found


def test_each_student_has_a_folder_and_neither_reaches_the_others_lab(hub: Hub, students: dict[str, Browser]) -> None:
    for name, other in (("ada", "bo"), ("bo", "ada")):
        own = students[name]
        assert (hub.folder / "home" / name / "springtide" / "rope.py").is_file()
        assert own.ask(f"/user/{name}/api/contents/springtide/rope.py")[0] == 200
        for path in (PAGE, "springtide/", "api/contents/springtide/rope.py", "files/springtide/answers.toml"):
            status, address, page = own.ask(f"/user/{other}/{path}")
            assert status in (403, 404) or "/hub/" in address, (path, status, address)
            assert "springtide-cover" not in page
            assert "def spring_force" not in page
        assert own.join(f"/user/{other}/{PAGE}") in (302, 403)
        assert Browser(hub.port).join(f"/user/{other}/{PAGE}") in (302, 403)


def test_the_port_of_a_lab_answers_nobody_and_its_key_is_in_no_log(hub: Hub, students: dict[str, Browser]) -> None:
    for name in students:
        lab = hub.lab_of(name)
        port, key = int(lab.cmdline()[-1]), lab.environ()[KEY_VARIABLE]
        assert Browser(port).ask("/")[0] == 403
        assert Browser(port).join("/") == 403
        assert len(key) > 20
        assert key not in hub.text()
        assert key not in " ".join(word for p in psutil.process_iter(["cmdline"]) for word in p.info["cmdline"] or ())


def test_a_lab_that_is_killed_comes_back(hub: Hub, students: dict[str, Browser]) -> None:
    before = hub.lab_of("bo")
    before.kill()
    before.wait(30)
    end = time.monotonic() + MAX_START
    while students["bo"].ask(f"/user/bo/{PAGE}")[0] != 200:
        assert time.monotonic() < end
        time.sleep(0.5)
    assert students["bo"].join(f"/user/bo/{PAGE}") == 101
    assert hub.lab_of("bo").pid != before.pid


def test_a_student_who_is_logged_out_loses_the_lab(students: dict[str, Browser]) -> None:
    """The last test, as it ends the session."""
    ada = students["ada"]
    assert ada.ask("/hub/logout")[0] == 200
    status, address, page = ada.ask(f"/user/ada/{PAGE}")
    assert "springtide-cover" not in page
    assert status == 403 or "/hub/login" in address
    assert ada.join(f"/user/ada/{PAGE}") in (302, 403)
