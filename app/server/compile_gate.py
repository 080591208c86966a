"""Holds back parameters that run what is not compiled yet, until it is: a compiler would stop the page."""

from collections.abc import Callable

from app.messages import BaseParams, Command, Load
from app.scenes.compiling import Compiling
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
        self.notice = ""  # what is waited for, in words

    def is_ready(self, params: BaseParams) -> bool:
        """Whether all is compiled that these parameters run; if not, it is compiled next."""
        jobs = self.compiling.missing(self.kind.name, params)
        if jobs:
            self.compiling.want(jobs)
            self.notice = f"Compiling {', '.join(job.piece for job in jobs)}: starts by itself when it is ready."
        return not jobs

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
