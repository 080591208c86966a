"""The server's half of the shader injection: who is asked, who has answered, and what Python and JavaScript share."""

import dataclasses
import json
import re
import shutil
import subprocess
import threading
import time
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.render import injection
from app.render.injection import SCRIPTS, ShaderInjector
from app.render.material import RAIN_UNIFORMS, WATER_UNIFORMS, Cutout, Material, Oil, SlickRegion, uniform_table
from sim.ocean.oil_film import BAND_WIDTH, BANDS


class FakeStorage:
    """A browser's local storage: `answer` returns what it holds, or raises."""

    def __init__(self, answer: Callable[[], str]) -> None:
        self.answer = answer

    def get_item(self, key: str, timeout: float) -> str:
        return self.answer()


class FakeClient:
    def __init__(self, answer: Callable[[], str]) -> None:
        self.local_storage = FakeStorage(answer)


class FakeServer:
    """What the injector uses of a viser server."""

    def __init__(self) -> None:
        self.clients: dict[int, FakeClient] = {}
        self._websock_server = self
        self.sources: list[str] = []

    def queue_message(self, message: Any) -> None:
        self.sources.append(message.source)

    def on_client_connect(self, callback: Callable[[Any], None]) -> None:
        self.connected = callback

    def get_clients(self) -> dict[int, FakeClient]:
        return dict(self.clients)


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> FakeServer:
    monkeypatch.setattr(injection, "ASK_INTERVAL", 0.01)
    return FakeServer()


def wait_for(condition: Callable[[], Any], seconds: float) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.005)
    return bool(condition())


def test_a_browser_that_is_stuck_does_not_delay_the_others(server: FakeServer) -> None:
    injector = ShaderInjector(server)  # type: ignore[arg-type]
    free = threading.Event()

    def stuck() -> str:
        free.wait(5.0)
        raise TimeoutError

    asked = threading.Event()

    def answers() -> str:
        asked.set()
        return f"{injector._token}\n/sea"

    server.clients = {1: FakeClient(stuck), 2: FakeClient(stuck), 3: FakeClient(answers)}
    injector.watch("/sea")
    assert asked.wait(1.0)
    server.clients = {3: server.clients[3]}
    assert wait_for(lambda: injector.is_active("/sea"), 1.0)
    free.set()


def test_answers_may_come_while_nodes_are_watched_and_forgotten(server: FakeServer) -> None:
    injector = ShaderInjector(server)  # type: ignore[arg-type]
    names = [f"/node{i}" for i in range(50)]
    answer = "\n".join([injector._token, *names])
    stop = threading.Event()

    def come_and_go() -> None:  # browsers that answer at once
        number = 0
        while not stop.is_set():
            number += 50
            server.clients = {number + i: FakeClient(lambda: answer) for i in range(50)}
            time.sleep(0.02)

    thread = threading.Thread(target=come_and_go)
    thread.start()
    try:
        end = time.monotonic() + 1.5
        while time.monotonic() < end:
            for name in names:
                injector.watch(name)
                injector.unwatch(name)
    finally:
        stop.set()
        thread.join()
    for name in names:
        injector.watch(name)
    assert wait_for(lambda: all(injector.is_active(name) for name in names), 5.0)


def test_no_more_threads_than_stated_ask_and_all_end(server: FakeServer) -> None:
    injector = ShaderInjector(server)  # type: ignore[arg-type]
    free = threading.Event()

    def asking() -> int:
        return sum(thread.name == "shader question" for thread in threading.enumerate())

    def stuck() -> str:
        free.wait(10.0)
        raise TimeoutError

    server.clients = {i: FakeClient(stuck) for i in range(3 * injection.MAX_QUESTIONS)}
    injector.watch("/sea")
    assert wait_for(lambda: asking() == injection.MAX_QUESTIONS, 5.0)
    time.sleep(0.1)
    assert asking() == injection.MAX_QUESTIONS
    server.clients = {}
    free.set()
    assert wait_for(lambda: asking() == 0, 5.0)


def test_a_browser_that_left_is_forgotten(server: FakeServer) -> None:
    injector = ShaderInjector(server)  # type: ignore[arg-type]
    server.clients = {1: FakeClient(lambda: f"{injector._token}\n/sea")}
    injector.watch("/sea")
    assert wait_for(lambda: injector.is_active("/sea"), 2.0)
    server.clients = {2: FakeClient(lambda: "another token\n/sea")}
    server.connected(None)
    assert wait_for(lambda: not injector._drawn.get(1), 2.0)
    assert injector.is_active("/sea") is None  # it may still answer


