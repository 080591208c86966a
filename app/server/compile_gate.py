"""Defers parameters until the kernels that they need are compiled; compiling here would freeze the page."""

from collections.abc import Iterable

from app.messages import Advance, BaseParams, Command, Reset, Take
from app.scenes.compiling import Compiling, Job
from app.scenes.contract import AnyKind
from app.server.merging import Record, merged, records_of


class CompileGate:
    """Holds back parameters of one scene until their kernels are compiled; the scene goes on with the present ones.

    The simulation thread alone calls it and changes it; the viewer thread reads `notice`.
    """

    def __init__(self, compiling: Compiling, kind: AnyKind, record: Record) -> None:
        """record: the one that runs."""
        self.compiling, self.kind = compiling, kind
        self.record = record  # the one that was handed over last
        self.held: list[Command] = []  # parameters that wait for the compiler, and what waits for them, in order
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

        Parameters that cannot run yet wait, and come later by themselves. A reset and a program's wait that were asked
        for after them come after them. Other commands concern the scene that is shown, and pass. Newer parameters that
        can run drop those that wait (`drop_held`).
        """
        admitted = self.passed()
        for command in commands:
            if isinstance(command, Take):
                admitted += self.passed(command)
            elif self.held and isinstance(command, Advance | Reset):
                self.held.append(command)
            else:
                admitted.append(command)
                self.note([command])
        return admitted

    def passed(self, newer: Take | None = None) -> list[Command]:
        """The commands that wait and can be handled now, up to the first that cannot. newer: comes after them."""
        passed = self.pop_ready()
        if newer is not None:
            self.held = self.drop_held(newer) if self.held else [newer]
            passed += self.pop_ready()
        return passed

    def pop_ready(self) -> list[Command]:
        """Take out those that can be handled now."""
        count = 0
        for command in self.held:
            if isinstance(command, Take) and not self.is_ready(command.params):
                break
            count += 1
        ready, self.held = self.held[:count], self.held[count:]
        self.note(ready)
        if ready and not self.held:
            self.jobs.clear()
            self.notice = ""
        return ready

    def drop_held(self, newer: Take) -> list[Command]:
        """What waits once newer parameters have come: without those that are of no more interest.

        An undo goes back past all that waits. Other parameters that can run take the place of those that wait, and
        begin the run of their act or go back to it, but where they come after a moment: that has parameters of its own.
        """
        waiting = [command for command in self.held if isinstance(command, Take)]
        if newer.changes_only:
            if not self.is_ready(newer.params) or any(take.state is not None for take in waiting):
                return merged([*self.held, newer], self.record)
            back = any(take.back and take.act == newer.act for take in waiting)
            newer = newer._replace(start=any(take.start and take.back == back for take in waiting), back=back)
        elif not newer.back and not self.is_ready(newer.params):
            return merged([*self.held, newer], self.record)
        return [newer, *(command for command in self.held if isinstance(command, Advance))]

    def note(self, commands: Iterable[Command]) -> None:
        """Note the record to which commands that are handled lead."""
        self.record = records_of(self.record, commands)[-1]
