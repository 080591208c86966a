"""What a scene sends to its browsers."""

import dataclasses
from collections.abc import Iterator
from typing import Any

import pytest

from app.scenes import NAMES
from app.server.viewer import Viewer
from tests.waiting import wait_for


def strings(value: Any) -> Iterator[str]:
    """Every string in a message of viser's."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for part in value.values():
            yield from strings(part)
    elif isinstance(value, list | tuple):
        for part in value:
            yield from strings(part)
    elif dataclasses.is_dataclass(value):
        yield from strings(vars(value))


@pytest.mark.parametrize("name", NAMES)
def test_every_text_is_of_the_one_type_that_viser_encodes(name: str) -> None:
    viewer = Viewer("127.0.0.1", 0)
    try:
        viewer.open(name)
        wait_for(lambda: viewer.served.drawn > 0 and viewer.panel.controls_tab.readings.notes is not None)
        messages = list(viewer.server._websock_server._broadcast_buffer.message_from_id.values())
        texts = [text for message in messages for text in strings(message)]
        assert any("<div" in text for text in texts)
        assert {type(text) for text in texts} == {str}
    finally:
        viewer.shut()
