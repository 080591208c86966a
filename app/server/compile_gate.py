"""Defers parameters until the kernels that they need are compiled; compiling here would freeze the page."""

from collections.abc import Iterable

from app.messages import Advance, BaseParams, Command, Take
from app.scenes.compiling import Compiling, Job
from app.scenes.contract import AnyKind
from app.server.merging import merged


class CompileGate:
    """Holds back parameters of one scene until their kernels are compiled; the scene goes on with the present ones.

    The simulation thread alone calls it and changes it; the viewer thread reads `notice`.
    """

    def __init__(self, compiling: Compiling, kind: AnyKind, params: BaseParams) -> None:
        """params: those that run."""
        self.compiling, self.kind = compiling, kind
        self.params = params  # those that were handed over last
        self.held: list[Take] = []  # wait for the compiler, in order
        self.programs: list[Advance] = []  # wait for what was set before them
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
        """The commands that can be handled now, in order.

        Parameters that cannot run yet wait, and come later by themselves, before a program's wait that was asked for
        after them. Newer ones that can run drop them, as those are of no more interest: an undo, or another preset.
        """
        admitted: list[Command] = self.passed()
        for command in commands:
            if isinstance(command, Advance) and self.held:
                self.programs.append(command)
                continue
            if not isinstance(command, Take):
                admitted.append(command)
                continue
            if self.is_ready(command.params):
                admitted += self.passed()  # of those that wait, what is ready by now
                self.held = [command]
            else:
                self.held = [take for take in merged([*self.held, command], self.params) if isinstance(take, Take)]
            admitted += self.passed()
        return admitted

    def passed(self) -> list[Command]:
        """Those of the parameters that wait that can run now, up to the first that cannot."""
        ready: list[Command] = []
        while self.held and self.is_ready(self.held[0].params):
            take = self.held.pop(0)
            self.params = take.params
            ready.append(take)
        if ready and not self.held:
            self.jobs.clear()
            self.notice = ""
            ready += self.programs
            self.programs.clear()
        return ready
