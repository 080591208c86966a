"""Each sentence of the panel's head belongs to a run, its values, an act or a compilation, and goes with it.

Random acts are compared with a model, which notes of each run with which values it stopped, and of each act what it
changed. It reads the words of the page, and knows nothing of when they are shown.
"""

import dataclasses
import html
import random
import re
from types import SimpleNamespace
from typing import Any, NamedTuple
from unittest.mock import patch

import pytest

from app.messages import GrabTo, Pause, Play, Release, StepOnce
from app.panel.history import MAX_SETTINGS
from app.panel.sharing import scene_switches
from app.scenes import NAMES, scene_named
from app.scenes.ahead.compiling import Job
from app.scenes.setups import Setup
from app.server.viewer import Viewer
from sim.parameters import effect_of_change
from sim.validation import DivergenceError
from tests import coroutines
from tests.app.channels import state_of
from tests.app.server.loop.test_acts import FORCES, SMALL

TICK = 1 / 15  # [s] of wall time
MAX_TICKS = 40  # after an act
UNSTABLE: dict[str, dict[str, float]] = {
    "rope": {"stiffness": 2.65e5}, "cloth": {"stiffness": 1e5}, "race": {"stiffness": 2.65e5},
    "mooring": {"time_step": 0.05},
}  # fmt: skip
ACTS = (
    "force", "unstable", "unstable", "mend", "mend", "preset", "reset", "pull", "plots", "undo", "redo", "play",
    "pause", "step", "switch", "switch", "switch", "switch_back", "compile_ahead", "compile_ahead",
    "end_compiling", "hold",
)  # fmt: skip
SIZES = {"square_sea": {"size": "64", "mesh": "64"}}  # which the list of sizes has
STATES = ("Running", "Paused", "Stopped", "Slow motion")
STOPPED_WITH_OTHERS, STABLE = "The run stopped with other values.", "These values are stable."
NOT_IN_MEMORY = "That run is no longer in memory"
SWITCHED, COMPILING, HELD = "Someone else switched everyone to", "This is done once.", "starts by itself when ready"
PIECES = "springs", "drawing", "packing"


class Switch(NamedTuple):
    """A set-up that another page opened."""

    preset: str
    before: Any  # parameters
    until: float | None = None  # [s] of the model's clock, from the first time that it is shown


