"""Parameters that need what is not compiled yet wait for it; the scene continues with the old ones."""

from concurrent.futures import Future

from app.messages import Advance, Checkpoint, Pause, Play, Reset, Take
from app.scenes.ahead.compiling import Compiling, Job
from app.scenes.rope import SCENE
from app.scenes.rope.parameters import RopeParams
from app.server.loop.commands import CompileGate, Record


class Queue(Compiling):
    """A queue in which everything but leapfrog is missing until it is reported; nothing is compiled."""

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
        """Report a piece as compiled, as a worker does."""
        self.there.add(piece)
        self.settled.add(Job("rope", piece, False))


def made() -> tuple[Queue, CompileGate]:
    queue = Queue()
    return queue, CompileGate(queue, SCENE, Record(RopeParams(), 1))


def test_a_method_that_is_not_compiled_waits_and_starts_by_itself() -> None:
    queue, gate = made()
    chosen = Take(RopeParams(integrator="rk4"))
    assert gate.admit([chosen]) == []
    assert "rk4" in gate.notice
    assert queue.wanted == ["rk4"]
    assert gate.admit([]) == []
    assert queue.wanted == ["rk4"]  # requested once
    queue.finish("rk4")
    assert gate.admit([]) == [chosen]
    assert gate.admit([]) == []
    assert not gate.notice


def test_going_back_to_what_is_there_ends_the_wait() -> None:
    queue, gate = made()
    assert gate.admit([Take(RopeParams(integrator="rk4"))]) == []
    back = Take(RopeParams(gravity=3.0))
    assert gate.admit([back]) == [back]
    assert not gate.notice
    queue.finish("rk4")
    assert gate.admit([]) == []


def test_a_preset_is_held_until_it_can_run() -> None:
    queue, gate = made()
    preset = Take(RopeParams(integrator="tr_bdf2"), start=True)
    assert gate.admit([preset, Pause()]) == [Pause()]
    queue.finish("tr_bdf2")
    assert gate.admit([Play()]) == [preset, Play()]
    assert gate.admit([]) == []


def test_a_reset_does_not_overtake_the_preset_before_it() -> None:
    queue, gate = made()
    preset = Take(RopeParams(integrator="tr_bdf2"), start=True, act=2)
    assert gate.admit([Reset(2)]) == [Reset(2)]
    assert gate.admit([preset, Reset(3), Reset(4)]) == []
    queue.finish("tr_bdf2")
    assert gate.admit([]) == [preset, Reset(3), Reset(4)]
    assert gate.record == Record(preset.params, 4)


def test_an_undo_drops_all_that_waits() -> None:
    queue, gate = made()
    changed = RopeParams(integrator="tr_bdf2", gravity=3.0)
    assert gate.admit([Take(changed, start=True, act=2), Reset(3), Take(changed, act=3)]) == []
    undone = Take(RopeParams(), act=1, back=True)
    assert gate.admit([undone]) == [undone]
    assert not gate.notice
    queue.finish("tr_bdf2")
    assert gate.admit([]) == []


def test_what_can_run_begins_the_run_of_the_preset_that_it_drops() -> None:
    _, gate = made()
    assert gate.admit([Take(RopeParams(integrator="tr_bdf2", gravity=3.0), start=True, act=2)]) == []
    changed = Take(RopeParams(gravity=3.0), act=2)
    assert gate.admit([changed]) == [changed._replace(start=True)]


def test_nothing_drops_a_moment_to_go_on_from_but_what_begins_again() -> None:
    queue, gate = made()
    moment = Take(RopeParams(integrator="rk4"), state=Checkpoint(0.0, {}), act=2)
    changed = Take(RopeParams(gravity=3.0), act=2)
    assert gate.admit([moment, changed]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [moment, changed]


def test_of_two_presets_only_the_last_is_loaded() -> None:
    queue, gate = made()
    later = Take(RopeParams(gravity=3.0), start=True)
    assert gate.admit([Take(RopeParams(integrator="tr_bdf2"), start=True)]) == []
    assert gate.admit([later]) == [later]
    queue.finish("tr_bdf2")
    assert gate.admit([]) == []


def test_a_slider_that_is_moved_while_a_preset_is_compiled_is_taken_after_its_start() -> None:
    queue, gate = made()
    preset = Take(RopeParams(integrator="rk4"), start=True)
    moved = [Take(RopeParams(integrator="rk4", gravity=gravity)) for gravity in (3.0, 4.0, 5.0)]
    assert gate.admit([preset]) == []
    for change in moved:
        assert gate.admit([change]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [preset, moved[-1]]


def test_a_moment_to_go_on_from_keeps_its_own_parameters() -> None:
    queue, gate = made()
    kept = Take(RopeParams(integrator="rk4"), state=Checkpoint(0.0, {}))
    moved = Take(RopeParams(integrator="rk4", gravity=3.0))
    assert gate.admit([kept, moved]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [kept, moved]


def test_a_newer_record_that_can_run_drops_the_preset_that_waits() -> None:
    queue, gate = made()
    assert gate.admit([Take(RopeParams(integrator="rk4"), start=True)]) == []
    undone = Take(RopeParams(gravity=3.0), act=1, back=True)
    assert gate.admit([undone]) == [undone]
    assert not gate.notice
    queue.finish("rk4")
    assert gate.admit([]) == []
    later = Take(RopeParams(gravity=5.0), start=True)
    assert gate.admit([later]) == [later]


def test_a_preset_that_can_run_since_a_moment_ago_is_not_dropped_for_a_newer_record() -> None:
    queue, gate = made()
    preset = Take(RopeParams(integrator="rk4"), start=True)
    assert gate.admit([preset]) == []
    queue.finish("rk4")
    newer = Take(RopeParams(integrator="rk4", gravity=3.0))
    assert gate.admit([newer]) == [preset, newer]


def test_a_program_waits_for_the_time_after_what_it_has_set() -> None:
    queue, gate = made()
    change, wait = Take(RopeParams(integrator="rk4")), Advance(1.0, Future())
    assert gate.admit([change, wait, Play()]) == [Play()]
    assert gate.admit([]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [change, wait]
    assert gate.admit([wait]) == [wait]
