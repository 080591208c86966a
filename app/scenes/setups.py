"""Set-ups: the parameters of a scene as the query of an address and as a file. Only this file reads both.

The address `/?scene=rope&preset=...&stiffness=2000` and the file

    {"version": 1, "scene": "rope", "preset": "...", "parameters": {"stiffness": 2000}, "name": "...", "note": "..."}

are equivalent: a preset (by default the scene's defaults), and the values that differ from it. A number is written so
that reading returns exactly the same number. A hull, a mooring or a spectrum from a file is no parameter: a set-up file
has its name, `"hull": "boat.stl"`, and the changes made to it in the panel; its reader is asked to add the file.

A replay (HTML) holds such a file in a block, and a recording (.npz) all parameters: both open like one.
"""

import contextlib
import dataclasses
import difflib
import io
import json
import math
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path, PureWindowsPath
from types import MappingProxyType
from typing import Any, BinaryIO, NamedTuple
from urllib.parse import parse_qsl, urlencode

import numpy as np

from app.messages import BaseParams, Vector
from app.scenes import NAMES, scene_named
from app.scenes.contract import AnyKind, SceneKind
from sim.parameters import (
    Value,
    changed_names,
    check_record,
    choice_error,
    clamp_value,
    parameters_of,
    parse_value,
    unknown_parameter,
)
from sim.quantities import read_number, write_number
from sim.validation import Refusals, argument_error, unreadable

VERSION = 2  # of a file that names another file; others are of version 1, so that older programs can read them
MAX_LENGTH = 5000  # characters of a query or a file
MAX_NAME, MAX_NOTE, MAX_FILE_NAME = 60, 1000, 255  # characters
MAX_CAMERA_DISTANCE = 1e4  # [m] from the origin
CAMERA_DECIMALS = 3  # of the camera's coordinates [m]
OWN_KEYS = ("scene", "preset", "camera")  # of a query; all others are parameters
MAX_REPLAY = 200_000_000  # [bytes] of a replay; one of 20 s has 25 MB
MAX_ABOUT = 100_000  # [bytes] of a recording's description
BLOCK, BLOCK_END = '<script type="application/json" id="springtide-setup">', "</script>"
UNREADABLE = (ValueError, KeyError, EOFError, RuntimeError, struct.error, zipfile.BadZipFile, zlib.error)
FORMS = "a set-up file (.json), a replay (.html) or a recording (.npz) of Springtide"
NO_VALUES: Mapping[str, Value] = MappingProxyType({})
# options that add a file to a scene -> the fields of its parameters with their paths
FILES = {"hull": "hull", "mooring": "moordyn_file", "spectrum": "spectrum_file"}
CHANGES = "file_changes"  # the field with what was changed of such a file, and its name in a set-up
CHANGED = ("length", "diameter")  # kinds of change
MOST_CHANGES = 200
FILE_KEYS = ("version", "scene", "preset", "parameters", "camera", *FILES, CHANGES, "name", "note")

Camera = tuple[Vector, Vector]  # position and target [m]
Changes = tuple[tuple[str, str, float], ...]  # one of CHANGED, of what, and its value [m]


class Setup(NamedTuple):
    """A scene's parameters."""

    scene: str
    params: BaseParams  # the scene's own record
    values: Mapping[str, Value]  # the parameters named, by the preset or one by one
    preset: str = ""  # from which they differ; "" for the defaults
    camera: Camera | None = None
    name: str = ""
    note: str = ""
    files: Mapping[str, str] = {}  # of FILES: the name of the added file, whose content is in no set-up
    changes: Changes = ()  # of that file
    task: str = ""  # of the lab, that a link opens too


def file_name(path: str) -> str:
    """The last part of a path of any system: only this goes into a file that may be shared."""
    return PureWindowsPath(path).name


def shared_values(params: BaseParams) -> dict[str, Value]:
    """All fields of a record by name, for a shared file: of a path only its file name."""
    paths = FILES.values()
    return {name: file_name(value) if name in paths else value for name, value in vars(params).items()}


def described(kind: AnyKind, params: BaseParams) -> dict[str, Any]:
    """Entries for the file of a run: the scene, its parameters, and the facts of a file that they name."""
    values, file = shared_values(params), kind.file_facts(params)
    if file is None:
        return {"scene": kind.name, "parameters": values}
    used = {name: value for name, value in values.items() if name not in file.unused}
    return {"scene": kind.name, "parameters": used, file.name: file.facts}


