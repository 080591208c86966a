"""Output cell of a lab in a notebook: its page while it runs, and a picture that stays."""

import base64
import contextvars
import json
import sys
import uuid
from importlib import resources
from typing import Any

from app.notebook.picture import Still

STILL_WIDTH = 640  # [pixels] of the picture that stays
STILL_SHOWN_WIDTH = 240  # [pixels] of it below the page, while that is open
PAGE_WIDTH = 1000  # [pixels] about, of a notebook's outputs: for the shape of the picture


def shell() -> Any:
    """The running IPython, or None."""
    ipython = sys.modules.get("IPython")
    return None if ipython is None else ipython.get_ipython()


def cell_of_now() -> tuple[str, str]:
    """The cell that is executed and the number of its execution; "" if the notebook does not say."""
    parent = getattr(shell(), "get_parent", dict)() or {}
    cell = (parent.get("metadata") or {}).get("cellId") or ""
    return str(cell), str((parent.get("header") or {}).get("msg_id") or "")


class Output:
    """Two outputs of a cell: the page, and the picture below it."""

    def __init__(self, port: int, key: str, height: int) -> None:
        """port, key: of the lab. height: of the page [pixels]."""
        self.port, self.key, self.height = port, key, height
        self.still: Still | None = None
        self.page_id, self.still_id = uuid.uuid4().hex, uuid.uuid4().hex
        self.context = contextvars.copy_context()  # which holds the cell of an output

    @property
    def still_size(self) -> tuple[int, int]:
        """Width and height [pixels] of the picture that stays."""
        return STILL_WIDTH, round(STILL_WIDTH * self.height / PAGE_WIDTH)

    def show(self) -> None:
        """Show the page, as soon as it answers."""
        if shell() is None:
            print(f"The lab is on http://127.0.0.1:{self.port}/{self.key}/")
            return
        put({"text/html": self.html(), "text/plain": "A lab that runs beside this notebook."}, self.page_id)
        put({"text/html": ""}, self.still_id)

    def html(self) -> str:
        """A box, and the script that finds the lab's page for it."""
        script = (resources.files("app.notebook") / "output.js").read_text("utf-8")
        name = f"springtide-{self.page_id}"
        settings = json.dumps({"box": name, "port": self.port, "key": self.key, "height": self.height})
        return f'<div id="{name}"></div><script>{script.rstrip()}({settings});</script>'

    def show_still(self, still: Still) -> None:
        """Keep a picture in the notebook, small while the page is open."""
        self.still = still
        put(image(still), self.still_id, {"image/png": {"width": STILL_SHOWN_WIDTH}}, update=True)

    def end(self) -> None:
        """The last picture in place of the page."""
        if self.still is None:
            put({"text/plain": "This lab was stopped."}, self.page_id, update=True)
            return
        put(image(self.still), self.page_id, update=True)
        put({"text/html": ""}, self.still_id, update=True)


def image(still: Still) -> dict[str, str]:
    """A picture in the format of notebooks."""
    return {"image/png": base64.b64encode(still.png).decode(), "text/plain": "A picture of the lab."}


def put(data: dict[str, str], name: str, metadata: dict[str, Any] | None = None, *, update: bool = False) -> None:
    """Show an output, or another one in its place. Nothing outside IPython."""
    ipython = shell()
    if ipython is not None:
        ipython.display_pub.publish(data, metadata or {}, transient={"display_id": name}, update=update)
