"""The channel between a lab and its pages: topics, down and up (`js/core/channel.js` is its other end).

Down: the lab sets the state of a topic, and viser sends it whole to each page that connects. Up: a page sends messages
on topics that the lab listens to, through one hidden field. Each message has the name of the page and a number, so that
an answer belongs to one message.

Topics down:

- `field`: the field for messages, and the topics that the lab listens to;
- `answers`: the last ones;
- `picture`: the sky and the nodes of a whole picture;
- `acts`: what Undo and Redo would change, the query of the preset, and the number of the awaited run;
- `time`: the recording;
- `panes`: the labs of a comparison.
"""

import collections
import json
import math
import threading
from collections.abc import Callable
from typing import Any, Generic, Literal, NamedTuple, TypeVar, cast

import viser

from app.render.handles.viser_inside import uuid_of
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import Html, fill

Down = Literal["field", "answers", "picture", "acts", "time", "panes"]
DOWN: tuple[Down, ...] = ("field", "answers", "picture", "acts", "time", "panes")
LAST = 1e9  # place in the panel
ANSWERS = 8  # that are remembered: a page asks one question of a topic at a time
LONG = 200  # [characters] of a message that viser need not keep for browsers to come

CHANNEL = "springtide_channel"  # attribute of a server with its channel

T = TypeVar("T")


class Message(NamedTuple, Generic[T]):
    """A message of a page."""

    client: viser.ClientHandle
    page: str  # name of the page (`js/core/viewer.js`)
    number: int  # of the message, among those of the page
    value: T


class Answer(NamedTuple):
    """The answer to a message."""

    page: str
    number: int
    value: object


class Channel:
    """The channel of one server. Messages come on viser's event loop; the viewer's thread sets states too."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._telling = threading.Lock()  # a state and its element change together
        self._answers: collections.deque[Answer] = collections.deque(maxlen=ANSWERS)
        self.restart()

    def restart(self) -> None:
        """Begin a scene: nobody listens, and only the answers are still known."""
        gui = self._server.gui
        self._listeners: dict[str, tuple[type, Callable[[Message[Any]], None]]] = {}
        self.field: GuiHandle = gui.add_text("From the page", "", multiline=True, visible=False, order=LAST)
        self.field.on_update(self._take)
        self._elements = {topic: gui.add_html("", order=LAST) for topic in DOWN}
        self._states: dict[Down, object] = {}
        self.tell("answers", list(self._answers))
        self._tell_field()

    def _tell_field(self) -> None:
        self.tell("field", {"uuid": uuid_of(self.field), "topics": sorted(self._listeners)})

    def tell(self, topic: Down, state: object) -> None:
        """Set the state of a topic, which JSON can hold."""
        with self._telling:
            if topic not in self._states or self._states[topic] != state:
                self._states[topic] = state
                self._elements[topic].content = str(topic_html(topic, state))

    def state_of(self, topic: Down) -> object:
        """The state of a topic; None while it has none."""
        return self._states.get(topic)

    def listen(self, topic: str, kind: type[T], call: Callable[[Message[T]], None]) -> None:
        """Have a function called with each message on a topic. Values of another type are ignored."""
        self._listeners[topic] = kind, call
        self._tell_field()

    def answer(self, message: Message[Any], value: object) -> None:
        """Answer a message. A page asks again in the next panel while it has no answer."""
        self._answers.append(Answer(message.page, message.number, value))
        self.tell("answers", list(self._answers))

    def is_answered(self, message: Message[Any]) -> bool:
        """True if this message has come before, and was answered."""
        return any(answer[:2] == (message.page, message.number) for answer in self._answers)

    async def _take(self, event: ViserEvent) -> None:
        """Call the listener of a message: a line with page, number and topic, and the value as JSON."""
        text, client = self.field.value, event.client
        if client is None:
            return  # the program has set the value
        if len(text) > LONG:
            self.field.value = ""
        head, _, body = text.partition("\n")
        try:
            page, number, topic = head.split(" ")
            kind, call = self._listeners[topic]
            message = Message(client, page, int(number), cast(object, json.loads(body)))
        except (LookupError, ValueError, RecursionError):
            return  # of a page that is older, or not ours
        if isinstance(message.value, kind) and not self.is_answered(message):
            call(message)


def topic_html(topic: Down, state: object) -> Html:
    """The state of a topic, as a page reads it."""
    return fill('<span data-springtide-topic="{}" data-value="{}"></span>', topic, json.dumps(state))


def channel_of(server: viser.ViserServer) -> Channel:
    """The channel of a server, made on the first call."""
    if not hasattr(server, CHANNEL):
        setattr(server, CHANNEL, Channel(server))
    return cast(Channel, getattr(server, CHANNEL))


def is_to_channel(server: viser.ViserServer, uuid: str) -> bool:
    """True if a message to this element of the panel is one of the channel."""
    channel: Channel | None = getattr(server, CHANNEL, None)
    return channel is not None and uuid_of(channel.field) == uuid


def finite(values: object, count: int) -> tuple[float, ...] | None:
    """A list of a page as finite numbers; None if it is something else."""
    if not isinstance(values, list) or len(cast(list[object], values)) != count:
        return None
    numbers = [float(v) for v in cast(list[object], values) if isinstance(v, int | float) and not isinstance(v, bool)]
    return tuple(numbers) if len(numbers) == count and all(map(math.isfinite, numbers)) else None
