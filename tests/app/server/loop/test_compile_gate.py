"""Parameters that need what is not compiled yet wait for it; the scene continues with the old ones."""

from concurrent.futures import Future

from app.messages import Advance, Begin, Change, Checkpoint, GoBack, Pause, Play, Reset, Resume
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
    chosen = Change(RopeParams(integrator="rk4"), "forces")
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
    assert gate.admit([Change(RopeParams(integrator="rk4"), "forces")]) == []
    back = Change(RopeParams(gravity=3.0), "forces")
    assert gate.admit([back]) == [back]
    assert not gate.notice
    queue.finish("rk4")
    assert gate.admit([]) == []


def test_a_change_that_drops_a_waiting_one_has_its_effect_on_what_the_loop_has() -> None:
    _, gate = made()
    assert gate.admit([Change(RopeParams(integrator="rk4", gravity=3.0), "forces")]) == []
    looks = RopeParams(speed=0.5)
    assert gate.admit([Change(looks, "forces")]) == [Change(looks, "look")]
    assert gate.admit([Change(RopeParams(integrator="rk4"), "forces")]) == []
    assert gate.admit([Change(looks, "forces")]) == [Change(looks, "look")]


def test_a_preset_is_held_until_it_can_run() -> None:
    queue, gate = made()
    preset = Begin(RopeParams(integrator="tr_bdf2"))
    assert gate.admit([preset, Pause()]) == [Pause()]
    queue.finish("tr_bdf2")
    assert gate.admit([Play()]) == [preset, Play()]
    assert gate.admit([]) == []


def test_a_reset_does_not_overtake_the_preset_before_it() -> None:
    queue, gate = made()
    preset = Begin(RopeParams(integrator="tr_bdf2"), 2)
    assert gate.admit([Reset(2)]) == [Reset(2)]
    assert gate.admit([preset, Reset(3), Reset(4)]) == []
    queue.finish("tr_bdf2")
    assert gate.admit([]) == [preset, Reset(3), Reset(4)]
    assert gate.record == Record(preset.params, 4)


def test_an_undo_drops_all_that_waits() -> None:
    queue, gate = made()
    changed = RopeParams(integrator="tr_bdf2", gravity=3.0)
    assert gate.admit([Begin(changed, 2), Reset(3), Change(changed, "look", 3)]) == []
    undone = GoBack(RopeParams(), 1)
    assert gate.admit([undone]) == [undone]
    assert not gate.notice
    queue.finish("tr_bdf2")
    assert gate.admit([]) == []


def test_what_can_run_begins_the_run_of_the_preset_that_it_drops() -> None:
    _, gate = made()
    assert gate.admit([Begin(RopeParams(integrator="tr_bdf2", gravity=3.0), 2)]) == []
    changed = Change(RopeParams(gravity=3.0), "forces", 2)
    assert gate.admit([changed]) == [Begin(changed.params, 2)]


def test_nothing_drops_a_moment_to_go_on_from_but_what_begins_again() -> None:
    queue, gate = made()
    moment = Resume(RopeParams(integrator="rk4"), Checkpoint(0.0, {}), 2)
    changed = Change(RopeParams(gravity=3.0), "forces", 2)
    assert gate.admit([moment, changed]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [moment, changed]


def test_of_two_presets_only_the_last_is_loaded() -> None:
    queue, gate = made()
    later = Begin(RopeParams(gravity=3.0))
    assert gate.admit([Begin(RopeParams(integrator="tr_bdf2"))]) == []
    assert gate.admit([later]) == [later]
    queue.finish("tr_bdf2")
    assert gate.admit([]) == []


def test_a_slider_that_is_moved_while_a_preset_is_compiled_is_taken_after_its_start() -> None:
    queue, gate = made()
    preset = Begin(RopeParams(integrator="rk4"))
    moved = [Change(RopeParams(integrator="rk4", gravity=gravity), "forces") for gravity in (3.0, 4.0, 5.0)]
    assert gate.admit([preset]) == []
    for change in moved:
        assert gate.admit([change]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [preset, moved[-1]]


def test_a_moment_to_go_on_from_keeps_its_own_parameters() -> None:
    queue, gate = made()
    kept = Resume(RopeParams(integrator="rk4"), Checkpoint(0.0, {}))
    moved = Change(RopeParams(integrator="rk4", gravity=3.0), "forces")
    assert gate.admit([kept, moved]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [kept, moved]


def test_a_newer_record_that_can_run_drops_the_preset_that_waits() -> None:
    queue, gate = made()
    assert gate.admit([Begin(RopeParams(integrator="rk4"))]) == []
    undone = GoBack(RopeParams(gravity=3.0), 1)
    assert gate.admit([undone]) == [undone]
    assert not gate.notice
    queue.finish("rk4")
    assert gate.admit([]) == []
    later = Begin(RopeParams(gravity=5.0))
    assert gate.admit([later]) == [later]


def test_a_preset_that_can_run_since_a_moment_ago_is_not_dropped_for_a_newer_record() -> None:
    queue, gate = made()
    preset = Begin(RopeParams(integrator="rk4"))
    assert gate.admit([preset]) == []
    queue.finish("rk4")
    newer = Change(RopeParams(integrator="rk4", gravity=3.0), "forces")
    assert gate.admit([newer]) == [preset, newer]


def test_a_program_waits_for_the_time_after_what_it_has_set() -> None:
    queue, gate = made()
    change, wait = Change(RopeParams(integrator="rk4"), "forces"), Advance(1.0, Future())
    assert gate.admit([change, wait, Play()]) == [Play()]
    assert gate.admit([]) == []
    queue.finish("rk4")
    assert gate.admit([]) == [change, wait]
    assert gate.admit([wait]) == [wait]
