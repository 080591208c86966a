"""Messages between the lab and the process that runs a student's functions: plain values as MessagePack.

Nothing that a student's function returns is unpickled in the lab's own process. A value that is neither a number, a
text, an array of numbers nor a list of these arrives as `Foreign`, which holds the name of its type only.
"""

import struct
from collections.abc import Callable
from typing import IO, Any, NamedTuple

import msgspec
import numpy as np

MAX_BYTES = 64 * 2**20  # of one message: more than any task needs
HEAD = struct.Struct("<Q")  # the length of a message [bytes]
NUMERIC_KINDS = "biufc"  # of a numpy dtype: boolean, integer, unsigned, real, complex


class Foreign(NamedTuple):
    """A value that cannot be passed on."""

    type_name: str


def pack(value: Any, refer: Callable[[Any], int]) -> Any:
    """`value` in types of MessagePack. refer: gives the number of a function that stays here."""
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        value = value.item()
    if value is None or isinstance(value, bool | str | float):
        return value
    if isinstance(value, int):
        return value if -(2**63) <= value < 2**63 else float(value)
    if isinstance(value, np.ndarray | np.generic):
        array = np.asarray(value)
        if array.dtype.kind not in NUMERIC_KINDS:
            return pack(array.tolist(), refer) if array.dtype.kind == "O" else {"foreign": f"array of {array.dtype}"}
        return {"array": [array.dtype.str, list(array.shape), np.ascontiguousarray(array).tobytes()]}
    if isinstance(value, complex):
        return pack(np.asarray(value), refer)
    if isinstance(value, list | set | frozenset):
        return [pack(entry, refer) for entry in value]
    if isinstance(value, tuple):
        return {"tuple": [pack(entry, refer) for entry in value]}
    if callable(value):
        return {"function": refer(value)}
    return {"foreign": type(value).__name__}


def unpack(value: Any, function: Callable[[int], Any]) -> Any:
    """The value from the result of `pack`. function: makes the stand-in of a function of the other process."""
    if isinstance(value, list):
        return [unpack(entry, function) for entry in value]
    if isinstance(value, dict):
        if "array" in value:
            dtype, shape, data = value["array"]
            return np.frombuffer(data, np.dtype(dtype)).reshape(shape).copy()
        if "tuple" in value:
            return tuple(unpack(entry, function) for entry in value["tuple"])
        if "function" in value:
            return function(value["function"])
        return Foreign(str(value.get("foreign", "?")))
    return value


def send(stream: IO[bytes], message: list[Any]) -> None:
    """Write one message. Raises ValueError if it is too long, OSError if nobody reads."""
    data = msgspec.msgpack.encode(message)
    if len(data) > MAX_BYTES:
        raise ValueError(f"{len(data) / 2**20:.0f} MiB of numbers, more than {MAX_BYTES // 2**20} MiB")
    stream.write(HEAD.pack(len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes]) -> list[Any] | None:
    """Read one message; None at the end of the stream, or if the bytes are not a message."""
    head = stream.read(HEAD.size)
    if len(head) < HEAD.size or HEAD.unpack(head)[0] > MAX_BYTES:
        return None
    data = stream.read(HEAD.unpack(head)[0])
    try:
        message = msgspec.msgpack.decode(data)
    except msgspec.DecodeError:
        return None
    return message if isinstance(message, list) else None
