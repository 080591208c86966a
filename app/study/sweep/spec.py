"""`Spec`: the specification of a sweep, read from TOML and checked completely before any work.

The checks are written here and not declared as types for msgspec or pydantic: what is allowed depends on the scene that
the spec names, and an error is to name the value and the range with its unit, which those libraries' errors do not.
"""

import dataclasses
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from app.scenes import NAMES, scene_named
from app.scenes.contract import SceneKind
from app.scenes.setups import Setup, file_name, make_setup, preset_setup, with_values, without_effect
from app.study.sweep.design import MAX_CASES, Axis, Listed, Range, grid, grid_values, hypercube, size
from sim.inputs.kinds import check_file
from sim.parameters import Parameter, check_value, parameters_of, unknown_parameter
from sim.validation import argument_error, check_choice, check_number, is_whole_number, unreadable

DESIGNS = ("grid", "random")
KEYS = ("scene", "seconds", "frames", "preset", "design", "cases", "seed", "set", "parameters")
RANGE = "{ from = LOW, to = HIGH, count = N, log = true } or a list of values, such as [1, 2]"
MAX_DURATION = 1e5  # [s] of simulated time
MAX_FRAMES = 10_000
MAX_FRAMES_IN_ALL = 10_000_000  # cases times frames


@dataclasses.dataclass(frozen=True)
class Spec:
    """A sweep, checked."""

    scene: str
    seconds: float  # [s]
    frames: int
    design: str  # grid, random
    seed: int | None  # of a random design
    fixed: dict[str, Any]  # parameters that are the same in every case and not their defaults
    swept: dict[str, tuple[Any, ...]]  # the values of each swept parameter: along its axis, or case by case
    cases: list[dict[str, Any]]  # the swept parameters of each case
    text: str  # as read; of the path of a preset the file name only
    notes: tuple[str, ...] = ()  # a line on each parameter of [set] that has no effect in any case

    @property
    def times(self) -> tuple[float, ...]:
        """Times [s] at which each case is measured."""
        return (self.seconds,) if self.frames == 1 else tuple(np.linspace(0.0, self.seconds, self.frames).tolist())

    @property
    def kind(self) -> SceneKind[Any, Any, Any]:
        """The scene that is swept."""
        return scene_named(self.scene)

    def params(self, index: int) -> Any:
        """The scene's parameters in case `index`."""
        return make_setup(self.kind, "", {**self.fixed, **self.cases[index]}).params

    def identity(self) -> dict[str, Any]:
        """Everything that determines the results, for JSON."""
        names = ("scene", "seconds", "frames", "design", "seed", "fixed")
        return {name: getattr(self, name) for name in names} | {
            "parameters": {k: list(v) for k, v in self.swept.items()}
        }


def read_spec(path: Path) -> Spec:
    """Read and check a spec. Raises ValueError with the key, its value and the allowed values."""
    check_file("SPEC", path, ("sweep", "toml"), "the specification of a sweep (TOML)")
    try:
        text = path.read_text("utf-8")
    except OSError as error:
        raise unreadable("SPEC", path, error) from None
    except ValueError as error:
        raise ValueError(f"SPEC: {path} is not TOML ({error})") from None
    try:
        content = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        advice = "; a path with backslashes goes in single quotes" if "\\" in text else ""
        raise ValueError(f"SPEC: {path} is not TOML ({error}){advice}") from None
    return make_spec(content, text, path.parent)


def make_spec(content: dict[str, Any], text: str = "", folder: Path | None = None) -> Spec:
    """Check a spec from a file in `folder`. Raises ValueError."""
    for key in content:
        if key not in KEYS:
            raise ValueError(f"{key}: no such key of a spec; the keys are {', '.join(KEYS)}")
    for key in ("scene", "seconds", "parameters"):
        if key not in content:
            raise ValueError(f"{key}: missing; a spec has scene, seconds and [parameters]")
    name = content["scene"]
    scene = scene_named(name if isinstance(name, str) else check_choice("scene", name, NAMES))
    known = parameters_of(scene.params)
    seconds = check_number("seconds", content["seconds"], "s", 0.0, MAX_DURATION, above=True)
    frames = whole(content, "frames", 1, 1, MAX_FRAMES)
    design = check_choice("design", content.get("design", "grid"), DESIGNS)
    swept = table(content, "parameters")
    if not swept:
        raise ValueError("parameters: empty; name at least one parameter to sweep")
    fixed = fixed_parameters(scene, content, folder)
    axes: dict[str, Axis] = {}
    for parameter_name, entry in swept.items():
        if parameter_name not in known:
            raise unknown_parameter(parameter_name, known)
        if parameter_name in table(content, "set"):
            raise ValueError(f"{parameter_name}: both in [set] and in [parameters]; name it once")
        axes[parameter_name] = read_axis(parameter_name, known[parameter_name], entry, design)
    seed = None
    if design == "random":
        if "cases" not in content:
            raise ValueError("cases: missing; a random design needs their number")
        seed = whole(content, "seed", 0, 0, 2**32 - 1)
        cases = hypercube(axes, known, whole(content, "cases", 0, 1, MAX_CASES), seed)
        values = {k: tuple(case[k] for case in cases) for k in axes}
    else:
        for key in ("cases", "seed"):
            if key in content:
                raise ValueError(f"{key}: belongs to a random design; this one is a grid")
        if size(axes) > MAX_CASES:
            raise argument_error("parameters", f"{size(axes)} cases", f"at most {MAX_CASES}")
        values = {k: grid_axis(k, known[k], axis) for k, axis in axes.items()}
        cases = grid(values)
    if len(cases) * frames > MAX_FRAMES_IN_ALL:
        raise argument_error("frames", f"{frames} times {len(cases)} cases", f"at most {MAX_FRAMES_IN_ALL} in all")
    for parameter_name in fixed.keys() & axes.keys():
        del fixed[parameter_name]
    preset = content.get("preset", "")
    if preset and preset not in scene.presets:
        for path in (json.dumps(preset, ensure_ascii=False)[1:-1], preset):  # as in double quotes, and in single ones
            text = text.replace(path, file_name(preset))
    spec = Spec(scene.name, seconds, frames, design, seed, fixed, values, cases, text)
    check_swept_parameters_matter(spec, scene)
    return dataclasses.replace(spec, notes=unused_in_all(spec, table(content, "set")))


