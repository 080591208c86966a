"""The lab guide in the panel: one task at a time. With a student's folder it is the workbook, which keeps answers.

Callbacks run on viser's event loop. They change the workbook and nothing on the page; `update`, on the viewer's
thread, shows what has changed.
"""

import time
from collections.abc import Callable, Iterator, Mapping

import viser

from app.lab.course.answer_check import chosen
from app.lab.course.live_values import LiveNumber, LiveValue, LiveValues, fill_in
from app.lab.course.task import PREDICTION, Question, Task, TaskSetup
from app.lab.student.workbook import Workbook, read_off
from app.panel.controls.controls import Controls
from app.panel.recording.report_pictures import ReportPictures
from app.panel.workbook.task_list import TaskList
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.formula import formula
from app.render.markup.html import (
    ERROR_COLOUR,
    GOOD_COLOUR,
    WARNING_COLOUR,
    Html,
    bold,
    coloured,
    faint,
    fill,
    join,
    note,
)
from app.scenes.contract import AnyKind, AnySnapshot
from sim.parameters import Value, in_words, parameters_of

TYPING_PAUSE = 1.0  # [s] after the last keystroke until a text is saved
UNANSWERED = "Choose …"  # in the list of choices
SET_UP, SHOW, HIDE = "Set this up", "Show the answer", "Hide the answer"
PICTURE = "Take a picture"
STATE_COLOURS = {"right": GOOD_COLOUR, "wrong": ERROR_COLOUR, "given": GOOD_COLOUR}
STATE_WORDS = {"right": "Right.", "wrong": "Not right.", "given": "Saved."}


class SnapshotValues(Mapping[str, LiveValue]):
    """Values that a task may name: the parameters, quantities of the scene, the clock, and the state of the run.

    A quantity is computed when first read; one that the scene lacks at present is missing.
    """

    def __init__(self, kind: AnyKind, snapshot: AnySnapshot) -> None:
        self.quantities, self.snapshot = kind.quantities, snapshot
        self.by_name: dict[str, LiveValue | None] = {}
        for name, parameter in parameters_of(snapshot.params).items():
            value: Value = getattr(snapshot.params, name)
            meaning = parameter.title or in_words(name)
            is_named = isinstance(value, bool | str)
            self.by_name[name] = value if is_named else LiveNumber(float(value), parameter.unit, meaning)
        status = snapshot.status
        self.by_name["time"] = LiveNumber(status.time, "s", "Time")
        self.by_name["diverged"] = status.state.has_stopped or status.state.replays

    def __getitem__(self, name: str) -> LiveValue:
        """The value of this name. Raises KeyError if the scene does not have it now."""
        if name not in self.by_name:
            self.by_name[name] = self.computed(name)
        value = self.by_name[name]
        if value is None:
            raise KeyError(name)
        return value

    def computed(self, name: str) -> LiveNumber | None:
        """The quantity of this name, None if the scene does not have it now."""
        quantity = self.quantities.get(name)
        value = quantity.value(self.snapshot) if quantity is not None and quantity.shown else None
        if quantity is None or value is None:
            return None
        floor = 0.0 if quantity.floor is None else quantity.floor(self.snapshot) or 0.0
        return LiveNumber(value, quantity.unit, quantity.meaning, floor)

    def __iter__(self) -> Iterator[str]:
        return iter([name for name in dict.fromkeys((*self.by_name, *self.quantities)) if name in self])

    def __len__(self) -> int:
        return len(list(iter(self)))


