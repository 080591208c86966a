"""The server's half of the shader injection: what pages report, and what Python and JavaScript share."""

import asyncio
import dataclasses
import re
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from app.render import injection
from app.render.handles.channel import Channel, channel_of
from app.render.injection import ShaderInjector
from app.render.material import RAIN_UNIFORMS, WATER_UNIFORMS, Cutout, Grid, Material, Oil, SlickRegion, uniform_table
from app.render.scripts import SHARED, modules
from app.render.skies import light_scene
from sim.ocean.fluids.oil_film import BAND_WIDTH, BANDS
from tests.app.channels import say


class FakeServer:
    """The parts of a viser server that the injector uses, and reports of pages."""

    def __init__(self) -> None:
        self.clients: dict[int, Any] = {}
        self._websock_server = self.gui = self

    def on_client_disconnect(self, callback: Callable[[Any], Any]) -> None:
        self.left = callback

    def get_clients(self) -> dict[int, Any]:
        return dict(self.clients)

    def add_text(self, label: str, value: str, **look: Any) -> Any:
        return SimpleNamespace(value=value, on_update=lambda call: None, _impl=SimpleNamespace(uuid="field"))

    def add_html(self, content: str, order: float) -> Any:
        return SimpleNamespace(content=content)

    def report(self, client: int, *names: str, scene: int | None = None, is_whole: bool = False) -> None:
        """A page reports the nodes that it draws with their shader."""
        number = self.picture["scene"] if scene is None else scene
        value = {"scene": number, "isWhole": is_whole, "nodes": list(names)}
        say(self.channel, "drawn", value, client=SimpleNamespace(client_id=client))

    @property
    def channel(self) -> Channel:
        return channel_of(self)  # type: ignore[arg-type]

    @property
    def picture(self) -> dict[str, Any]:
        """The parts of a whole picture, as pages have them."""
        return cast(dict[str, Any], self.channel.state_of("picture"))

    def begin_scene(self, injector: ShaderInjector) -> None:
        self.channel.restart()
        injector.restart()


@pytest.fixture
def server() -> FakeServer:
    return FakeServer()


@pytest.fixture
def injector(server: FakeServer) -> ShaderInjector:
    return ShaderInjector(server)  # type: ignore[arg-type]


def test_a_shader_is_active_while_every_browser_reports_it(server: FakeServer, injector: ShaderInjector) -> None:
    injector.watch("/sea")
    assert injector.is_active("/sea") is None  # nobody looks
    server.clients = {1: None, 2: None}
    server.report(1, "/sea", "/rope")
    assert injector.is_active("/sea") is None
    server.report(2, "/sea")
    assert injector.is_active("/sea") is True
    assert injector.is_active("/rope") is None
    server.report(1)  # its driver has refused a program
    assert injector.is_active("/sea") is None


def test_the_page_is_told_the_nodes_of_a_whole_picture(server: FakeServer, injector: ShaderInjector) -> None:
    assert server.picture["nodes"] == []
    injector.watch("/sea")
    injector.watch("/rope")
    assert server.picture["nodes"] == ["/sea", "/rope"]
    injector.unwatch("/sea")
    assert server.picture["nodes"] == ["/rope"]
    server.begin_scene(injector)
    assert server.picture["nodes"] == []


def test_the_page_is_told_the_sky_before_it_is_sent() -> None:
    """The page names a sky as it arrives."""
    server = FakeServer()
    shaders = injection.injector_of(server)  # type: ignore[arg-type]
    assert server.picture["sky"] == ""
    sent: list[Any] = []
    sky = lambda: server.picture["sky"]  # noqa: E731
    server.scene = SimpleNamespace(configure_environment_map=lambda name, **how: sent.append((name, how, sky())))
    light_scene(server, "dawn", environment_intensity=0.5)  # type: ignore[arg-type]
    assert sent == [("dawn", {"environment_intensity": 0.5}, "dawn")]
    assert shaders is not None
    server.begin_scene(shaders)
    assert server.picture["sky"] == ""


def test_a_browser_that_left_is_forgotten(server: FakeServer, injector: ShaderInjector) -> None:
    server.clients = {1: None}
    injector.watch("/sea")
    server.report(1, "/sea")
    assert injector.is_active("/sea") is True
    asyncio.run(server.left(SimpleNamespace(client_id=1)))
    assert injector.is_active("/sea") is None
    server.clients = {}
    assert injector.is_active("/sea") is None


def test_nothing_reported_of_a_scene_counts_in_the_next_one(server: FakeServer, injector: ShaderInjector) -> None:
    server.clients = {1: None}
    server.report(1, "/sea", is_whole=True)
    assert injector.whole == {1}
    before = server.picture["scene"]
    server.begin_scene(injector)
    injector.watch("/sea")
    server.report(1, "/sea", scene=before, is_whole=True)  # on its way when the scene began
    assert (injector.is_active("/sea"), injector.whole) == (None, set())
    server.report(1, "/sea")
    assert (injector.is_active("/sea"), injector.whole) == (True, set())


