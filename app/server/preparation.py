"""Compiling of the kernels of a scene before it is opened, with its progress on the page and on the terminal."""

import threading
import time
from collections.abc import Callable

import viser

from app.messages import BaseParams
from app.render.injection import reset_page
from app.render.markup.html import fill, note
from app.scenes.ahead.compiling import Compiling
from app.scenes.contract import AnyKind

PROGRESS_INTERVAL = 0.25  # [s] between two updates of the progress


def progress_line(words: str) -> str:
    """A line as HTML that covers the page (`js/page/cover.js`)."""
    return note(fill('<span class="springtide-progress">{}</span>', words))


def cover(server: viser.ViserServer, words: str) -> viser.GuiHtmlHandle:
    """Cover the page with a line, until it is removed."""
    return server.gui.add_html(progress_line(words))


class Preparation:
    """Compiles the kernels of scenes before they are opened."""

    def __init__(
        self, server: viser.ViserServer, compiling: Compiling, say: Callable[[str], None], *, ahead: bool
    ) -> None:
        """say: prints a line. ahead: compile for later too (`go_on`)."""
        self.server, self.compiling, self.say, self.ahead = server, compiling, say, ahead
        self.notice = ""  # on the compilation for the next scene

    def compile(self, kind: AnyKind, params: BaseParams, *, covers: bool, given_up: Callable[[], bool]) -> bool:
        """Compile the kernels of a scene. Returns False if cancelled before all were ready.

        covers: show the progress in place of the page. An open scene shows `notice`, and continues meanwhile.
        """
        jobs = self.compiling.missing(kind.name, params)
        if not jobs:
            return True
        start = time.monotonic()
        self.say(f"{kind.title}: compiling {', '.join(job.piece for job in jobs)}. This is done once.")
        line = None
        if covers:
            reset_page(self.server)
            line = cover(self.server, "")
        self.compiling.want(jobs)
        try:
            done = False
            while not done:
                left = [job.piece for job in jobs if job not in self.compiling.settled]
                spent = time.monotonic() - start
                self.notice = f"{kind.title}: compiling {', '.join(left)}, {spent:.0f} s. This is done once."
                if line is not None:
                    line.content = progress_line(self.notice)
                done = self.compiling.wait(jobs, PROGRESS_INTERVAL)
                if given_up():
                    return False
        finally:
            self.notice = ""
        self.say(f"{kind.title}: compiled in {time.monotonic() - start:.1f} s")
        return True

    def go_on(self, kind: AnyKind) -> None:
        """Compile kernels that the open scene (of this kind) and others may call later, on a separate thread."""
        if self.ahead:
            action = self.compiling.go_on_with
            threading.Thread(target=action, args=(kind.name,), name="compile ahead", daemon=True).start()