def added_files(params: object) -> dict[str, str]:
    """Names of the files added to these parameters, by their options."""
    paths = {option: file_name(getattr(params, field, "")) for option, field in FILES.items()}
    return {option: name for option, name in paths.items() if name}


def missing_files(setup: Setup, present: object = None) -> str:
    """Advice for adding the files of a set-up, or "" if it needs none or the parameters `present` have them."""
    missing = [(option, name) for option, name in setup.files.items() if added_files(present).get(option) != name]
    end = ", then open the set-up again for its changes of the file." if setup.changes else "."
    return " ".join(
        f"The {option} {name} is missing: the set-up only names it. Restart with --{option} {name} to add the file{end}"
        for option, name in missing
    )


def without_effect(setup: Setup) -> list[str]:
    """A line on each parameter that a set-up names, with another value than its preset, and that has no effect."""
    kind = scene_named(setup.scene)
    preset = make_setup(kind, setup.preset).params
    hidden = kind.hidden(setup.params)
    named = [name for name, value in setup.values.items() if name in hidden and getattr(preset, name) != value]
    return [f"{name} has no effect with {cause_of(kind, setup, name)}" for name in named]


def cause_of(kind: AnyKind, setup: Setup, name: str) -> str:
    """The parameter, or the file, without which a parameter would have an effect, for a sentence."""
    params = setup.params
    known = parameters_of(params)
    for other in sorted(known, key=lambda one: one not in setup.values):  # those that are named first
        parameter, present = known[other], getattr(params, other)
        numbers = () if parameter.choices or parameter.kind is bool else (0, 1, parameter.low, parameter.high)
        for value in (*(parameter.choices or ()), *(() if numbers else (not present,)), *numbers):
            changed = clamp_value(parameter, value)
            if other != name and changed != present:
                with contextlib.suppress(ValueError):  # one that the others do not allow
                    if name not in kind.hidden(dataclasses.replace(params, **{other: changed})):
                        return f"{other}={write_value(present)}"
    files = added_files(params)
    return " and ".join(f"the {option} {file}" for option, file in files.items()) or "the other parameters"


def with_changes(params: BaseParams, setup: Setup) -> BaseParams:
    """The parameters with a set-up's changes of their file, if it is the one that the set-up names.

    Raises ValueError if this file, of the same name, cannot have them.
    """
    editing = scene_named(setup.scene).file_editing
    if editing is None or not setup.files or added_files(params) != setup.files:
        return params
    new_params = dataclasses.replace(params, **{CHANGES: setup.changes})
    editing.numbers(new_params)
    return new_params


def differing_values(kind: AnyKind, params: BaseParams, preset: str) -> dict[str, Value]:
    """The parameters in which a record differs from a preset of the scene, or from the defaults where it is ""."""
    base = make_setup(kind, preset).params
    names = changed_names(base, params)
    return {name: getattr(params, name) for name in parameters_of(params) if name in names}


def make_setup(
    kind: AnyKind, preset: str | None = None, values: Mapping[str, object] = NO_VALUES, what: str = "preset"
) -> Setup:
    """The set-up of a preset, with other values of some parameters.

    preset: a name, or "" for the scene's defaults; None for the preset that the scene opens with, or for the defaults
    if there are values. Raises ValueError, naming `what`, if there is no such preset or a value is not allowed.
    """
    if preset is None:
        preset = "" if values else kind.opening
    named = preset_named(what, preset, kind) if preset else NO_VALUES
    return with_values(Setup(kind.name, kind.params(), named, preset), values)


def with_values(setup: Setup, values: Mapping[str, object]) -> Setup:
    """A set-up with other values of some parameters. Raises ValueError if one is not allowed.

    All records from presets, files, links and values are made here.
    """
    named = {**setup.values, **values}
    params = check_record(scene_named(setup.scene).params, named)
    return setup._replace(params=params, values={name: getattr(params, name) for name in named})


def nearest_preset(kind: AnyKind, params: BaseParams, preset: str) -> str:
    """`preset` where naming it makes the set-up shorter, otherwise ""."""
    if preset not in kind.presets:
        return ""
    return preset if len(differing_values(kind, params, preset)) < len(differing_values(kind, params, "")) else ""


