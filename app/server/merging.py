"""Coalescing of waiting commands: those that a later one supersedes are dropped, the others keep their order."""

import itertools
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from app.messages import (
    Advance,
    Ask,
    BaseParams,
    Command,
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
from sim.parameters import EFFECTS, Effect, effect_of_change

Motion = Play | Pause | TogglePlay | Halt  # what leaves the scene alone


class Record(NamedTuple):
    """Parameters, and the number of the act with which the run that has them begins."""

    params: BaseParams
    act: int


def merged(commands: Iterable[Command], record: Record) -> list[Command]:
    """The commands that have the same effect as all of them in order. record: that of the scene before.

    Only neighbours are merged, so that nothing moves past what might depend on it.
    """
    kept: list[Command] = []
    for command in commands:
        match kept[-1] if kept else None, command:
            case (_, Take(start=True, back=False)):
                while kept and is_begun_over(kept[-1]):
                    kept.pop()  # nothing of it is left once the scene has begun again, and runs
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
    """True if nothing of a command is left once the scene has begun again, nor in the run that an undo goes back to."""
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
    """Drop the last changes of parameters as far as `change` alone does what they and it do in order."""
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
    """A record, and those to which the commands lead from it one after the other."""
    records = [record]
    for command in commands:
        if isinstance(command, Take | Reset):
            last = records[-1]
            params = command.params if isinstance(command, Take) else last.params
            records.append(Record(params, command.act or last.act))
    return records


def effect_between(before: Record, after: Record) -> Effect | None:
    """Effect of going from one record to another: another act begins another run."""
    return "start" if before.act != after.act else effect_of_change(before.params, after.params)


def is_one_change(records: Sequence[Record]) -> bool:
    """True if going from the first record to the last at once does what it does by the others.

    Other forces count from the next step on, so that of several the last ones count: a net whose number of points
    changes twice is interpolated once. A scene that has begun again and then takes other forces need not be as one that
    begins with these.
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
    """True if the scene begins from its start after this command, whatever it is like before."""
    return isinstance(command, Reset) or (isinstance(command, Take) and command.start)


def is_urgent(command: Command) -> bool:
    """True if a command should not wait for a long solve.

    Drags, going on and those of a waiting program may; a change of parameters as its effect asks for.
    """
    if isinstance(command, Take):
        return not command.changes_only
    return not isinstance(command, SceneCommand | Play | Ask | Advance)


def effect_of_takes(record: Record, commands: Iterable[Command]) -> tuple[BaseParams, Effect | None]:
    """The last parameters that commands bring, and the greatest effect on the way to them from `record`."""
    records = records_of(record, commands)
    effects: list[Effect | None] = [effect_between(a, b) for a, b in itertools.pairwise(records)]
    return records[-1].params, max(effects, key=rank, default=None)
