"""Chromium, Firefox and WebKitGTK (Safari's engine) with one interface, all of them drawing in software.

Playwright drives Chromium; Firefox speaks WebDriver BiDi, and WebKitGTK WebDriver. Each browser has its own folder and,
except Chromium, its own X server, and ends with all its processes. On Debian they are the packages `firefox-esr`,
`webkit2gtk-driver` and `xvfb`.
"""

import abc
import base64
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
SIZE = (1000, 700)  # [pixels] of the page
SCREEN = ("Xvfb", "-displayfd", "1", "-screen", "0", "1600x1200x24", "-nolisten", "tcp")
SOFTWARE = {"LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe"}
KEYS = {
    "Control": "\ue009", "Meta": "\ue03d", "Enter": "\ue007", "Escape": "\ue00c", "Tab": "\ue004",
    "ArrowLeft": "\ue012", "ArrowRight": "\ue014", "ArrowDown": "\ue015", "Space": " ",
}  # fmt: skip
BUTTONS = ("left", "middle", "right")  # of a mouse, in the order of their numbers
PREFERENCES = {
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "toolkit.telemetry.reportingpolicy.firstRun": False,
    "app.update.enabled": False,
    "webgl.force-enabled": True,
    "remote.active-protocols": 1,
    "browser.download.folderList": 2,  # the folder that is named
}
# Keeps the files that a page saves, as the browser would: by a link with a name, at the moment of its press.
KEEP_FILES = """if (window.savedFiles) return;
    window.savedFiles = [];
    const contents = new Map(), make = URL.createObjectURL, press = HTMLAnchorElement.prototype.click;
    URL.createObjectURL = (content) => {
        const address = make.call(URL, content);
        contents.set(address, content);
        return address;
    };
    HTMLAnchorElement.prototype.click = function () {
        const reader = new FileReader(), { download: name, href } = this;
        reader.onload = () => window.savedFiles.push([name, reader.result]);
        if (name && contents.has(href)) reader.readAsDataURL(contents.get(href));
        press.call(this);
    };"""
MINI_BROWSER = next(iter(Path("/usr/lib").glob("*/webkit2gtk-4.*/MiniBrowser")), None)
Point = Sequence[float]


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


# The words of a page, and whether viser's client takes messages, for a wait that failed.
STATE = """const { getRenderRequestState, messageQueue } = window.__viserMutable ?? {};
    const errors = [...new Set(window.noted?.map(String))];
    return [document.body.innerText.slice(0, 300), getRenderRequestState, messageQueue?.length, errors];"""


def moves(points: Sequence[Point]) -> list[dict[str, Any]]:
    """Actions that move a pointer along these points [pixels of the page]."""
    how = {"type": "pointerMove", "duration": 40, "origin": "viewport"}
    return [{**how, "x": round(x), "y": round(y)} for x, y in points]


