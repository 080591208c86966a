"""The comparison of what two versions take to serve."""

from pathlib import Path

import pytest

from app.bench import serving_turns

ROOT = str(Path(__file__).parents[3])


def test_folders_without_sources_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="BEFORE AFTER"):
        serving_turns.main([ROOT, str(tmp_path)])


@pytest.mark.stress
def test_a_version_costs_what_it_costs() -> None:
    versions = serving_turns.Version(ROOT), serving_turns.Version(ROOT)
    try:
        row = serving_turns.compare(versions, "rope/Pendulum", 2, 1.0)
    finally:
        for version in versions:
            version.end()
    assert 0.1 < row["before [% of a core]"] < 100.0
    assert 0.3 < row["ratio"] < 3.0
    assert row["least ratio"] <= row["ratio"] <= row["greatest ratio"]
