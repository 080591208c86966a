"""Earlier settings, which undo brings back, with the runs that had them."""

import collections
import itertools
import time
from typing import NamedTuple

from app.messages import BaseParams
from app.render.cameras import ClientCamera

MAX_SETTINGS = 100  # kept; beyond that the oldest are dropped
SAME_CHANGE = 1.0  # [s] within which changes of one parameter, as a slider is moved, count as one


class EarlierSettings(NamedTuple):
    """All parameters, the preset that they come from, and the state of the screen."""

    params: BaseParams
    preset: str
    run: int = 1  # number of the run, which `History.note` sets
    cameras: tuple[ClientCamera, ...] = ()  # of all browsers


class History:
    """The settings before each change, the last one first to be taken, and the numbers of the runs."""

    def __init__(self) -> None:
        self.run, self.runs = 1, itertools.count(2)  # number of the present run, and of those to come
        self.settings: collections.deque[EarlierSettings] = collections.deque(maxlen=MAX_SETTINGS)
        self.last = "", 0.0  # what was changed last, and when [s]

    def note(self, before: EarlierSettings, what: str, *, begins: bool = False) -> int:
        """Keep the settings before a change. what: the parameter or the preset. begins: it begins another run.

        Returns the number of the run after it.
        """
        name, at = self.last
        now = time.monotonic()
        self.last = what, now
        if name != what or now - at > SAME_CHANGE:
            self.settings.append(before._replace(run=self.run))
            if begins:
                self.run = next(self.runs)
        return self.run

    def take_last(self) -> EarlierSettings | None:
        """Settings before the last change that is still kept; None if there is none. Their run is the present one."""
        self.last = "", 0.0
        if not self.settings:
            return None
        settings = self.settings.pop()
        self.run = settings.run
        return settings
