"""Questions to all visitors: may a link or a file of one browser change the lab for all?

A question waits until a visitor answers it or the browsers that ask it have left, also while scenes change. Browsers
that ask the same share one question. What waits changes on viser's event loop only, and is replaced as a whole; the
viewer's thread reads and draws it.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import viser

from app.render.html import fill, note
from app.render.viser_types import ViserEvent
from app.scenes import scene_named
from app.scenes.comparisons import COMPARISONS
from app.scenes.setups import Setup

OPEN, LEAVE = "Open it for all", "Leave the lab as it is"
LEFT = "A visitor chose to leave the lab as it is."
Subject: TypeAlias = Setup | str  # a set-up, or the name of a comparison that is ready


class Asker(NamedTuple):
    """A browser that asks."""

    client: int
    page: str  # word that its page knows itself by (app/render/js/share.js)


class Question(NamedTuple):
    """A request of one or more browsers to show something to all."""

    number: int
    subject: Subject
    askers: tuple[Asker, ...]

    def words(self, visitors: int) -> str:
        """The question as HTML; each page shows the sentence that is meant for it."""
        if isinstance(self.subject, str):
            title, name = COMPARISONS[self.subject].title, ""
        else:
            title, name = scene_named(self.subject.scene).title, self.subject.name or self.subject.preset
        what = fill("<b>{}</b>{}", title, f" ({name})" if name else "")
        count = f"all {visitors} browsers" if visitors > 1 else "all"
        return note(
            fill(
                '<span data-springtide-askers="{}">'
                '<span class="springtide-asker">You are about to open {} for {}.</span>'
                '<span class="springtide-asked">Another browser asks to open {}. This changes the lab for {}.</span>'
                "</span>",
                " ".join(asker.page for asker in self.askers), what, count, what, count,
            )
        )  # fmt: skip


class Questions:
    """The questions of one server that wait for an answer."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.waiting: tuple[Question, ...] = ()
        self.count = 0  # questions so far
        server.on_client_disconnect(self.on_leave)

    def ask(self, subject: Subject, asker: Asker) -> None:
        """Ask for a browser, in place of its earlier question."""
        self.forget(asker.client)
        same = next((question for question in self.waiting if question.subject == subject), None)
        if same is None:
            self.count += 1
            self.waiting = (*self.waiting, Question(self.count, subject, (asker,)))
        else:
            joined = same._replace(askers=(*same.askers, asker))
            self.waiting = tuple(joined if question is same else question for question in self.waiting)

    def forget(self, client: int) -> None:
        """Drop the question of a browser."""
        left = [q._replace(askers=tuple(a for a in q.askers if a.client != client)) for q in self.waiting]
        self.waiting = tuple(question for question in left if question.askers)

    def take(self, number: int) -> Question | None:
        """Take a question out; None where it has been answered or dropped."""
        found = next((question for question in self.waiting if question.number == number), None)
        self.waiting = tuple(question for question in self.waiting if question is not found)
        return found

    async def on_leave(self, client: viser.ClientHandle) -> None:
        """A browser has left."""
        self.forget(client.client_id)


class Ballot:
    """The questions as one panel shows them, each with its own buttons: a vote counts for the question above it."""

    def __init__(
        self,
        server: viser.ViserServer,
        folder: viser.GuiFolderHandle,
        questions: Questions,
        show: Callable[[Subject, int], None],
        refuse: Callable[[viser.ClientHandle | None, str], None],
    ) -> None:
        """show: opens something for all, with its camera for one browser. refuse: tells a browser why not."""
        self.server, self.folder, self.questions, self.show, self.refuse = server, folder, questions, show, refuse
        self.drawn: dict[int, tuple[viser.GuiHtmlHandle, viser.GuiButtonGroupHandle]] = {}  # question -> its handles

    def draw(self) -> None:
        """Show the open questions; on the viewer's thread."""
        waiting = self.questions.waiting
        if not waiting and not self.drawn:
            return
        for number in self.drawn.keys() - {question.number for question in waiting}:
            for handle in self.drawn.pop(number):
                handle.remove()
        visitors = len(self.server.get_clients())
        for question in waiting:
            words = question.words(visitors)
            if question.number not in self.drawn:
                self.drawn[question.number] = self.add(question.number, words)
            self.drawn[question.number][0].content = words

    def add(self, number: int, words: str) -> tuple[viser.GuiHtmlHandle, viser.GuiButtonGroupHandle]:
        """The handles of a question."""
        with self.folder:
            text = self.server.gui.add_html(words)
            buttons = self.server.gui.add_button_group("", (OPEN, LEAVE))

        @buttons.on_click
        async def _(event: ViserEvent) -> None:
            self.answer(number, event.target.value == OPEN, event.client_id)

        return text, buttons

    def answer(self, number: int, opens: bool, voter: int | None) -> None:
        """A visitor has answered; the first answer counts."""
        question = self.questions.take(number)
        if question is None:
            return
        if opens:
            self.show(question.subject, question.askers[0].client)
            return
        clients = self.server.get_clients()
        for asker in question.askers:
            if asker.client != voter:
                self.refuse(clients.get(asker.client), LEFT)
