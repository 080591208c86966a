"""The lab's end of the channel: which messages reach whom, answers, and states that two threads set."""

import json
import threading
from types import SimpleNamespace
from typing import Any

import pytest

from app.render.handles.channel import Channel, Message, finite
from tests import coroutines
from tests.app.channels import text_of

CLIENT = SimpleNamespace(client_id=1)


class Elements:
    """The parts of a viser server that a channel uses."""

    def __init__(self) -> None:
        self.gui = self

    def add_text(self, label: str, value: str, **look: Any) -> Any:
        return SimpleNamespace(value=value, on_update=lambda call: None, _impl=SimpleNamespace(uuid="field"))

    def add_html(self, content: str, order: float) -> Any:
        return SimpleNamespace(content=content)


@pytest.fixture
def channel() -> Channel:
    return Channel(Elements())  # type: ignore[arg-type]


def take(channel: Channel, text: str, client: Any = CLIENT) -> None:
    channel.field.value = text
    coroutines.run(channel._take(SimpleNamespace(client=client)))


def test_a_message_reaches_who_listens_to_its_topic(channel: Channel) -> None:
    messages: list[Message[Any]] = []
    channel.listen("a", str, messages.append)
    take(channel, text_of("a", "words\nand more", page="p", number=7))
    take(channel, text_of("b", "words"))
    assert messages == [(CLIENT, "p", 7, "words\nand more")]
    channel.restart()
    take(channel, text_of("a", "words"))
    assert len(messages) == 1


@pytest.mark.parametrize(
    "text",
    ["", "p 1 a", "p 1 a\n", "p 1 a\n{", "p x a\n1", "p a\n1", "p 1 a b\n1", "p 1 nobody\n1", "p 1 a\n\"text\"",
     "p 1 a\nnull", "p 1 a\n" + "[" * 20_000, "p " + "9" * 5000 + " a\n[]"],
)  # fmt: skip
def test_what_is_no_message_of_ours_is_ignored(channel: Channel, text: str) -> None:
    messages: list[Message[Any]] = []
    channel.listen("a", list, messages.append)
    take(channel, text)
    assert messages == []
    take(channel, text_of("a", []))
    assert len(messages) == 1


def test_a_value_that_the_program_sets_is_no_message(channel: Channel) -> None:
    messages: list[Message[Any]] = []
    channel.listen("a", bool, messages.append)
    take(channel, text_of("a", True), None)
    assert messages == []


def test_a_question_is_asked_again_until_it_is_answered_and_answers_outlive_the_scene(channel: Channel) -> None:
    messages: list[Message[Any]] = []
    text = text_of("a", "?", page="p", number=3)
    channel.listen("a", str, messages.append)
    for _ in range(2):
        take(channel, text)
    assert len(messages) == 2
    channel.answer(messages[0], "yes")
    channel.restart()
    channel.listen("a", str, messages.append)
    take(channel, text)
    assert len(messages) == 2
    assert channel.state_of("answers") == [("p", 3, "yes")]
    take(channel, text_of("a", "?", page="q", number=3))
    assert len(messages) == 3


def test_a_long_message_is_not_kept_for_browsers_to_come(channel: Channel) -> None:
    messages: list[Message[Any]] = []
    channel.listen("a", str, messages.append)
    take(channel, text_of("a", "x" * 5000))
    assert [len(message.value) for message in messages] == [5000]
    assert channel.field.value == ""


def test_a_state_and_its_element_agree_whichever_thread_sets_them(channel: Channel) -> None:
    class Slow:
        """An element whose content is set late, the first time."""

        def __init__(self) -> None:
            self.text, self.began, self.may_end = "", threading.Event(), threading.Event()

        @property
        def content(self) -> str:
            return self.text

        @content.setter
        def content(self, text: str) -> None:
            if not self.began.is_set():
                self.began.set()
                self.may_end.wait(1.0)
            self.text = text

    element = channel._elements["time"] = Slow()  # type: ignore[assignment]
    first = threading.Thread(target=channel.tell, args=("time", 1))
    second = threading.Thread(target=channel.tell, args=("time", 2))
    first.start()
    assert element.began.wait(10.0)
    second.start()
    second.join(0.2)
    element.may_end.set()
    for thread in (first, second):
        thread.join(10.0)
    assert f'data-value="{json.dumps(channel.state_of("time"))}"' in element.content


@pytest.mark.parametrize("values", [None, "12", [1.0], [1.0, 2.0, 3.0], [1.0, "2"], [1.0, True], [1.0, float("nan")]])
def test_what_is_no_list_of_finite_numbers_is_none(values: object) -> None:
    assert finite(values, 2) is None
    assert finite([1, 2.5], 2) == (1.0, 2.5)
