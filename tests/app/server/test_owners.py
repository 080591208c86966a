"""Nothing outlives its owner: what a comparison, a scene or a whole lab holds is gone when it has ended."""

import gc
import threading
from collections.abc import Callable

import psutil
import pytest
import viser

from app.panel.recording.recorder import Recorder
from app.render.injection import ShaderInjector
from app.scenes.setups import read_query
from app.server.beside import ComparedLabs
from app.server.loop.sim_loop import SimLoop
from app.server.served_scene import ServedScene
from app.server.viewer import Viewer
from tests.waiting import wait_for

OWNED = (Viewer, viser.ViserServer, ServedScene, SimLoop, Recorder, ComparedLabs, ShaderInjector)


def counted() -> dict[str, int]:
    """Living objects of the owners, threads, sockets and open files."""
    gc.collect()
    objects = gc.get_objects()
    counts = {one.__name__: sum(type(o) is one for o in objects) for one in OWNED}
    process = psutil.Process()
    return {
        **counts,
        "threads": threading.active_count(),
        "sockets": len(process.net_connections("tcp")),
        "files": len(process.open_files()),
    }


def has_at_most(expected: dict[str, int]) -> bool:
    """True if no more is alive than expected."""
    return all(count <= expected[name] for name, count in counted().items())


def compare(viewer: Viewer) -> None:
    viewer.comparing.begin([read_query("?scene=rope&stiffness=2000")], False)
    viewer.comparing.end_now()


def change_scene(viewer: Viewer) -> None:
    viewer.open("cloth")
    viewer.open("rope")


def make_lab(viewer: Viewer) -> None:
    other = Viewer("127.0.0.1", 0)
    other.open("rope")
    other.shut()


@pytest.fixture(scope="module")
def viewer():
    lab = Viewer("127.0.0.1", 0)
    lab.open("rope")
    yield lab
    lab.shut()


@pytest.mark.parametrize("act", [compare, change_scene, make_lab])
def test_what_has_ended_is_gone(viewer: Viewer, act: Callable[[Viewer], None]) -> None:
    """As much is alive after the fourth time as after the first."""
    act(viewer)
    before = counted()
    for _ in range(3):
        act(viewer)
    wait_for(lambda: has_at_most(before))
