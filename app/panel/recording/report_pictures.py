"""Pictures of a browser's view for the report of a workbook."""

import threading
from collections.abc import Callable

import viser

from app.lab.course.task import Task
from app.lab.student.workbook import Workbook
from app.panel.recording.long_work import LongWork
from app.panel.recording.picture import take_picture

PICTURE_WIDTH = 1280  # [pixels]


class ReportPictures:
    """Takes pictures for the report, one at a time in a separate thread."""

    def __init__(self, workbook: Workbook) -> None:
        self.workbook = workbook
        self.busy = threading.Lock()

    def start(self, client: viser.ClientHandle | None, task: Task, name: str, is_shown: Callable[[], bool]) -> None:
        """Take a picture of a browser's view for a task. name: of its file. is_shown: true while both are shown."""
        if client is None or not self.busy.acquire(blocking=False):
            return
        work = LongWork(client, "Picture for the report", "No picture was taken")
        work.start(lambda: self.take(client, task, name, is_shown), self.busy.release)

    def take(self, client: viser.ClientHandle, task: Task, name: str, is_shown: Callable[[], bool]) -> str:
        """Save a picture in the student's folder; returns the words on it. Runs in a separate thread.

        Raises ValueError if the view is no longer that of the task.
        """
        picture = take_picture(client, (PICTURE_WIDTH, 0), jpeg=True)
        if not is_shown():
            raise ValueError("another task or scene was opened before it was ready")
        return f"The report has the picture “{self.workbook.add_picture(task, name, picture)}”."
