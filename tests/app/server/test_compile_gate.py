"""Parameters that need what is not compiled yet wait for it; the scene goes on with the old ones."""

from app.messages import Command, Load, Reset
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


def made() -> tuple[Queue, CompileGate, list[Command], Params]:
    queue, posted, first = Queue(), list[Command](), Params()
    return queue, CompileGate(queue, SCENE, posted.append, (first, 0)), posted, first


def test_a_method_that_is_not_compiled_waits_and_starts_by_itself() -> None:
    queue, gate, _, first = made()
    chosen = Params(integrator="rk4"), 0
    assert gate.read(chosen) == (first, 0)
    assert "rk4" in gate.notice
    assert queue.wanted[-1] == "rk4"
    queue.finish("rk4")
    assert gate.read(chosen) is chosen
    assert not gate.notice


def test_going_back_to_what_is_there_ends_the_wait() -> None:
    _, gate, _, _ = made()
    gate.read((Params(integrator="rk4"), 0))
    back = Params(gravity=3.0), 0
    assert gate.read(back) is back
    assert not gate.notice


def test_a_preset_is_held_until_it_can_run() -> None:
    queue, gate, posted, first = made()
    load = Load(Params(integrator="xpbd"), 1)
    gate.post(load)
    gate.post(Reset())
    assert posted == [Reset()]
    assert gate.read((load.params, 1)) == (first, 0)
    queue.finish("xpbd")
    assert gate.read((load.params, 1)) == (load.params, 1)
    assert posted == [Reset(), load]


def test_of_two_presets_only_the_last_is_loaded() -> None:
    queue, gate, posted, _ = made()
    later = Load(Params(gravity=3.0), 2)
    gate.post(Load(Params(integrator="xpbd"), 1))
    gate.post(later)
    queue.finish("xpbd")
    gate.read((later.params, 2))
    assert posted == [later]