class Model:
    """The lab, random acts on it, and what its sentences are about."""

    def __init__(self, lab: Viewer, rng: random.Random) -> None:
        lab.served.stop_threads()
        self.lab, self.rng, self.loop, self.settings = lab, rng, lab.loop, lab.settings
        self.loop.admit, self.loop.run.audience = list, lambda: 1
        self.loop.clock.effort = lambda: 0.0  # no frame is too expensive, so that a sequence is always the same
        self.advance, lab.loop.scene.advance = lab.loop.scene.advance, self.advance_and_note  # type: ignore[method-assign]
        self.name, self.first = lab.settings.kind.name, lab.settings.params
        self.before: list[tuple[Any, str]] = []  # parameters and preset before each act
        self.after: list[tuple[Any, str]] = []
        self.stopped_with: Any = None  # parameters with which the run has diverged last
        self.restarted: set[int] = set()  # numbers of the runs that an undo had to restart
        self.seen: set[str] = set()  # sentences
        self.clock = 0.0  # [s]
        self.switched: Switch | None = None
        self.compiling: list[Job] = []
        self.ready: set[Job] = set()  # compiled
        self.held: Job | None = None  # without which the last parameters cannot run
        lab.compiling.progress = lambda: (self.compiling, 0)  # type: ignore[method-assign]

    @property
    def now(self) -> tuple[Any, str]:
        return self.settings.params, self.settings.loaded

    def act(self) -> None:
        """A random act, and some time."""
        now, last = self.now, self.settings.history.last
        kind = self.rng.choice([*ACTS, "undo", "undo"])
        getattr(self, kind)()
        self.settings.history.number = ""
        if kind not in ("undo", "redo") and self.settings.history.last is not last:
            self.before = [*self.before, now][-MAX_SETTINGS:]
            self.after.clear()
        for _ in range(self.rng.choice([1, 1, 5, MAX_TICKS])):
            self.tick()
        if self.held is not None:
            self.release(self.held)

    def advance_and_note(self, steps: int) -> None:
        try:
            self.advance(steps)
        except DivergenceError:
            self.stopped_with = self.loop.scene.params
            raise

    def tick(self) -> None:
        self.clock += TICK
        self.loop.tick(TICK)
        self.check()

    def force(self) -> None:
        name = self.rng.choice(FORCES[self.name])
        value = getattr(self.first, name)
        self.settings.set(name, value * self.rng.choice([1.0, 1.01, 1.02]) if value else 0.01 * self.rng.random())

    def unstable(self) -> None:
        self.settings.set_all(UNSTABLE.get(self.name, {}))

    def mend(self) -> None:
        self.settings.set_all({name: getattr(self.first, name) for name in UNSTABLE.get(self.name, {})})

    def preset(self) -> None:
        preset = self.rng.choice(list(self.settings.kind.presets))
        changes = self.rng.choice([{}, UNSTABLE.get(self.name, {})])
        self.settings.load_params(dataclasses.replace(self.first, **changes), preset)

    def reset(self) -> None:
        self.settings.reset()

    def pull(self) -> None:
        for place in ((0.1, 0.0, 0.2), (0.2, 0.0, 0.2)):
            self.settings.drag(GrabTo(1, place, 7))
        self.settings.drag(Release(7))

    def plots(self) -> None:
        self.settings.toggle_plots()

    def undo(self) -> None:
        self.go(self.settings.history.last, self.settings.undo, self.before, self.after)

    def redo(self) -> None:
        self.go(self.settings.history.next, self.settings.redo, self.after, self.before)

    def go(self, settings: Any, press: Any, source: list[Any], target: list[Any]) -> None:
        assert bool(settings) is bool(source)
        now, run = self.now, self.loop.run
        is_other = settings is not None and settings.act != run.identity.act
        press()
        if not source:
            return
        target.append(now)
        assert self.now == source.pop()
        left = {one.act for one in self.loop.runs.left.runs} | {run.identity.act}
        self.loop.tick(TICK)
        if is_other and settings.act not in left:
            self.restarted.add(run.identity.number)

    def play(self) -> None:
        self.settings.post(Play())

    def pause(self) -> None:
        self.settings.post(Pause())

    def step(self) -> None:
        self.settings.post(StepOnce())

    def switch(self) -> None:
        """Another page opens a link."""
        share, preset = self.lab.panel.share, self.rng.choice(list(self.settings.kind.presets))
        name = self.rng.choice(FORCES[self.name])
        params = dataclasses.replace(self.first, **{name: getattr(self.first, name) * self.rng.choice([1.0, 1.03])})
        if params == self.settings.params:
            return
        setup = Setup(self.name, params, {}, preset)
        self.switched = Switch(preset, self.settings.params)
        change = share.change(setup, "another page")
        share.show(setup, 1)
        share.changes.latest = change

    def switch_back(self) -> None:
        """Press the button of the notice, if it is there."""
        if self.lab.panel.share.notice.undo.visible:
            coroutines.run(self.lab.panel.share.notice.on_undo(None))  # type: ignore[arg-type]

    def compile_ahead(self) -> None:
        self.compiling = [Job(self.name, self.rng.choice(PIECES))]

    def end_compiling(self) -> None:
        self.compiling = []

    def hold(self) -> None:
        """Set parameters whose kernels are compiled first; the scene goes on meanwhile."""
        gate, job = self.lab.served.gate, Job(self.name, self.rng.choice(PIECES))
        gate.compiling = SimpleNamespace(missing=lambda name, params: [job], want=lambda jobs: None, settled=self.ready)  # type: ignore[assignment]
        before, self.loop.admit = self.settings.params, gate.admit
        self.force()
        if self.settings.params == before:
            self.loop.admit = list
        else:
            self.held = job

    def release(self, job: Job) -> None:
        """Its kernels are compiled."""
        self.ready.add(job)
        self.held = None
        self.tick()
        self.loop.admit = list
        self.ready.clear()

    def check_line(self) -> None:
        """The line on compiling is there while something is compiled, and names it."""
        text = html.unescape(self.lab.served.compile_line.content)
        if self.held is not None:
            assert f"Compiling {self.held.piece}: {HELD}" in text
        elif self.compiling:
            assert all(f"{job.scene.replace('_', ' ')}: {job.piece}" in text for job in self.compiling)
            assert HELD not in text
        else:
            assert text == ""
        self.seen |= {words for words in (COMPILING, HELD) if words in text}

    def check_switch(self) -> None:
        """The notice of another page's link goes with its time, and once the former set-up is back."""
        notice, switch = self.lab.panel.share.notice, self.switched
        if switch is not None and switch.until is None:
            switch = switch._replace(until=self.clock + scene_switches.SHOWN_TIME)
        if switch is not None and (self.clock > (switch.until or 0.0) or self.settings.params == switch.before):
            switch = None
        self.switched = switch
        assert notice.text.visible is notice.undo.visible is (switch is not None)
        if switch is not None:
            words = html.unescape(notice.text.content)
            assert SWITCHED in words
            assert f"({switch.preset})" in words
            self.seen.add(SWITCHED)

    def check(self) -> None:
        """Compare the words of the head with the model."""
        panel, run, snapshot = self.lab.panel, self.loop.run, self.loop.latest
        panel.status_at = panel.marks_at = 0.0
        self.lab.served.show_latest()
        text, head = html.unescape(panel.head.status.content), panel.head
        shown = [state for state in STATES if f">{state}<" in text]
        assert shown == [shown[0]]
        assert (shown[0] == "Stopped") is bool(run.halted)
        assert (shown[0] == "Paused") <= (not run.running)
        same = self.stopped_with is not None and effect_of_change(self.stopped_with, run.scene.params) in (None, "look")
        assert ('role="alert"' in text) is bool(run.halted)
        assert (STOPPED_WITH_OTHERS in text) is bool(run.halted and not same)
        assert not run.halted or (run.halted in text) is same
        if STABLE in text:
            assert snapshot.readings.stability.share <= 1.0
        if head.again.visible:
            assert STOPPED_WITH_OTHERS in text
        advice = head.remedy.advice
        assert head.remedy.button.visible is (advice is not None)
        if advice is not None:
            assert run.halted
            if hasattr(snapshot.readings, "stability"):
                assert advice.value <= snapshot.readings.stability.critical_step * (1.0 + 1e-9)
        if NOT_IN_MEMORY in text:
            assert run.identity.number in self.restarted
        speed = re.search(r"×([\d.]+)", text)
        if speed is not None:
            assert run.running
            assert float(speed[1]) <= 1.1 * run.scene.params.speed * max(1.0, run.scene.pace) + 0.01
        self.check_hint(state_of(self.lab, "acts")["undo"])
        self.check_line()
        self.check_switch()
        self.seen |= {words for words in (*STATES, STOPPED_WITH_OTHERS, STABLE, NOT_IN_MEMORY) if words in text}

    def check_hint(self, hint: str) -> None:
        """The hint of Undo names what comes back."""
        assert bool(hint) is bool(self.before)
        if self.before and self.before[-1][1] != self.settings.loaded:
            assert hint.endswith(f"back to {self.before[-1][1]}")


def run_acts(name: str, seed: int, acts: int) -> set[str]:
    """Random acts in a scene. Returns the sentences that were seen."""
    lab = Viewer("127.0.0.1", 0)
    try:
        lab.open(name, dataclasses.replace(scene_named(name).params(), **{**SMALL[name], **SIZES.get(name, {})}))
        model = Model(lab, random.Random(f"{name} {seed}"))
        with patch.object(scene_switches, "time", SimpleNamespace(monotonic=lambda: model.clock)):
            for _ in range(acts):
                model.act()
        return model.seen
    finally:
        lab.shut()


def test_no_sentence_outlives_what_it_is_about() -> None:
    seen = run_acts("rope", 1, 80)
    assert seen >= {"Running", "Paused", "Stopped", STOPPED_WITH_OTHERS, STABLE, NOT_IN_MEMORY}
    assert seen >= {SWITCHED, COMPILING, HELD}


@pytest.mark.stress
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", NAMES)
def test_no_sentence_outlives_what_it_is_about_in_500_acts(name: str) -> None:
    run_acts(name, 1, 500)
