"""The first picture of a scene: the run waits for it, so that its first seconds are seen.

A page says that its picture is whole once its cover goes (`app/render/js/scene/cover.js`). Programs that connect draw
nothing, and a lab that draws by viser's public interface alone gets no word of its pages: neither is waited for.
"""

import time
from collections.abc import Callable, Collection

from app.render.injection import ShaderInjector

PATIENCE = 90.0  # [s] after the first page has connected; a page itself lifts its cover after 60 s


class FirstPicture:
    """The wait for the first picture of a scene."""

    def __init__(self, injector: ShaderInjector | None, pages: Collection[int]) -> None:
        """injector: hears of the pages' pictures; None without shaders. pages: clients that are pages of the lab."""
        self.injector, self.pages = injector, pages
        self.is_seen = injector is None
        self.since: float | None = None  # [s] when the first page was there

    def audience(self, clients: Collection[int], count: int, clock: Callable[[], float] = time.monotonic) -> int:
        """The number of those who watch: `count`, or 0 while all of these clients wait for their first picture."""
        if self.is_seen or count == 0:
            return count
        assert self.injector is not None
        now = clock()
        self.since = now if self.since is None else self.since
        is_whole = not self.injector.whole.isdisjoint(clients)
        self.is_seen = is_whole or any(one not in self.pages for one in clients) or now - self.since > PATIENCE
        return count if self.is_seen else 0
