"""Contract of `springtide export` with a scene that can be written as a sequence of files."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol


class Sequence(Protocol):
    """One run of a scene, written frame by frame into a folder."""

    passes: int  # number of runs: work of `write`, in frames, over the number of frames
    bytes_per_frame: int  # before anything is compressed

    def write(self, folder: Path, start: float, count: int) -> Iterator[float | None]:
        """Write `count` frames, the first at `start` [s]. Yields the time [s] of each, None for one of a first pass.

        Raises DivergenceError if the run diverges: the frames before that are written. Raises OSError.
        """
        ...

    def about(self) -> Mapping[str, Any]:
        """Contents of the files, with units, for the JSON file beside them; complete after `write`."""
        ...


class Exporter(NamedTuple):
    """Writer of one scene."""

    formats: tuple[str, ...]  # the first is the default
    make: Callable[[Any, float, str], Sequence]  # of the parameters, the frame interval [s] and the format


def file_name(stem: str, number: int, suffix: str) -> str:
    """The name of a file of a sequence; numbers begin at 1."""
    return f"{stem}.{number:04d}.{suffix}"
