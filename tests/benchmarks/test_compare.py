"""Two commits of a tiny repository whose benchmark writes a table of its own."""

import json
import shutil
import subprocess

import pytest

from benchmarks import compare

PROGRAM = """
import csv, pathlib, sys
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir(parents=True)
with (out / "tiny.csv").open("w", newline="") as file:
    writer = csv.writer(file)
    writer.writerow(["method", "points", "time [ms]", "error [m]"])
    writer.writerow(["rk4", 10, {time}, 0.1])
    writer.writerow(["rk4", 20, 5.0, 0.1])
"""


def git(root, *arguments):
    names = ("-c", "user.name=a", "-c", "user.email=a@b.c")
    return subprocess.run(
        ["git", "-C", str(root), *names, *arguments], check=True, capture_output=True, encoding="locale"
    ).stdout.strip()


@pytest.fixture
def repository(tmp_path):
    """Commits `slow` and `fast`, of 4 and 1 ms, and `broken`."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    root = tmp_path / "repository"
    (root / "app").mkdir(parents=True)
    (root / "app" / "__init__.py").touch()
    git(tmp_path, "init", "-q", str(root))
    for tag, text in (
        ("slow", PROGRAM.format(time=4.0)),
        ("fast", PROGRAM.format(time=1.0)),
        ("broken", "raise SystemExit('no such bench')"),
    ):
        (root / "app" / "__main__.py").write_text(text, "utf-8")
        git(root, "add", ".")
        git(root, "commit", "-qm", tag)
        git(root, "tag", tag)
    return root


def test_two_commits_are_compared_and_their_folders_are_gone(repository, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "REPEATS", 2)
    out = tmp_path / "out"
    assert compare.compare(["tiny"], ("slow", "fast"), out=out, root=repository) == 0
    kept = json.loads((out / "compare.json").read_text("utf-8"))
    assert kept["commits"] == [git(repository, "rev-parse", tag) for tag in ("slow", "fast")]
    assert [(row["row"], row["time"], row["B / A"], row["largest"]) for row in kept["rows"]] == [
        ("tiny: rk4 10", "time [ms]", 0.25, 0.25),
        ("tiny: rk4 20", "time [ms]", 1.0, 1.0),
    ]
    assert "0.25 to 0.25" in capsys.readouterr().out
    assert len(git(repository, "worktree", "list").splitlines()) == 1


def test_ratios_have_a_spread_and_leave_out_what_one_commit_lacks():
    key, gone = ("t", "rk4", "time [ms]"), ("t", "old", "time [ms]")
    runs = [
        ({key: 1.0, gone: 1.0}, {key: 3.0}),
        ({key: 2.0, gone: 1.0}, {key: 2.0}),
        ({key: 4.0, gone: 1.0}, {key: 4.0}),
    ]
    (row,) = compare.ratios(runs)
    assert (row["A"], row["B"], row["B / A"]) == (2.0, 3.0, 1.5)
    assert (row["least"], row["largest"]) == (1.0, 3.0)


@pytest.mark.parametrize(
    ("names", "commits", "message"),
    [
        (["tiny"], ("slow", "nowhere"), r"^--compare: 'nowhere' is not allowed; allowed: a commit"),
        (["tiny"], ("--all", "fast"), r"^--compare: '--all' is not allowed"),
        ([], ("slow", "fast"), r"^--compare: name the benchmarks"),
        (["tiny"], ("slow", "broken"), r"^--compare: the benchmark failed at 1-\w+: no such bench$"),
    ],
)
def test_what_cannot_be_compared_is_refused(repository, names, commits, message):
    with pytest.raises(ValueError, match=message):
        compare.compare(names, commits, root=repository)
    assert len(git(repository, "worktree", "list").splitlines()) == 1


def test_changes_that_are_not_committed_are_refused(repository):
    (repository / "app" / "__main__.py").write_text("", "utf-8")
    with pytest.raises(ValueError, match=r"^--compare: commit or stash changes first.*app/__main__\.py$"):
        compare.compare(["tiny"], ("slow", "fast"), root=repository)
