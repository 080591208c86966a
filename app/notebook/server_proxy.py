"""The entry of jupyter-server-proxy: a lab of one's own behind Jupyter's login, at BASE_URL/springtide/."""

import sys

from app.server.access import KEY_HEADER, KEY_VARIABLE, make_key

START_TIMEOUT = 60.0  # [s]


def springtide() -> dict[str, object]:
    """Settings for jupyter-server-proxy: how the lab is started, and the key that only the two of them know.

    Jupyter asks for its token and checks the origin before it passes a request on. What does not come through it has
    no key and is refused: another page, or another user of the same machine.
    """
    key = make_key()
    python = sys.executable.replace("{", "{{").replace("}", "}}")  # it fills in what is in braces
    return {
        # -P: a file of a student's that is called app.py is not the program.
        "command": [python, "-P", "-m", "app", "--no-open", "--resume", "--port", "{port}"],
        "environment": {KEY_VARIABLE: key},
        "request_headers_override": {KEY_HEADER: key},
        "timeout": START_TIMEOUT,
        "launcher_entry": {"title": "Springtide"},
    }
