"""A disk that is full, as far as a file of this process is concerned."""

import contextlib
import sys
from collections.abc import Iterator

import pytest


@contextlib.contextmanager
def full_disk(limit: int) -> Iterator[None]:
    """No file of this process may become longer than `limit` bytes.

    Python writes no byte code meanwhile: it would keep a cut file beside the source, and fail at every later import.
    """
    resource = pytest.importorskip("resource", reason="this system limits no sizes of files")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    writes_no_byte_code, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode = writes_no_byte_code
