"""Dark or light, in each browser for itself."""

from unittest.mock import Mock

from app.panel.display import follow_theme
from tests.app.channels import FakeChannel


def test_a_browser_makes_its_own_panel_and_floor_dark_or_light() -> None:
    channel, view = FakeChannel(), Mock()
    follow_theme(channel, view)  # type: ignore[arg-type]
    for dark in (True, False):
        client = Mock()
        channel.say("dark", dark, client)
        assert client.gui.configure_theme.call_args.kwargs["dark_mode"] is dark
        view.set_dark.assert_called_with(client, dark)
    assert view.set_dark.call_count == 2
