"""Chromium, Firefox and WebKitGTK (Safari's engine) with one interface, all of them drawing in software.

Playwright drives Chromium; Firefox speaks WebDriver BiDi, and WebKitGTK WebDriver. Each browser has a folder and, but
for Chromium, an X server of its own, and ends with all its processes. On Debian they are the packages `firefox-esr`,
`webkit2gtk-driver` and `xvfb`.
"""

import abc
import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import connect

from tests.browser.conftest import NO_PIXELS

START_TIME = 60.0  # [s] for which a browser may take to answer
ANSWER_TIME = 180.0  # [s] the same for a command
SCREEN = ("Xvfb", "-displayfd", "1", "-screen", "0", "1600x1200x24", "-nolisten", "tcp")
SOFTWARE = {"LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe"}
KEYS = {"Control": "\ue009", "Enter": "\ue007", "Escape": "\ue00c", "Tab": "\ue004", "Right": "\ue014", "Space": " "}
PREFERENCES = {
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "toolkit.telemetry.reportingpolicy.firstRun": False,
    "app.update.enabled": False,
    "webgl.force-enabled": True,
    "remote.active-protocols": 1,
}
MINI_BROWSER = next(iter(Path("/usr/lib").glob("*/webkit2gtk-4.*/MiniBrowser")), None)
Point = Sequence[float]


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


