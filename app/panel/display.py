"""Display settings of a browser: dark or light, text size, and quality."""

# pyright: reportPrivateUsage=false

import viser

from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import fill
from app.scenes.contract import AnyView

BRAND_COLOUR = (28, 106, 168)


def set_theme(gui: viser.GuiApi, *, dark: bool) -> None:
    """Set the look of viser's panel, of every browser or of one by its own `gui`."""
    gui.configure_theme(
        dark_mode=dark, show_logo=False, show_share_button=False, control_width="medium", brand_color=BRAND_COLOUR
    )


def add_theme_buttons(gui: viser.GuiApi, view: AnyView) -> None:
    """Add two hidden buttons, by which a browser chooses a dark or light panel and floor.

    They are buttons because two browsers may choose the same: viser passes on only changes of a checkbox.
    """
    dark_button: GuiHandle = gui.add_button("Dark", visible=False)
    light_button: GuiHandle = gui.add_button("Light", visible=False)

    for button, is_dark in ((dark_button, True), (light_button, False)):

        @button.on_click
        async def _(event: ViserEvent, dark: bool = is_dark) -> None:
            if event.client is not None:
                set_theme(event.client.gui, dark=dark)
                view.set_dark(event.client, dark)

    told = fill(
        '<span data-springtide-dark="{}" data-springtide-light="{}"></span>',
        uuid_of(dark_button),
        uuid_of(light_button),
    )
    gui.add_html(str(told))


def add_switches(gui: viser.GuiApi) -> None:
    """Add the choices of each browser; the page does the rest (`js/panel/display.js`, `js/shading/quality.js`)."""
    gui.add_html(
        '<div class="springtide-switches"><button type="button" data-springtide-switch="dark">Dark</button>'
        '<button type="button" data-springtide-switch="large">Large text</button></div>'
        '<div class="springtide-switches"><label>Quality <select data-springtide-quality>'
        '<option value="automatic">automatic</option><option value="high">high</option>'
        '<option value="medium">medium</option><option value="low">low</option></select> '
        "<span data-springtide-quality-now></span></label>"
        '<button type="button" data-springtide-display>Display …</button>'
        '<button type="button" data-springtide-projector title="Key L">Projector</button></div>'
    )
