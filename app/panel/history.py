"""Earlier settings, which undo restores, with the acts that began their runs; and those that redo restores.

The history goes through all scenes of a lab: another scene is an act, too.
"""

import collections
import itertools
import time
from collections.abc import MutableSequence
from typing import NamedTuple

from app.messages import BaseParams
from app.render.cameras import ClientCamera

MAX_SETTINGS = 100  # kept; beyond that the oldest are dropped
SAME_CHANGE = 1.0  # [s] after a change of a number, or the release of its slider, within which it continues


class EarlierSettings(NamedTuple):
    """All parameters of a scene, their preset, and the state of the screen."""

    scene: str
    params: BaseParams
    preset: str
    act: int = 1  # number of the act that began their run, which `History.note` sets
    runs: bool = False  # that act has the lab run, as a preset does; set by `History.note` too
    cameras: tuple[ClientCamera, ...] = ()  # of all browsers, before a change that moves them
    words: str = ""  # the act between them and the later settings


class SceneRequest(NamedTuple):
    """A scene to open."""

    scene: str
    params: BaseParams | None = None  # from a task, a link or the history
    cameras: tuple[ClientCamera, ...] = ()  # of single browsers
    earlier: EarlierSettings | None = None  # the settings of an undo or a redo


class History:
    """The settings before each act of a person, as a stack, and the numbers of the acts.

    An act is everything that a person changes at once. A browser's changes of one number are one act while it holds a
    slider, and if they follow each other soon.
    """

    def __init__(self) -> None:
        self.act, self.runs = 1, False  # of the present run: at first the opening of the scene
        self.acts = itertools.count(2)  # numbers of those to come
        self.settings: collections.deque[EarlierSettings] = collections.deque(maxlen=MAX_SETTINGS)
        self.undone: list[EarlierSettings] = []  # the next one to be redone is the last
        self.number, self.changed_at = "", 0.0  # name of the last number changed, and the time [s]
        self.client: int | None = None  # the browser that changed it
        self.hands: set[int] = set()  # browsers in which a slider is held

    def note(
        self,
        before: EarlierSettings,
        *,
        number: str = "",
        client: int | None = None,
        begins: bool = False,
        runs: bool = False,
    ) -> int:
        """Keep the settings before a change. number: name of the number that changes, alone.

        client: the browser that changes it, if it is known. begins: it begins another run. runs: and starts the clock.
        Returns the number of the act that begins the next run.
        """
        goes_on = number != "" and (number, client) == (self.number, self.client)
        goes_on = goes_on and (client in self.hands or time.monotonic() - self.changed_at <= SAME_CHANGE)
        self.number, self.client, self.changed_at = number, client, time.monotonic()
        if not goes_on:
            self.undone.clear()
            self.settings.append(before._replace(act=self.act, runs=self.runs))
            if begins:
                self.act, self.runs = next(self.acts), runs
        return self.act

    def press(self, client: int) -> None:
        """Note that a browser holds a slider: its later changes are another act."""
        self.hands.add(client)
        if client == self.client:
            self.number = ""

    def release(self, client: int) -> None:
        """Note that a browser has released its slider, or has left. Its last messages may still arrive."""
        if client in self.hands:
            self.hands.discard(client)
            self.changed_at = time.monotonic()

    @property
    def last(self) -> EarlierSettings | None:
        """The settings that an undo restores."""
        return self.settings[-1] if self.settings else None

    @property
    def next(self) -> EarlierSettings | None:
        """The settings that a redo restores."""
        return self.undone[-1] if self.undone else None

    def leads_to(self, settings: EarlierSettings | None) -> bool:
        """True if these are the settings of the next undo or redo."""
        return settings is not None and (settings is self.last or settings is self.next)

    def for_other_scene(self, now: EarlierSettings, earlier: EarlierSettings | None) -> "History":
        """A copy that leads on to another scene; this one stays with the scene that is left.

        now: the settings that are left. earlier: those to restore, if the scene is opened by an undo or a redo.
        """
        other = History()
        other.act, other.runs, other.acts = self.act, self.runs, self.acts
        other.settings, other.undone = self.settings.copy(), self.undone.copy()
        if not other.leads_to(earlier):
            other.note(now, begins=True, runs=True)
        elif earlier is other.last:
            other.take_last(now)
        else:
            other.take_next(now)
        return other

    def take_last(self, now: EarlierSettings) -> EarlierSettings | None:
        """Settings before the last act in the history, or None. Their run is the present one.

        now: the present settings, for a redo.
        """
        return self.move(self.settings, self.undone, now)

    def take_next(self, now: EarlierSettings) -> EarlierSettings | None:
        """Settings after the act that was undone last, or None. now: the present settings, for another undo."""
        return self.move(self.undone, self.settings, now)

    def move(
        self,
        source: MutableSequence[EarlierSettings],
        target: MutableSequence[EarlierSettings],
        now: EarlierSettings,
    ) -> EarlierSettings | None:
        """Take the last settings from `source`, and put the present ones at the end of `target`."""
        self.number = ""
        if not source:
            return None
        settings = source.pop()
        target.append(now._replace(act=self.act, runs=self.runs, words=settings.words))
        self.act, self.runs = settings.act, settings.runs
        return settings
