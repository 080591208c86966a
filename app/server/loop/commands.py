"""Commands before a tick: which pass, wait, are superseded, or cancel a solve.

Parameters wait until the kernels that they need are compiled, since compiling here would freeze the page. Nothing
overtakes what it may depend on.
"""

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Literal, NamedTuple

from app.messages import (
    Advance,
    Ask,
    BaseParams,
    Command,
    GoOn,
    GrabTo,
    Halt,
    Pause,
    Place,
    Play,
    Release,
    Reset,
    SceneCommand,
    StepOnce,
    StudentAnswer,
    Take,
    TogglePlay,
)
from app.scenes.ahead.compiling import Compiling, Job
from app.scenes.contract import AnyKind
from sim.parameters import EFFECTS, Effect, effect_of_change

Motion = Play | Pause | TogglePlay | Halt  # transport commands: they do not touch the scene


class Record(NamedTuple):
    """Parameters, and the number of the act that begins their run."""

    params: BaseParams
    act: int


def merged(commands: Iterable[Command], record: Record) -> list[Command]:
    """The shortest commands with the effect of all in order. record: that of the scene before.

    Only neighbours are merged, so that no command overtakes another that it may depend on.
    """
    kept: list[Command] = []
    for command in commands:
        match kept[-1] if kept else None, command:
            case (_, Take(start=True, back=False)):
                while kept and is_begun_over(kept[-1]):
                    kept.pop()  # the new run leaves nothing of it
            case (Take(), Take()) if command.changes_only:
                drop_changes(kept, command, record)
            case (StepOnce(before), StepOnce(steps)):
                kept.pop()
                command = StepOnce(before + steps)
            case (last, _) if last is not None and repeats(last, command):
                kept.pop()
            case _:
                pass
        kept.append(command)
    return kept


def is_begun_over(command: Command) -> bool:
    """True if a restart leaves nothing of a command, neither in the new run nor in the one that an undo restores."""
    if isinstance(command, Take):
        return command.state is None and not command.back
    return isinstance(command, Reset)


def repeats(earlier: Command, later: Command) -> bool:
    """True if the later one of two neighbours does all that both do."""
    match earlier, later:
        case (Place(thing), Place(other)):
            return thing == other
        case (GrabTo(particle, _, client), GrabTo(other, _, by)):
            return (particle, client) == (other, by)
        case (Release(client), Release(by)):
            return client == by
        case (Reset(first), Reset(second)):
            return second != 0 or first == 0
        case (StudentAnswer(), StudentAnswer()):
            return True
        case _:
            return False


def drop_changes(kept: list[Command], change: Take, record: Record) -> None:
    """Drop the last changes of parameters, as long as `change` alone has the effect of all in order."""
    last = len(kept)
    while last and isinstance(before := kept[last - 1], Take) and before.changes_only:
        last -= 1
    chain = len(kept) - last
    records = records_of(record, [*kept, change])[-chain - 2 :]  # the first is the one before the chain
    for dropped in range(chain, 0, -1):
        if is_one_change(records[-dropped - 2 :]):
            del kept[-dropped:]
            return


def records_of(record: Record, commands: Iterable[Command]) -> list[Record]:
    """A record, followed by the record after each command."""
    records = [record]
    for command in commands:
        if isinstance(command, Take | Reset):
            last = records[-1]
            params = command.params if isinstance(command, Take) else last.params
            records.append(Record(params, command.act or last.act))
        elif isinstance(command, GoOn):  # no other run
            records[-1] = records[-1]._replace(act=command.act)
    return records


def effect_between(before: Record, after: Record) -> Effect | None:
    """Effect of going from one record to another: another act begins another run."""
    return "start" if before.act != after.act else effect_of_change(before.params, after.params)


def is_one_change(records: Sequence[Record]) -> bool:
    """True if going from the first record to the last at once has the same effect as through the others.

    Changed forces act from the next step on, so that only the last of several count: a net whose number of points
    changes twice is interpolated once. A scene that begins and then takes other forces may differ from one that begins
    with these.
    """
    effects: list[Effect | None] = [effect_between(a, b) for a, b in itertools.pairwise(records)]
    begins = [number for number, effect in enumerate(effects) if effect == "start"]
    if begins and "forces" in effects[begins[-1] :]:
        return False
    return rank(effect_between(records[0], records[-1])) >= max(map(rank, effects))


def rank(effect: Effect | None) -> int:
    """Effects in order: a greater one includes the smaller ones."""
    return -1 if effect is None else EFFECTS.index(effect)