class Engine(abc.ABC):
    """The common part of browsers: a page, which takes actions of WebDriver and runs JavaScript."""

    releases_right = True  # whether the driver can release the right button of the mouse

    def __init__(self) -> None:
        self.folder = tempfile.mkdtemp(prefix="engine")
        self.downloads = Path(self.folder, "downloads")
        self.downloads.mkdir()
        self.processes: list[subprocess.Popen[str]] = []
        self.is_closed = False

    def start(self, *command: str, **how: Any) -> subprocess.Popen[str]:
        """Start a process that ends with the browser."""
        self.processes.append(subprocess.Popen(command, start_new_session=True, encoding="locale", **how))
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
        """The result of the body of an async function in the page. Raises RuntimeError if it throws."""

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
        state = self.run(STATE)
        raise AssertionError(f"not within {seconds:g} s: {body}; {state}")

    @abc.abstractmethod
    def resize(self, width: int, height: int, ratio: float = 1.0) -> None:
        """Give the page a size [pixels of the page], and a number of screen pixels for each of them."""

    @abc.abstractmethod
    def choose_file(self, selector: str, path: Path) -> None:
        """Choose a file in a field of the page."""

    def files(self) -> list[Path]:
        """The files that the page has saved."""
        return list(self.downloads.iterdir())

    def move(self, *points: Point) -> None:
        """Move the mouse without a button."""
        self.act_pointer(moves(points), "mouse")

    def hold(self, *points: Point, button: int = 0, kind: str = "mouse") -> None:
        """Press at the first point, move along the others, and hold. kind: "mouse" or "touch"."""
        first, *others = moves(points)
        self.act_pointer([first, {"type": "pointerDown", "button": button}, *others], kind)

    def release(self, button: int = 0, kind: str = "mouse") -> None:
        """End what `hold` began."""
        self.act_pointer([{"type": "pointerUp", "button": button}], kind)

    def act_pointer(self, actions: list[dict[str, Any]], kind: str) -> None:
        self.act([{"type": "pointer", "id": kind, "parameters": {"pointerType": kind}, "actions": actions}])

    def press(self, *points: Point, button: int = 0, kind: str = "mouse") -> None:
        """Press at the first point, move along the others, and release."""
        first, *others = moves(points)
        ends = [{"type": "pointerDown", "button": button}, *others, {"type": "pointerUp", "button": button}]
        self.act_pointer([first, *ends], kind)

    def press_in_frame(self, number: int, *points: Point) -> None:
        """The same in a frame of the page; points: [pixels] from its corner."""
        left, top = self.run(
            f"""const box = document.querySelectorAll("iframe")[{number}].getBoundingClientRect();
            return [box.left, box.top];"""
        )
        self.press(*((left + x, top + y) for x, y in points))

    def turn_wheel(self, point: Point, along: float) -> None:
        """Turn the wheel of the mouse [pixels of scrolling] over a point."""
        x, y = (round(at) for at in point)
        step = {"type": "scroll", "x": x, "y": y, "deltaX": 0, "deltaY": round(along), "duration": 0}
        self.act([{"type": "wheel", "id": "wheel", "actions": [step | {"origin": "viewport"}]}])

    def press_on(self, expression: str) -> None:
        """Press the mouse on the middle of an element, once it exists and stands still; repeated if it moved away."""
        place = f"""const find = () => {expression}, places = [];
            for (let k = 0; k < 2; k++) {{
                find()?.scrollIntoView({{ block: "nearest" }});
                await new Promise((done) => setTimeout(done, 200));
                const box = find()?.getBoundingClientRect();
                places.push(box && [box.left + box.width / 2, box.top + box.height / 2]);
            }}
            const stands = places[1] && String(places[0]) === String(places[1]);
            if (!stands || !find().contains(document.elementFromPoint(...places[1]))) return null;
            window.isPressed = false;
            addEventListener("pointerdown", ({{ target }}) => (window.isPressed = Boolean(find()?.contains(target))),
                             {{ once: true, capture: true }});
            return places[1];"""
        for _ in range(3):
            self.press(self.wait(place))
            with contextlib.suppress(RuntimeError):  # another page may have come
                for _ in range(10):
                    if self.run("return window.isPressed ?? true;"):
                        return
                    time.sleep(0.1)
                continue
            return
        raise AssertionError(f"pressed in vain: {expression}")

    def type(self, *keys: str) -> None:
        """Press keys one after the other: letters, names in `KEYS`, or keys that are held together, as "Control+k"."""
        actions = []
        for key in keys:
            values = [KEYS.get(one, one) for one in (key.split("+") if len(key) > 1 else [key])]
            actions += [{"type": "keyDown", "value": value} for value in values]
            actions += [{"type": "keyUp", "value": value} for value in reversed(values)]
        self.act([{"type": "key", "id": "keys", "actions": actions}])

    def close(self) -> None:
        """End all processes, the browser before its X server."""
        self.is_closed = True
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
        chosen = {**PREFERENCES, "browser.download.dir": str(self.downloads)}
        lines = (f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in chosen.items())
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
        self.resize(*SIZE)

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

    def press_in_frame(self, number: int, *points: Point) -> None:
        (page,) = self.send("browsingContext.getTree", root=self.context)["contexts"]
        whole, self.context = self.context, page["children"][number]["context"]
        try:
            self.press(*points)
        finally:
            self.context = whole

    def resize(self, width: int, height: int, ratio: float = 1.0) -> None:
        size = {"width": width, "height": height}
        self.send("browsingContext.setViewport", context=self.context, viewport=size, devicePixelRatio=ratio)

    def choose_file(self, selector: str, path: Path) -> None:
        locator = {"type": "css", "value": selector}
        (field,) = self.send("browsingContext.locateNodes", context=self.context, locator=locator)["nodes"]
        element = {"sharedId": field["sharedId"]}
        self.send("input.setFiles", context=self.context, element=element, files=[str(path)])

    def close(self) -> None:
        self.socket.close()
        super().close()


