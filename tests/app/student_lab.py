"""`springtide lab DIR` on a new folder of exercises, for tests."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.student.session import Session
from app.lab.student.workbook import Workbook
from app.server.viewer import Viewer


@contextlib.contextmanager
def student_lab(folder: Path, **options: Any) -> Iterator[tuple[Viewer, Session]]:
    """A lab with the workbook and the functions of a folder that is made for it. options: of the session."""
    tasks = load_tasks()
    make_folder(folder, tasks)
    session = Session(folder, tasks, **options)
    viewer = Viewer("127.0.0.1", 0, workbook=Workbook(tasks, folder), session=session)
    try:
        yield viewer, session
    finally:
        viewer.shut()
        session.close()
