"""Lines of the program on the error stream, without control characters."""

import sys


def print_error(text: str, status: int) -> int:
    """Print an error on one line of printable characters; returns the exit status."""
    print(f"springtide: {one_line(text)}", file=sys.stderr)
    return status


def say_on_error_stream(text: str) -> None:
    """Print a line on the error stream."""
    print(f"springtide: {one_line(text)}", file=sys.stderr)


def one_line(text: str) -> str:
    """`text` with its control characters written out: names from a file must not steer the terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
