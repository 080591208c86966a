"""Each sentence of the panel's head belongs to a run, its values or an act, and goes with it.

Random acts are compared with a model, which notes of each run with which values it stopped, and of each act what it
changed. It reads the words of the page, and knows nothing of when they are shown.
"""

import dataclasses
import html
import random
import re
from typing import Any

import pytest

from app.messages import GrabTo, Pause, Play, Release, StepOnce
from app.panel.history import MAX_SETTINGS
from app.scenes import NAMES, scene_named
from app.server.viewer import Viewer
from sim.parameters import effect_of_change
from sim.validation import DivergenceError
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
    "pause", "step",
)  # fmt: skip
SIZES = {"square_sea": {"size": "64", "mesh": "64"}}  # which the list of sizes has
STATES = ("Running", "Paused", "Stopped", "Slow motion")
STOPPED_WITH_OTHERS, STABLE = "The run stopped with other values.", "These values are stable."
NOT_IN_MEMORY = "That run is no longer in memory"


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

    def advance_and_note(self, steps: int) -> None:
        try:
            self.advance(steps)
        except DivergenceError:
            self.stopped_with = self.loop.scene.params
            raise

    def tick(self) -> None:
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
        for _ in range(acts):
            model.act()
        return model.seen
    finally:
        lab.shut()


def test_no_sentence_outlives_what_it_is_about() -> None:
    seen = run_acts("rope", 1, 80)
    assert seen >= {"Running", "Paused", "Stopped", STOPPED_WITH_OTHERS, STABLE, NOT_IN_MEMORY}


@pytest.mark.stress
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", NAMES)
def test_no_sentence_outlives_what_it_is_about_in_500_acts(name: str) -> None:
    run_acts(name, 1, 500)
