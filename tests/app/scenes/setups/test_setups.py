"""Set-ups as addresses and as files: what is written is read back to the last bit, and nothing else is taken."""

import dataclasses
import io
import json
import math
import random
from typing import Any
from urllib.parse import urlencode

import numpy as np
import pytest

from app.render.markup.html import fill
from app.scenes import NAMES, scene_named
from app.scenes.setups import (
    FILE_KEYS,
    MAX_LENGTH,
    MAX_NAME,
    OWN_KEYS,
    make_setup,
    preset_setup,
    read_file,
    read_query,
    read_setup_text,
    setup_block,
    write_file,
    write_query,
)  # fmt: skip
from sim.parameters import Parameter, Value, check_record, parameters_of

RECORDS = 200  # of each scene
HOSTILE = 1000
CAMERA = ((1.25, -4.0, 2.5), (0.0, 0.5, 1.75))  # of few digits: these are kept as they are


def random_value(parameter: Parameter, rng: random.Random) -> Value:
    """Any value that is allowed: the bounds too, and numbers with all their digits."""
    if parameter.choices:
        return rng.choice(parameter.choices)
    if parameter.kind is bool:
        return rng.random() < 0.5
    if parameter.kind is int:
        return rng.randint(math.ceil(parameter.low), math.floor(parameter.high))
    kind = rng.randrange(5)
    if kind == 0:
        return float(rng.choice((parameter.low, parameter.high)))
    if kind == 1:
        ratio = 1 / rng.randint(2, 5000)
        return ratio if parameter.low <= ratio <= parameter.high else float(parameter.default)
    if kind == 2 and parameter.log_from:
        return min(10.0 ** rng.uniform(math.log10(parameter.log_from), math.log10(parameter.high)), parameter.high)
    return rng.uniform(parameter.low, parameter.high)


def random_record(name: str, rng: random.Random) -> tuple[str, Any]:
    """A preset of a scene, and a record that differs from it in some parameters."""
    kind = scene_named(name)
    preset = rng.choice(["", *kind.presets])
    base = kind.params(**kind.presets[preset]) if preset else kind.params()
    known = parameters_of(kind.params)
    changed = rng.sample(list(known), rng.randint(0, min(12, len(known))))
    return preset, dataclasses.replace(base, **{key: random_value(known[key], rng) for key in changed})


@pytest.mark.parametrize("name", NAMES)
def test_a_record_survives_an_address_and_a_file_to_the_last_bit(name: str) -> None:
    rng, kind = random.Random(name), scene_named(name)
    for _ in range(RECORDS):
        preset, params = random_record(name, rng)
        link = write_query(kind, params, preset, CAMERA)
        by_link = read_query(link)
        by_file = read_file(write_file(kind, params, preset, CAMERA, name="Mine", note="ö · <b>"))
        for setup in (by_link, by_file):
            assert setup.params == params, (link, setup.params)
            assert setup.scene == name
            assert setup.camera == CAMERA
        assert (by_file.name, by_file.note) == ("Mine", "ö · <b>")


@pytest.mark.parametrize("name", NAMES)
def test_the_shortest_form_names_only_what_differs(name: str) -> None:
    kind = scene_named(name)
    # A scene alone opens as it is shown first, which the defaults are not everywhere.
    first = next(preset for preset, values in kind.presets.items() if not values)
    alone = {"scene": name, **({"preset": first} if kind.opening else {})}
    assert write_query(kind, kind.params()) == "?" + urlencode(alone)
    assert read_query(f"?scene={name}").params == make_setup(kind).params
    assert json.loads(write_file(kind, kind.params())) == {"version": 1, "scene": name, "parameters": {}}
    for preset, values in kind.presets.items():
        params = kind.params(**values)
        assert write_query(kind, params, preset) == "?" + urlencode(
            {"scene": name, "preset": preset} if params != kind.params() else alone
        )
        other = dataclasses.replace(params, speed=0.125)
        assert set(read_query(write_query(kind, other, preset)).values) == {*(values if values else ()), "speed"}


