"""Labs of a class that end at random moments: by TERM, as a hub ends them, or killed, as in a crash or a power cut."""

import asyncio
import importlib
import math
import os
import random
import signal
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

from app.lab.course.answers import read_answers
from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.scenes.last_setup import read_last
from benchmarks.pupil import STIFFNESS, Pupil

CLASS = importlib.import_module("benchmarks.cases.program.class_")
TASKS = load_tasks(with_checks=False)
LABS, ROUNDS = 30, 1
MAX_LIFE = 4.0  # [s] of a lab from the first answer on
SENT = range(1, 100_000)  # stretches [mm], and stiffnesses above `LEAST` [N/m]
LEAST = 400


class Busy(Pupil):
    """Answers a question and changes the stiffness, as fast as the lab takes it, until the lab ends."""

    sent = 0

    async def work(self, pid: int, how: signal.Signals) -> None:
        """Send, and end the lab at a random moment."""
        async with self.joined() as socket:
            await self.send(socket, "From the page", "pupil\n?task=3.2-1")
            while not (question := next((label for label in self.controls if "spring stretched?" in label), "")):
                await self.hear()
            ending = asyncio.get_running_loop().call_later(self.random.uniform(0.3, MAX_LIFE), os.kill, pid, how)
            try:
                for self.sent in SENT:
                    await self.send(socket, question, f"{self.sent / 1000}")
                    await self.send(socket, STIFFNESS, f"{LEAST + self.sent % 1000}")
                    await asyncio.sleep(self.random.uniform(0.0, 0.03))
            except ConnectionClosed:
                return
            finally:
                ending.cancel()


@pytest.fixture(scope="module", autouse=True)
def kernels() -> None:
    CLASS.compile_kernels()


@pytest.mark.parametrize("seed", range(ROUNDS))
def test_labs_that_end_leave_whole_workbooks_and_set_ups(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = random.Random(seed)
    folders = [tmp_path / f"student-{number}" for number in range(LABS)]
    for folder in folders:
        make_folder(folder, load_tasks())

    async def lesson() -> list[Busy]:
        labs = [CLASS.lab(folder) for folder in folders]
        opened = [lab.__enter__() for lab in labs]
        try:
            pupils = [
                Busy(port, folder, moments.randrange(10**6)) for (_, port), folder in zip(opened, folders, strict=True)
            ]
            ways = [moments.choice((signal.SIGTERM, signal.SIGKILL)) for _ in pupils]
            async with asyncio.timeout(300.0):
                await asyncio.gather(
                    *(pupil.work(pid, how) for pupil, (pid, _), how in zip(pupils, opened, ways, strict=True))
                )
        finally:
            for lab in labs:
                lab.__exit__(None, None, None)
        return pupils

    for pupil in asyncio.run(lesson()):
        answers = read_answers(pupil.folder)
        assert answers.error == ""
        stretch = answers.values.get(("spring_force", "stretch"))
        assert stretch is None or round(1000 * float(stretch)) in range(1, pupil.sent + 1)
        assert pupil.sent > 3
        assert [path.name for path in pupil.folder.iterdir() if path.suffix not in (".py", ".toml", ".md", "")] == []
        monkeypatch.setenv("SPRINGTIDE_DATA", f"{pupil.folder}-data")
        last = read_last()
        assert last is not None
        assert last.scene == "rope"
    monkeypatch.undo()

    async def stiffness_again(folder: Path, port: int) -> float:
        pupil = Pupil(port, folder, 0)
        async with pupil.joined():
            while math.isnan(pupil.stiffness):
                await pupil.hear()
            return pupil.stiffness

    monkeypatch.setenv("SPRINGTIDE_DATA", f"{folders[0]}-data")
    kept = read_last()
    monkeypatch.undo()
    assert kept is not None
    with CLASS.lab(folders[0]) as (_, port):
        assert asyncio.run(stiffness_again(folders[0], port)) == pytest.approx(vars(kept.params)["stiffness"])
