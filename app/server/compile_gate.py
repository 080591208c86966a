"""Holds back parameters that run what is not compiled yet, until it is: a compiler would stop the page."""

from collections.abc import Callable

from app.messages import BaseParams, Command, Load
from app.scenes.compiling import Compiling, Job
from app.scenes.contract import AnyKind


class CompileGate:
    """Stands between the panel and the simulation of one scene. The scene goes on with what it has until then."""

    def __init__(
        self,
        compiling: Compiling,
        kind: AnyKind,
        post: Callable[[Command], None],
        state: tuple[BaseParams, int],
    ) -> None:
        """post: takes commands for the simulation. state: parameters that run, and the number of the last `Load`."""
        self.compiling, self.kind, self.pass_on = compiling, kind, post
        self.passed = state
        self.held: Load | None = None
        self.asked: BaseParams | None = None  # parameters that `jobs` are of
        self.jobs: list[Job] = []  # still to be compiled for them
        self.notice = ""  # what is waited for, in words

    def is_ready(self, params: BaseParams) -> bool:
        """Whether all is compiled that these parameters run; if not, it is compiled next."""
        if params is not self.asked:  # what they need is asked for once, and not in each tick
            self.asked, self.jobs = params, self.compiling.missing(self.kind.name, params)
            if self.jobs:
                self.compiling.want(self.jobs)
                names = ", ".join(job.piece for job in self.jobs)
                self.notice = f"Compiling {names}: starts by itself when it is ready."
        self.jobs = [job for job in self.jobs if job not in self.compiling.settled]
        return not self.jobs

    def post(self, command: Command) -> None:
        """A command of the panel; called on viser's event loop."""
        if isinstance(command, Load):
            self.held = None if self.is_ready(command.params) else command
            if self.held is not None:
                return
        self.pass_on(command)

    def read(self, state: tuple[BaseParams, int]) -> tuple[BaseParams, int]:
        """The parameters to run with, of those that the panel has; called on the simulation thread in each tick."""
        if state is not self.passed:
            if not self.is_ready(state[0]):
                return self.passed
            held, self.held = self.held, None
            if held is not None:
                self.pass_on(held)
            self.passed, self.notice = state, ""
        return self.passed
