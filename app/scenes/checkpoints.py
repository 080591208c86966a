"""Checkpoints: copies of the state of a scene, from which it can continue later.

`copy.deepcopy` makes them. Classes of `sim` that hold much that never changes in place share it with their copies.
"""

import copy
from collections.abc import Mapping
from typing import Any, cast

import numpy as np


def copied(values: Mapping[str, Any], *shared: object) -> dict[str, Any]:
    """Deep copies of these values, which keep their common parts. shared: objects that nothing changes."""
    return copy.deepcopy(dict(values), {id(one): one for one in shared})


def restore(scene: object, checkpoint: object) -> None:
    """Give a scene the attributes in a checkpoint of `copied`, in copies of their own."""
    vars(scene).update(copied(cast(dict[str, Any], checkpoint)))


def arrays_in(value: object) -> dict[int, int]:
    """The arrays that a value holds, in containers and attributes: identity of the owner of the memory -> bytes."""
    sizes: dict[int, int] = {}
    seen: set[int] = set()
    waiting: list[object] = [value]
    while waiting:
        one = waiting.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, np.ndarray):
            owner = one if one.base is None else one.base
            sizes[id(owner)] = one.nbytes if one.base is None else getattr(owner, "nbytes", one.nbytes)
        elif isinstance(one, dict):
            waiting.extend(one.values())
        elif isinstance(one, list | tuple | set | frozenset):
            waiting.extend(one)
        elif hasattr(one, "__dict__") and not callable(one):
            waiting.extend(vars(one).values())
    return sizes
