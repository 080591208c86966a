"""Earlier settings, which undo restores, with the acts that began their runs."""

import collections
import itertools
import time
from typing import NamedTuple

from app.messages import BaseParams
from app.render.cameras import ClientCamera

MAX_SETTINGS = 100  # kept; beyond that the oldest are dropped
SAME_CHANGE = 1.0  # [s] after a change of a number, or the release of its slider, within which it continues


class EarlierSettings(NamedTuple):
    """All parameters, their preset, and the state of the screen."""

    params: BaseParams
    preset: str
    act: int = 1  # number of the act that began their run, which `History.note` sets
    runs: bool = False  # that act has the lab run, as a preset does; set by `History.note` too
    cameras: tuple[ClientCamera, ...] = ()  # of all browsers, before a change that moves them


class History:
    """The settings before each act of a person, as a stack, and the numbers of the acts.

    An act is everything that a person changes at once. Changes of one number are one act while a slider is held, and if
    they follow each other soon.
    """

    def __init__(self) -> None:
        self.act, self.runs = 1, False  # of the present run: at first the opening of the scene
        self.acts = itertools.count(2)  # numbers of those to come
        self.settings: collections.deque[EarlierSettings] = collections.deque(maxlen=MAX_SETTINGS)
        self.number, self.changed_at = "", 0.0  # name of the last number changed, and the time [s]
        self.hands: set[int] = set()  # browsers in which a slider is held

    def note(self, before: EarlierSettings, *, number: str = "", begins: bool = False, runs: bool = False) -> int:
        """Keep the settings before a change. number: name of the number that changes, alone.

        begins: it begins another run. runs: and starts the clock. Returns the number of the act that begins the next
        run.
        """
        goes_on = number != "" and number == self.number
        goes_on = goes_on and (bool(self.hands) or time.monotonic() - self.changed_at <= SAME_CHANGE)
        self.number, self.changed_at = number, time.monotonic()
        if not goes_on:
            self.settings.append(before._replace(act=self.act, runs=self.runs))
            if begins:
                self.act, self.runs = next(self.acts), runs
        return self.act

    def press(self, client: int) -> None:
        """Note that a browser holds a slider: later changes are another act."""
        self.hands.add(client)
        self.number = ""

    def release(self, client: int) -> None:
        """Note that a browser has released its slider, or has left. Its last messages may still arrive."""
        if client in self.hands:
            self.hands.discard(client)
            self.changed_at = time.monotonic()

    def take_last(self) -> EarlierSettings | None:
        """Settings before the last change in the history, or None. Their run is the present one."""
        self.number = ""
        if not self.settings:
            return None
        settings = self.settings.pop()
        self.act, self.runs = settings.act, settings.runs
        return settings
