"""The runs that a preset, a reset or a new start has ended: each with its last state, to which an undo goes back."""

import collections
from typing import NamedTuple

from app.messages import KeptState, PlotRow
from app.panel.recorder import FrameMemory

MAX_BYTES = 100e6  # of all that is kept; beyond that the oldest are dropped
ROW_BYTES = 32  # of a number in a plot row, with its place in the tuple


class LeftRun(NamedTuple):
    """A run as it was when it was left."""

    number: int
    state: KeptState
    rows: tuple[PlotRow, ...]  # of its plots
    running: bool

    @property
    def arrays(self) -> dict[int, int]:
        """Identity -> bytes of all that it holds."""
        return {**self.state.arrays, id(self.rows): ROW_BYTES * len(self.rows) * len(self.rows[0]) if self.rows else 0}


class LeftRuns:
    """The last ones, within bounded memory; one that is larger than that is not kept."""

    def __init__(self) -> None:
        self.runs: collections.deque[LeftRun] = collections.deque()
        self.memory = FrameMemory()

    def add(self, run: LeftRun) -> None:
        """Keep a run."""
        self.runs.append(run)
        self.memory.add(run.arrays)
        while self.memory.bytes > MAX_BYTES:
            self.memory.remove(self.runs.popleft().arrays)

    def take(self, number: int) -> LeftRun | None:
        """The run of that number, which is no longer kept then; None if it is not kept."""
        for place in reversed(range(len(self.runs))):
            if self.runs[place].number == number:
                found = self.runs[place]
                del self.runs[place]
                self.memory.remove(found.arrays)
                return found
        return None
