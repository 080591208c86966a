"""The table of the states of a run: the next state for each event.

The reason of a halt, the moments of a replay and the beginning to repeat are data of a state. A goal of a program and
an awaited event are facts: they cause an event when they are reached.
"""

from collections.abc import Mapping
from enum import Enum

from app.messages import RunState


class Event(Enum):
    """Event that changes the state of a run."""

    PLAY = "play"
    PAUSE = "pause"  # a single step and the end of a wait pause, too
    ADVANCE = "advance"  # a program waits for a simulated time
    HALT = "halt"  # an error; of a scene that is beginning: it cannot begin
    REPLAY = "replay"  # show the last moments of a divergence, or go on with them
    RESTART = "restart"  # from the start of the scene, playing or paused as before; a run that has stopped plays
    BEGIN = "begin"  # from the start of the scene, playing
    BEGIN_PAUSED = "begin paused"  # the same of a run that was left paused
    RESUME = "resume"  # from a checkpoint, playing
    CANCEL = "cancel"  # a control cancels a solve without which there is no scene to run
    MADE = "made"  # the scene has begun


class IllegalEventError(RuntimeError):
    """An event that is impossible in the state of a run: a fault of the program."""


MAKING, MAKING_PAUSED, UNMADE = RunState.MAKING, RunState.MAKING_PAUSED, RunState.UNMADE
RUNNING, PAUSED, HALTED = RunState.RUNNING, RunState.PAUSED, RunState.HALTED
REPLAYING, REPLAY_PAUSED = RunState.REPLAYING, RunState.REPLAY_PAUSED

ALWAYS = {Event.BEGIN: MAKING, Event.BEGIN_PAUSED: MAKING_PAUSED, Event.RESUME: RUNNING}

TABLE: dict[RunState, Mapping[Event, RunState]] = {
    MAKING: {
        **ALWAYS, Event.PLAY: MAKING, Event.PAUSE: MAKING_PAUSED, Event.HALT: UNMADE, Event.RESTART: MAKING,
        Event.CANCEL: MAKING, Event.MADE: RUNNING,
    },
    MAKING_PAUSED: {
        **ALWAYS, Event.PLAY: MAKING, Event.PAUSE: MAKING_PAUSED, Event.HALT: UNMADE, Event.RESTART: MAKING_PAUSED,
        Event.CANCEL: MAKING_PAUSED, Event.MADE: PAUSED,
    },
    UNMADE: {
        **ALWAYS, Event.PLAY: UNMADE, Event.PAUSE: UNMADE, Event.ADVANCE: UNMADE, Event.HALT: UNMADE,
        Event.RESTART: MAKING,
    },
    RUNNING: {
        **ALWAYS, Event.PLAY: RUNNING, Event.PAUSE: PAUSED, Event.ADVANCE: RUNNING, Event.HALT: HALTED,
        Event.REPLAY: REPLAYING, Event.RESTART: MAKING, Event.CANCEL: MAKING,
    },
    PAUSED: {
        **ALWAYS, Event.PLAY: RUNNING, Event.PAUSE: PAUSED, Event.ADVANCE: RUNNING, Event.HALT: HALTED,
        Event.RESTART: MAKING_PAUSED, Event.CANCEL: MAKING_PAUSED,
    },
    REPLAYING: {
        **ALWAYS, Event.PAUSE: REPLAY_PAUSED, Event.ADVANCE: REPLAY_PAUSED, Event.HALT: HALTED, Event.REPLAY: REPLAYING,
        Event.RESTART: MAKING, Event.CANCEL: MAKING,
    },
    REPLAY_PAUSED: {
        **ALWAYS, Event.PAUSE: REPLAY_PAUSED, Event.ADVANCE: REPLAY_PAUSED, Event.HALT: HALTED, Event.REPLAY: REPLAYING,
        Event.RESTART: MAKING_PAUSED, Event.CANCEL: MAKING_PAUSED,
    },
    HALTED: {
        **ALWAYS, Event.PLAY: RUNNING, Event.PAUSE: HALTED, Event.ADVANCE: HALTED, Event.HALT: HALTED,
        Event.REPLAY: REPLAYING, Event.RESTART: MAKING, Event.CANCEL: MAKING,
    },
}  # fmt: skip


def state_after(state: RunState, event: Event) -> RunState:
    """The state of a run after an event. Raises IllegalEventError if the table has none."""
    if event not in TABLE[state]:
        raise IllegalEventError(f"a run that is {state.value} cannot meet {event.value}")
    return TABLE[state][event]
