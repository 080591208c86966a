"""Earlier settings, which undo brings back."""

import collections
import time
from typing import NamedTuple

from app.messages import BaseParams

MAX_SETTINGS = 100  # kept; beyond that the oldest are dropped
SAME_CHANGE = 1.0  # [s] within which changes of one parameter, as a slider is moved, count as one


class Settings(NamedTuple):
    """All parameters, and the preset that they come from."""

    params: BaseParams
    preset: str


class History:
    """The settings before each change, the last one first to be taken."""

    def __init__(self) -> None:
        self.settings: collections.deque[Settings] = collections.deque(maxlen=MAX_SETTINGS)
        self.last = "", 0.0  # what was changed last, and when [s]

    def note(self, before: Settings, what: str) -> None:
        """Keep the settings before a change. what: the parameter or the preset."""
        name, at = self.last
        now = time.monotonic()
        if name != what or now - at > SAME_CHANGE:
            self.settings.append(before)
        self.last = what, now

    def take_last(self) -> Settings | None:
        """Settings before the last change that is still kept; None if there is none."""
        self.last = "", 0.0
        return self.settings.pop() if self.settings else None
