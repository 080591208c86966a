"""What tests of several folders share."""

from collections.abc import Iterator
from typing import Any

import pytest

import app  # noqa: F401  first of all, as numpy's BLAS is to get one thread, as it does when the program runs


@pytest.fixture
def lab(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A viewer with the module's SCENE and PARAMS open, or the rope, on a free port of the loopback."""
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    viewer.open(getattr(request.module, "SCENE", "rope"), getattr(request.module, "PARAMS", None))
    yield viewer
    viewer.shut()
