"""Coalescing of waiting commands: the latest of those that supersede each other is left."""

from collections.abc import Iterable
from typing import Literal

from app.messages import (
    Advance,
    Ask,
    Command,
    Grab,
    Halt,
    Load,
    Pause,
    Place,
    Play,
    Point,
    Release,
    Reset,
    SceneCommand,
    StepOnce,
    StudentAnswer,
    TogglePlay,
)

Motion = Literal["play", "pause", "toggle"]
AFTER: dict[tuple[Motion | None, type], Motion | None] = {  # (waiting, next) -> what both together ask for
    ("play", TogglePlay): "pause",
    ("pause", TogglePlay): "play",
    ("toggle", TogglePlay): None,
    (None, TogglePlay): "toggle",
}
COMMAND_OF: dict[Motion, Command] = {"play": Play(), "pause": Pause(), "toggle": TogglePlay()}


def merged(commands: Iterable[Command]) -> list[Command]:
    """The commands that have the same effect as all of them in order.

    Of presets and resets the last is left, and nothing that a scene was asked for before it; single steps are added
    up; of the positions of one thing, and of the drags of one browser, the last is left. What a program waits for comes
    last, in order.
    """
    halt: Halt | None = None
    start: Load | Reset | None = None
    motion: Motion | None = None
    steps = 0
    asked: list[Command] = []
    scene: dict[tuple[str, str | int], SceneCommand] = {}
    for command in commands:
        match command:
            case Halt():
                halt = halt or command
            case Load():
                start, steps, motion = command, 0, None  # it starts the run
                scene.clear()
            case Reset():
                start = start if isinstance(start, Load) else command
                steps = 0
                scene.clear()
            case Play() | Pause() | TogglePlay():
                steps = 0 if isinstance(command, Play) else steps
                motion = AFTER.get((motion, type(command)), "play" if isinstance(command, Play) else "pause")
            case StepOnce(more):
                steps, motion = steps + more, "pause"
            case Place(thing, _):
                put_last(scene, ("place", thing), command)
            case Grab() | Release():
                put_last(scene, ("drag", command.client), command)
            case Point():
                put_last(scene, ("point", ""), command)
            case StudentAnswer():
                put_last(scene, ("student", ""), command)
            case Ask() | Advance():
                asked.append(command)
    found: list[Command] = [halt] if halt else []
    if start is not None:
        found.append(start)
    found.extend(scene.values())
    if steps:
        found.append(StepOnce(steps))
    if motion is not None and not (steps and motion == "pause"):  # a step pauses the run
        found.append(COMMAND_OF[motion])
    return found + asked


def begins_anew(command: Command) -> bool:
    """True if the scene begins from its start after this command."""
    return isinstance(command, Reset) or (isinstance(command, Load) and command.state is None)


def is_urgent(command: Command) -> bool:
    """True if a command should not wait for a long solve: all but drags, going on, and those of a waiting program."""
    return not isinstance(command, SceneCommand | Play | Ask | Advance)


def put_last(waiting: dict[tuple[str, str | int], SceneCommand], key: tuple[str, str | int], new: SceneCommand) -> None:
    """Replace the waiting command of a key, and move it to the end: the order of the latest ones is kept."""
    waiting.pop(key, None)
    waiting[key] = new
