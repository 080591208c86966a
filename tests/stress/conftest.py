"""The stress suite: `pytest -m stress` runs it, everything else leaves it out. A report of its counts ends it."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from app.scenes import NAMES
from tests.stress.hammer import Hammer
from tests.stress.tally import SERVED, Tally

TALLY = Tally()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Everything in this folder is stress, and may take long."""
    for item in items:
        if "/tests/stress/" in item.path.as_posix():
            item.add_marker(pytest.mark.stress)
            item.add_marker(pytest.mark.timeout(1200 + 2 * SERVED))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    lines = list(TALLY.lines())
    if lines:
        terminalreporter.section("stress report")
        for line in lines:
            terminalreporter.write_line(line)


@pytest.fixture
def tally() -> Tally:
    return TALLY


@pytest.fixture(scope="session")
def hammers() -> Iterator[Callable[[str], Hammer]]:
    """A hammer for each scene, made when first asked for."""
    made: dict[str, Hammer] = {}

    def hammer_of(name: str) -> Hammer:
        if name not in made:
            made[name] = Hammer(name, TALLY)
        return made[name]

    yield hammer_of
    for hammer in made.values():
        hammer.shut()


@pytest.fixture(params=NAMES)
def hammer(request: pytest.FixtureRequest, hammers: Callable[[str], Hammer]) -> Hammer:
    """Each scene in turn, running with its defaults."""
    hammer = hammers(request.param)
    hammer.calm()
    return hammer
