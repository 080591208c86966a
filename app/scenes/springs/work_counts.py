"""Work counts of a scene of springs: what it computed and what it left out."""

import collections

from app.messages import WorkCount
from sim.springs import Net

SURFACE_COUNT = 2  # surfaces that a net may touch: floor and sphere


class SpringWorkCounts:
    """Filled by a scene frame by frame."""

    def __init__(self) -> None:
        self.done: collections.Counter[str] = collections.Counter()
        self.skipped: collections.Counter[str] = collections.Counter()

    def update(self, net: Net, force_evals: int, steps: int, *, with_account: bool) -> None:
        """Count a frame of `steps` steps. Every force evaluation tests each point against each surface present.

        with_account: whether the energy account was kept.
        """
        points = net.shape[0] * net.shape[1]
        surfaces = (net.floor is not None) + (net.sphere is not None)
        self.done["force evaluations"] += force_evals
        self.done["points held against floor or sphere"] += force_evals * points * surfaces
        self.skipped["points held against floor or sphere"] += force_evals * points * (SURFACE_COUNT - surfaces)
        self.add("steps with their energy balance", steps, with_account)

    def add(self, name: str, number: int, done: bool) -> None:
        """Count `number` pieces of work as done, or as skipped."""
        (self.done if done else self.skipped)[name] += number

    def __call__(self) -> dict[str, WorkCount]:
        """The counts since the scene was made."""
        names = sorted({*self.done, *self.skipped})
        return {name: WorkCount(self.done[name], self.skipped[name]) for name in names}
