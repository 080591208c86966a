"""Lines of an opened MoorDyn file are changed in the panel, and written again."""

import itertools
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.__main__ import make_parser
from app.commands.options import read_params
from app.panel.controls.file_numbers import APPLY, SAVE, FileNumbers
from app.panel.sharing.share import not_in_link
from app.scenes import NAMES, scene_named
from app.scenes.mooring.files.editing import DIAMETER, LENGTH, changed, content, lines_of, numbers
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.readings.report import notes_of
from app.scenes.setups import described, make_setup, missing_files, read_file, with_changes, write_file
from app.server.loop.sim_loop import SimLoop
from app.server.viewer import Viewer
from sim.mooring import read_moordyn
from tests import coroutines
from tests.app.channels import say, state_of
from tests.waiting import wait_for

PATH = Path(__file__).parents[2] / "sim/mooring/moordyn/files/shared_line.txt"
FILE = MooringParams(moordyn_file=str(PATH), time_step=2e-3)
NUMBERS = itertools.count()  # of texts that a page sends


def test_a_file_that_was_changed_and_written_is_that_which_runs(tmp_path: Path) -> None:
    first, second, *_ = numbers(FILE)
    params = changed(FILE, first, {LENGTH: 123.25, DIAMETER: numbers(FILE)[first][DIAMETER]})
    params = changed(params, second, {LENGTH: numbers(FILE)[second][LENGTH], DIAMETER: 0.123})
    name, written = content(params)
    assert name == "shared_line-changed.txt"
    (tmp_path / name).write_bytes(written)
    again, running = read_moordyn(tmp_path / name, lambda line: None), SimLoop(scene_named("mooring").make(params))
    assert again == running.scene.file.system
    assert again.lines[0].length == 123.25
    assert lines_of(params)[second].type.diameter == 0.123
    rows, others = PATH.read_bytes().splitlines(), written.splitlines()
    assert sum(a != b for a, b in zip(rows, others, strict=True)) == 2
    assert content(FILE) == ("shared_line.txt", PATH.read_bytes())
    assert read_moordyn(PATH, lambda line: None) == SimLoop(scene_named("mooring").make(FILE)).scene.file.system
    assert "changed here: length of 1 is 123.25 m" in notes_of(running.latest)["Files"]
    assert described(scene_named("mooring"), params)["mooring"]["lines"][0]["length"] == 123.25


def test_a_number_that_is_changed_back_leaves_the_file_as_it_is() -> None:
    first, second, *_ = own = numbers(FILE)
    for there, back in ((LENGTH, DIAMETER), (DIAMETER, LENGTH)):
        params = changed(FILE, first, {**own[first], there: 3.5})
        params = changed(params, second, {**own[second], back: 0.5})
        assert len(params.file_changes) == 2
        params = changed(params, first, own[first])
        assert [value for *_, value in params.file_changes] == [0.5]
        assert changed(params, second, own[second]) == FILE
    assert changed(edited(), first, numbers(edited())[first]) == edited()


def edited() -> MooringParams:
    """The file with another length of its first line and another diameter of the second one's type."""
    first, second, *_ = numbers(FILE)
    params = changed(FILE, first, {LENGTH: 123.25, DIAMETER: numbers(FILE)[first][DIAMETER]})
    return changed(params, second, {LENGTH: numbers(FILE)[second][LENGTH], DIAMETER: 0.123})


def test_a_setup_holds_the_changes_of_the_file_that_it_names() -> None:
    params, kind = edited(), scene_named("mooring")
    setup = read_file(write_file(kind, params))
    assert len(setup.changes) == 2
    assert with_changes(FILE, setup) == params
    assert with_changes(params, read_file(write_file(kind, FILE))) == FILE  # that of the unchanged file
    assert with_changes(params, make_setup(kind)) == params  # a preset names no file
    other = MooringParams(moordyn_file="another.txt")
    assert with_changes(other, setup) == other
    assert "open the set-up again for its changes" in missing_files(setup, other)
    assert missing_files(setup, FILE) == ""


def test_a_run_of_the_command_line_has_the_changes_of_its_setup(tmp_path: Path, capsys: Any) -> None:
    path, kind = tmp_path / "changed.json", scene_named("mooring")
    path.write_text(write_file(kind, edited()), "utf-8")
    words = ["run", "mooring", "--preset", str(path), "--mooring", str(PATH), "--seconds", "1", "--out", "run.npz"]
    params = read_params(kind, make_parser().parse_args(words))
    assert params.file_changes == edited().file_changes
    said = capsys.readouterr().err
    assert "shared_line.txt: changed here: length of 1 is 123.25 m" in said
    assert "without the changes" not in said
    name, written = content(edited())
    (tmp_path / name).write_bytes(written)
    words[words.index(str(PATH))] = str(tmp_path / name)
    again = read_params(kind, make_parser().parse_args(words))
    assert again.file_changes == ()
    assert lines_of(again) == lines_of(params)
    assert f"{name}: without the changes of the set-up, which are those of {PATH.name}" in capsys.readouterr().err


@pytest.mark.parametrize(
    "bad",
    [
        "length", [["length", "1"]], [["mass", "1", 2.0]], [["length", 1, 2.0]], [["length", "1", -2.0]],
        [["length", "1", True]], [["length", "1", 1e999]], [["length", "1", 2.0]] * 201,
    ],
)  # fmt: skip
def test_changes_that_a_file_cannot_have_are_refused_by_name(bad: object) -> None:
    content = {"version": 2, "scene": "mooring", "parameters": {}, "mooring": "a.txt", "file_changes": bad}
    with pytest.raises(ValueError, match="set-up: file_changes"):
        read_file(json.dumps(content))