class Engine(abc.ABC):
    """What the browsers have in common: a page, which takes actions of WebDriver and runs JavaScript."""

    def __init__(self) -> None:
        self.folder = tempfile.mkdtemp(prefix="engine")
        self.processes: list[subprocess.Popen[str]] = []

    def start(self, *command: str, **how: Any) -> subprocess.Popen[str]:
        """Start a process that ends with the browser."""
        self.processes.append(subprocess.Popen(command, start_new_session=True, text=True, **how))
        return self.processes[-1]

    def open_screen(self) -> dict[str, str]:
        """Start an X server; returns the environment of the browser."""
        screen = self.start(*SCREEN, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        assert screen.stdout is not None
        return {**os.environ, **SOFTWARE, "DISPLAY": f":{screen.stdout.readline().strip()}"}

    @abc.abstractmethod
    def open(self, address: str) -> None:
        """Load a page."""

    @abc.abstractmethod
    def run(self, body: str) -> Any:
        """The result of the body of an async function in the page. Raises RuntimeError where it throws."""

    @abc.abstractmethod
    def act(self, actions: list[dict[str, Any]]) -> None:
        """Perform actions of WebDriver."""

    def wait(self, body: str, seconds: float = 120.0) -> Any:
        """The result of the body of a function once it is true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            with contextlib.suppress(RuntimeError):
                if found := self.run(body):
                    return found
            time.sleep(0.2)
        raise AssertionError(f"not within {seconds:g} s: {body}; {self.run('return document.body.innerText;')[:300]}")

    def press(self, *points: Point) -> None:
        """Press the mouse at the first point, move along the others, and release it."""
        moves = [
            {"type": "pointerMove", "x": round(x), "y": round(y), "duration": 40, "origin": "viewport"}
            for x, y in points
        ]
        down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        actions = [moves[0], down, *moves[1:], up]
        self.act([{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}])

    def press_on(self, expression: str) -> None:
        """Press the mouse on the middle of an element, once it is there and stands still."""
        place = f"""const find = () => {expression}, places = [];
            for (let k = 0; k < 2; k++) {{
                find()?.scrollIntoView({{ block: "nearest" }});
                await new Promise((done) => setTimeout(done, 200));
                const box = find()?.getBoundingClientRect();
                places.push(box && [box.left + box.width / 2, box.top + box.height / 2]);
            }}
            const stands = places[1] && String(places[0]) === String(places[1]);
            return stands && find().contains(document.elementFromPoint(...places[1])) && places[1];"""
        self.press(self.wait(place))

    def type(self, *keys: str) -> None:
        """Press keys one after the other: letters, or names in `KEYS`."""
        actions = [
            {"type": kind, "value": KEYS.get(key, key)} for key in keys for kind in ("keyDown", "keyUp")
        ]  # fmt: skip
        self.act([{"type": "key", "id": "keys", "actions": actions}])

    def close(self) -> None:
        """End all processes, the browser before its X server."""
        for process in reversed(self.processes):
            for kind in (signal.SIGTERM, signal.SIGKILL):
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, kind)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(5)
        shutil.rmtree(self.folder, ignore_errors=True)


class Firefox(Engine):
    """Firefox with a window of its own: without one it finds no Mesa, and has no WebGL."""

    def __init__(self) -> None:
        super().__init__()
        lines = (f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in PREFERENCES.items())
        Path(self.folder, "user.js").write_text("".join(lines), "utf-8")
        port = free_port()
        command = ("firefox-esr", "--no-remote", "--profile", self.folder, "--remote-debugging-port", str(port))
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.start(*command, "about:blank", env=self.open_screen(), **quiet)
        end = time.monotonic() + START_TIME
        while True:
            try:
                self.socket = connect(f"ws://127.0.0.1:{port}/session", max_size=None, open_timeout=START_TIME)
                break
            except OSError:
                assert time.monotonic() < end, "Firefox does not answer"
                time.sleep(0.2)
        self.count = 0
        self.send("session.new", capabilities={"alwaysMatch": {"unhandledPromptBehavior": {"default": "accept"}}})
        self.context = self.send("browsingContext.getTree")["contexts"][0]["context"]
        script = f"() => {{ {NO_PIXELS} }}"
        self.send("script.addPreloadScript", functionDeclaration=script)
        self.send("browsingContext.setViewport", context=self.context, viewport={"width": 1000, "height": 700})

    def send(self, method: str, **params: Any) -> Any:
        self.count += 1
        self.socket.send(json.dumps({"id": self.count, "method": method, "params": params}))
        answer: dict[str, Any] = {}
        while answer.get("id") != self.count:
            answer = json.loads(self.socket.recv(timeout=ANSWER_TIME))
        if answer["type"] == "error":
            raise RuntimeError(f"{method}: {answer['message']}")
        return answer["result"]

    def open(self, address: str) -> None:
        self.send("browsingContext.navigate", context=self.context, url=address, wait="complete")

    def run(self, body: str) -> Any:
        function = f"async () => JSON.stringify(await (async () => {{ {body} }})() ?? null)"
        target = {"context": self.context}
        got = self.send("script.callFunction", functionDeclaration=function, awaitPromise=True, target=target)
        if got["type"] == "exception":
            raise RuntimeError(got["exceptionDetails"]["text"])
        return json.loads(got["result"]["value"])

    def act(self, actions: list[dict[str, Any]]) -> None:
        self.send("input.performActions", context=self.context, actions=actions)

    def close(self) -> None:
        self.socket.close()
        super().close()


class WebKit(Engine):
    """WebKitGTK's MiniBrowser; its language is "C", which is none."""

    def __init__(self) -> None:
        super().__init__()
        homes = ("HOME", "XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")
        around = {**self.open_screen(), **dict.fromkeys(homes, self.folder), "LC_ALL": "C", "LANG": "C"}
        around |= {"WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS": "1", "NO_AT_BRIDGE": "1", "GDK_BACKEND": "x11"}
        port = free_port()
        self.address = f"http://127.0.0.1:{port}"
        command = ("dbus-run-session", "--", "WebKitWebDriver", f"--port={port}", "--host=127.0.0.1")
        self.start(*command, env=around, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        options = {"binary": str(MINI_BROWSER), "args": ["--automation"]}
        wanted = {"capabilities": {"alwaysMatch": {"webkitgtk:browserOptions": options}}}
        end = time.monotonic() + START_TIME
        while True:
            try:
                session = self.send("/session", wanted)["sessionId"]
                break
            except OSError:
                assert time.monotonic() < end, "WebKitWebDriver does not answer"
                time.sleep(0.2)
        self.address += f"/session/{session}"
        self.send("/timeouts", {"script": 120_000, "pageLoad": 120_000})
        self.send("/window/rect", {"width": 1000, "height": 800})

    def send(self, path: str, data: dict[str, Any]) -> Any:
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(self.address + path, json.dumps(data).encode(), headers)
        try:
            with urllib.request.urlopen(request, timeout=ANSWER_TIME) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(error.read().decode()[:400]) from None

    def open(self, address: str) -> None:
        self.send("/url", {"url": address})
        self.run(NO_PIXELS)  # its driver has no scripts that run before a page

    def run(self, body: str) -> Any:
        function = f"""const done = arguments[arguments.length - 1];
            (async () => {{ {body} }})().then((value) => done([true, value ?? null]),
                                              (error) => done([false, String(error)]));"""
        is_good, value = self.send("/execute/async", {"script": function, "args": []})
        if not is_good:
            raise RuntimeError(value)
        return value

    def act(self, actions: list[dict[str, Any]]) -> None:
        self.send("/actions", {"actions": actions})


class Chromium(Engine):
    """A page of the Chromium that the other tests use."""

    def __init__(self, chromium: Any) -> None:
        super().__init__()
        self.page = chromium.new_page(viewport={"width": 1000, "height": 700})
        self.page.add_init_script(NO_PIXELS)

    def open(self, address: str) -> None:
        self.page.goto(address)

    def run(self, body: str) -> Any:
        return self.page.evaluate(f"async () => {{ {body} }}")

    def act(self, actions: list[dict[str, Any]]) -> None:
        mouse, keyboard = self.page.mouse, self.page.keyboard
        names = {value: name for name, value in KEYS.items() if name != "Space"} | {"\ue014": "ArrowRight"}
        for step in actions[0]["actions"]:
            match step["type"]:
                case "pointerMove":
                    mouse.move(step["x"], step["y"])
                case "pointerDown":
                    mouse.down()
                case "pointerUp":
                    mouse.up()
                case "keyDown":
                    keyboard.down(names.get(step["value"], step["value"]))
                case "keyUp":
                    keyboard.up(names.get(step["value"], step["value"]))

    def close(self) -> None:
        self.page.close()
        super().close()


def missing(name: str) -> str:
    """What this machine lacks for a browser; "" where it lacks nothing."""
    needed = {
        "firefox": ("firefox-esr", "Xvfb"),
        "webkit": ("WebKitWebDriver", "Xvfb", "dbus-run-session"),
    }
    lacks = [program for program in needed.get(name, ()) if shutil.which(program) is None]
    return ", ".join(lacks) or ("MiniBrowser" if name == "webkit" and MINI_BROWSER is None else "")


@contextlib.contextmanager
def opened(name: str, chromium: Any) -> Iterator[Engine]:
    """A browser by its name; the test is skipped where it is not installed."""
    if lacks := missing(name):
        pytest.skip(f"no {lacks} on the search path")
    engine = Chromium(chromium) if name == "chromium" else {"firefox": Firefox, "webkit": WebKit}[name]()
    guard = threading.Timer(0.8 * START_TIME + ANSWER_TIME, engine.close)  # so that no browser is left behind
    guard.start()
    try:
        yield engine
    finally:
        guard.cancel()
        engine.close()
