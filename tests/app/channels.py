"""Messages of pages to a lab, without a page."""

import itertools
import json
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from app.render.handles.channel import Channel, Message
from app.server.viewer import Viewer
from tests import coroutines

NUMBERS = itertools.count(1)  # of messages


def text_of(topic: str, value: object, *, page: str = "page", number: int | None = None) -> str:
    """A message as the field has it. number: of an earlier message, to send it again."""
    return f"{page} {next(NUMBERS) if number is None else number} {topic}\n{json.dumps(value)}"


def say(channel: Channel, topic: str, value: object, *, client: Any = None, page: str = "page") -> None:
    """Have a channel take a message of a browser."""
    channel.field.value = text_of(topic, value, page=page)
    coroutines.run(channel._take(SimpleNamespace(client=client or SimpleNamespace(client_id=1))))


def state_of(lab: Viewer, topic: Any) -> Any:
    """The state of a topic, as pages have it."""
    return lab.panel.head.channel.state_of(topic)


class FakeChannel:
    """A channel without a server: what was told, and messages for those who listen."""

    def __init__(self) -> None:
        self.told: dict[str, Any] = {}
        self.answers: list[object] = []
        self.listeners: dict[str, tuple[type, Callable[[Message[Any]], None]]] = {}

    def tell(self, topic: str, state: object) -> None:
        json.dumps(state)
        self.told[topic] = state

    def listen(self, topic: str, kind: type, call: Callable[[Message[Any]], None]) -> None:
        self.listeners[topic] = kind, call

    def answer(self, message: Message[Any], value: object) -> None:
        self.answers.append(value)

    def say(self, topic: str, value: object, client: Any = None) -> None:
        """Call the listener, as a message of a page would."""
        kind, call = self.listeners[topic]
        assert isinstance(value, kind)
        call(Message(client or SimpleNamespace(client_id=1), "page", next(NUMBERS), value))