class WebKit(Engine):
    """WebKitGTK's MiniBrowser; its language is "C", which is none."""

    releases_right = False

    def __init__(self) -> None:
        super().__init__()
        homes = ("HOME", "XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")
        self.turned = 0.0
        around = {**self.open_screen(), **dict.fromkeys(homes, self.folder), "LC_ALL": "C", "LANG": "C"}
        around |= {
            "XDG_DOWNLOAD_DIR": str(self.downloads),
            "WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS": "1",
            "NO_AT_BRIDGE": "1",
            "GDK_BACKEND": "x11",
        }
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
        self.resize(*SIZE)

    def send(self, path: str, data: dict[str, Any]) -> Any:
        """The answer to a command of WebDriver."""
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(self.address + path, json.dumps(data).encode(), headers)
        try:
            with urllib.request.urlopen(request, timeout=ANSWER_TIME) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(error.read().decode()[:400]) from None

    def open(self, address: str) -> None:
        self.send("/url", {"url": address})
        for script in (NO_PIXELS, KEEP_FILES):  # its driver has no scripts that run before a page
            self.run(script)

    def files(self) -> list[Path]:
        """Its driver delivers no downloads: they are what the links of the page name."""
        for name, content in self.run("return window.savedFiles.splice(0);"):
            Path(self.downloads, name).write_bytes(base64.b64decode(content.partition(",")[2]))
        return super().files()

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

    def turn_wheel(self, point: Point, along: float) -> None:
        self.turned += along  # its driver takes a turn for where the wheel has been turned to
        super().turn_wheel(point, self.turned)

    def press_in_frame(self, number: int, *points: Point) -> None:
        self.send("/frame", {"id": number})
        try:
            self.press(*points)
        finally:
            self.send("/frame", {"id": None})

    def resize(self, width: int, height: int, ratio: float = 1.0) -> None:
        """Its driver knows no ratio: the page is told another one. Its window has at least 447 pixels."""
        self.send("/window/rect", {"width": width, "height": height})
        around = self.run("return [outerWidth - innerWidth, outerHeight - innerHeight];")
        self.send("/window/rect", {"width": width + around[0], "height": height + around[1]})
        self.run(f"""Object.defineProperty(window, "devicePixelRatio", {{ value: {ratio:g}, configurable: true }});
            dispatchEvent(new Event("resize"));""")

    def choose_file(self, selector: str, path: Path) -> None:
        element = self.send("/element", {"using": "css selector", "value": selector})
        self.send(f"/element/{next(iter(element.values()))}/value", {"text": str(path)})


