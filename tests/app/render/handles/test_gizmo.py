"""The arrows that move a thing, on a handle without a server."""

from types import SimpleNamespace
from typing import Any

from app.messages import Place
from app.render.handles.gizmo import Gizmo
from tests import coroutines


class Handle:
    """viser's transform controls, as far as they are used."""

    position: Any = (0.0, 0.0, 0.0)
    visible = True

    def on_update(self, callback: Any) -> None:
        self.callback = callback


def make() -> tuple[Gizmo, Handle, list]:
    handle, posted = Handle(), []
    server: Any = SimpleNamespace(scene=SimpleNamespace(add_transform_controls=lambda *_, **__: handle))
    return Gizmo(server, posted.append, "sphere", 0.5), handle, posted


def test_arrows_above_a_thing_move_the_thing() -> None:
    gizmo, handle, posted = make()
    gizmo.show((1.0, 2.0, 3.0), 0.75)
    assert handle.position == (1.0, 2.0, 3.75)
    handle.position = (1.5, 2.0, 4.0)
    coroutines.run(handle.callback(SimpleNamespace(target=handle)))
    assert posted == [Place("sphere", (1.5, 2.0, 3.25))]


def test_hidden_arrows_come_back_where_the_thing_is() -> None:
    gizmo, handle, _ = make()
    gizmo.show((1.0, 2.0, 3.0))
    gizmo.show(None)
    assert not handle.visible
    gizmo.show((0.0, 0.0, 1.0))
    assert handle.visible
    assert handle.position == (0.0, 0.0, 1.0)


def test_a_place_that_is_not_finite_is_not_posted() -> None:
    _, handle, posted = make()
    handle.position = (float("nan"), 0.0, 0.0)
    coroutines.run(handle.callback(SimpleNamespace(target=handle)))
    assert posted == []
