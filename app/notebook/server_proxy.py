"""The entry of jupyter-server-proxy: a lab for each user behind Jupyter's login, at BASE_URL/springtide/."""

import os
import sys
from pathlib import Path

from app.server.web.access import KEY_HEADER, KEY_VARIABLE, make_key

START_TIMEOUT = 60.0  # [s]
LAB_VARIABLE = "SPRINGTIDE_LAB"  # the student's folder


def springtide() -> dict[str, object]:
    """Settings for jupyter-server-proxy: the command of the lab, and the key that only these two know.

    Jupyter checks its token and the origin before it passes a request on. Other requests have no key and are refused:
    those of another page, or another user of the same machine.
    """
    key = make_key()
    # -P: a student's file named app.py must not replace the program.
    command = [sys.executable, "-P", "-m", "app", *lab_words(), "--no-open", "--resume"]
    return {
        "command": [*(word.replace("{", "{{").replace("}", "}}") for word in command), "--port", "{port}"],
        "environment": {KEY_VARIABLE: key},
        "request_headers_override": {KEY_HEADER: key},
        "timeout": START_TIMEOUT,
        "launcher_entry": {"title": "Springtide"},
    }


def lab_words() -> list[str]:
    """The words of a command line that runs the student's folder.

    The exercises are added if it has no answers yet, whatever other files it holds.

    None if the environment names no folder, or one that cannot be made.
    """
    named = os.environ.get(LAB_VARIABLE)
    if not named:
        return []
    from app.lab.course.answers import FILE
    from app.lab.course.folder import add_exercises
    from app.lab.course.task import load_tasks

    try:
        folder = Path(named).expanduser().absolute()
        if not (folder / FILE).exists():
            add_exercises(folder, load_tasks())
    except (OSError, RuntimeError) as error:  # the latter without a home folder
        print(f"springtide: {LAB_VARIABLE}: {error}", file=sys.stderr)
        return []
    return ["lab", str(folder)]
