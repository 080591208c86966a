"""The number of threads that is chosen, with a clock that counts what each costs."""

import pytest

from app.scenes.springs.thread_tuner import MAX_PART_STEPS, TRIAL_INTERVAL, TRIAL_STEPS, ThreadTuner


class Machine:
    """A clock that advances by what each step costs."""

    def __init__(self, one: float, two: float) -> None:
        self.costs = {1: one, 2: two}
        self.now = 0.0
        self.taken = {1: 0, 2: 0}

    def take(self, threads: int, steps: int) -> None:
        self.now += self.costs[threads] * steps
        self.taken[threads] += steps

    def run(self, tuner: ThreadTuner, frames: int, steps: int = 80, *, large: bool = True) -> None:
        for _ in range(frames):
            before = sum(self.taken.values())
            tuner.advance(steps, self.take, large=large)
            assert sum(self.taken.values()) == before + steps
            self.now += 1 / 60


def test_two_threads_are_used_where_they_are_faster():
    machine = Machine(50e-6, 27e-6)
    tuner = ThreadTuner(clock=lambda: machine.now, count=2)
    machine.run(tuner, 600)
    assert tuner.threads == 2
    assert machine.taken[2] > 20 * machine.taken[1]


@pytest.mark.parametrize("two", [49e-6, 60e-6, 6e-3])
def test_where_they_are_slower_they_are_only_tried_from_time_to_time(two: float):
    machine = Machine(50e-6, two)
    tuner = ThreadTuner(clock=lambda: machine.now, count=2)
    machine.run(tuner, 600)
    assert tuner.threads == 1
    assert 0 < machine.taken[2] <= TRIAL_STEPS * (2 + machine.now / TRIAL_INTERVAL)


def test_a_machine_that_becomes_busy_costs_one_part():
    machine = Machine(50e-6, 27e-6)
    tuner = ThreadTuner(clock=lambda: machine.now, count=2)
    machine.run(tuner, 60)
    before, machine.costs[2] = machine.taken[2], 6e-3
    machine.run(tuner, 5)
    assert tuner.threads == 1
    assert machine.taken[2] - before <= MAX_PART_STEPS


def test_small_nets_and_single_tuner_never_try():
    machine = Machine(50e-6, 27e-6)
    machine.run(ThreadTuner(clock=lambda: machine.now, count=2), 300, large=False)
    machine.run(ThreadTuner(clock=lambda: machine.now, count=1), 300)
    assert machine.taken[2] == 0
