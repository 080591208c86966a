"""Numbers typed key by key, and the panel's state of playing, in a real browser."""

import pytest

from app.messages import Pause
from app.panel.controls.control import title
from app.panel.controls.scene_pictures import TITLE
from app.server.viewer import Viewer
from sim.parameters import parameters_of
from sim.quantities import write_number
from tests.browser.conftest import Tab

SCENE = "rope"
# Whether the browser's history has an entry for what is shown, and is at it.
TAKEN_IN = "() => history.state?.springtide === __springtide.channel.topicState('acts')?.here"


def field(lab: Viewer, tab: Tab, name: str):
    """The text field of a parameter on the page; its folder is opened."""
    parameter = parameters_of(lab.settings.params)[name]
    found = tab.page.get_by_role("textbox", name=title(name, parameter), exact=True)
    if not found.is_visible():
        tab.page.get_by_role("button", name=parameter.group, exact=True).click()
        tab.wait(found.is_visible, 10)
        tab.page.wait_for_timeout(300)  # the folder unfolds
    return found


def type_into(lab: Viewer, tab: Tab, name: str, text: str, end: str = "Enter", delay: int = 50) -> None:
    found = field(lab, tab, name)
    found.click()
    tab.page.keyboard.press("Control+A")
    tab.page.keyboard.press("Delete")
    tab.page.keyboard.type(text, delay=delay)
    tab.page.keyboard.press(end)


TAKEN = (  # all forms of a number: tests/sim/test_quantities.py
    ("time_step", "0,005", 0.005),
    ("time_step", "1/60", 1 / 60),
    ("stiffness", "20k", 20e3),
    ("points", "27", 27),
)


