"""Parameters that need what is not compiled yet wait for it; the scene goes on with the old ones."""

from app.messages import Load, Play, Reset
from app.scenes.compiling import Compiling, Job
from app.scenes.rope.parameters import Params
from app.scenes.rope.scene import SCENE
from app.server.compile_gate import CompileGate


class Queue(Compiling):
    """All but leapfrog is missing until it is said to be there; nothing is compiled."""

    def __init__(self) -> None:
        super().__init__(1)
        self.there = {"leapfrog"}
        self.wanted: list[str] = []

    def missing(self, name: str, params: object) -> list[Job]:
        method = getattr(params, "integrator", "")
        return [] if method in self.there else [Job(name, method, False)]

    def want(self, jobs: object) -> None:
        self.wanted += [job.piece for job in jobs]  # type: ignore[attr-defined]

    def finish(self, piece: str) -> None:
        """Say that a piece is there, as a worker does."""
        self.there.add(piece)
        self.settled.add(Job("rope", piece, False))


def made() -> tuple[Queue, CompileGate, Params]:
    queue, first = Queue(), Params()
    return queue, CompileGate(queue, SCENE, (first, 0)), first


def test_a_method_that_is_not_compiled_waits_and_starts_by_itself() -> None:
    queue, gate, first = made()
    chosen = Params(integrator="rk4"), 0
    assert gate.read(chosen) == (first, 0)
    assert "rk4" in gate.notice
    assert queue.wanted == ["rk4"]
    gate.read(chosen)
    assert queue.wanted == ["rk4"]  # asked for once
    queue.finish("rk4")
    assert gate.read(chosen) is chosen
    assert not gate.notice


def test_going_back_to_what_is_there_ends_the_wait() -> None:
    _, gate, _ = made()
    gate.read((Params(integrator="rk4"), 0))
    back = Params(gravity=3.0), 0
    assert gate.read(back) is back
    assert not gate.notice


def test_a_preset_is_held_until_it_can_run() -> None:
    queue, gate, first = made()
    load = Load(Params(integrator="tr_bdf2"), 1)
    assert gate.admit([load, Reset()]) == [Reset()]
    assert gate.read((load.params, 1)) == (first, 0)
    queue.finish("tr_bdf2")
    assert gate.admit([Play()]) == [Play(), load]
    assert gate.read((load.params, 1)) == (load.params, 1)
    assert gate.admit([]) == []


def test_of_two_presets_only_the_last_is_loaded() -> None:
    queue, gate, _ = made()
    later = Load(Params(gravity=3.0), 2)
    assert gate.admit([Load(Params(integrator="tr_bdf2"), 1)]) == []
    assert gate.admit([later]) == [later]
    queue.finish("tr_bdf2")
    assert gate.admit([]) == []
    assert gate.read((later.params, 2)) == (later.params, 2)


def test_a_newer_record_drops_the_preset_that_waits() -> None:
    queue, gate, first = made()
    load = Load(Params(integrator="rk4"), 1)
    assert gate.admit([load]) == []
    assert gate.read((load.params, 1)) == (first, 0)
    undone = Params(gravity=3.0), 1  # an undo: the number stays
    assert gate.read(undone) == (undone[0], 0)
    assert not gate.notice
    assert gate.admit([]) == []
    queue.finish("rk4")
    assert gate.admit([]) == []
    moved = Params(gravity=4.0), 1
    assert gate.read(moved) == (moved[0], 0)
    later = Load(Params(gravity=5.0), 2)
    assert gate.admit([later]) == [later]
    assert gate.read((later.params, 2)) == (later.params, 2)


def test_a_preset_that_can_run_since_a_moment_ago_is_not_dropped_for_a_newer_record() -> None:
    queue, gate, first = made()
    load = Load(Params(integrator="rk4"), 1)
    assert gate.admit([load]) == []
    queue.finish("rk4")
    newer = Params(integrator="rk4", gravity=3.0), 1
    assert gate.read(newer) == (first, 0)
    assert gate.admit([]) == [load]
    assert gate.read(newer) is newer
