"""The text of a file in the encodings that tables have."""

import codecs
import gzip
import zlib
from pathlib import Path

from sim.validation import argument_error, unreadable

MAX_BYTES = 100_000_000  # of a text file, unpacked


def read_text(path: Path, forms: str) -> str:
    """The text of a file, also of one that gzip has packed; forms: the formats that are read, for messages.

    Raises ValueError if it cannot be read, is too large, or is no text.
    """
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            raise argument_error("path", str(path), f"{forms}, in a file")
        if path.is_file() and path.stat().st_size > MAX_BYTES:
            raise argument_error("path", str(path), f"{forms}, of at most {MAX_BYTES // 1_000_000} MB")
        with path.open("rb") as file:
            packed = file.read(2) == b"\x1f\x8b"
        with gzip.open(path) if packed else path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (EOFError, gzip.BadGzipFile, zlib.error):
        raise argument_error("path", str(path), f"{forms}; what gzip has packed is damaged here") from None
    except OSError as error:
        raise unreadable("path", path, error) from None
    if len(content) > MAX_BYTES:
        raise argument_error("path", str(path), f"{forms}, of at most {MAX_BYTES // 1_000_000} MB unpacked")
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        raise argument_error("path", str(path), forms)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:  # of spreadsheets on Windows: it matters in units only
        return content.decode("cp1252", errors="replace")
