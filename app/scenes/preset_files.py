"""Preset files: a scene's parameters as JSON, {"scene": "rope", "parameters": {"points": 50}}."""

import json
from pathlib import Path
from typing import Any

from app.scenes.contract import SceneKind
from sim.parameters import check_record
from sim.validation import argument_error


def read_preset(path: Path, scene: SceneKind[Any, Any, Any]) -> dict[str, Any]:
    """The parameters in a preset file; raises ValueError where it is not one of this scene's."""
    try:
        content = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise argument_error("--preset", str(path), f"a file that can be read ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"--preset: {path} is not JSON ({error})") from None
    name = scene.name
    if not isinstance(content, dict) or not isinstance(content.get("parameters"), dict):
        raise ValueError(f'--preset: {path} is not a preset; allowed: {{"scene": "{name}", "parameters": {{...}}}}')
    if content.get("scene", name) != name:
        raise argument_error("--preset scene", content["scene"], name)
    check_record(scene.params, content["parameters"])
    return content["parameters"]