def test_no_parameter_bears_a_name_that_addresses_use() -> None:
    for name in NAMES:
        assert not set(OWN_KEYS) & set(parameters_of(scene_named(name).params))


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("?scene=race&stiffness=2000&stifness=1", "stifness: no such parameter"),
        ("?scene=rope&stiffness=-5", "stiffness: '-5' is not allowed; allowed: 1 to"),
        ("?scene=rope&stiffness=nan", "stiffness: 'nan' is not allowed"),
        ("?scene=rope&stiffness=1e999", "stiffness"),
        ("?scene=rope&points=2.5", "points: '2.5' is not allowed"),
        ("?scene=rope&stiffness=1&stiffness=2", "'stiffness': given more than once"),
        ("?scene=rop", "did you mean rope"),
        ("?scene=roope&stifness=3k", "; stifness: no such parameter"),
        ("?stiffness=3", "scene: '' is not allowed"),
        ("?scene=rope&preset=Nowhere", "preset: 'Nowhere' is not allowed"),
        ("?scene=rope&integrator=rk5", "integrator"),
        ("?scene=rope&camera=1,2,3", "camera"),
        ("?scene=rope&camera=1,2,3,1,2,3", "not the same"),
        ("?scene=rope&camera=1,2,3,4,5,1e9", "camera"),
        ("?scene=rope&camera=a,b,c,d,e,f", "camera: 'a,b,c,d,e,f' is not allowed"),
        ("?scene=" + "r" * MAX_LENGTH, "address: "),
    ],
)
def test_what_an_address_may_not_say_is_refused_in_one_line(query: str, words: str) -> None:
    with pytest.raises(ValueError, match=r"\w") as caught:
        read_query(query)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_address_takes_numbers_as_people_write_them() -> None:
    params = read_query("scene=rope&stiffness=2k&time_step=1/600&damping=0%2C02&grid=off").params
    assert vars(params)["stiffness"] == 2000.0
    assert vars(params)["time_step"] == 1 / 600
    assert vars(params)["damping"] == 0.02
    assert vars(params)["grid"] is False


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not a JSON file"),
        ("[1]", "a file {"),
        ("PK\x03\x04", "a recording (.npz)' is not allowed"),
        ("<html>", "a replay (.html)"),
        ("{}", "a file {"),
        ('{"scene": "rope"}', "a file {"),
        ("[" * 5000, "not a JSON file"),
        ('{"parameters": {}}', "scene: None"),
        ('{"version": 3, "scene": "rope", "parameters": {}}', "version: 3 is not allowed"),
        ('{"version": true, "scene": "rope", "parameters": {}}', "version: True is not allowed"),
        ('{"version": 1.0, "scene": "rope", "parameters": {}}', "version: 1.0 is not allowed"),
        ('{"version": "1", "scene": "rope", "parameters": {}}', "version: '1' is not allowed"),
        ('{"scene": "rope", "scene": "race", "parameters": {}}', "a key appears twice"),
        ('{"scene": "rope", "parameters": {"points": 5, "points": 6}}', "a key appears twice"),
        ('{"scene": "rope", "parameters": [1]}', "a file {"),
        ('{"scene": "rope", "parameters": {"stiffness": NaN}}', "stiffness: nan is not allowed"),
        ('{"scene": "rope", "parameters": {"stiffness": "2000"}}', "stiffness: '2000' is not allowed"),
        ('{"scene": "rope", "parameters": {"stiffness": true}}', "stiffness: True is not allowed"),
        ('{"scene": "rope", "parameters": {"stiffness": [1]}}', "stiffness: [1] is not allowed"),
        ('{"scene": "rope", "parameters": {"points": 1e400}}', "points: inf is not allowed"),
        ('{"scene": "rope", "parameters": {"no": 1}}', "no: no such parameter"),
        ('{"scene": "rope", "parameters": {}, "more": 1}', "'more' is not allowed"),
        ('{"scene": ["rope"], "parameters": {}}', "scene"),
        ('{"scene": "rope", "preset": 3, "parameters": {}}', "preset: 3"),
        ('{"scene": "rope", "preset": [], "parameters": {}}', "preset: []"),
        ('{"scene": "rope", "preset": null, "parameters": {}}', "preset: None"),
        ('{"scene": "rope", "parameters": {}, "camera": [1, 2, 3, 4, 5, NaN]}', "camera"),
        (f'{{"scene": "rope", "parameters": {{}}, "camera": [1, 2, 3, 4, 5, {"9" * 400}]}}', "camera"),
        ('{"scene": "rope", "parameters": {}, "camera": [1, 2, 3, 4, 5, true]}', "camera"),
        ('{"scene": "rope", "parameters": {}, "name": "a\\nb"}', "name"),
        (f'{{"scene": "rope", "parameters": {{}}, "name": "{"n" * (MAX_NAME + 1)}"}}', "name"),
        ('{"scene": "rope", "parameters": {}, "note": 5}', "note: '5' is not allowed"),
        (" " * (MAX_LENGTH + 1), "characters"),
    ],
)
def test_what_a_file_may_not_say_is_refused_in_one_line(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=r"\w") as caught:
        read_file(text)
    assert words in str(caught.value), str(caught.value)
    assert "\n" not in str(caught.value)


