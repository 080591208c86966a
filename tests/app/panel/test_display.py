"""Dark or light, in each browser for itself."""

import inspect
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

from app.panel.display import add_theme_buttons
from tests import coroutines


class Button:
    """Stands for a hidden button of the panel."""

    def __init__(self) -> None:
        self._impl = SimpleNamespace(uuid="a-button")

    def on_click(self, action: Any) -> None:
        """Keep what a click does."""
        assert inspect.iscoroutinefunction(action)
        self.action = action


def test_a_browser_makes_its_own_panel_and_floor_dark_or_light() -> None:
    buttons: dict[str, Button] = {}
    gui, view = Mock(), Mock()
    gui.add_button = lambda name, **_: buttons.setdefault(name, Button())
    add_theme_buttons(gui, view)
    for name, dark in (("Dark", True), ("Light", False)):
        client = Mock()
        coroutines.run(buttons[name].action(SimpleNamespace(client=client)))
        assert client.gui.configure_theme.call_args.kwargs["dark_mode"] is dark
        view.set_dark.assert_called_with(client, dark)
        coroutines.run(buttons[name].action(SimpleNamespace(client=None)))
    assert view.set_dark.call_count == 2
    gui.configure_theme.assert_not_called()
