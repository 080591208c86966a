"""Defers parameters until the kernels that they need are compiled; compiling here would freeze the page."""

from collections.abc import Iterable

from app.messages import BaseParams, Command, Load
from app.scenes.compiling import Compiling, Job
from app.scenes.contract import AnyKind


class CompileGate:
    """Holds back parameters of one scene until their kernels are compiled; the scene goes on with the present ones.

    The simulation thread alone calls it and changes it; the viewer thread reads `notice`.
    """

    def __init__(self, compiling: Compiling, kind: AnyKind, state: tuple[BaseParams, int]) -> None:
        """state: parameters that run, and the number of the last `Load`."""
        self.compiling, self.kind = compiling, kind
        self.seen = state  # the last record of the panel that could run
        self.passed = state  # the same as the simulation is given it
        self.held: Load | None = None  # waits for the compiler
        self.loaded = state[1]  # number of the last `Load` that was passed on
        self.dropped: int | None = None  # number of the last one that was dropped for a newer record
        self.jobs: dict[BaseParams, list[Job]] = {}  # still to be compiled, asked for once and not in each tick
        self.notice = ""  # pending compilation, in words

    def is_ready(self, params: BaseParams) -> bool:
        """True if all is compiled that these parameters run; if not, it is compiled next."""
        if params not in self.jobs:
            self.jobs[params] = self.compiling.missing(self.kind.name, params)
            if self.jobs[params]:
                self.compiling.want(self.jobs[params])
                names = ", ".join(job.piece for job in self.jobs[params])
                self.notice = f"Compiling {names}: starts by itself when it is ready."
        self.jobs[params] = [job for job in self.jobs[params] if job not in self.compiling.settled]
        return not self.jobs[params]

    def admit(self, commands: Iterable[Command]) -> list[Command]:
        """The commands that can be handled now. A preset waits until it can run, and the latest one wins."""
        admitted: list[Command] = []
        for command in commands:
            if not isinstance(command, Load):
                admitted.append(command)
            elif self.is_ready(command.params):
                admitted.append(self.pass_on(command))
            else:
                self.held = command
        if self.held is not None and self.is_ready(self.held.params):
            admitted.append(self.pass_on(self.held))
        return admitted

    def pass_on(self, load: Load) -> Load:
        """Note that this preset is handed to the simulation."""
        self.held, self.loaded = None, load.number
        return load

    def read(self, state: tuple[BaseParams, int]) -> tuple[BaseParams, int]:
        """The parameters to run with, of those that the panel has now; read after `admit` had the commands.

        A newer record that can run drops a preset that cannot, and comes with the number of the preset before it.
        """
        params, number = state
        if state is self.seen or not self.is_ready(params):
            return self.passed
        if self.held is not None:
            if self.is_ready(self.held.params):  # since `admit`, which passes it on in the next tick
                return self.passed
            self.held, self.dropped = None, self.held.number
        self.seen, self.passed = state, (params, self.loaded) if number == self.dropped else state
        self.jobs.clear()
        self.notice = ""
        return self.passed