def test_random_addresses_and_files_give_a_set_up_or_one_line() -> None:
    rng = random.Random(5)
    words = [
        "scene", "rope", "race", "preset", "camera", "stiffness", "1e5", "&", "=", "?", "%", "%00", "<script>", "{",
    ]  # fmt: skip
    words += ['"', ":", ",", "}", "[", "]", "version", "parameters", "1", "\x00", "é", "\n", "null", *FILE_KEYS]
    taken = 0
    for _ in range(HOSTILE):
        text = "".join(rng.choice(words) for _ in range(rng.randint(0, 30)))
        if rng.random() < 0.5:  # near what is right
            name = rng.choice(NAMES)
            preset, params = random_record(name, rng)
            good = rng.choice((write_query, write_file))(scene_named(name), params, preset)
            at = rng.randrange(len(good))
            text = good[:at] + rng.choice((*words, *"0123456789")) + good[at + rng.randint(0, 3) :]
        for read in (read_query, read_file):
            problem = ""
            try:
                setup = read(text)
            except ValueError as reason:
                problem = str(reason)
            else:
                taken += 1
                again = read_query(write_query(scene_named(setup.scene), setup.params, setup.preset, setup.camera))
                assert again.params == setup.params
            assert "\n" not in problem
            assert len(problem) < 4000
    assert taken > 5  # otherwise the loop has tried nothing


def test_a_preset_option_takes_a_file_of_its_own_scene_only(tmp_path: Any) -> None:
    rope, file = scene_named("rope"), tmp_path / "mine.json"
    file.write_text(write_file(rope, check_record(rope.params, {"points": 33, "time_step": 1 / 700})), "utf-8")
    assert preset_setup("--preset", str(file), rope).values == {"points": 33, "time_step": 1 / 700}
    assert preset_setup("--preset", "mine.json", rope, tmp_path).values == {"points": 33, "time_step": 1 / 700}
    with pytest.raises(ValueError, match=r"mine\.json: scene: 'rope' is not allowed; allowed: race"):
        preset_setup("--preset", str(file), scene_named("race"))


@pytest.mark.parametrize(
    ("name", "values", "digits"),
    [
        ("rope", {"points": 9}, ("stiffness", 1e3, 3e3)),
        ("race", {"points": 6, "ropes": 2}, ("stiffness", 1e3, 3e3)),
        ("cloth", {"rows": 6, "cols": 7}, ("stiffness", 500.0, 900.0)),
        ("square_sea", {"size": "64", "mesh": "64"}, ("wind_speed", 4.0, 9.0)),
        ("radial_sea", {"bodies": 2, "rings": 20, "spokes": 24}, ("wind_speed", 4.0, 9.0)),
        ("mooring", {"lines": 2, "segments": 8}, ("wave_height", 1.0, 5.0)),
    ],
)
def test_a_set_up_runs_as_the_record_does(name: str, values: dict[str, Any], digits: tuple[str, float, float]) -> None:
    key, low, high = digits
    kind = scene_named(name)
    params = dataclasses.replace(kind.params(), **values, **{key: random.Random(name).uniform(low, high)})
    by_link, by_file = read_query(write_query(kind, params)).params, read_file(write_file(kind, params)).params
    runs = []
    for one in (params, by_link, by_file):
        scene = kind.make(one)
        for _ in range(3):
            scene.advance(6)
            scene.frame()
        runs.append(scene.arrays())
    for other in runs[1:]:
        assert all(np.array_equal(runs[0][key][0], other[key][0], equal_nan=True) for key in runs[0])


def replay_of(kind: Any, params: Any) -> bytes:
    """A page as a replay is: a client, frames, and at the end the set-up."""
    return f"<!doctype html><html><body><script>1 < 2</script>ö{setup_block(kind, params)}</body></html>".encode()