def unused_in_all(spec: Spec, values: dict[str, Any]) -> tuple[str, ...]:
    """Lines on the given parameters without effect in all cases, by the others of the first case."""
    unused = set(values)
    for index in range(len(spec.cases)):
        unused &= spec.kind.hidden(spec.params(index))
        if not unused:
            return ()
    first = Setup(spec.scene, spec.params(0), {name: value for name, value in values.items() if name in unused})
    return tuple(without_effect(first))


def fixed_parameters(scene: SceneKind[Any, Any, Any], content: dict[str, Any], folder: Path | None) -> dict[str, Any]:
    """Values of the preset and of [set]. The plots are on, because measures depend on them."""
    preset = content.get("preset")
    if preset is not None and not isinstance(preset, str):
        raise argument_error("preset", preset, "one of " + ", ".join(scene.presets) + "; or a file FILE.json")
    setup = make_setup(scene, "") if preset is None else preset_setup("preset", preset, scene, folder)
    for option, file in setup.files.items():
        allowed = f"a set-up without a {option} in a sweep"
        raise argument_error("preset", f"{preset} with the {option} {file}", allowed)
    plotted = make_setup(scene, "", dict.fromkeys(scene.plots, True))
    return dict(with_values(plotted, {**setup.values, **table(content, "set")}).values)


def read_axis(name: str, parameter: Parameter, entry: Any, design: str) -> Axis:
    """The list or range of a swept parameter. Raises ValueError."""
    if isinstance(entry, list):
        if not entry:
            raise argument_error(name, entry, RANGE)
        values = tuple(check_value(name, parameter, value) for value in entry)
        if len(set(values)) < len(values):
            raise ValueError(f"{name}: {entry!r} holds a value twice")
        return Listed(values)
    if not isinstance(entry, dict) or not {"from", "to"} <= entry.keys():
        raise argument_error(name, entry, RANGE)
    for key in entry:
        if key not in ("from", "to", "count", "log"):
            raise argument_error(f"{name}.{key}", entry[key], RANGE)
    if parameter.choices or parameter.kind is bool:
        raise argument_error(name, entry, f"a list of values, {parameter.allowed}")
    low, high = check_value(f"{name}.from", parameter, entry["from"]), check_value(f"{name}.to", parameter, entry["to"])
    if not low < high:
        raise argument_error(f"{name}.to", high, f"above from, {low:g}")
    log = entry.get("log", False)
    if not isinstance(log, bool):
        raise argument_error(f"{name}.log", log, "true or false")
    if log and low <= 0:
        raise argument_error(f"{name}.from", low, "above 0 where log is true")
    if design == "random":
        if "count" in entry:
            raise ValueError(f"{name}.count: belongs to a grid; in a random design `cases` is their number")
        return Range(low, high, 0, log)
    if "count" not in entry:
        raise ValueError(f"{name}.count: missing; a grid needs the number of values")
    return Range(low, high, whole(entry, "count", 0, 2, MAX_CASES, name), log)


def grid_axis(name: str, parameter: Parameter, axis: Axis) -> tuple[Any, ...]:
    """The values along an axis of a grid. Raises ValueError if rounding to whole numbers makes two of them equal."""
    values = grid_values(axis, parameter)
    if len(set(values)) < len(values):
        raise argument_error(f"{name}.count", len(values), f"at most {len(set(values))}: these are whole numbers")
    return values


def check_swept_parameters_matter(spec: Spec, scene: SceneKind[Any, Any, Any]) -> None:
    """Raises ValueError for a swept parameter that has no effect in any of the cases."""
    without_effect = set(spec.swept)
    for index in range(len(spec.cases)):
        without_effect &= scene.hidden(spec.params(index))
        if not without_effect:
            return
    name = min(without_effect)
    raise ValueError(f"{name}: has no effect with the other parameters; set those that make it act")


def table(content: dict[str, Any], key: str) -> dict[str, Any]:
    """The TOML table at `key`, or an empty one. Raises ValueError for anything else."""
    section = content.get(key, {})
    if not isinstance(section, dict):
        raise argument_error(key, section, f"a table, [{key}]")
    return section


def whole(content: dict[str, Any], key: str, default: int, low: int, high: int, of: str = "") -> int:
    """The whole number at `key`, in [low, high]. of: the parameter that it belongs to. Raises ValueError."""
    value = content.get(key, default)
    if not is_whole_number(value) or not low <= value <= high:
        raise argument_error(f"{of}.{key}" if of else key, value, f"a whole number from {low} to {high}")
    return value
