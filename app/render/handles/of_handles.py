"""Values of viser's handles, which need not be hashable: newer versions compare them by their content."""

import weakref
from typing import Generic, TypeVar

from app.render.handles.viser_types import GuiHandle

T = TypeVar("T")


class OfHandles(Generic[T]):
    """One value for each of some handles, by their identity; it goes with the handle."""

    def __init__(self) -> None:
        self.values: dict[int, tuple[weakref.ref[GuiHandle], T]] = {}

    def put(self, handle: GuiHandle, value: T) -> None:
        """Set the value of a handle."""
        identity = id(handle)
        self.values[identity] = weakref.ref(handle, lambda _: self.values.pop(identity, None)), value

    def get(self, handle: GuiHandle) -> T | None:
        """Value of a handle; None if it has none."""
        return self.values[id(handle)][1] if id(handle) in self.values else None

    def drop(self, handle: GuiHandle) -> None:
        """Forget the value of a handle, if it has one."""
        self.values.pop(id(handle), None)
