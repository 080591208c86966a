"""Saved versions of a folder: found by looks at its files; which one runs, and what failed in which."""

import os
from collections.abc import Collection, Iterator
from pathlib import Path
from unittest.mock import Mock

import pytest

from app.lab.check.program_check import Verdict
from app.lab.course.task import load_tasks
from app.lab.process.runner import BUSY, RunError
from app.lab.student.live_net import ROPE
from app.lab.student.saved import read_files
from app.lab.student.versions import FileWatch, Use, Versions, stamps


def test_a_look_finds_what_was_written_made_and_removed(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    look = FileWatch(folder, ".py")
    assert not look.has_changed()  # there is no folder yet
    folder.mkdir()
    assert look.has_changed()
    for change in (
        lambda: (folder / "a.py").write_text("x", "utf-8"),
        lambda: (folder / "a.py").write_text("xy", "utf-8"),
        lambda: os.utime(folder / "a.py", ns=(1, 1)),
        lambda: (folder / "a.py").rename(folder / "b.py"),
        lambda: (folder / "b.py").unlink(),
    ):
        before = stamps(folder, ".py")
        change()
        assert stamps(folder, ".py") != before
        assert look.has_changed()
    (folder / "notes.txt").write_text("x", "utf-8")
    look.sure_at = 0.0
    assert not look.has_changed()
    look.forget()
    assert look.has_changed()


@pytest.mark.skipif(os.name != "posix", reason="Windows lets few users make links")
def test_a_link_to_nothing_is_no_file_and_a_reason_to_look(tmp_path: Path) -> None:
    look, before = FileWatch(tmp_path, ".py"), stamps(tmp_path, ".py")
    assert look.has_changed()
    (tmp_path / "c.py").symlink_to(tmp_path / "b.py")
    assert stamps(tmp_path, ".py") == before
    assert look.has_changed()


def test_a_save_of_several_writes_is_one_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    look = FileWatch(tmp_path, ".py")
    assert look.has_changed()
    found = [frozenset({("a.py", 1, size, size)}) for size in (10, 20, 30, 30, 40)]
    seen = iter(found)
    monkeypatch.setattr("app.lab.student.versions.stamps", lambda *_: next(seen))
    assert look.has_changed()
    assert look.seen == found[3]
    assert next(seen) == found[4]


def test_a_second_save_that_changes_no_stamp_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr("app.lab.student.versions.time.monotonic", lambda: clock[0])
    path = tmp_path / "mine" / "rope.py"
    path.parent.mkdir()
    look = Versions(path.parent, ())

    def save(text: str) -> None:
        path.write_text(text, "utf-8")
        os.utime(path, ns=(2 * 10**9, 2 * 10**9))  # of a file system that counts in steps of 2 s

    save("x = 1")
    first = look.look()
    assert first is not None
    assert look.look() is None
    save("x = 2")
    clock[0] += 2.0
    second = look.look()
    assert second is not None
    assert (first.number, first.texts["rope.py"]) == (1, b"x = 1")
    assert (second.number, second.texts["rope.py"]) == (2, b"x = 2")
    clock[0] += 1000.0
    assert look.look() is None


def test_programs_of_up_to_a_mebibyte_are_copied(tmp_path: Path) -> None:
    for name, size in (("small.py", 10), ("full.py", 1024 * 1024), ("large.py", 1024 * 1024 + 1), ("notes.txt", 10)):
        (tmp_path / name).write_bytes(b"#" * size)
    assert {name: len(text) for name, text in read_files(tmp_path).items()} == {"full.py": 1024 * 1024, "small.py": 10}


def test_a_version_that_could_not_be_copied_is_found_again(tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text("x = 1", "utf-8")
    look = Versions(tmp_path, ())
    look.copies.rmdir()
    for _ in range(2):
        with pytest.raises(FileNotFoundError):
            look.look()
        look.files.sure_at = 0.0  # equal stamps mean equal files
    look.copies.mkdir()
    found = look.look()
    assert found is not None
    assert found.texts == {"rope.py": b"x = 1"}


FORCE = "def spring_force(x1):\n    return {}\n"
GRAVITY = Use("sea", "gravity", "square_sea.py")
SPECTRUM = Use("sea", "spectrum", "square_sea.py")


def process(*_: object) -> Mock:
    """A process that never starts."""
    return Mock(is_fresh=False)


@pytest.fixture
def versions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Versions]:
    """The versions of an empty folder, with processes that never start."""
    monkeypatch.setattr("app.lab.student.versions.Runner", process)
    (tmp_path / "mine").mkdir()
    found = Versions(tmp_path / "mine", load_tasks())
    found.look()
    yield found
    found.close()


def save(versions: Versions, **texts: str) -> int:
    """Save files, by name without ending; returns the number of the version."""
    for name, text in texts.items():
        (versions.folder / f"{name}.py").write_text(text, "utf-8")
    saved = versions.look()
    assert saved is not None
    return saved.number


def ran(versions: Versions, use: Use, error: RunError | None = None, fails: Collection[int] = ()) -> int:
    """The version by which a use runs; 0 for none. error: of the versions in `fails`."""

    def job(runner: Mock, own: frozenset[str]) -> None:
        assert own == {use.name}
        if error is not None and int(runner.enter.call_args.args[0].name) in fails:
            raise error

    done = versions.run(use, lambda begun: begun & {use.name}, job)
    return 0 if done is None else done.saved.number


def test_a_save_is_a_new_version_of_the_files_that_it_may_have_changed(versions: Versions) -> None:
    assert save(versions, rope="x = 1", square_sea="y = 1") == 2
    assert save(versions, rope="x = 2") == 3
    numbers = {file: versions.of(file).number for file in ("rope.py", "square_sea.py", "cloth.py")}
    assert numbers == {"rope.py": 3, "square_sea.py": 2, "cloth.py": 1}
    assert save(versions, mine="z = 1") == 4  # which any of them may use
    assert {saved.number for saved in versions.of_file.values()} == {4}
    save(versions, mine="z = 2")
    assert sorted(path.name for path in versions.copies.iterdir()) == ["5"]


def test_a_failure_of_some_arguments_holds_for_these_and_a_costly_one_for_all(versions: Versions) -> None:
    sea = "def gravity(m):\n    return {}\ndef spectrum(k):\n    return 1\n"
    raised, endless = (RunError(kind, "no result", "square_sea.py") for kind in ("raised", "endless"))
    save(versions, square_sea=sea.format(1))
    assert ran(versions, GRAVITY) == 2
    save(versions, square_sea=sea.format(2))
    assert ran(versions, GRAVITY, raised, {3}) == 2
    assert versions.errors == {GRAVITY: raised}
    assert ran(versions, SPECTRUM) == 3
    assert ran(versions, GRAVITY) == 3
    assert versions.errors == {}
    assert ran(versions, GRAVITY, endless, {3}) == 2
    assert ran(versions, GRAVITY) == 2
    assert versions.errors == {GRAVITY: endless}
    save(versions, rope="x = 1")
    assert ran(versions, GRAVITY) == 2  # the sea's file is as it was
    save(versions, square_sea="def spectrum(k):\n    return 1\n")
    assert versions.errors == {}
    assert ran(versions, GRAVITY) == 0


def test_of_a_lane_only_the_processes_live_by_which_it_runs(versions: Versions) -> None:
    processes = []
    for number in range(2, 6):
        save(versions, square_sea=f"def gravity(m):\n    return {number}\n")
        assert ran(versions, GRAVITY) == number
        processes.append(versions.processes["sea", number, False])
        assert list(versions.processes) == [("sea", number, False)]
    assert [process.close.call_count for process in processes] == [1, 1, 1, 0]
    assert sorted(path.name for path in versions.copies.iterdir()) == ["1", "3", "4", "5"]


def test_versions_that_are_tried_and_never_run_keep_one_process(versions: Versions) -> None:
    for number in range(2, 6):
        save(versions, rope=FORCE.format(number))
        assert versions.attempt(ROPE.use, lambda begun: begun, lambda runner, _: None)
        assert list(versions.processes) == [("rope", number, False)]
    done = versions.run(ROPE.use, lambda begun: begun, lambda runner, _: None)
    assert done is not None
    assert done.saved.number == 5
    save(versions, rope="def spring_force(x1):\n    ...\n")
    assert versions.attempt(ROPE.use, lambda begun: begun, lambda runner, _: None)
    assert versions.run(ROPE.use, lambda begun: begun, lambda runner, _: None) is None
    assert not versions.processes


def test_a_trial_leaves_the_process_alone_that_runs_meanwhile(versions: Versions) -> None:
    def job(runner: Mock, _: frozenset[str]) -> None:
        if len(versions.processes) == 1:
            save(versions, rope=FORCE.format(2))
            assert versions.attempt(ROPE.use, lambda begun: begun, lambda runner, _: None)
            assert not runner.close.called

    save(versions, rope=FORCE.format(1))
    assert versions.attempt(ROPE.use, lambda begun: begun, lambda runner, _: None)
    runs = [versions.run(ROPE.use, lambda begun: begun, job) for _ in range(2)]
    assert [done and done.saved.number for done in runs] == [2, 3]
    assert list(versions.processes) == [("rope", 3, False)]


def test_what_a_function_writes_beside_the_copies_harms_nothing(versions: Versions) -> None:
    (versions.copies / "notes.txt").write_text("x", "utf-8")
    assert save(versions, rope="x = 1") == 2


def test_a_version_that_was_compiled_runs_so_until_it_fails_or_another_is_saved(versions: Versions) -> None:
    use, own = ROPE.use, frozenset({"spring_force"})

    def march() -> tuple[int, tuple[str, ...]] | None:
        done = versions.run(use, lambda begun: begun, lambda runner, _: runner.march())
        return None if done is None else (done.saved.number, done.compiled)

    save(versions, rope=FORCE.format(1))
    assert versions.attempt(use, lambda begun: begun, lambda runner, _: None)
    assert march() == (2, ())
    compiler = Mock(is_fresh=False, **{"compile.return_value": (["spring_force"], "")})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.lab.student.versions.Runner", lambda *_, compiles=False: compiler if compiles else process())
        versions.compile(use)
        assert march() == (2, ("spring_force",))
        compiler.march.side_effect = RunError("raised", "index out of range", "rope.py")
        assert march() == (2, ())
        assert versions.errors == {}
        assert (use, ("rope", 2, True), own) in versions.failed

        def saved_meanwhile(_: object) -> None:
            save(versions, rope=FORCE.format(2))
            assert compiler.abort.called
            raise RunError("ended", "the lab has ended the process", "rope.py")

        compiler.compile.side_effect = saved_meanwhile
        versions.compile(use)
    assert march() == (2, ())  # until the newer one has been tried
    assert versions.attempt(use, lambda begun: begun, lambda runner, _: None)
    assert not versions.attempt(use, lambda begun: begun, lambda runner, _: None)
    assert march() == (3, ())


def test_a_verdict_holds_until_the_function_is_saved_again(versions: Versions) -> None:
    save(versions, rope=FORCE.format(1))
    task, saved = next((task, saved) for task, saved in versions.unchecked() if task.name == "spring_force")
    count = len(versions.unchecked())
    versions.judge(task, saved, Verdict("not checked"), final=False)
    assert len(versions.unchecked()) == count
    versions.judge(task, saved, Verdict("right"), final=True)
    assert len(versions.unchecked()) == count - 1
    save(versions, cloth="x = 1")
    assert versions.verdicts == {"spring_force": Verdict("right")}
    save(versions, rope=FORCE.format(2))
    assert versions.verdicts == {}
    versions.judge(task, saved, Verdict("wrong"), final=True)  # of the version before
    assert versions.verdicts == {}
    assert len(versions.unchecked()) == count


def test_on_a_busy_machine_the_newest_version_waits_and_is_tried_again(versions: Versions) -> None:
    busy = RunError(BUSY, "no process can be started", "Python")
    outcomes: list[RunError | None] = []

    def job(*_: object) -> None:
        if (error := outcomes.pop(0)) is not None:
            raise error

    def attempt() -> bool:
        return versions.attempt(ROPE.use, lambda begun: begun, job)

    outcomes[:] = [None, busy, None]
    save(versions, rope=FORCE.format(1))
    assert attempt()
    save(versions, rope=FORCE.format(2))
    assert not attempt()
    assert versions.errors == {ROPE.use: busy}
    assert attempt()
    assert versions.errors == {}
    outcomes[:] = [busy, None]
    with pytest.raises(RunError, match="no process"):  # and the version before does not run meanwhile
        versions.run(ROPE.use, lambda begun: begun, job)
    assert versions.errors == {ROPE.use: busy}
    done = versions.run(ROPE.use, lambda begun: begun, job)
    assert done is not None
    assert done.saved.number == 3
    assert versions.errors == {}


def test_a_process_that_no_function_has_entered_is_kept_for_the_next_version(versions: Versions) -> None:
    def refuse(*_: object) -> None:
        raise RunError("syntax", "invalid syntax", "rope.py", 2)

    versions.warm()
    spare = versions.spare
    assert isinstance(spare, Mock)
    spare.is_fresh = True
    save(versions, rope=FORCE.format(1), square_sea="def gravity(m):\n    return 1\n")
    assert not versions.attempt(ROPE.use, lambda begun: begun, refuse)
    assert versions.spare is spare
    assert versions.run(GRAVITY, lambda begun: begun & {"gravity"}, refuse) is None
    assert versions.spare is spare
    assert not spare.close.called
    assert versions.attempt(ROPE.use, lambda begun: begun, lambda *_: None) is False  # it has been tried
    assert ran(versions, GRAVITY) == 2
    assert versions.spare is None
    versions.warm()
    assert versions.spare is not spare


def test_once_it_is_aborted_no_process_runs(versions: Versions) -> None:
    save(versions, rope=FORCE.format(1), square_sea="def gravity(m):\n    return 1\n")
    assert ran(versions, GRAVITY) == 2
    versions.warm()
    before = [versions.spare, versions.processes["sea", 2, False]]
    versions.abort()
    versions.spare = None
    versions.warm()
    spare, saved = versions.spare, versions.of("rope.py")
    versions.spare = None
    assert saved is not None
    for one in (*before, spare, versions.process(("rope", 2, False), saved)):
        assert isinstance(one, Mock)
        assert one.abort.called
