"""Number of steps that lead a scene to a time."""

import math
from typing import Any

from app.scenes.contract import Scene


def steps_to(scene: Scene[Any, Any, Any], until: float) -> int:
    """Steps from a scene's time to the first whole step at or after `until` [s], round-off allowed for."""
    return max(0, math.ceil((until - scene.time) / scene.step * (1.0 - 1e-9) - 1e-6))
