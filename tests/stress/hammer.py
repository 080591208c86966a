"""The whole lab of one scene on one thread, with what its browsers are told looked through.

Panel, loop, scene and drawing are the real ones; only the clock is the test's own, so that a thousand frames take as
long as they take to compute. Every message that would go to a browser is searched for numbers that are not finite.
"""

import dataclasses
import math
import random
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from app.lab.course.task import load_tasks
from app.lab.student.workbook import Workbook
from app.messages import GrabTo, Pause, Place, Play, PointAlong, Release, Reset, StepOnce
from app.scenes.ahead.compiling import prepare
from app.scenes.contract import FRAME_INTERVAL
from app.server.viewer import Viewer
from sim.parameters import Parameter, parameters_of
from tests.stress.tally import Tally

# How a halt is worded that is no divergence.
CRASHES = "stopped with", "not finite", "could not be drawn", "could not go on", "could not be updated"


def infinite(value: Any, path: str = "") -> Iterator[str]:
    """Where in a message there is a number that is not finite."""
    if isinstance(value, np.ndarray):
        # In the columns of a chart, a NaN is a place without a line.
        finite = np.isfinite(value) | (np.isnan(value) & (".data[" in path)) if value.dtype.kind == "f" else True
        if not np.all(finite):
            yield f"{path}{value.shape}"
    elif isinstance(value, float | np.floating):
        if not math.isfinite(value):
            yield path
    elif isinstance(value, str):
        if "nan" in value.lower().split():
            yield f"{path} says {value!r}"
    elif isinstance(value, dict):
        for key, part in value.items():
            yield from infinite(part, f"{path}.{key}")
    elif isinstance(value, list | tuple):
        for index, part in enumerate(value):
            yield from infinite(part, f"{path}[{index}]")
    elif dataclasses.is_dataclass(value):
        yield from infinite(vars(value), f"{path}{type(value).__name__}")


class Hammer:
    """One scene and what is done to it."""

    def __init__(self, name: str, tally: Tally) -> None:
        prepare(name)
        self.name, self.tally = name, tally
        workbook = Workbook(load_tasks(with_checks=False))
        workbook.go_to_scene(name)
        workbook.show_answer(workbook.task)
        self.viewer = Viewer("127.0.0.1", 0, workbook=workbook)
        self.server = self.viewer.server._websock_server
        self.poison: list[str] = []
        self.queue = self.server.queue_message
        self.server.queue_message = self.look_through  # type: ignore[method-assign]
        self.viewer.open(name)
        self.viewer.served.stop_threads()  # from here on this thread does their work
        self.viewer.loop.run.audience = lambda: 1
        self.viewer.served.attempt = lambda what, action: action()  # what goes wrong is to be seen
        self.longest = 0.0  # [s] of processor time in a frame

    def look_through(self, message: Any) -> None:
        """What is sent to every browser."""
        self.tally.counts[self.name]["messages"] += 1
        self.poison.extend(infinite(message))
        self.queue(message)

    @property
    def loop(self) -> Any:
        return self.viewer.loop

    @property
    def parameters(self) -> dict[str, Parameter]:
        return parameters_of(self.viewer.settings.params)

    def set(self, name: str, value: Any) -> None:
        """Turn one parameter, as the panel does."""
        self.tally.counts[self.name]["changes"] += 1
        self.viewer.settings.set(name, value)

    def frame(self, count: int = 1, wall: float = FRAME_INTERVAL) -> None:
        """Frames `wall` [s] apart as the two threads would make them, each checked."""
        panel = self.viewer.panel
        for _ in range(count):
            start = time.process_time()
            self.loop.tick(wall)
            panel.status_at = panel.marks_at = 0.0  # write every text, every frame
            self.viewer.served.show_latest()
            self.longest = max(self.longest, time.process_time() - start)
            self.check()
        self.tally.counts[self.name]["frames"] += count

    def check(self) -> None:
        status = self.loop.latest.status
        assert not self.poison, f"sent to the browser: {self.poison[:3]} with {self.unusual()}"
        assert not any(crash in status.halted for crash in CRASHES), f"{status.halted} with {self.unusual()}"
        if status.halted:
            assert not status.running
            assert len(status.halted) > 20, status.halted
        else:
            assert math.isfinite(status.time)

    def unusual(self) -> dict[str, Any]:
        """The parameters that are not at their defaults."""
        params = self.viewer.settings.params
        return {
            name: getattr(params, name) for name, k in self.parameters.items() if getattr(params, name) != k.default
        }

    def go_on(self) -> None:
        """After a halt: reset, and where the parameters cannot hold, the defaults; then it must run."""
        if self.loop.run.halted:
            self.tally.counts[self.name]["halts"] += 1
            self.loop.commands.put(Reset())
            self.frame()
            if self.loop.run.halted:
                self.calm()

    def calm(self) -> None:
        """Back to the defaults and running."""
        panel = self.viewer.panel
        panel.settings.load(next(iter(panel.kind.presets)))
        self.loop.commands.put(Play())
        self.frame(2)
        assert not self.loop.run.halted, self.loop.run.halted
        before = self.loop.scene.time
        self.frame(3)
        assert self.loop.run.running
        assert self.loop.scene.time > before

    def shut(self) -> None:
        self.tally.notes.append(f"{self.name}: longest frame {self.longest:.2f} s of processor time")
        self.viewer.shut()


def ends(parameter: Parameter) -> tuple[Any, ...]:
    """Both ends of a parameter, or all its choices."""
    if parameter.choices:
        return parameter.choices
    return (False, True) if parameter.kind is bool else (parameter.kind(parameter.low), parameter.kind(parameter.high))


def anywhere(parameter: Parameter, rng: random.Random) -> Any:
    """Any value a parameter may have, its ends among them more often than chance has it."""
    if parameter.choices or parameter.kind is bool or rng.random() < 0.1:
        return rng.choice(ends(parameter))
    if parameter.log_from:
        value = 10.0 ** rng.uniform(math.log10(parameter.log_from), math.log10(parameter.high))
    else:
        value = rng.uniform(parameter.low, parameter.high)
    return min(max(round(value), int(parameter.low)), int(parameter.high)) if parameter.kind is int else value


def some_command(rng: random.Random) -> Any:
    """Something a hand does, in or out of reach."""
    reach = rng.choice([1.0, 5.0, 100.0])
    place = rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(-reach, reach)
    aim = rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)
    return rng.choice(
        [
            GrabTo(rng.randrange(0, 12), place), GrabTo(rng.randrange(-5, 2000), place), Release(),
            Place(rng.choice(["root", "sphere", "camera", "nothing"]), place), PointAlong(place, aim),
            PointAlong(place, (0.0, 0.0, 0.0)), StepOnce(), Pause(), Play(), Reset(),
        ]
    )  # fmt: skip