@pytest.mark.long
def test_a_number_is_taken_as_it_is_typed(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    for name, text, value in TAKEN:
        type_into(lab, tab, name, text)
        tab.wait(lambda name=name, value=value: getattr(lab.settings.params, name) == value, 10)
        written = write_number(value)
        tab.wait(lambda name=name, written=written: field(lab, tab, name).input_value() == written, 10)
        tab.wait(lambda name=name, value=value: getattr(lab.scene.params, name) == value, 10)


def test_the_simulation_never_sees_a_number_that_is_half_typed(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    seen: set[float] = set()
    take = lab.loop.runs.take

    def watched(params, *rest):
        seen.add(params.time_step)
        return take(params, *rest)

    lab.loop.runs.take = watched
    type_into(lab, tab, "time_step", "0.005", delay=150)
    tab.wait(lambda: lab.scene.params.time_step == 0.005, 10)
    assert seen == {0.005}


def test_what_is_not_allowed_is_refused_with_name_value_and_range(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    for text in ("0.5", "", "5 m/s"):
        type_into(lab, tab, "stiffness", text)
        refusal = tab.wait(lambda: tab.page.locator(".springtide-refusal").all_inner_texts(), 10)
        assert len(refusal) == 1
        assert refusal[0].startswith(f"stiffness: {text!r} is not allowed; allowed: 1 to 1e9 N/m")
        assert lab.settings.params.stiffness == lab.scene.params.stiffness == 800.0
        tab.wait(lambda: field(lab, tab, "stiffness").input_value() == "800", 10)
        type_into(lab, tab, "stiffness", "800")  # what the field shows
        tab.wait(lambda: tab.page.locator(".springtide-refusal").count() == 0, 10)
        assert field(lab, tab, "stiffness").input_value() == "800"


def test_escape_and_arrows_and_leaving_a_field(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    type_into(lab, tab, "stiffness", "123", end="Escape")
    assert field(lab, tab, "stiffness").input_value() == "800"
    type_into(lab, tab, "stiffness", "850", end="ArrowUp")
    tab.wait(lambda: lab.settings.params.stiffness == 860.0, 10)
    type_into(lab, tab, "points", "12", end="ArrowDown")
    tab.wait(lambda: lab.settings.params.points == 11, 10)
    type_into(lab, tab, "mass", "0.4", end="Tab")
    tab.wait(lambda: lab.settings.params.mass == 0.4, 10)


@pytest.mark.long
def test_a_preset_that_was_changed_is_chosen_again(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    preset = tab.page.get_by_label("Preset")
    type_into(lab, tab, "stiffness", "2000")
    tab.wait(lambda: preset.input_value() == "Lab code: 10 points (changed)", 10)
    preset.click()
    tab.page.get_by_role("option", name="Lab code: 10 points", exact=True).click()
    tab.wait(lambda: preset.input_value() == "Lab code: 10 points", 10)
    tab.wait(lambda: field(lab, tab, "stiffness").input_value() == "800", 10)
    assert lab.settings.params.stiffness == 800.0
    tab.page.keyboard.press("u")
    tab.wait(lambda: field(lab, tab, "stiffness").input_value() == "2000", 10)


def test_the_preset_that_is_shown_is_chosen_again_and_begins_again(shown: tuple[Viewer, Tab]) -> None:
    viewer, tab = shown
    preset = tab.page.get_by_label("Preset")
    name = preset.input_value()
    viewer.loop.commands.put(Pause())
    tab.wait(lambda: not viewer.loop.run.running)
    number = viewer.loop.run.identity.number
    preset.click()
    tab.page.get_by_role("option", name=name, exact=True).click()
    tab.wait(lambda: viewer.loop.run.identity.number > number and viewer.loop.run.running)
    assert preset.input_value() == name
    preset.click()
    tab.page.get_by_role("option", name="Pendulum", exact=True).click()
    tab.wait(lambda: viewer.settings.loaded == "Pendulum")
    tab.wait(lambda: viewer.loop.run.identity.number == number + 2)
    assert not tab.errors


def test_a_slow_drag_of_a_slider_is_one_change_for_undo(shown: tuple[Viewer, Tab]) -> None:
    """Press, move, wait longer than changes of a number may be apart, move on, release; then undo it."""
    lab, tab = shown
    settings, thumb = lab.settings, tab.page.get_by_role("slider", name="Stiffness [N/m]")
    tab.wait(thumb.count)
    thumb.scroll_into_view_if_needed()
    settings.history.settings.clear()  # of the tests before, which may have filled it
    before = vars(settings.params)["stiffness"]
    box = thumb.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.page.mouse.move(x, y)
    tab.page.mouse.down()
    for step in (1, 2):
        last = vars(settings.params)["stiffness"]
        tab.page.mouse.move(x + 12 * step, y, steps=3)
        tab.wait(lambda last=last: vars(settings.params)["stiffness"] != last, 10)
        tab.page.wait_for_timeout(1500)
    assert settings.history.hands
    tab.page.mouse.up()
    tab.wait(lambda: not settings.history.hands, 10)
    assert len(settings.history.settings) == 1
    tab.page.keyboard.press("u")
    tab.wait(lambda: vars(settings.params)["stiffness"] == before, 10)


def test_keys_go_to_the_lab_after_a_list_was_used(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    number = lab.loop.run.identity.number
    tab.page.get_by_label("Preset").click()
    tab.page.get_by_role("option", name="Pendulum", exact=False).first.click()
    tab.wait(lambda: lab.loop.run.identity.number > number, 10)
    tab.wait(lambda: lab.loop.run.running, 10)
    tab.page.keyboard.press("Space")
    tab.wait(lambda: not lab.loop.run.running, 10)


@pytest.mark.long
def test_the_panel_says_at_once_whether_the_lab_plays(shown: tuple[Viewer, Tab]) -> None:
    lab, tab = shown
    panel = tab.page.locator(".springtide-panel").first

    def says(word: str, button: str) -> None:
        tab.wait(lambda: panel.inner_text().startswith(word), 5)
        assert lab.loop.run.running == (word == "Running")
        tab.wait(lambda: tab.page.get_by_role("button", name=button, exact=True).count() == 1, 5)

    says("Running", "Pause")
    for _ in range(2):
        tab.page.keyboard.press("Space")
        says("Paused", "Play")
        tab.page.get_by_role("button", name="Play", exact=True).click()
        says("Running", "Pause")
        tab.page.get_by_role("button", name="Step", exact=True).click()
        says("Paused", "Play")
        tab.page.keyboard.press("Space")
        says("Running", "Pause")


@pytest.mark.long
def test_a_press_on_a_picture_opens_its_scene(lab: Viewer, open_tab) -> None:
    tab = open_tab(lab.port)
    picture = tab.page.locator("[data-springtide-act=scene][value=cloth]")
    tab.wait(tab.page.get_by_text(TITLE).is_visible)
    tab.page.get_by_text(TITLE).click()
    tab.wait(picture.is_visible, 20)
    tab.wait(lambda: tab.page.evaluate("one => one.naturalWidth", picture.locator("img").element_handle()) == 160, 10)
    picture.click()
    tab.wait(lambda: lab.settings.kind.name == "cloth")
    assert tab.errors == []


@pytest.mark.long
def test_back_and_forward_go_through_scenes_and_presets(lab: Viewer, open_tab) -> None:
    tab = open_tab(lab.port)

    def shows(scene: str, preset: str) -> bool:
        acts = tab.page.locator("[data-springtide-topic=acts]")
        return (lab.settings.kind.name, lab.settings.loaded) == (scene, preset) and acts.count() == 1

    def at(scene: str, preset: str) -> None:
        tab.wait(lambda: shows(scene, preset), 30)
        tab.wait_for_panel(lab)
        tab.wait(lambda: tab.page.evaluate(TAKEN_IN), 30)

    first = lab.settings.loaded
    at("rope", first)
    address = tab.page.url
    lab.settings.load("Pendulum")
    at("rope", "Pendulum")
    lab.open("cloth")
    at("cloth", "Curtain")
    assert tab.page.evaluate("history.length") >= 3
    for move, place in (
        ("back", ("rope", "Pendulum")), ("back", ("rope", first)), ("forward", ("rope", "Pendulum")),
        ("forward", ("cloth", "Curtain")), ("back", ("rope", "Pendulum")),
    ):  # fmt: skip
        tab.page.evaluate(f"history.{move}()")
        at(*place)
    lab.settings.load(first)  # what is visited after a step back takes the place of what lay ahead
    at("rope", first)
    tab.page.evaluate("history.forward()")
    tab.page.wait_for_timeout(1000)
    assert shows("rope", first)
    tab.page.evaluate("history.back()")
    at("rope", "Pendulum")
    assert tab.page.url == address
    assert tab.errors == []
