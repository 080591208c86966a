"""Which number of threads is taken, with a clock that says what each costs."""

import pytest

from app.scenes.springs.thread_tuner import PIECE, TRIAL, TRY_EVERY, ThreadTuner


class Machine:
    """A clock that advances by what each step costs."""

    def __init__(self, one: float, two: float) -> None:
        self.costs = {1: one, 2: two}
        self.now = 0.0
        self.taken = {1: 0, 2: 0}

    def take(self, threads: int, steps: int) -> None:
        self.now += self.costs[threads] * steps
        self.taken[threads] += steps

    def run(self, cores: ThreadTuner, frames: int, steps: int = 80, *, large: bool = True) -> None:
        for _ in range(frames):
            before = sum(self.taken.values())
            cores.advance(steps, self.take, large=large)
            assert sum(self.taken.values()) == before + steps
            self.now += 1 / 60


def test_two_threads_are_taken_where_they_are_quicker():
    machine = Machine(50e-6, 27e-6)
    cores = ThreadTuner(clock=lambda: machine.now, count=2)
    machine.run(cores, 600)
    assert cores.threads == 2
    assert machine.taken[2] > 20 * machine.taken[1]


@pytest.mark.parametrize("two", [49e-6, 60e-6, 6e-3])
def test_elsewhere_they_are_only_tried_now_and_then(two: float):
    machine = Machine(50e-6, two)
    cores = ThreadTuner(clock=lambda: machine.now, count=2)
    machine.run(cores, 600)
    assert cores.threads == 1
    assert 0 < machine.taken[2] <= TRIAL * (2 + machine.now / TRY_EVERY)


def test_a_machine_that_gets_busy_costs_one_piece():
    machine = Machine(50e-6, 27e-6)
    cores = ThreadTuner(clock=lambda: machine.now, count=2)
    machine.run(cores, 60)
    before, machine.costs[2] = machine.taken[2], 6e-3
    machine.run(cores, 5)
    assert cores.threads == 1
    assert machine.taken[2] - before <= PIECE


def test_small_nets_and_single_cores_never_try():
    machine = Machine(50e-6, 27e-6)
    machine.run(ThreadTuner(clock=lambda: machine.now, count=2), 300, large=False)
    machine.run(ThreadTuner(clock=lambda: machine.now, count=1), 300)
    assert machine.taken[2] == 0
