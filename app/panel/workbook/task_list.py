"""The list of the guide's tasks, with the sign of each one's state in a workbook."""

import viser

from app.lab.course.task import Task
from app.lab.student.workbook import Workbook
from app.render.handles.viser_types import ViserEvent

BACK, ON = "◀", "▶"  # to the task before, and to the next; `fields.js` names them
SIGNS = {"right": "✓", "begun": "●", "open": "○"}  # before a task, by its state


class TaskList:
    """Chooses a task of the workbook; made in the open container."""

    def __init__(self, gui: viser.GuiApi, workbook: Workbook) -> None:
        self.workbook = workbook
        self.judged: tuple[object, ...] = ()  # source of the signs before the titles
        self.titles = self.titles_now()
        self.chooser = gui.add_dropdown("Task", self.titles, initial_value=self.titles[workbook.index])
        self.chooser.on_update(self.on_chooser)
        self.turn = gui.add_button_group("", (BACK, ON))
        self.turn.on_click(self.on_turn)

    async def on_chooser(self, event: ViserEvent) -> None:
        """Take the chosen task."""
        if event.client_id is not None and event.target.value in self.titles:
            self.workbook.go(self.titles.index(event.target.value))

    async def on_turn(self, event: ViserEvent) -> None:
        """Turn to the next or the previous task."""
        self.workbook.go(self.workbook.index + (1 if event.target.value == ON else -1))

    def titles_now(self) -> tuple[str, ...]:
        """The tasks in the list, in a workbook each with the sign of its state."""
        book = self.workbook
        if book.folder is None:
            return tuple(map(title_of, book.tasks))
        return tuple(f"{SIGNS[book.state(task)]} {title_of(task)}" for task in book.tasks)

    def show(self, task: Task) -> None:
        """Show the list, with this task chosen."""
        judged = self.workbook.revision, self.workbook.programs()
        if judged != self.judged:  # all answers of all tasks are checked for the signs, which takes a millisecond
            self.judged = judged
            titles = self.titles_now()
            if titles != self.titles:
                self.titles = titles
                self.chooser.options = titles
        self.chooser.value = self.titles[self.workbook.tasks.index(task)]


def title_of(task: Task) -> str:
    """Name of a task in the list."""
    return f"{task.item} {task.title}{' (optional)' if task.optional else ''}"
