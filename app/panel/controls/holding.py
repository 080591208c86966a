"""Two hidden buttons, by which a page reports that a slider is held and released (`app/render/js/fields.js`)."""

from collections.abc import Callable

import viser

from app.panel.history import History
from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import fill


def add_holding(gui: viser.GuiApi, history: History) -> None:
    """Add the buttons; all changes by a held slider are one act of the history."""
    held: GuiHandle = gui.add_button("Slider held", visible=False)
    free: GuiHandle = gui.add_button("Slider free", visible=False)

    for button, note in ((held, history.press), (free, history.release)):

        @button.on_click
        async def _(event: ViserEvent, note: Callable[[int], None] = note) -> None:
            if event.client_id is not None:
                note(event.client_id)

    told = fill('<span data-springtide-held="{}" data-springtide-free="{}"></span>', uuid_of(held), uuid_of(free))
    gui.add_html(str(told))
