"""Commands before a tick: which pass, wait, are superseded, or cancel a solve.

Parameters wait until the kernels that they need are compiled, since compiling here would freeze the page. Nothing
overtakes what it may depend on.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Literal, NamedTuple

from app.messages import (
    Advance,
    Ask,
    BaseParams,
    Begin,
    Change,
    Command,
    GoBack,
    GoOn,
    GrabTo,
    Halt,
    Pause,
    Place,
    Play,
    RecordCommand,
    Release,
    Reset,
    Resume,
    SceneCommand,
    StepOnce,
    StudentAnswer,
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


def merged(commands: Iterable[Command]) -> list[Command]:
    """The shortest commands with the effect of all in order.

    Only neighbours are merged, so that no command overtakes another that it may depend on.
    """
    short: list[Command] = []
    for command in commands:
        match short[-1] if short else None, command:
            case (_, Begin()):
                while short and isinstance(short[-1], Change | Begin | Reset):
                    short.pop()  # the new run leaves nothing of it, neither here nor in what an undo restores
            case (Change(), Change()):
                command = merge_changes(short, command)
            case (StepOnce(before), StepOnce(steps)):
                short.pop()
                command = StepOnce(before + steps)
            case (last, _) if last is not None and repeats(last, command):
                short.pop()
            case _:
                pass
        short.append(command)
    return short


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


def merge_changes(commands: list[Command], change: Change) -> Change:
    """Drop the last changes that one can do together with `change`; returns it, with the greatest of their effects."""
    effects: list[Effect] = [change.effect]
    most, number = 0, 0  # of changes: to drop, and seen
    for before in reversed(commands):
        if not isinstance(before, Change):
            break
        effects.insert(0, before.effect)
        number += 1
        most = number if is_one_change(effects) else most
    if most == 0:
        return change
    del commands[-most:]
    return change._replace(effect=max(effects[number - most :], key=EFFECTS.index))


def is_one_change(effects: Sequence[Effect]) -> bool:
    """True if one change can replace several with these effects.

    Changed forces act from the next step on, so that only the last of several count: a net whose number of points
    changes twice is interpolated once. A scene that begins and then takes other forces may differ from one that begins
    with these.
    """
    begins = [number for number, effect in enumerate(effects) if effect == "start"]
    return not begins or "forces" not in effects[begins[-1] :]


def record_after(record: Record, command: Command) -> Record:
    """The record after a command."""
    match command:
        case Change(params, _, act) | Begin(params, act) | Resume(params, _, act) | GoBack(params, act):
            return Record(params, act or record.act)
        case Reset(act):
            return Record(record.params, act or record.act)
        case GoOn(act):
            return Record(record.params, act)
        case _:
            return record


def effect_after(record: Record, params: BaseParams, act: int) -> Effect | None:
    """Effect of going from a record to the parameters of an act: another act has another run."""
    return "start" if act not in (0, record.act) else effect_of_change(record.params, params)


def effect_of(command: Command, record: Record) -> Effect | None:
    """Effect of a command after a record; None if it changes no parameters and begins nothing.

    A change carries its own. Going back may lead to the present run, if the run that it leaves has never begun.
    """
    match command:
        case Change(_, effect):
            return effect
        case Begin() | Resume() | Reset():
            return "start"
        case GoBack(params, act):
            return effect_after(record, params, act)
        case _:
            return None


def effect_of_all(record: Record, commands: Iterable[Command]) -> tuple[BaseParams, Effect | None]:
    """The last parameters of the commands, and the greatest effect on the way to them from `record`."""
    greatest: Effect | None = None
    for command in commands:
        effect = effect_of(command, record)
        if effect is not None and (greatest is None or EFFECTS.index(effect) > EFFECTS.index(greatest)):
            greatest = effect
        record = record_after(record, command)
    return record.params, greatest


def is_urgent(command: Command) -> bool:
    """True if a command should not wait for a long solve.

    Drags and commands of a waiting program may wait; a change of parameters depends on its effect.
    """
    return not isinstance(command, Change | SceneCommand | Play | GoOn | Ask | Advance)


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
        drop: Callable[[RecordCommand], None] = lambda command: None,
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
            if isinstance(command, RecordCommand):
                admitted += self.passed(command)
            elif self.held and isinstance(command, Advance | Reset | GoOn):
                self.held.append(command)
            else:
                admitted.append(command)
                self.note([command])
        return admitted

    def passed(self, newer: RecordCommand | None = None) -> list[Command]:
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
            if isinstance(command, RecordCommand) and not self.is_ready(command.params):
                break
            count += 1
        ready, self.held = self.held[:count], self.held[count:]
        self.note(ready)
        if ready and not self.held:
            self.jobs.clear()
            self.notice = ""
        return ready

    def drop_held(self, newer: RecordCommand) -> list[Command]:
        """The waiting commands without those that newer parameters make obsolete.

        An undo goes back past all of them. Other parameters that can run replace the waiting ones, and begin the run of
        their act or return to it, unless they follow a moment, which has its own parameters.
        """
        waiting = [command for command in self.held if isinstance(command, RecordCommand)]
        if not isinstance(newer, GoBack) and not self.is_ready(newer.params):
            return merged([*self.held, newer])
        if isinstance(newer, Change):
            if any(isinstance(command, Resume) for command in waiting):
                return merged([*self.held, newer])
            newer = self.in_place_of(waiting, newer)
        for command in waiting:
            self.drop(command)
        return [newer, *(command for command in self.held if isinstance(command, Advance))]

    def in_place_of(self, waiting: Sequence[RecordCommand], change: Change) -> RecordCommand:
        """The command that replaces a change and the waiting ones before it.

        Those never reach the loop, so that its effect is that of going there from the loop's record.
        """
        params, _, act = change
        backs = [command for command in waiting if isinstance(command, GoBack)]
        if any(command.act == act for command in backs):
            return GoBack(params, act, any(command.runs for command in backs))
        if any(isinstance(command, Begin) for command in waiting):
            return Begin(params, act)
        return change._replace(effect=effect_after(self.record, params, act) or "look")

    def note(self, commands: Iterable[Command]) -> None:
        """Note the record after the handled commands."""
        for command in commands:
            self.record = record_after(self.record, command)
