"""The last moments of a run that diverged, shown one after the other."""

from app.messages import LastFrame

MOMENT_INTERVAL = 1 / 12  # [s] of wall time for which each moment is shown


class Replay:
    """Plays the moments of one divergence once; there is at least one moment."""

    def __init__(self, moments: tuple[LastFrame, ...], reason: str) -> None:
        """reason: why the run diverged."""
        self.moments, self.reason = moments, reason
        self.number = 0  # of the moment that is shown
        self.shown_for = 0.0  # [s] of wall time

    @property
    def moment(self) -> LastFrame:
        """The moment that is shown; the last one at the end."""
        return self.moments[self.number]

    @property
    def ended(self) -> bool:
        """True if all were shown."""
        return self.number == len(self.moments) - 1 and self.shown_for >= MOMENT_INTERVAL

    def play(self, wall: float) -> bool:
        """Continue by `wall` [s]; returns True if the shown moment has changed. A late tick skips none."""
        self.shown_for += wall
        if self.shown_for < MOMENT_INTERVAL or self.number == len(self.moments) - 1:
            return False
        self.step()
        return True

    def step(self) -> None:
        """Show the next moment; at the last one, end."""
        last = self.number == len(self.moments) - 1
        self.number, self.shown_for = (self.number, MOMENT_INTERVAL) if last else (self.number + 1, 0.0)