def begins_anew(command: Command) -> bool:
    """True if the scene starts from its beginning after this command, whatever its state before."""
    return isinstance(command, Reset) or (isinstance(command, Take) and command.start)


def is_urgent(command: Command) -> bool:
    """True if a command should not wait for a long solve.

    Drags, resuming and commands of a waiting program may wait; a change of parameters depends on its effect.
    """
    if isinstance(command, Take):
        return not command.changes_only
    return not isinstance(command, SceneCommand | Play | GoOn | Ask | Advance)


def effect_of_takes(record: Record, commands: Iterable[Command]) -> tuple[BaseParams, Effect | None]:
    """The last parameters of the commands, and the greatest effect on the way to them from `record`."""
    records = records_of(record, commands)
    effects: list[Effect | None] = [effect_between(a, b) for a, b in itertools.pairwise(records)]
    return records[-1].params, max(effects, key=rank, default=None)


class Activity(NamedTuple):
    """One solve. A new beginning of the scene cancels each of them."""

    kind: Literal["none", "steps", "beginning", "forces", "frame"]
    may_end: bool = False  # cancelled by every command that needs another solve, too


NOTHING = Activity("none")
STEPS = Activity("steps", may_end=True)  # the scene's frame is that of a whole step, even during one
BEGINNING = Activity("beginning")  # if it fails, there is no scene to run
OTHER_FORCES = Activity("forces")  # the scene's parameters are the old or the new ones


class CompileGate:
    """Holds back parameters of one scene until their kernels are compiled; the scene continues with the present ones.

    The simulation thread alone calls it and changes it; the viewer thread reads `notice`.
    """

    def __init__(
        self,
        compiling: Compiling,
        kind: AnyKind,
        record: Record,
        drop: Callable[[Take], None] = lambda take: None,
    ) -> None:
        """record: the running one. drop: called with each dropped one, which an undo may restore."""
        self.compiling, self.kind, self.drop = compiling, kind, drop
        self.record = record  # the last one handed over
        self.held: list[Command] = []  # parameters that wait for the compiler, and commands behind them
        self.jobs: dict[BaseParams, list[Job]] = {}  # pending compilations, each requested once
        self.notice = ""  # pending compilation, in words

    def is_ready(self, params: BaseParams) -> bool:
        """True if everything that these parameters run is compiled; otherwise it is compiled next."""
        if params not in self.jobs:
            self.jobs[params] = self.compiling.missing(self.kind.name, params)
            if self.jobs[params]:
                self.compiling.want(self.jobs[params])
                names = ", ".join(job.piece for job in self.jobs[params])
                self.notice = f"Compiling {names}: starts by itself when ready."
        self.jobs[params] = [job for job in self.jobs[params] if job not in self.compiling.settled]
        return not self.jobs[params]

    def admit(self, commands: Iterable[Command]) -> list[Command]:
        """The commands that can be handled now, in order.

        Parameters that cannot run yet wait, and are admitted later. A later reset, drag or wait of a program stays
        behind them. Other commands concern the scene that is shown, and pass. Newer parameters that can run drop those
        that wait (`drop_held`).
        """
        admitted = self.passed()
        for command in commands:
            if isinstance(command, Take):
                admitted += self.passed(command)
            elif self.held and isinstance(command, Advance | Reset | GoOn):
                self.held.append(command)
            else:
                admitted.append(command)
                self.note([command])
        return admitted

    def passed(self, newer: Take | None = None) -> list[Command]:
        """The waiting commands that can be handled now, up to the first that cannot. newer: comes after them."""
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
        """The waiting commands without those that newer parameters make obsolete.

        An undo goes back past all of them. Other parameters that can run replace the waiting ones, and begin the run of
        their act or return to it, unless they follow a moment, which has its own parameters.
        """
        waiting = [command for command in self.held if isinstance(command, Take)]
        if newer.changes_only:
            if not self.is_ready(newer.params) or any(take.state is not None for take in waiting):
                return merged([*self.held, newer], self.record)
            back = any(take.back and take.act == newer.act for take in waiting)
            newer = newer._replace(start=any(take.start and take.back == back for take in waiting), back=back)
        elif not newer.back and not self.is_ready(newer.params):
            return merged([*self.held, newer], self.record)
        for take in waiting:
            self.drop(take)
        return [newer, *(command for command in self.held if isinstance(command, Advance))]

    def note(self, commands: Iterable[Command]) -> None:
        """Note the record after the handled commands."""
        self.record = records_of(self.record, commands)[-1]
