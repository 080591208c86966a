"""Two browsers of one lab act, undo and redo in random order, against a model of what both see.

Everything is sent as the pages send it. The model is that of the loop's own test: a stack of screens.
"""

import asyncio
import dataclasses
import random
from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from app.messages import Ask
from app.scenes import scene_named
from app.scenes.setups import read_query, write_query
from app.server.served_scene import ServedScene
from app.server.viewer import Viewer
from sim.parameters import check_record, effect_of_change, in_words
from tests import coroutines
from tests.app.channels import text_of
from tests.app.server.loop.test_acts import Model, RunSeen
from tests.app.server.visitors import Visitor, until, visitor
from tests.stress.clients import DRAG

SMALL: dict[str, dict[str, Any]] = {
    "rope": {"points": 5},
    "cloth": {"rows": 4, "cols": 4},
    "race": {"ropes": 2, "points": 4},
    "square_sea": {"size": "64"},
}
NUMBERS = {"rope": "stiffness", "cloth": "stiffness", "race": "mass", "square_sea": "amplitude"}
STARTS = {"rope": "points", "cloth": "rows", "race": "points", "square_sea": "length"}
ARROWS = {"rope": ("root", "sphere"), "cloth": ("pin a", "pin b", "sphere"), "race": ("root",), "square_sea": ()}
PULLED = {"rope": "/points", "race": "/race/points"}
ACTS = 34


class Screen(NamedTuple):
    """State of the lab, read between two steps."""

    time: float  # [s]
    act: int  # that began the run
    arrays: dict[str, np.ndarray]