def write_value(value: Value) -> str:
    """A value as `parse_value` reads it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else write_number(value)


def write_query(kind: AnyKind, params: BaseParams, preset: str = "", camera: Camera | None = None) -> str:
    """The shortest query, "?scene=...", of a set-up. preset: source of the parameters."""
    base = nearest_preset(kind, params, preset)
    said = {"scene": kind.name}
    if base:
        said["preset"] = base
    said.update({name: write_value(value) for name, value in differing_values(kind, params, base).items()})
    if len(said) == 1 and kind.opening:  # a scene alone opens as it is shown first
        said["preset"] = next(name for name, values in kind.presets.items() if not values)
    if camera is not None:
        said["camera"] = ",".join(f"{c:g}" for c in camera_numbers(camera))
    return "?" + urlencode(said, safe=",")


def read_query(query: str) -> Setup:
    """The set-up of a query, with or without its "?"; of a scene alone, its first view.

    Raises ValueError with all its errors.
    """
    texts = entries(query)
    scene, wrong = texts.get("scene", ""), Refusals()
    with wrong:
        kind_named(scene)
    kind = scene_named(next(iter(difflib.get_close_matches(scene, NAMES, 1)), NAMES[0]))
    known = parameters_of(kind.params)
    values: dict[str, Value] = {}
    if texts.get("preset"):
        with wrong:
            preset_named("preset", texts["preset"], kind)
    for name, text in texts.items():
        if name in OWN_KEYS:
            continue
        with wrong:
            if name not in known:
                raise unknown_parameter(name, known)
            values[name] = parse_value(name, known[name], text)
    camera = None
    if "camera" in texts:
        with wrong:
            camera = read_camera([camera_number(text, texts["camera"]) for text in texts["camera"].split(",")])
    wrong.check()
    return make_setup(kind, texts.get("preset"), values)._replace(camera=camera)


def split_task(query: str) -> tuple[str, str]:
    """The task that a query names, "" for none, and the rest of the query. Raises ValueError as `read_query` does."""
    texts = entries(query)
    return texts.pop("task", ""), urlencode(texts)


def entries(query: str) -> dict[str, str]:
    """The values of a query by name. Raises ValueError if it is too long or names one twice."""
    check_length("address", query)
    pairs = parse_qsl(query.removeprefix("?"), keep_blank_values=True)
    texts = dict(pairs)
    for name in texts:
        if sum(other == name for other, _ in pairs) > 1:
            raise ValueError(f"{shortened(name)!r}: given more than once in the address")
    return texts


def read_setup(text: str) -> Setup:
    """The set-up of a word of a command line: SCENE, SCENE:PRESET, a link or its query, or a set-up file.

    A scene alone opens in its first view. Raises ValueError for an invalid word.
    """
    if "?" in text:
        return read_query(text[text.index("?") :])
    path = Path(text)
    if path.suffix == ".json" or path.is_file():
        return read_file(read_setup_text("set-up", path), f"set-up {path}")
    scene, _, preset = text.partition(":")
    kind = kind_named(scene)
    preset = preset or kind.opening
    return read_query("?" + urlencode({"scene": scene, **({"preset": preset} if preset else {})}))


def camera_numbers(camera: Camera) -> list[float]:
    """The six numbers of a camera, rounded to a millimetre."""
    return [round(c, CAMERA_DECIMALS) + 0.0 for point in camera for c in point]


def camera_number(text: str, camera: str) -> float:
    """One of the camera's six numbers. Raises ValueError."""
    try:
        return read_number(text)
    except ValueError:
        raise camera_error(camera) from None


def camera_error(camera: object) -> ValueError:
    """The error for an invalid camera."""
    allowed = f"six numbers, position and target, at most {MAX_CAMERA_DISTANCE:g} m from the origin and not the same"
    return argument_error("camera", camera, allowed)


def read_camera(numbers: object) -> Camera:
    """Position and target of six numbers [m]. Raises ValueError."""
    if not isinstance(numbers, list) or len(numbers) != 6:
        raise camera_error(numbers)
    if any(isinstance(c, bool) or not isinstance(c, int | float) for c in numbers):
        raise camera_error(numbers)
    if not all(abs(c) <= MAX_CAMERA_DISTANCE for c in numbers):  # before `float`, which raises for a very long number
        raise camera_error(numbers)
    x, y, z, target_x, target_y, target_z = (float(c) for c in numbers)
    position, target = (x, y, z), (target_x, target_y, target_z)
    if position == target:
        raise camera_error(numbers)
    return position, target