def test_a_browser_that_never_answers_counts_as_one_without_shaders(
    server: FakeServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(injection, "MAX_ANSWER_TIME", 0.1)
    injector = ShaderInjector(server)  # type: ignore[arg-type]
    server.clients = {1: FakeClient(lambda: "")}
    injector.watch("/sea")
    assert injector.is_active("/sea") is None
    assert wait_for(lambda: injector.is_active("/sea") is False, 2.0)


def source_of(name: str) -> str:
    return (resources.files("app.render") / "js" / name).read_text("utf-8")


def test_the_shaders_declare_every_uniform_that_travels_and_no_other() -> None:
    declared = set()
    for name in SCRIPTS:
        declared |= set(re.findall(r"uniform vec3 (\w+);", source_of(name)))
    assert declared == {*WATER_UNIFORMS, *RAIN_UNIFORMS}
    assert len(set(WATER_UNIFORMS)) == len(WATER_UNIFORMS)


def test_the_shader_has_the_bands_of_light_of_the_model_of_oil() -> None:
    """The numbers stand in both, since a shader has constants and no table."""
    source = source_of("water_shader.js")
    (bands,) = re.findall(r"phase = .* / vec3\((.*)\);", source)
    assert [float(band) for band in bands.split(",")] == pytest.approx(BANDS)
    (width_squared,) = re.findall(r"exp\(-0\.5 \* phase \* phase \* ([0-9.]+)\)", source)
    assert float(width_squared) == pytest.approx(BAND_WIDTH**2)


def test_the_script_takes_the_order_of_the_uniforms_from_python(server: FakeServer) -> None:
    injector = ShaderInjector(server)  # type: ignore[arg-type]
    (sent,) = server.sources
    assert sent == injector.script()
    for name, value in (("WATER_UNIFORMS", WATER_UNIFORMS), ("RAIN_UNIFORMS", RAIN_UNIFORMS)):
        (found,) = re.findall(rf"const {name} = (.*);", sent)
        assert tuple(json.loads(found)) == value
    # No file repeats the order: it would have names of uniforms in quotes. "slick" is also the name of a plain mesh.
    for name in SCRIPTS:
        quoted = set(re.findall(r"[\"'](\w+)[\"']", source_of(name)))
        assert quoted & {*WATER_UNIFORMS, *RAIN_UNIFORMS} <= {"slick"}


def test_each_program_that_depends_on_the_details_has_three_variants() -> None:
    """Those of water, dome and rain; a program whose name does not tell them apart would stay as it is."""
    variants = {int(n) for n in re.findall(r"details: (\d)[ }]", source_of("quality.js"))}
    assert variants == {0, 1, 2}
    scripts = source_of("water.js") + source_of("rain.js")
    sources = re.findall(r"fragmentShader = (.*);", scripts)
    assert sorted(s for s in sources if "withDetails" in s) == [
        "withDetails(DOME_FRAGMENT)",
        "withDetails(RAIN_FRAGMENT)",
        "withDetails(WATER_FRAGMENT)",
    ]
    names = [line for line in scripts.splitlines() if "replaceShader(" in line and "wire" not in line]
    assert ["keyWithDetails(" in name for name in names] == [True] * 3
    assert "DETAILS" in source_of("water_shader.js")


@pytest.mark.skipif(shutil.which("node") is None, reason="no node on the search path")
def test_the_script_is_javascript(server: FakeServer, tmp_path: Path) -> None:
    file = tmp_path / "script.js"
    file.write_text(ShaderInjector(server).script(), "utf-8")  # type: ignore[arg-type]
    checked = subprocess.run(["node", "--check", str(file)], capture_output=True, text=True, timeout=60)
    assert checked.returncode == 0, checked.stderr


def test_every_field_of_a_material_reaches_the_uniforms() -> None:
    slick, oil = SlickRegion((1.0, 2.0), 3.0, 0.01, 0.02, 0.7), Oil((0.1, 0.2, 0.3), 1.5)
    others = {"oil": oil, "slick": slick, "cutout": Cutout((1.0, 2.0), 3.0, (0.6, 0.8), 4.0)}
    plain = Material()

    def table(material: Material) -> np.ndarray:
        return uniform_table(material, (1.0, 2.0, 3.0), (4, 5, 6.0), 7)

    assert table(plain).shape == (len(WATER_UNIFORMS), 3)
    for field in dataclasses.fields(Material):
        value = getattr(plain, field.name)
        if field.name in others:
            other = others[field.name]
        elif isinstance(value, bool):
            other = not value
        elif isinstance(value, tuple):
            other = tuple(c * c + 0.2 for c in value)
        else:
            other = 0.7 * value + 0.11
        changed = table(dataclasses.replace(plain, **{field.name: other}))
        assert (changed != table(plain)).any(), field.name