def recording_of(kind: Any, params: Any) -> bytes:
    """A recording as the panel and `springtide run` write it, without its frames."""
    content = io.BytesIO()
    about = np.array(json.dumps({"scene": kind.name, "parameters": vars(params), "units": {"t": "s"}}))
    np.savez_compressed(content, t=np.zeros(3), about=about)
    return content.getvalue()


@pytest.mark.parametrize("name", NAMES)
def test_a_record_survives_a_replay_and_a_recording_to_the_last_bit(name: str, tmp_path: Any) -> None:
    rng, kind, file = random.Random(name), scene_named(name), tmp_path / "kept"
    for _ in range(RECORDS // 4):
        _, params = random_record(name, rng)
        for content in (replay_of(kind, params), recording_of(kind, params)):
            file.write_bytes(content)
            assert read_file(read_setup_text("set-up", file)).params == params
            assert kind.params(**preset_setup("--preset", str(file), kind).values) == params


def test_hostile_replays_and_recordings_give_a_set_up_or_one_line(tmp_path: Any) -> None:
    rng, file, rope = random.Random(9), tmp_path / "kept", scene_named("rope")
    taken = 0
    for _ in range(HOSTILE):
        good = bytearray(
            rng.choice((replay_of, recording_of))(rope, check_record(rope.params, {"points": rng.randint(2, 99)}))
        )
        for _ in range(rng.randint(1, 8)):
            good[rng.randrange(len(good))] = rng.randrange(256)
        file.write_bytes(good[: rng.choice((len(good), rng.randrange(len(good))))])
        problem = ""
        try:
            preset_setup("--preset", str(file), rope)
        except ValueError as reason:
            problem = str(reason)
        else:
            taken += 1
        assert "\n" not in problem
        assert len(problem) < 1000
    assert 0 < taken < HOSTILE


def test_a_recording_with_a_huge_or_a_pickled_text_is_refused_unread(tmp_path: Any) -> None:
    file, rope = tmp_path / "kept.npz", scene_named("rope")
    for about in (np.array("1" * 10_000_000), np.array([{}], object), np.zeros(3), np.array("[1]"), np.array("{")):
        np.savez_compressed(file, about=about)
        with pytest.raises(ValueError, match=r"^--preset: .*kept.npz' is not allowed; allowed: a set-up file"):
            preset_setup("--preset", str(file), rope)


def test_a_set_up_in_a_page_ends_where_it_should() -> None:
    rope = scene_named("rope")
    block = setup_block(rope, dataclasses.replace(rope.params(), integrator="</script><script>alert(1)"))
    assert block.count("<") == 2
    assert json.loads(block[block.index(">") + 1 : block.rindex("<")])["parameters"]["integrator"].startswith("</scr")


@pytest.mark.parametrize("size", [MAX_LENGTH + 1, 1_000_000])
def test_what_is_too_long_is_refused_unread(size: int) -> None:
    for text in ("?scene=rope&stiffness=" + "1" * size, '{"scene": "rope", "parameters": ' + "{" * size, "[" * size):
        for read in (read_query, read_file):
            with pytest.raises(ValueError, match=r"characters' is not allowed; allowed: at most 5000"):
                read(text)


@pytest.mark.parametrize(("part", "most"), [("name", 60), ("note", 1000)])
def test_names_and_notes_have_a_longest_length(part: str, most: int) -> None:
    said = {"name": "n", "note": "", part: "x" * most}
    kind = scene_named("rope")
    assert getattr(read_file(write_file(kind, kind.params(), **said)), part) == "x" * most
    with pytest.raises(ValueError, match=f"^{part}: .* allowed: .*{most}"):
        write_file(kind, kind.params(), **said | {part: "x" * (most + 1)})


def test_a_script_in_a_name_stays_text() -> None:
    script = "<script>alert(1)</script><img src=x onerror=alert(1)>"
    rope = scene_named("rope")
    setup = read_file(write_file(rope, rope.params(), name=script, note=script))
    assert (setup.name, setup.note) == (script, script)
    with pytest.raises(ValueError, match="no such parameter") as caught:
        read_query(f"?scene=rope&{urlencode({script: 1})}")
    assert "\n" not in str(caught.value)
    assert "<script>" not in str(fill("{}", caught.value))  # as the page shows it
