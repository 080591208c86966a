"""The reader of presets: a scene's own by name, or a file {"scene": "rope", "parameters": {"points": 50}}."""

import json
from pathlib import Path
from typing import Any

from app.scenes.contract import SceneKind
from sim.parameters import check_record
from sim.validation import argument_error


def read_preset(
    option: str, preset: str, scene: SceneKind[Any, Any, Any], folder: Path | None = None
) -> dict[str, Any]:
    """The parameters that a preset sets. preset: a name, or the path of a .json file, relative to `folder`.

    Raises ValueError, naming the option, where there is no such preset of this scene or a value is not allowed.
    """
    if preset in scene.presets:
        return dict(scene.presets[preset])
    path = (folder or Path()) / preset
    if path.suffix != ".json" and not path.is_file():
        raise argument_error(option, preset, "one of " + ", ".join(scene.presets) + "; or a file FILE.json")
    try:
        content = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise argument_error(option, str(path), f"a file that can be read ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise argument_error(option, str(path), f"a file of JSON ({error})") from None
    name = scene.name
    if not isinstance(content, dict) or not isinstance(content.get("parameters"), dict):
        raise argument_error(option, str(path), f'a file {{"scene": "{name}", "parameters": {{...}}}}')
    if content.get("scene", name) != name:
        raise argument_error(f"{option} scene", content["scene"], name)
    given = content["parameters"]
    checked = check_record(scene.params, given)
    return {key: getattr(checked, key) for key in given}
