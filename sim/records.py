"""Records of arrays: one of them is equal to itself only, as the truth of `array == array` is not one value."""

from typing import TypeVar

Record = TypeVar("Record")


def equal_to_itself(kind: type[Record]) -> type[Record]:
    """Class decorator of a NamedTuple with arrays: `==` and `hash` are those of the object, and never raise."""
    kind.__eq__, kind.__ne__, kind.__hash__ = object.__eq__, object.__ne__, object.__hash__  # type: ignore[method-assign]
    return kind
