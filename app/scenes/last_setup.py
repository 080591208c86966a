"""The set-up that a lab was left with, as a link in a file of the user: `springtide --resume` opens it again."""

from pathlib import Path

from app.scenes.own_setups import data_folder
from app.scenes.setups import MAX_LENGTH, Setup, read_query
from sim.files import replacing


def last_path() -> Path:
    """The file, which may not exist."""
    return data_folder() / "last-set-up.txt"


def keep_last(query: str) -> None:
    """Keep a link, "?scene=...". Raises OSError if it cannot be written."""
    path = last_path()
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as draft:
        draft.write_text(query, "utf-8")


def read_last() -> Setup | None:
    """The set-up of the last lab; None if no file holds one that this version can read."""
    try:
        with last_path().open("rb") as file:
            return read_query(file.read(4 * MAX_LENGTH + 1).decode("utf-8"))
    except (OSError, ValueError):
        return None