class QuestionWidgets:
    """One question of the workbook: its text, the field of its answer, and the result of the check."""

    def __init__(self, guide: "GuideTab", task: Task, question: Question) -> None:
        self.guide, self.task, self.question = guide, task, question
        self.workbook = guide.workbook
        self.refusal = ""
        self.refused: str | None = None  # an answer that was not saved because the file could not be read
        self.typed = self.flushed = "", 0.0  # the text as typed, and when [s] it last changed; the one that was kept
        gui = guide.gui
        self.widgets: list[GuiHandle] = []
        label = label_of(question)
        content = self.kept_text()
        if question.kind == "choice":
            self.field: GuiHandle = gui.add_dropdown(label, (UNANSWERED, *question.choices), initial_value=content)
        else:
            self.field = gui.add_text(label, content, multiline=question.kind == "text")
        self.field.on_update(self.on_field)
        self.widgets.append(self.field)
        self.line = gui.add_html("")
        self.widgets.append(self.line)
        self.reader: GuiHandle | None = None
        if question.read_off:
            self.reader = gui.add_button_group("", ("Read off",), visible=False)
            self.reader.on_click(self.on_read_off)
            self.widgets.append(self.reader)
        self.show()

    def kept_text(self) -> str:
        """Content of the field for the stored answer."""
        answer = self.workbook.answers.of(self.task, self.question)
        unread = self.workbook.answers.unread_of(self.task, self.question)
        if self.question.kind == "choice":
            choice = chosen(self.question, answer) if isinstance(answer, str) else ""
            return choice if choice in self.question.choices else UNANSWERED
        if unread is not None:
            return unread.text
        return "" if answer is None else answer if isinstance(answer, str) else f"{answer:.10g}"

    async def on_field(self, event: ViserEvent) -> None:
        """Take an answer from a browser; a text is saved once the typing pauses."""
        if event.client_id is None:
            return
        text = str(event.target.value)
        if self.question.kind == "text":
            self.typed = text, time.monotonic()
        else:
            self.store("" if text == UNANSWERED else text)

    async def on_read_off(self, event: ViserEvent) -> None:
        """Take the live value."""
        text = read_off(self.question, self.guide.values)
        if event.client_id is not None and text:
            self.store(text)

    def store(self, text: str) -> None:
        """Save an answer, or remember why it was refused."""
        self.refusal = self.guide.attempt(lambda: self.workbook.answer(self.task, self.question, text))
        self.refused = text if self.refusal and self.workbook.answers.error else None
        if not self.refusal:
            self.guide.refusal = ""  # such as that a prediction comes first
        self.guide.stale = True

    def flush(self, now: float) -> None:
        """Save a text whose typing has ended."""
        typed = self.typed  # a browser may continue typing meanwhile
        if typed is not self.flushed and now - typed[1] >= TYPING_PAUSE:
            self.flushed = typed
            self.store(typed[0])

    def show(self) -> None:
        """Show the stored answer and its check, except over a text that is being typed."""
        if self.refused is not None and not self.workbook.answers.error:  # the student has mended the file
            self.store(self.refused)
        verdict = self.workbook.verdict(self.task, self.question)
        self.field.disabled = self.question.key == PREDICTION and self.workbook.is_shown(self.task)
        content = self.kept_text()
        if self.typed is self.flushed and not self.refusal and self.field.value.strip() != content:
            self.field.value = content
        if self.reader is not None:
            self.reader.visible = bool(read_off(self.question, self.guide.values))
        feedback = Html()
        if self.refusal:
            feedback = fill('<div class="springtide-refusal" role="alert">{}</div>', self.refusal)
        elif verdict.state in STATE_WORDS and (verdict.state != "given" or self.question.kind == "text"):
            text = verdict.text
            if verdict.state == "given":
                text = self.comparison()
            feedback = fill(
                '<div class="springtide-line springtide-verdict">{} {}</div>',
                coloured(STATE_WORDS[verdict.state], STATE_COLOURS[verdict.state]),
                text,
            )
        self.line.content = str(feedback)

    def comparison(self) -> str:
        """The program's answer beside a text of the student's, once the answer of the task has been shown."""
        if not self.question.why:
            return ""
        if not self.workbook.is_shown(self.task):
            return f"“{SHOW}” puts the program's beside it."
        return f"Compare: {self.question.why}"

    def remove(self) -> None:
        """Take it from the page."""
        for widget in self.widgets:
            widget.remove()


class ControlsAgain:
    """The controls of the panel that a task shows a second time; made in the open container."""

    def __init__(self, gui: viser.GuiApi, controls: Controls) -> None:
        self.controls, self.place = controls, gui.add_folder(None)
        self.names: tuple[str, ...] = ()  # of their parameters

    def show(self, names: tuple[str, ...]) -> None:
        """Show the controls of these parameters instead of the former ones."""
        self.names = names
        self.controls.show_again(names, self.place)


