"""What tests of several folders share."""

from collections.abc import Iterator
from typing import Any

import pytest


@pytest.fixture
def lab() -> Iterator[Any]:
    """A viewer with the rope open, on a free port of the loopback."""
    from app.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    viewer.open("rope")
    yield viewer
    viewer.shut()
