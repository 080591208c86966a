"""Fixtures of the tests of the program."""

from collections.abc import Iterator

import pytest


@pytest.fixture(scope="session", autouse=True)
def prompt() -> Iterator[None]:
    """Look at files, and update a panel that nobody looks at, at short intervals: tests wait for them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.server.served_scene.ALONE_HEARTBEAT", 0.05)
        patch.setattr("app.lab.student.session.LOOK_INTERVAL", 0.05)
        patch.setattr("app.panel.workbook.guide.TYPING_PAUSE", 0.2)
        yield