@pytest.mark.parametrize("name", NAMES)
def test_without_a_file_there_are_no_numbers_of_it(name: str) -> None:
    kind = scene_named(name)
    assert (kind.file_editing is not None) == (name == "mooring")
    if kind.file_editing is not None:
        assert kind.file_editing.numbers(kind.params()) == {}


@pytest.fixture
def panel() -> Any:
    viewer = Viewer("127.0.0.1", 0)
    viewer.open("mooring", FILE, paused=True)
    yield viewer
    viewer.shut()


def press(found: FileNumbers, viewer: Viewer, label: str) -> list[tuple[str, bytes]]:
    sent: list[tuple[str, bytes]] = []
    client = SimpleNamespace(send_file_download=lambda name, content, **how: sent.append((name, content)))
    gui: Any = viewer.server.gui
    buttons = next(
        one for one in gui._gui_input_handle_from_uuid.values() if getattr(one, "options", ()) == (APPLY, SAVE)
    )
    for callback in buttons._impl.update_cb:
        coroutines.run(callback(SimpleNamespace(target=SimpleNamespace(value=label), client=client, client_id=1)))
    return sent


def test_a_file_that_is_gone_is_told_without_its_folder(tmp_path: Path) -> None:
    path = tmp_path / "moor.txt"
    path.write_bytes(PATH.read_bytes())
    params = MooringParams(moordyn_file=str(path), time_step=2e-3)
    (name, *_) = numbers(params)
    path.unlink()
    with pytest.raises(ValueError, match=r"moor\.txt") as error:
        changed(params, name, {LENGTH: 120.0, DIAMETER: 0.1})
    assert str(tmp_path) not in str(error.value)


def test_numbers_are_applied_undone_and_saved(panel: Viewer) -> None:
    found: Any = panel.panel.controls_tab.file_numbers
    assert found.chooser.options == tuple(numbers(FILE))
    before = found.fields[LENGTH].value
    found.fields[LENGTH].value = "0,13 km"
    press(found, panel, APPLY)
    assert panel.settings.params.file_changes == (("length", "1", 130.0),)
    wait_for(lambda: panel.scene.params.file_changes)
    assert panel.scene.file.system.lines[0].length == 130.0
    ((name, written),) = press(found, panel, SAVE)
    assert (name, b"130.0" in written) == ("shared_line-changed.txt", True)
    for wrong, words in (("-1", "-1.0 is not allowed; allowed: above 0 m"), ("long", "'long'"), ("", "''")):
        found.fields[LENGTH].value = wrong
        press(found, panel, APPLY)
        assert words in found.line.content.replace("&#39;", "'")
        assert panel.settings.params.file_changes == (("length", "1", 130.0),)
    panel.settings.set("speed", 2.0)
    assert found.fields[LENGTH].value == ""  # it may be half typed
    panel.settings.undo()
    panel.settings.undo()
    assert panel.settings.params.file_changes == ()
    assert found.fields[LENGTH].value == before
    wait_for(lambda: not panel.scene.params.file_changes)
    assert panel.scene.file.system == read_moordyn(PATH, lambda line: None)


def message(viewer: Viewer, text: str) -> list[str]:
    """Send an address or a set-up as a page does; returns the notifications."""
    told: list[str] = []
    client = SimpleNamespace(
        client_id=1, add_notification=lambda title, body, **how: told.append(body), camera=SimpleNamespace()
    )
    say(viewer.panel.share.channel, "open", text, client=client)
    return told


def test_a_scene_that_is_shown_again_has_its_file_as_it_was_changed(panel: Viewer) -> None:
    kind = scene_named("mooring")
    for way, params in (("Back", edited()), ("list", FILE), ("set-up", edited())):
        panel.settings.show_setup(read_file(write_file(kind, params)), None)
        query = state_of(panel, "acts")["here"]  # that the page keeps for Back and Forward
        assert message(panel, "?scene=rope") == []
        wait_for(lambda: panel.is_open and panel.settings.kind.name == "rope")
        if way == "list":
            panel.settings.open_first_view_of("mooring")
        else:
            assert message(panel, query if way == "Back" else write_file(kind, params)) == []
        wait_for(lambda: panel.is_open and panel.settings.kind.name == "mooring")
        assert panel.settings.params.moordyn_file == str(PATH)
        assert panel.settings.params.file_changes == params.file_changes
        wait_for(lambda params=params: panel.scene.params.file_changes == params.file_changes)
    act = panel.settings.history.act
    for params, begun in ((panel.settings.params, 0), (FILE, 1), (FILE, 1)):
        assert message(panel, write_file(kind, params)) == []
        assert panel.settings.history.act == act + begun  # what is shown already does not begin again


def test_an_opened_setup_changes_the_file_and_undo_takes_it_back_in_either_order(panel: Viewer) -> None:
    kind = scene_named("mooring")
    plain, own = (read_file(write_file(kind, params)) for params in (FILE, edited()))
    for setup, changes in ((own, edited().file_changes), (plain, ()), (own, edited().file_changes)):
        panel.settings.show_setup(setup, None)
        assert panel.settings.params.file_changes == changes
        wait_for(lambda changes=changes: panel.scene.params.file_changes == changes)
    assert panel.scene.file.system.lines[0].length == 123.25
    panel.settings.undo()
    assert panel.settings.params.file_changes == ()
    missing = own._replace(changes=(("length", "99", 1.0),))
    with pytest.raises(ValueError, match="length of line: 99"):
        panel.settings.show_setup(missing, None)
    assert panel.settings.params.file_changes == ()
    assert "and its changes" in not_in_link(edited())
    assert not_in_link(MooringParams()) == ""