class GuideTab:
    """The tab of the panel."""

    def __init__(
        self,
        gui: viser.GuiApi,
        kind: AnyKind,
        workbook: Workbook,
        set_up: Callable[[TaskSetup], None],
        tab: viser.GuiTabHandle,
        controls: Controls,
    ) -> None:
        """set_up: shows the set-up of a task; raises ValueError if it does not exist. tab: holds the guide.

        controls: of the panel; a task repeats its own.
        """
        self.gui, self.kind, self.workbook, self.set_up = gui, kind, workbook, set_up
        self.values: LiveValues = {}
        self.stale = True  # True if something other than live values has to be shown again
        self.revision: int = workbook.revision
        self.refusal = ""  # reason why the last request was refused
        self.unwritten = ""  # reason why a step could not be ticked off at the last look
        self.pictures = ReportPictures(workbook)
        self.shown_task: Task | None = None
        self.questions: list[QuestionWidgets] = []
        workbook.go_to_scene(kind.name)
        with tab:
            self.tasks = TaskList(gui, workbook)
            self.text = gui.add_html("")
            self.tools = gui.add_button_group("", (SET_UP, SHOW))
            self.tools.on_click(self.on_tool)
            # Folders without a name, which hold the widgets of a task in place.
            self.again = ControlsAgain(gui, controls)
            self.readings = gui.add_html("")
            self.question_place = gui.add_folder(None)
            self.answer = gui.add_html("")
            if workbook.folder is not None:
                self.name = gui.add_text("Your name", workbook.answers.name)
                self.name.on_update(self.on_name)
        self.show_task(workbook.task)

    # ----- actions of browsers

    async def on_name(self, event: ViserEvent) -> None:
        """The student's name, for the report."""
        if event.client_id is not None:
            self.refusal = self.attempt(lambda: self.workbook.rename(str(event.target.value)))
            self.stale = True

    async def on_tool(self, event: ViserEvent) -> None:
        """Set the task up, show its answer, or take a picture."""
        task = self.workbook.task
        if event.target.value == PICTURE:
            self.start_picture(event.client, task)
        elif event.target.value == SET_UP:
            self.refusal = self.attempt(lambda: self.set_up(self.workbook.set_up_of(task)))
        else:
            self.refusal = self.attempt(lambda: self.workbook.show_answer(task))
        self.stale = True

    def start_picture(self, client: viser.ClientHandle | None, task: Task) -> None:
        """Take a picture of a browser's view for the report, named by scene and time."""
        now = self.values.get("time")
        at = f"-{now.value:.0f}s" if isinstance(now, LiveNumber) else ""
        self.pictures.start(
            client, task, f"{self.kind.name}{at}", lambda: self.shown_task is self.workbook.task is task
        )

    def attempt(self, action: Callable[[], None]) -> str:
        """Try an action; returns the reason for a failure, or ""."""
        try:
            action()
        except ValueError as error:
            return str(error)
        except OSError as error:
            return f"answers.toml could not be written: {error.strerror or error}"
        return ""

    # ----- display

    def update(self, snapshot: AnySnapshot, refresh: bool) -> None:
        """Show changes. Called on the viewer's thread.

        refresh: show the live values of this snapshot, as the panel shows its readout: both say the same.
        """
        now = time.monotonic()
        task = self.workbook.task  # callbacks may change it meanwhile
        stale, self.stale = self.stale, False  # requests from now on are for the next update
        for widgets in self.questions:
            widgets.flush(now)
        if refresh:
            self.workbook.refresh()
            self.values = SnapshotValues(self.kind, snapshot)
            if self.is_set_up_here(task):
                self.unwritten = self.attempt(lambda: self.workbook.watch(task, self.values))
        if self.workbook.revision != self.revision:
            self.revision, stale = self.workbook.revision, True
        if task is not self.shown_task:
            self.refusal = self.unwritten = ""
            self.show_task(task)
        elif refresh or stale:
            self.show_values(task)

    def is_set_up_here(self, task: Task) -> bool:
        """True if a task belongs to the open scene."""
        return self.workbook.set_up_of(task).scene == self.kind.name

    def show_task(self, task: Task) -> None:
        """Show another task."""
        self.flush()
        for widgets in self.questions:
            widgets.remove()
        self.questions = []
        if self.workbook.folder is not None:
            with self.question_place:
                self.questions = [QuestionWidgets(self, task, question) for question in task.questions]
        self.again.show(self.controls_of(task))
        self.show_values(task)
        self.shown_task = task

    def controls_of(self, task: Task) -> tuple[str, ...]:
        """Names of the parameters that a task is about: those of its steps, and of the values that it shows."""
        if not self.is_set_up_here(task):
            return ()
        in_steps = (condition.name for step in task.steps for condition in step.when)
        names = dict.fromkeys((*in_steps, *self.workbook.set_up_of(task).show))
        return tuple(name for name in names if name in self.again.controls.parameters)

    def show_values(self, task: Task) -> None:
        """Show the texts of the task with the present values."""
        is_shown = self.workbook.is_shown(task)
        self.tasks.show(task)
        compares = any(question.kind == "text" and question.why for question in task.questions)
        tools = (SET_UP, SHOW, PICTURE) if task.guide is not None or compares else (SET_UP, PICTURE)
        if self.workbook.folder is None:
            tools = (SET_UP, HIDE if is_shown else SHOW)
        if self.tools.options != tools:
            self.tools.options = tools
        self.text.content = note(join((self.statement(task), self.steps(task))))
        self.readings.content = str(fill('<div class="springtide-note springtide-readings">{}</div>', self.now(task)))
        self.answer.content = note(join((self.said(), self.answer_text(task) if is_shown else "")))
        for widgets in self.questions:
            widgets.show()

    def statement(self, task: Task) -> Html:
        """The task, and where to look."""
        setup = self.workbook.set_up_of(task)
        question = bold(task.guide.question if task.guide is not None else task.title)
        if self.workbook.folder is not None:
            code = fill(" Write <code>{}</code> in <code>{}</code>.", task.name, task.file) if task.file else ""
            question = fill("{}{}", task.statement, code)
        elsewhere = Html()
        if not self.is_set_up_here(task) and setup.scene:
            scene = in_words(setup.scene).lower()
            elsewhere = coloured(f"This task is about the {scene}: press “{SET_UP}”.", WARNING_COLOUR)
        # In a workbook the steps of a task are the instructions.
        look = Html() if self.workbook.folder is not None and task.steps else faint(setup.look)
        return fill('<div class="springtide-guide">{}<div>{}</div>{}</div>', elsewhere, question, look)

    def now(self, task: Task) -> Html:
        """The live values that the task keeps visible."""
        values = [self.values.get(name) for name in self.workbook.set_up_of(task).show if name not in self.again.names]
        rows = [fill("{}: <b>{}</b>", v.meaning, format(v, "")) for v in values if isinstance(v, LiveNumber)]
        return fill("Now: {}", join(rows, " · ")) if rows else Html()

    def steps(self, task: Task) -> Html:
        """The steps of the task, ticked off once seen."""
        if self.workbook.folder is None:
            return Html()
        done = self.workbook.done(task)
        return join(
            fill(
                '<div class="springtide-step" data-done="{}">{} <b>Do</b> {}</div>',
                "yes" if i in done else "no",
                coloured("✓", GOOD_COLOUR) if i in done else "○",
                step.text,
            )
            for i, step in enumerate(task.steps, 1)
        )

    def said(self) -> Html:
        """The failed action and its cause."""
        error = self.refusal or self.unwritten or self.workbook.answers.error
        return fill('<div class="springtide-refusal" role="alert">{}</div>', error) if error else Html()

    def answer_text(self, task: Task) -> Html:
        """The law, and the answer with the present values, or the settings that the scene lacks."""
        guide = task.guide
        if guide is None:
            return Html()
        laws = join(fill('<div class="springtide-law">{}</div>', formula(law)) for law in guide.law)
        if not self.is_set_up_here(task) or not all(condition.holds(self.values) for condition in guide.needs):
            hint = coloured(f"Press “{SET_UP}” for the numbers.", WARNING_COLOUR)
            return fill('<div class="springtide-answer">{}{}</div>', laws, hint)
        return fill('<div class="springtide-answer">{}{}</div>', laws, fill_in(guide.answer, self.values))

    def close(self) -> None:
        """End, and save the texts that are being typed."""
        self.shown_task = None
        self.flush()

    def flush(self) -> None:
        """Save the texts that are being typed."""
        for widgets in self.questions:
            widgets.flush(float("inf"))


def label_of(question: Question) -> str:
    """Name of the field of an answer: the question, with its unit."""
    unit = f" [{question.unit}]" if question.unit else ""
    return f"{'Predict: ' if question.key == PREDICTION else ''}{question.ask}{unit}"
