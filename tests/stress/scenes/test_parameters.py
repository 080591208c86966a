"""Every parameter of every scene, turned while the simulation runs."""

import os
import random

from app.messages import Play
from tests.stress.hammer import Hammer, anywhere, ends, some_command

CHANGES = int(os.environ.get("SPRINGTIDE_STRESS_CHANGES", "10000"))  # of the walk, for each scene
FRAMES = 3  # at each end
AT_ONCE = 10  # most parameters turned between two frames


def test_each_parameter_at_both_ends(hammer: Hammer) -> None:
    for name, parameter in hammer.parameters.items():
        before = getattr(hammer.viewer.settings.params, name)
        for value in ends(parameter):
            hammer.set(name, value)
            hammer.frame(FRAMES)
            hammer.go_on()
        hammer.set(name, before)
        hammer.frame()
        hammer.go_on()


def test_all_parameters_at_one_end_together(hammer: Hammer) -> None:
    for which in (0, -1):
        for name, parameter in hammer.parameters.items():
            hammer.set(name, ends(parameter)[which])
        hammer.frame(FRAMES)
        hammer.go_on()
        # The same one by one, so that each meets the others half turned.
        hammer.calm()
        for name, parameter in hammer.parameters.items():
            hammer.set(name, ends(parameter)[which])
            hammer.frame()
            hammer.go_on()


def test_random_walk_over_all_parameters(hammer: Hammer) -> None:
    rng = random.Random(f"walk {hammer.name}")
    names = list(hammer.parameters)
    done = 0
    while done < CHANGES:
        for _ in range(rng.randint(1, AT_ONCE)):
            name = rng.choice(names)
            hammer.set(name, anywhere(hammer.parameters[name], rng))
            done += 1
        if rng.random() < 0.3:
            hammer.loop.commands.put(some_command(rng))
        hammer.frame()
        hammer.go_on()
        if not hammer.loop.run.running and not hammer.loop.run.halted:
            hammer.loop.commands.put(Play())
    hammer.calm()
