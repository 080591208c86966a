"""Counts for the ledger what a scene of springs computes and what it leaves out."""

import collections

from app.messages import WorkCount
from sim.springs import Net

SURFACES = 2  # that a net may meet: floor and sphere


class SpringWorkCounts:
    """Filled by a scene frame by frame."""

    def __init__(self) -> None:
        self.done: collections.Counter[str] = collections.Counter()
        self.skipped: collections.Counter[str] = collections.Counter()

    def take(self, net: Net, force_evals: int, steps: int, *, with_account: bool) -> None:
        """A frame of `steps` steps: every force evaluation holds each point against each surface there is."""
        points = net.shape[0] * net.shape[1]
        there = (net.floor is not None) + (net.sphere is not None)
        self.done["force evaluations"] += force_evals
        self.done["points held against floor or sphere"] += force_evals * points * there
        self.skipped["points held against floor or sphere"] += force_evals * points * (SURFACES - there)
        self.add("steps with their energy balance", steps, with_account)

    def add(self, what: str, number: int, done: bool) -> None:
        """Count `number` pieces of work as done, or as not needed."""
        (self.done if done else self.skipped)[what] += number

    def __call__(self) -> dict[str, WorkCount]:
        """What the scene's `work()` answers."""
        names = sorted({*self.done, *self.skipped})
        return {name: WorkCount(self.done[name], self.skipped[name]) for name in names}
