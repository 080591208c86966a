"""Display settings of a browser: dark or light, text size, and quality."""

import viser

from app.render.handles.channel import Channel, Message
from app.scenes.contract import AnyView

BRAND_COLOUR = (28, 106, 168)


def set_theme(gui: viser.GuiApi, *, dark: bool) -> None:
    """Set the look of viser's panel, of every browser or of one by its own `gui`."""
    gui.configure_theme(
        dark_mode=dark, show_logo=False, show_share_button=False, control_width="medium", brand_color=BRAND_COLOUR
    )


def follow_theme(channel: Channel, view: AnyView) -> None:
    """Give each browser the panel and the floor that it asks for, dark or light."""

    def take(message: Message[bool]) -> None:
        set_theme(message.client.gui, dark=message.value)
        view.set_dark(message.client, message.value)

    channel.listen("dark", bool, take)


def add_switches(gui: viser.GuiApi) -> None:
    """Add the choices of each browser; the page does the rest (`js/panel/display.js`, `js/shading/quality.js`)."""
    gui.add_html(
        '<div class="springtide-switches"><button type="button" data-springtide-act="dark">Dark</button>'
        '<button type="button" data-springtide-act="large">Large text</button></div>'
        '<div class="springtide-switches"><label>Quality <select data-springtide-choice="quality">'
        '<option value="automatic">automatic</option><option value="high">high</option>'
        '<option value="medium">medium</option><option value="low">low</option></select> '
        '<span class="springtide-quality"></span></label>'
        '<button type="button" data-springtide-act="display">Display …</button>'
        '<button type="button" data-springtide-act="projector" title="Key L">Projector</button></div>'
    )
