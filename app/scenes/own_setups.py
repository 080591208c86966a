"""The user's own set-ups: files in a folder of the user, which the list of presets shows beside those of the program.

Each is a file as `app/scenes/setups.py` writes it. What is in the folder and cannot be read is left out.
"""

import itertools
import re
from pathlib import Path

import platformdirs

from app.scenes.contract import AnyKind
from app.scenes.setups import MAX_LENGTH, Setup, read_file
from sim.cache import user_folder
from sim.files import replacing
from sim.validation import argument_error

MAX_OWN = 100  # of one scene
FILE_NAME = re.compile(r"[^a-z0-9]+")  # replaced in a name


def data_folder() -> Path:
    """Folder of the user's own set-ups."""
    return user_folder("SPRINGTIDE_DATA", platformdirs.user_data_dir)


def folder_of(kind: AnyKind) -> Path:
    """Folder of the set-ups of a scene."""
    return data_folder() / "set-ups" / kind.name


def own_files(kind: AnyKind) -> dict[str, tuple[Path, Setup]]:
    """Name -> (file, set-up), in order of the names; at most `MAX_OWN` of those that can be read."""
    setups: dict[str, tuple[Path, Setup]] = {}
    try:
        paths = sorted(folder_of(kind).glob("*.json"))
    except OSError:
        return setups
    for path in paths:
        if len(setups) == MAX_OWN:
            break
        try:
            with path.open("rb") as file:
                setup = read_file(file.read(4 * MAX_LENGTH + 1).decode("utf-8"), path.name, kind.name)
        except (OSError, ValueError):
            continue
        setups.setdefault(setup.name or path.stem, (path, setup))
    return dict(sorted(setups.items()))


def keep_own(kind: AnyKind, name: str, text: str) -> None:
    """Keep the text of a file under the name that is in it; one of the same name is replaced.

    Raises ValueError if there is no name or there are too many, and OSError if it cannot be written.
    """
    if not name:
        raise argument_error("name", name, "a name, for the list of presets")
    own = own_files(kind)
    if name in own:
        path = own[name][0]
    elif len(own) >= MAX_OWN:
        raise argument_error("set-ups of your own", len(own), f"at most {MAX_OWN}: remove one first")
    else:
        folder = folder_of(kind)
        folder.mkdir(parents=True, exist_ok=True)
        # Windows reserves names such as "con", with any extension.
        stem = f"set-up-{FILE_NAME.sub('-', name.lower()).strip('-')}".strip("-")
        paths = (folder / f"{stem}{end}.json" for end in itertools.chain(("",), itertools.count(2)))
        path = next(path for path in paths if not path.exists())
    with replacing(path) as draft:
        draft.write_text(text, "utf-8")


def remove_own(kind: AnyKind, name: str) -> None:
    """Remove one. Raises ValueError for an unknown name, and OSError if it cannot be removed."""
    own = own_files(kind)
    if name not in own:
        raise argument_error("name", name, "one of " + ", ".join(own) if own else "none, as no set-up is saved")
    own[name][0].unlink()
