"""Pictures of a browser's view for the report of a workbook."""

import threading
import traceback
from collections.abc import Callable

import viser

from app.lab.task import Task
from app.lab.workbook import Workbook
from app.panel.picture import take_picture

PICTURE_WIDTH = 1280  # [pixels]


class ReportPictures:
    """Takes pictures for the report, one at a time in a separate thread, and reports success or the error."""

    def __init__(self, workbook: Workbook, finished: Callable[[], None]) -> None:
        """finished: called when `said` has changed."""
        self.workbook, self.finished = workbook, finished
        self.busy = threading.Lock()
        self.said = ""

    def start(self, client: viser.ClientHandle | None, task: Task, name: str) -> None:
        """Take a picture of a browser's view for a task. name: of its file."""
        if client is None or not self.busy.acquire(blocking=False):
            return
        self.said = "The picture is being taken …"
        threading.Thread(
            target=self.take, args=(client, task, name), name="picture for the report", daemon=True
        ).start()

    def take(self, client: viser.ClientHandle, task: Task, name: str) -> None:
        """Keep a picture in the student's folder; whatever goes wrong is said. In a separate thread."""
        try:
            picture = take_picture(client, (PICTURE_WIDTH, 0), jpeg=True)
            kept = self.workbook.add_picture(task, name, picture)
            self.said = f"The report has the picture “{kept}”."
        except OSError as error:  # a TimeoutError is one too
            self.said = f"No picture was taken: {error.strerror or error}"
        except (ValueError, RuntimeError) as reason:
            self.said = f"No picture was taken: {reason}"
        except Exception as error:
            traceback.print_exc()
            self.said = f"No picture was taken: {type(error).__name__}: {error}"
        finally:
            self.finished()
            self.busy.release()