def test_a_browser_that_never_reports_counts_as_one_without_shaders(
    server: FakeServer, injector: ShaderInjector, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = 100.0
    monkeypatch.setattr(injection.time, "monotonic", lambda: clock)
    server.clients = {1: None, 2: None}
    injector.watch("/sea")
    server.report(1, "/sea")
    assert injector.is_active("/sea") is None
    clock += injection.MAX_ANSWER_TIME + 0.1
    assert injector.is_active("/sea") is False
    injector.watch("/sea")  # made anew
    assert injector.is_active("/sea") is None
    clock += injection.MAX_ANSWER_TIME + 0.1
    server.clients = {3: None}
    assert injector.is_active("/sea") is None  # it has just come
    server.report(3, "/sea")
    assert injector.is_active("/sea") is True


def test_of_several_browsers_without_reports_the_first_to_come_counts(
    server: FakeServer, injector: ShaderInjector, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = 100.0
    monkeypatch.setattr(injection.time, "monotonic", lambda: clock)
    injector.watch("/sea")
    server.clients = {1: None}
    assert injector.is_active("/sea") is None
    clock += injection.MAX_ANSWER_TIME - 1.0
    server.clients = {1: None, 2: None}
    assert injector.is_active("/sea") is None
    clock += 1.1
    assert injector.is_active("/sea") is False


def test_the_shaders_declare_every_uniform_that_travels_and_no_other() -> None:
    declared = set()
    for source in modules().values():
        declared |= set(re.findall(r"uniform vec3 (\w+);", source))
    assert declared == {*WATER_UNIFORMS, *RAIN_UNIFORMS, "underwater", "eye"}  # the page sets the last two
    assert len(set(WATER_UNIFORMS)) == len(WATER_UNIFORMS)


def test_the_shader_has_the_bands_of_light_of_the_model_of_oil() -> None:
    """The numbers stand in both, since a shader has constants and no table."""
    source = modules()["sea/water_shader.js"]
    (bands,) = re.findall(r"turns = .* / vec3\(([^)]*)\)", source)
    assert [float(band) for band in bands.split(",")] == pytest.approx(BANDS)
    (width_squared,) = re.findall(r"exp\(-0\.5 \* \(([0-9.]+) \* phase \* phase", source)
    assert float(width_squared) == pytest.approx(BAND_WIDTH**2)


def test_no_module_repeats_the_order_of_the_uniforms() -> None:
    """It would have names of uniforms in quotes. "slick" is also the name of a plain mesh, and the table of the sky
    depends on some."""
    for path, source in modules().items():
        quoted = set(re.findall(r"[\"'](\w+)[\"']", source)) if path != "shared.js" else set()
        assert quoted & {*WATER_UNIFORMS, *RAIN_UNIFORMS} <= {"slick", "skyline", "skyFold", "skyTint", "sunDirection"}
    assert tuple(SHARED["WATER_UNIFORMS"]) == WATER_UNIFORMS


def test_each_program_that_depends_on_the_details_has_three_variants() -> None:
    """Those of water, dome and rain; a program whose name does not tell them apart would stay as it is."""
    variants = {int(n) for n in re.findall(r"details: (\d)[ }]", modules()["shading/judge.js"])}
    assert variants == {0, 1, 2}
    scripts = modules()["sea/water.js"] + modules()["sea/rain.js"]
    sources = re.findall(r"fragmentShader = (.*);", scripts)
    assert sorted(sources) == [
        "isLit === false ? withSky(whole.defines + WATER_FRAGMENT, sea.uniforms) : shape.defines + LIT_FRAGMENT",
        "shape.defines + PLAIN_FRAGMENT",
        "withSky(DOME_FRAGMENT, sea.uniforms)",
        "withSky(RAIN_FRAGMENT, sea.uniforms)",
    ]
    keys = re.findall(r"(?:replaceShader\([\w.]+|dress\(renderer, sea\.dome), (.*), (?:edit\)|\(shader)", scripts)
    keys += re.findall(r"const key = (.*);", scripts)
    assert len(keys) == sum("withSky(" in source for source in sources)
    assert all("keyWithDetails(" in key for key in keys)
    lit = re.findall(r"^ +\[(.+), [\w +]+_VERTEX, (.+_FRAGMENT.*)\],$", modules()["sea/lit_sea.js"], re.MULTILINE)
    assert [("keyWithDetails(" in key, "withSky(" in source) for key, source in lit] == 3 * [(False, False)] + [
        (True, True)
    ]
    assert "withDetails(" in modules()["sea/sky_table.js"]
    assert "DETAILS" in modules()["sea/water_shader.js"]


def test_every_field_of_a_material_reaches_the_uniforms() -> None:
    slick, oil = SlickRegion((1.0, 2.0), 3.0, 0.01, 0.02, 0.7), Oil((0.1, 0.2, 0.3), 1.5)
    others = {"oil": oil, "slick": slick, "cutout": Cutout((1.0, 2.0), 3.0, (0.6, 0.8), 4.0)}
    plain = Material()

    def table(material: Material) -> np.ndarray:
        return uniform_table(material, (1.0, 2.0, 3.0), Grid(4, 5, 6.0))

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


def test_rain_and_haze_are_seen_through_as_one_medium() -> None:
    """Their extinctions add up."""
    material = dataclasses.replace(Material(), haze_distance=2000.0, rain_extinction=1.5e-3)
    table = uniform_table(material, (0.0, 1.0, 0.01), Grid(8, 8, 100.0))
    assert table[WATER_UNIFORMS.index("lens"), 0] == pytest.approx(500.0)
