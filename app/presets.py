"""Preset files: a scene's knobs as JSON, {"scene": "rope", "knobs": {"points": 50}}."""

import json
from pathlib import Path
from types import ModuleType
from typing import Any

from sim.knobs import check, refusal


def read_preset(path: Path, scene: ModuleType) -> dict[str, Any]:
    """The knobs in a preset file; raises ValueError where it is not one of this scene's."""
    try:
        content = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise refusal("--preset", str(path), f"a file that can be read ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"--preset: {path} is not JSON ({error})") from None
    name = scene.__name__.rpartition(".")[2]
    if not isinstance(content, dict) or not isinstance(content.get("knobs"), dict):
        raise ValueError(f'--preset: {path} is not a preset; allowed: {{"scene": "{name}", "knobs": {{...}}}}')
    if content.get("scene", name) != name:
        raise refusal("--preset scene", content["scene"], name)
    check(scene.Params, content["knobs"])
    return content["knobs"]
