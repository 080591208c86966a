"""A class that checks at the end of the hour, on a busy machine."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from app.lab.check.program_check import check_program
from app.lab.course.task import load_tasks
from app.lab.process.runner import Runner
from tests.app.lab.check.test_true_sentences import TASKS, source_of
from tests.app.lab.solutions.right_solutions import RIGHT

STUDENTS = 30
LOOPS = 2  # that keep two cores busy


def write_folder(folder: Path) -> None:
    """Right functions for all tasks, in the files of the tasks."""
    folder.mkdir()
    for file in {task.file for task in TASKS.values()}:
        own = [task for task in load_tasks() if task.file == file and task.name in RIGHT]
        (folder / file).write_text("\n\n".join(source_of(task, RIGHT[task.name]) for task in own), "utf-8")


def states_of(folder: Path) -> dict[str, str]:
    """States of all functions of a folder by the check."""
    with Runner(folder) as runner:
        verdicts = {name: check_program(folder, runner, task) for name, task in TASKS.items()}
    return {name: verdict.text for name, verdict in verdicts.items() if verdict.state not in ("right", "not checked")}


@pytest.mark.stress  # minutes
@pytest.mark.timeout(3600)
def test_thirty_checks_at_once_on_two_busy_cores_call_nobody_wrong(tmp_path: Path) -> None:
    folders = [tmp_path / f"student{i}" for i in range(STUDENTS)]
    for folder in folders:
        write_folder(folder)
    loops = [subprocess.Popen([sys.executable, "-c", "while 1: pass"], start_new_session=True) for _ in range(LOOPS)]
    try:
        with ThreadPoolExecutor(STUDENTS) as pool:
            false_words = list(pool.map(states_of, folders))
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()
    assert false_words == STUDENTS * [{}]