def write_file(
    kind: AnyKind, params: BaseParams, preset: str = "", camera: Camera | None = None, *, name: str = "", note: str = ""
) -> str:
    """The text of a set-up file. Raises ValueError for a name or note that is not allowed."""
    base = nearest_preset(kind, params, preset)
    files = added_files(params)
    content: dict[str, Any] = {"version": VERSION if files else 1, "scene": kind.name}
    if base:
        content["preset"] = base
    content["parameters"] = differing_values(kind, params, base)
    if camera is not None:
        content["camera"] = camera_numbers(camera)
    content |= files
    if changes := getattr(params, CHANGES, ()):
        content[CHANGES] = [list(one) for one in changes]
    if name:
        content["name"] = read_text("name", name, MAX_NAME)
    if note:
        content["note"] = read_text("note", note, MAX_NOTE)
    return json.dumps(content, ensure_ascii=False, indent=2) + "\n"


def read_file(text: str, where: str = "set-up", scene: str | None = None) -> Setup:
    """The set-up in the text of a file. where: names the file in errors. scene: the required one, if any.

    A file without a version is of version 1, and one without a scene is of `scene`. Raises ValueError for what is not
    allowed.
    """
    if text.startswith("PK"):
        raise argument_error(where, "a recording (.npz)", "a set-up file or a replay; `--preset FILE` takes recordings")
    if text.lstrip().startswith("<"):
        raise argument_error(where, shortened(text), FORMS)
    check_length(where, text)
    try:
        content = json.loads(text, object_pairs_hook=unique_keys)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{where}: not a JSON file: {error}") from None
    form = f'{{"version": {VERSION}, "scene": "{scene or "rope"}", "parameters": {{...}}}}'
    if not isinstance(content, dict) or not isinstance(content.get("parameters", {}), dict):
        raise argument_error(where, shortened(text), f"a file {form}")
    for key in content:
        if key not in FILE_KEYS:
            raise argument_error(f"{where}: key", key, "one of " + ", ".join(FILE_KEYS))
    version = content.get("version", 1)
    if type(version) is not int or not 1 <= version <= VERSION:
        raise argument_error(f"{where}: version", version, f"1 to {VERSION}; a newer one needs a newer Springtide")
    if "parameters" not in content and "preset" not in content:
        raise argument_error(where, shortened(text), f"a file {form}")
    scene_name = content.get("scene", scene)
    if scene is not None and scene_name != scene:
        raise argument_error(f"{where}: scene", scene_name, scene)
    kind = kind_named(scene_name)
    preset = content.get("preset", "")
    if preset != "":
        preset_named(f"{where}: preset", preset, kind)
    setup = make_setup(kind, preset, content.get("parameters", {}))
    camera = read_camera(content["camera"]) if content.get("camera") is not None else None
    name = read_text(f"{where}: name", content.get("name", ""), MAX_NAME)
    note = read_text(f"{where}: note", content.get("note", ""), MAX_NOTE)
    names = {one: file_name(read_text(f"{where}: {one}", content.get(one, ""), MAX_FILE_NAME)) for one in FILES}
    files = {option: file for option, file in names.items() if file}
    changes = read_changes(f"{where}: {CHANGES}", content.get(CHANGES, []))
    return setup._replace(camera=camera, name=name, note=note, files=files, changes=changes)


def read_changes(what: str, value: object) -> Changes:
    """The changes of a file as JSON holds them. Raises ValueError."""
    if not isinstance(value, list) or len(value) > MOST_CHANGES:
        raise argument_error(what, shortened(str(value)), f"a list of at most {MOST_CHANGES} changes")
    changes: list[tuple[str, str, float]] = []
    for one in value:
        if not (
            isinstance(one, list)
            and len(one) == 3
            and one[0] in CHANGED
            and type(one[2]) in (int, float)
            and 0.0 < one[2] < math.inf
        ):
            allowed = f'["length", "1", 210.0]: {" or ".join(CHANGED)}, of what, and metres above 0'
            raise argument_error(what, shortened(str(one)), allowed)
        changes.append((one[0], read_text(what, one[1], MAX_NAME), float(one[2])))
    return tuple(changes)


def unique_keys(pairs: list[tuple[str, object]]) -> dict[str, object]:
    """A JSON object. Raises ValueError for a repeated key, whose value would be ambiguous."""
    members = dict(pairs)
    if len(members) < len(pairs):
        raise ValueError("a key appears twice")
    return members


def check_length(what: str, text: str) -> None:
    """Raises ValueError for a text longer than any set-up."""
    if len(text) > MAX_LENGTH:
        raise argument_error(what, f"more than {MAX_LENGTH} characters", f"at most {MAX_LENGTH}")