class Chromium(Engine):
    """A page of the Chromium that the other tests use."""

    def __init__(self, chromium: Any) -> None:
        super().__init__()
        self.errors = pytest.importorskip("playwright.sync_api").Error
        self.page = chromium.new_page()
        self.page.add_init_script(NO_PIXELS)
        self.page.on("download", lambda file: file.save_as(self.downloads / file.suggested_filename))
        self.devtools = self.page.context.new_cdp_session(self.page)
        self.resize(*SIZE)

    def open(self, address: str) -> None:
        self.page.goto(address)

    def run(self, body: str) -> Any:
        try:
            return self.page.evaluate(f"async () => {{ {body} }}")
        except self.errors as error:  # so when another page comes
            raise RuntimeError(str(error)) from None

    def act(self, actions: list[dict[str, Any]]) -> None:
        mouse, keyboard = self.page.mouse, self.page.keyboard
        names = {value: name for name, value in KEYS.items() if name != "Space"}
        (source,) = actions
        if source.get("parameters") == {"pointerType": "touch"}:
            return self.touch(source["actions"])
        for step in source["actions"]:
            match step["type"]:
                case "pointerMove":
                    mouse.move(step["x"], step["y"])
                case "pointerDown":
                    mouse.down(button=BUTTONS[step["button"]])
                case "pointerUp":
                    mouse.up(button=BUTTONS[step["button"]])
                case "scroll":
                    mouse.move(step["x"], step["y"])
                    mouse.wheel(step["deltaX"], step["deltaY"])
                case "keyDown":
                    keyboard.down(names.get(step["value"], step["value"]))
                case "keyUp":
                    keyboard.up(names.get(step["value"], step["value"]))
        return None

    def touch(self, steps: list[dict[str, Any]]) -> None:
        """The same with a finger, which Playwright cannot move."""
        for step in steps:
            match step["type"]:
                case "pointerMove":
                    self.finger = {"x": step["x"], "y": step["y"]}
                    if step is not steps[0]:  # the finger is there
                        self.send_touch("touchMove", [self.finger])
                case "pointerDown":
                    self.send_touch("touchStart", [self.finger])
                case "pointerUp":
                    self.send_touch("touchEnd", [])

    def send_touch(self, kind: str, fingers: list[dict[str, Any]]) -> None:
        self.devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    def resize(self, width: int, height: int, ratio: float = 1.0) -> None:
        size = {"width": width, "height": height, "deviceScaleFactor": ratio, "mobile": False}
        self.devtools.send("Emulation.setDeviceMetricsOverride", size)

    def choose_file(self, selector: str, path: Path) -> None:
        self.page.set_input_files(selector, str(path))

    def close(self) -> None:
        if threading.current_thread() is threading.main_thread():  # where Playwright takes it
            self.page.close()
        super().close()


def missing(name: str) -> str:
    """Programs that a browser needs and this machine lacks; "" without any."""
    needed = {
        "firefox": ("firefox-esr", "Xvfb"),
        "webkit": ("WebKitWebDriver", "Xvfb", "dbus-run-session"),
    }
    lacks = [program for program in needed.get(name, ()) if shutil.which(program) is None]
    return ", ".join(lacks) or ("MiniBrowser" if name == "webkit" and MINI_BROWSER is None else "")


def make(name: str, chromium: Any) -> Engine:
    """Start a browser by its name; the test is skipped if it is not installed."""
    if lacks := missing(name):
        pytest.skip(f"no {lacks} on the search path")
    return Chromium(chromium) if name == "chromium" else {"firefox": Firefox, "webkit": WebKit}[name]()


@contextlib.contextmanager
def guarded(engine: Engine) -> Iterator[Engine]:
    """Close a browser that a test waits for too long, so that it is not left behind."""
    guard = threading.Timer(0.8 * START_TIME + ANSWER_TIME, engine.close)
    guard.start()
    try:
        yield engine
    finally:
        guard.cancel()


@contextlib.contextmanager
def opened(name: str, chromium: Any) -> Iterator[Engine]:
    """A browser by its name, for one test."""
    engine = make(name, chromium)
    try:
        with guarded(engine):
            yield engine
    finally:
        engine.close()
