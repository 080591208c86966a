"""A picture of a browser's view."""

from pathlib import Path

from app.panel.recording.picture import take_picture
from app.server.viewer import Viewer
from sim.validation import argument_error, is_whole_number

MAX_SIDE = 8000  # [pixels]
PAGE_TIMEOUT = 20.0  # [s] for a page to connect
DRAW_TIMEOUT = 20.0  # [s] for a browser to draw a picture; it draws none of a page scrolled out of view


class Still:
    """A picture that a notebook shows and keeps."""

    def __init__(self, png: bytes) -> None:
        self.png = png

    def _repr_png_(self) -> bytes:
        return self.png

    def save(self, path: str | Path) -> None:
        """Write a PNG file. Raises OSError."""
        Path(path).write_bytes(self.png)


def take_still(viewer: Viewer, width: int, height: int, timeout: float = DRAW_TIMEOUT) -> Still:
    """View of the newest browser, drawn again at width x height [pixels]. timeout: [s] for drawing it.

    Raises ValueError for what is not a size, RuntimeError if no browser shows the lab, and TimeoutError if it
    does not draw.
    """
    for name, side in (("width", width), ("height", height)):
        if not is_whole_number(side) or not 1 <= side <= MAX_SIDE:
            raise argument_error(name, side, f"1 to {MAX_SIDE} pixels")
    client = viewer.newest_visitor(PAGE_TIMEOUT)
    if client is None:
        raise RuntimeError("no browser shows this lab, so there is no picture of it; open its cell in a browser")
    try:
        return Still(take_picture(client, (int(width), int(height)), timeout=timeout))
    except TimeoutError:
        raise TimeoutError(f"the browser drew no picture within {timeout:g} s; the page has to be visible") from None