def shortened(text: str) -> str:
    """The beginning of a text, for a message."""
    return text if len(text) <= 40 else text[:40] + "..."


def read_text(what: str, text: object, max_length: int) -> str:
    """A name or note: printable, on one line. Raises ValueError."""
    if not isinstance(text, str) or len(text) > max_length or not text.isprintable():
        raise argument_error(what, shortened(str(text)), f"at most {max_length} printable characters on one line")
    return text


def kind_named(name: object) -> AnyKind:
    """The scene of a set-up. Raises ValueError for an unknown name."""
    if not isinstance(name, str) or name not in NAMES:
        raise choice_error("scene", name, NAMES)
    return scene_named(name)


def preset_named(what: str, preset: object, kind: SceneKind[Any, Any, Any]) -> Mapping[str, Value]:
    """The values of a scene's preset. Raises ValueError for an unknown name."""
    if not isinstance(preset, str) or preset not in kind.presets:
        raise choice_error(what, preset, kind.presets)
    return kind.presets[preset]


def preset_setup(option: str, preset: str, kind: SceneKind[Any, Any, Any], folder: Path | None = None) -> Setup:
    """The set-up that a preset names. preset: a name, or the path of a file, relative to `folder`.

    Raises ValueError, naming the option, if there is no such preset of this scene or a value is not allowed.
    """
    if preset in kind.presets:
        return make_setup(kind, preset)
    path = (folder or Path()) / preset
    if path.suffix != ".json" and not path.is_file():
        raise choice_error(option, preset, kind.presets, "; or a file FILE.json")
    return read_file(read_setup_text(option, path), f"{option} {path}", kind.name)


def setup_block(kind: AnyKind, params: BaseParams) -> str:
    """A set-up file as an inert block of a page."""
    return BLOCK + write_file(kind, params).replace("<", "\\u003c") + BLOCK_END


def read_setup_text(what: str, path: Path) -> str:
    """The text of a set-up file, or of the set-up that a replay or a recording holds.

    what: name of the file in errors. Raises ValueError if it cannot be read or holds no set-up.
    """
    from sim.inputs.kinds import check_file  # a start without a file does without it

    check_file(what, path, ("set-up", "json"), FORMS)
    try:
        with path.open("rb") as file:
            start = file.read(4 * MAX_LENGTH + 1)
            if start.startswith(b"PK"):
                return recorded_setup(file)
            if start.lstrip().startswith(b"<"):
                return replayed_setup((start + file.read(MAX_REPLAY)).decode("utf-8"))
        return start.decode("utf-8")
    except OSError as error:
        raise unreadable(what, path, error) from None
    except UnicodeDecodeError:
        raise argument_error(what, str(path), "a JSON file in UTF-8") from None
    except UNREADABLE:
        raise argument_error(what, str(path), FORMS) from None


def replayed_setup(page: str) -> str:
    """The text of the set-up file in a replay. Raises ValueError without one."""
    start = page.rindex(BLOCK) + len(BLOCK)
    return page[start : page.index(BLOCK_END, start)]


def recorded_setup(file: BinaryIO) -> str:
    """The parameters of a recording as the text of a set-up file.

    Raises ValueError, KeyError or an error of `zipfile` for any other file.
    """
    with zipfile.ZipFile(file) as parts:
        about = parts.getinfo("about.npy")
        if about.file_size > MAX_ABOUT or about.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError("about: too long, or packed in another way than numpy's")
        array = io.BytesIO(parts.read(about))
    if np.lib.format.read_magic(array) != (1, 0):
        raise ValueError("about: not in numpy's format")
    shape, _, dtype = np.lib.format.read_array_header_1_0(array)
    if shape != () or dtype.kind != "U":  # before an array of any size is made
        raise ValueError("about: not a text")
    content = json.loads(str(np.frombuffer(array.read(), dtype)[0]), object_pairs_hook=unique_keys)
    if not isinstance(content, dict) or not isinstance(content.get("parameters"), dict):
        raise ValueError("about: without the parameters of a recording")
    kind = kind_named(content.get("scene"))
    others = {field.name for field in dataclasses.fields(kind.params)} - set(parameters_of(kind.params))
    values = {name: value for name, value in content["parameters"].items() if name not in others}
    setup = {
        "version": VERSION,
        "scene": kind.name,
        "parameters": values,
        **{option: content["parameters"].get(field, "") for option, field in FILES.items()},
        CHANGES: content["parameters"].get(CHANGES, []),
    }
    return json.dumps(setup, ensure_ascii=False)
