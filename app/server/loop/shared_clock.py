"""One clock for several simulation loops: all advance by the same simulated time, and the slowest sets the speed.

The clock's time rises with the wall clock, but at most to `LEAD` after the next step of the slowest loop. Each loop
takes the steps up to the clock's time. Once the clock stands still, all reach it, so that their times differ by less
than a step.

Only the loop of the first seat writes the clock's time. Each seat's numbers are written by its own loop, which also
passes common commands on to the others.
"""

import queue

from app.messages import Command, Pause, Play, Reset, StepOnce, TogglePlay

LEAD = 0.05  # [s] of wall time by which running loops may differ: they draw at different moments
MAX_DEBT = 0.25  # [s] of wall time that the clock makes up for
MAX_HAND_STEPS = 100  # single steps that one command takes


class Seat:
    """A loop's place at the clock."""

    def __init__(self, clock: "SharedClock") -> None:
        self.clock = clock
        self.told: queue.SimpleQueue[Command] = queue.SimpleQueue()  # commands from the other loops
        self.offset = clock.origin  # [s] of the clock when the scene's time was 0
        self.reached = clock.origin  # [s] of the clock reached by the loop
        self.step = 0.0  # [s] of the scene
        self.pace = 1.0  # factor on the speed requested by the scene
        self.running = True
        self.halted = False

    @property
    def is_first(self) -> bool:
        """True if this loop advances the clock."""
        return self.clock.seats[:1] == (self,)

    def due(self, time: float, step: float) -> int:
        """Number of steps [s] of a scene at `time` [s] to the clock's time."""
        return max(0, int((self.clock.time - self.offset - time) / step * (1 + 1e-9) + 1e-6))

    def note(self, time: float, step: float, pace: float, *, running: bool, halted: bool) -> None:
        """Record the state of the loop: its scene's time and step [s], and its pace."""
        self.running, self.halted, self.pace = running, halted, pace
        self.reached, self.step = self.offset + time, step

    def begin(self) -> None:
        """Note a restart with all others: the run's time is 0 at the present time of the clock."""
        self.offset = self.clock.origin

    def go_on_from(self, time: float) -> None:
        """Resume from another time [s] of the run; from here on it advances as the others do."""
        self.offset = self.clock.time - time

    def begin_others(self) -> None:
        """Restart all other runs with this one."""
        if self in self.clock.seats:
            self.clock.origin = self.clock.time
            self.tell_others(Reset())

    def tell_others(self, command: Command) -> None:
        """Pass a command to all other loops; one that has lost its place tells nobody."""
        seats = self.clock.seats
        if self in seats:
            for seat in seats:
                if seat is not self:
                    seat.told.put(command)

    def share(self, command: Command) -> Command:
        """Pass shared commands to the other loops; returns the commands for this one."""
        match command:
            case TogglePlay():
                return self.share(Pause() if self.running else Play())
            case Play() | Pause() | StepOnce():
                self.tell_others(command)
            case Reset():
                self.begin_others()
                if any(seat.halted for seat in self.clock.seats):  # the halted one has paused the others
                    self.tell_others(Play())
                    self.told.put(Play())
            case _:
                pass
        return command


class SharedClock:
    """The clock. `seats` is replaced as a whole by another thread when a loop joins or leaves, and may be empty."""

    def __init__(self) -> None:
        self.time = 0.0  # [s] simulated
        self.origin = 0.0  # [s] of `time` at the last start of the runs
        self.debt = 0.0  # [s] simulated by which `time` is late
        self.late = False  # True while time that could not be made up is dropped
        self.seats: tuple[Seat, ...] = ()

    def advance(self, wall: float, speed: float) -> None:
        """Let `wall` seconds pass at `speed`, as far as all loops can follow; called by the first seat's loop.

        If one scene requests slow motion, all have it.
        """
        speed *= min((seat.pace for seat in self.seats), default=1.0)
        most = MAX_DEBT * speed
        self.debt += wall * speed
        self.late = self.debt > most
        room = min((seat.reached + seat.step for seat in self.seats), default=self.time) + LEAD * speed - self.time
        taken = max(0.0, min(self.debt, most, room))
        self.time += taken
        self.debt = min(self.debt, most) - taken

    def step_by_hand(self, count: int) -> None:
        """Let all loops take single steps: at least `count` of the longest; called by the first seat's loop."""
        self.debt = 0.0
        self.time += min(count, MAX_HAND_STEPS) * max((seat.step for seat in self.seats), default=0.0)