class TwoBrowsers:
    """A lab, two browsers of it, and the model beside them."""

    def __init__(self, lab: Viewer, browsers: tuple[Visitor, Visitor], rng: random.Random, clock: list[float]) -> None:
        """clock: [s] in a list; that of the history."""
        self.lab, self.browsers, self.rng, self.clock = lab, browsers, rng, clock
        self.model = Model(lab.settings.params, lab.settings.loaded)
        self.model.screen.running = None
        self.to_do: list[Any] = []  # acts

    @property
    def params(self) -> Any:
        """Parameters of the model."""
        return self.model.screen.params

    @property
    def scene(self) -> str:
        """Scene of the model."""
        return next(name for name in SMALL if isinstance(self.params, scene_named(name).params))

    @property
    def browser(self) -> Visitor:
        """Either of the two."""
        return self.rng.choice(self.browsers)

    # ----- what is sent

    async def press(self, label: str) -> None:
        await self.browser.send(self.lab.panel.head.buttons, label)

    async def command(self, label: str) -> None:
        commands = self.lab.server.gui._command_handle_from_uuid  # type: ignore[attr-defined]
        uuid = next(uuid for uuid, handle in commands.items() if handle.label == label)
        await self.browser.say({"type": "CommandTriggerMessage", "uuid": uuid})

    async def hold(self, browser: Visitor, held: bool) -> None:
        """A browser takes a slider, or lets it go."""
        await browser.send(self.lab.panel.share.channel.field, text_of("held", held))

    async def type_number(self, name: str, value: Any) -> None:
        await self.browser.send(self.lab.panel.controls[name].field, str(value))

    # ----- acts

    async def number(self) -> None:
        """A number of the forces, which the run continues with."""
        await self.change(NUMBERS[self.scene])

    async def start(self) -> None:
        """A number that begins another run."""
        await self.change(STARTS[self.scene])

    def another(self, name: str) -> float:
        """Another value of a number than that of the model, near that of the small scene."""
        value = getattr(small(self.scene), name)
        values = [value + k for k in range(3)] if isinstance(value, int) else [round(value * k, 4) for k in (0.8, 1.2)]
        return self.rng.choice([new for new in values if new != getattr(self.params, name)])

    async def change(self, name: str) -> None:
        new = self.another(name)
        await self.type_number(name, new)
        await until(lambda: self.lab.settings.params != self.params)
        params = dataclasses.replace(self.params, **{name: new})
        self.model.act(params, begins=effect_of_change(self.params, params) == "start")

    async def preset(self) -> None:
        names = [name for name in self.lab.settings.kind.presets if name != self.lab.panel.head.preset.value]
        name = self.rng.choice(names)
        self.model.act(self.lab.settings.params_of(name), name, begins=True, runs=True)
        await self.browser.send(self.lab.panel.head.preset, name)

    async def reset(self) -> None:
        self.model.act(self.params, begins=True)
        await self.press("Reset")

    async def plots(self) -> None:
        await self.press("Plots")
        await until(lambda: self.lab.settings.params != self.params)
        self.model.act(self.lab.settings.params, begins=False)

    async def arrows(self) -> None:
        """A drag of the root, a sphere or a pin."""
        things = ARROWS[self.scene]
        if things:
            name, browser = f"/{self.rng.choice(things).replace(' ', '_')}_gizmo", self.browser
            handle = self.lab.server.scene._handle_from_node_name[name]  # type: ignore[attr-defined]
            place = [self.rng.uniform(-0.2, 0.2) for _ in range(3)]
            self.dragged()
            for share in (0.5, 1.0):
                await browser.say(
                    {"type": "TransformControlsUpdateMessage", "name": name, "wxyz": (1.0, 0.0, 0.0, 0.0),
                     "position": [share * c for c in place]}
                )  # fmt: skip
            await until(lambda: np.allclose(handle.position, place))

    async def pull(self) -> None:
        """A drag of a point, with a step in the middle of it."""
        node = PULLED.get(self.scene)
        if node is not None:
            browser, index = self.browser, self.rng.randrange(4)
            nodes = self.lab.server.scene._handle_from_node_name  # type: ignore[attr-defined]
            await until(lambda: node in nodes and self.lab.served.drawn > 0)  # a person drags what is drawn
            drawn = self.lab.served.drawn
            await self.step()
            await until(lambda: self.lab.served.drawn > drawn)  # with the points of the present run
            self.dragged()
            for phase in ("start", "update"):
                await self.say_drag(browser, node, phase, index)
            await self.settle()
            await self.step()
            await self.say_drag(browser, node, "end", index)

    async def say_drag(self, browser: Visitor, node: str, phase: str, index: int) -> None:
        end = (0.3, 0.1, 1.0)
        await browser.say(
            {**DRAG, "phase": phase, "name": node, "instance_index": index, "start_position": end, "end_position": end}
        )

    def dragged(self) -> None:
        now = self.model.screen
        self.model.act(now.params, begins=True, run=RunSeen(now.run.time))

    async def choice(self) -> None:
        """Another scene of the list."""
        scene = self.rng.choice([name for name in SMALL if name != self.scene])
        await self.browser.send(self.lab.panel.head.chooser, in_words(scene))
        await self.opened(scene)

    async def file(self) -> None:
        """A set-up from a link, of this scene or another."""
        scene = self.rng.choice(list(SMALL))
        kind = scene_named(scene)
        value = round(getattr(small(scene), NUMBERS[scene]) * self.rng.uniform(0.8, 1.2), 6)
        params = dataclasses.replace(small(scene), **{NUMBERS[scene]: value})
        query = write_query(kind, params, self.rng.choice(list(kind.presets)))
        await self.browser.send(self.lab.panel.share.channel.field, text_of("open", query))
        if scene == self.scene:
            self.model.act(params, read_query(query).preset or next(iter(kind.presets)), begins=True, runs=True)
        else:
            await self.opened(scene)

    async def opened(self, scene: str) -> None:
        """Note that another scene was opened; no run of it is in memory."""
        await until(lambda: self.lab.is_open and self.lab.settings.kind.name == scene)
        self.model.act(self.lab.settings.params, self.lab.settings.loaded, begins=True, runs=True)
        self.forget_runs()

    def forget_runs(self) -> None:
        runs: dict[int, RunSeen] = {}
        for screen in (*self.model.before, self.model.screen, *self.model.after):
            screen.run, screen.running = runs.setdefault(id(screen.run), RunSeen()), None

    async def acts_beside_a_slider(self) -> None:
        """One browser holds a slider, the other types twice: each is an act."""
        name, (holds, other) = NUMBERS[self.scene], self.rng.sample(self.browsers, 2)
        await self.hold(holds, True)
        await until(lambda: self.lab.settings.history.hands == {holds.client})
        for browser in (other, other, holds):
            await browser.send(self.lab.panel.controls[name].field, str(self.another(name)))
            await until(lambda: self.lab.settings.params != self.params)
            self.model.act(self.lab.settings.params, begins=False)
            await self.settle()
        await self.hold(holds, False)
        await until(lambda: not self.lab.settings.history.hands)

    async def undo_under_a_slider(self) -> None:
        """One browser holds a slider, the other undoes in the middle of its drag, and the first one drags on."""
        name, (holds, other) = NUMBERS[self.scene], self.rng.sample(self.browsers, 2)
        before = self.params
        await self.hold(holds, True)
        await until(lambda: self.lab.settings.history.hands == {holds.client})
        for factor in (1.5, 1.6):
            await holds.send(self.lab.panel.controls[name].field, str(factor * getattr(small(self.scene), name)))
            shown = self.lab.settings.params
            await until(lambda shown=shown: self.lab.settings.params != shown)
            self.clock[0] += 100.0
        self.model.act(self.lab.settings.params, begins=False)
        await self.settle()
        await other.send(self.lab.panel.head.buttons, "Undo")
        self.model.undo()
        await self.settle()
        await self.see()
        await holds.send(self.lab.panel.controls[name].field, str(self.another(name)))
        await until(lambda: self.lab.settings.params != before)
        self.model.act(self.lab.settings.params, begins=False)
        await self.hold(holds, False)
        await until(lambda: not self.lab.settings.history.hands)

    async def undo(self) -> None:
        await self.go("Undo", self.lab.settings.undo_words, self.model.before, self.model.undo)

    async def redo(self) -> None:
        await self.go("Redo", self.lab.settings.redo_words, self.model.after, self.model.redo)

    async def go(self, label: str, words: str, source: list[Any], move: Any) -> None:
        """Undo or redo by a button or a command. Without an act the page disables the button: it has no words."""
        assert bool(words) is bool(source)
        scene, preset = self.scene, self.model.screen.preset
        move()
        if self.scene != scene:
            assert words == f"{'back' if label == 'Undo' else 'forward'} to {in_words(self.scene)}, in a new run"
            self.forget_runs()
        elif source is not None and self.model.screen.preset != preset:
            assert words.endswith(f" to {self.model.screen.preset}")
        await (self.press(label) if label == "Undo" and self.rng.random() < 0.5 else self.command(label))

    # ----- between acts

    async def step(self) -> None:
        """A step, which is no act."""
        before = await self.read()
        await self.press("Step")
        while (await self.read()).time == before.time:
            await asyncio.sleep(0.01)
        self.model.screen.run.time, self.model.screen.run.arrays = (await self.read()).time, None

    async def settle(self) -> None:
        """Wait until the lab has taken everything that was sent."""
        await until(
            lambda: (
                self.lab.is_open
                and (len(self.lab.settings.history.settings), len(self.lab.settings.history.undone))
                == (len(self.model.before), len(self.model.after))
            )
        )
        self.clock[0] += 100.0
        await until(lambda: not self.lab.served.gate.held and self.lab.scene.params == self.lab.settings.params)

    async def read(self) -> Screen:
        scene, run, answer = self.lab.scene, self.lab.loop.run, Future[Any]()

        def read() -> Screen:
            arrays = {name: np.array(array) for name, (array, _) in scene.arrays().items() if name != "foam"}
            return Screen(scene.time, run.identity.act, arrays)

        self.lab.commands.put(Ask(read, answer))
        return await asyncio.wrap_future(answer)

    async def see(self) -> None:
        """Compare the lab with the model."""
        screen, settings = self.model.screen, self.lab.settings
        shown = await self.read()
        assert settings.kind.name == self.scene
        assert settings.params == screen.params
        assert settings.loaded == screen.preset
        run = screen.run
        assert not self.lab.loop.run.halted
        assert settings.history.act == shown.act
        assert run.act in (0, shown.act)
        assert shown.act not in [before.run.act for before in self.model.before if before.run is not run]
        assert run.time is None or shown.time == pytest.approx(run.time, abs=1e-9)
        for name, array in (run.arrays or {}).items():
            np.testing.assert_array_equal(shown.arrays[name], array, err_msg=name)
        run.time, run.act, run.arrays = shown.time, shown.act, shown.arrays

    async def random_act(self) -> None:
        """An act; each of a list once, in random order, before the list begins anew."""
        if not self.to_do:
            self.to_do = [
                self.number, self.start, self.preset, self.reset, self.plots, self.arrows, self.pull, self.choice,
                self.file, self.undo_under_a_slider, self.acts_beside_a_slider, *[self.undo] * 4, *[self.redo] * 2,
            ]  # fmt: skip
            self.rng.shuffle(self.to_do)
        act = self.to_do.pop()
        await act()
        await self.settle()
        if self.rng.random() < 0.3:
            await self.step()
        await self.see()


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The clock of the history [s], which tests put forward; scenes open at once, and no time passes by itself."""
    now = [0.0]
    monkeypatch.setattr("app.panel.history.time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr("app.server.viewer.MIN_SCENE_TIME", 0.0)
    monkeypatch.setattr(ServedScene, "audience", lambda self: 0)
    return now


def small(scene: str) -> Any:
    return check_record(scene_named(scene).params, SMALL[scene])


@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.stress) for seed in range(2, 20))])
def test_each_undo_in_either_of_two_browsers_restores_the_screen_before_the_act(
    lab: Viewer, clock: list[float], seed: int
) -> None:
    rng = random.Random(seed)
    lab.open("rope", small("rope"))
    lab.settings.history.settings.clear()

    async def act() -> None:
        async with visitor(lab) as first, visitor(lab) as second:
            two = TwoBrowsers(lab, (first, second), rng, clock)
            for _ in range(ACTS):
                await two.random_act()
            for move, source in ((two.undo, two.model.before), (two.redo, two.model.after)):
                while source:
                    await move()
                    await two.settle()
                    await two.see()
                await move()  # which does nothing
                await two.settle()
                await two.see()

    coroutines.run(act())
