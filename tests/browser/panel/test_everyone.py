"""The page for every eye and hand: a table of ways to see and use it, each tried in all scenes."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import imageio.v3 as iio
import numpy as np
import pytest

from app.messages import Pause, Play
from app.scenes import NAMES
from app.server.viewer import Viewer
from sim.parameters import in_words
from tests.browser.boxes import faults
from tests.browser.conftest import Tab
from tests.browser.panel.test_access import CONTROLS, check_both_ends, low_contrasts
from tests.browser.panel.test_layout import CUT_OFF

MIN_SHAPE_CONTRAST = 3.0  # WCAG 2.2, 1.4.11
SHORT = 20.0  # [ms] of a motion that nobody sees
SHAPES = {
    "panel": "[data-floating-window]",
    "button": '[data-springtide-icon="Reset"]',
    "track": ".multi-slider-track",
    "thumb": ".multi-slider-thumb",
    "chosen tab": '[role="tab"][aria-selected="true"]',
    "other tab": '[role="tab"][aria-selected="false"]',
    "field": "input.mantine-TextInput-input",
    "list": ".mantine-Select-input",
    "time line": "#springtide-time button",
    "gauge": ".springtide-step-bar",
    "colour bar": ".springtide-scale",
}
ABSENT = {  # shapes that a scene does not have, or not as it opens
    "cloth": {"colour bar"},
    "race": {"gauge", "colour bar"},
    "square_sea": {"gauge", "colour bar"},
    "radial_sea": {"gauge", "colour bar"},
    "mooring": {"gauge"},
}
# What a click or a key opens, with what is chosen in it.
LIST = (".mantine-Select-dropdown", '[role="option"][data-combobox-selected]')
PALETTE = (".mantine-Spotlight-content", ".mantine-Spotlight-action[data-selected]")
SHOWN_BOXES = """selectors => Object.fromEntries(Object.entries(selectors).flatMap(([name, selector]) => {
    const box = [...document.querySelectorAll(selector)].find(e => e.checkVisibility() && e.offsetWidth > 0)
        ?.getBoundingClientRect();
    return box ? [[name, [box.x, box.y, box.width, box.height]]] : []; }))"""
SMALL_TARGETS = """() => [...document.querySelectorAll(
        "button, [role=button], [role=tab], input[type=checkbox], select, .multi-slider-thumb")]
    .filter(e => e.checkVisibility({ visibilityProperty: true }) && e.getBoundingClientRect().width > 1)
    .map(e => { const { width, height } = e.getBoundingClientRect();
        return [e.getAttribute("aria-label") || e.textContent || e.className, width, height]; })
    .filter(([, width, height]) => width < 24 || height < 24)"""
SCROLLS_ACROSS = "document.documentElement.scrollWidth > innerWidth"
# The element with the focus: its role, its name, and whether a ring or a border shows it.
STOP = """() => { const at = document.activeElement, style = getComputedStyle(at);
    const label = at.getAttribute("aria-label") || at.labels?.[0]?.textContent || at.textContent || "";
    return [at.getAttribute("role") || at.tagName.toLowerCase(), label.trim().slice(0, 40),
        at.matches("body, input, textarea, select") || style.boxShadow !== "none" ||
            (style.outlineStyle !== "none" && Number.parseFloat(style.outlineWidth) > 0)]; }"""
# Keeps the names of what moves for longer than SHORT.
WATCH_MOTION = f"""window.moving = new Set();
(function look() {{
    for (const one of document.getAnimations()) {{
        const {{ duration, iterations }} = one.effect.getTiming();
        if (duration > {SHORT} || iterations === Infinity) {{
            window.moving.add(`${{one.animationName ?? one.transitionProperty}} of ${{one.effect.target.className}}`);
        }}
    }}
    requestAnimationFrame(look);
}})();"""
LAYOUTS = {  # what a key gives by its place: a letter to show the grid, a digit, and the letter of "undo"
    "QWERTY": ("g", "KeyG", "2", "Digit2", "z", "KeyZ"),
    "QWERTZ": ("g", "KeyG", "2", "Digit2", "z", "KeyY"),
    "AZERTY": ("g", "KeyG", "é", "Digit2", "z", "KeyW"),
    "Dvorak": ("g", "KeyU", "2", "Digit2", "z", "Slash"),
    "Russian": ("п", "KeyG", "2", "Digit2", "я", "KeyZ"),
    "Greek": ("γ", "KeyG", "2", "Digit2", "ζ", "KeyZ"),
}
CTRL = 2  # of the protocol of Chromium's tools


class Way(NamedTuple):
    """A way to see or use the page, and what must hold in each scene."""

    check: Callable[[Viewer, Tab, str], None]
    device: Mapping[str, Any] = MappingProxyType({})
    begin: Callable[[Tab], None] = lambda _: None


def luminance(colours: np.ndarray) -> np.ndarray:
    """Relative luminance of colours (..., 3) from 0 to 255, as WCAG 2.2 defines it."""
    parts = colours / 255.0
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def edge_contrast(tab: Tab, name: str, box: tuple[float, float, float, float]) -> float:
    """Ratio of luminance across the edges of a shape, in their middles: the smallest of them.

    The left and the right edge count. The track crosses these edges of a thumb: its upper and its lower edge stand out.
    A tab has all four.
    """
    x, y, width, height = box
    upright = [(edge - 4, y + 0.5 * height - 1, 8, 2) for edge in (x, x + width)]
    level = [(x + 0.5 * width - 1, edge - 4, 2, 8) for edge in (y, y + height)]
    clips = level if name == "thumb" else upright + level if name.endswith(" tab") else upright
    found = []
    for clip in clips:
        picture = iio.imread(tab.page.screenshot(clip=dict(zip(("x", "y", "width", "height"), clip, strict=True))))
        light = luminance(picture[..., :3].astype(float))
        found.append(float((light.max() + 0.05) / (light.min() + 0.05)))
    return min(found)


def check_shapes(viewer: Viewer, tab: Tab, scene: str) -> None:
    tab.page.wait_for_timeout(500)
    shapes = tab.page.evaluate(SHOWN_BOXES, SHAPES)
    assert shapes.keys() == SHAPES.keys() - ABSENT.get(scene, set())
    for (opened, chosen), key in ((LIST, ""), (PALETTE, "Control+k")):
        tab.page.evaluate("document.activeElement?.blur()")
        if key:
            tab.page.keyboard.press(key)
        else:
            tab.page.get_by_label("Preset", exact=True).first.click()
        tab.wait(lambda opened=opened: tab.page.evaluate(SHOWN_BOXES, {opened: opened}), 10)
        tab.page.keyboard.press("ArrowDown")
        tab.page.wait_for_timeout(500)  # it opens gradually
        shown = tab.page.evaluate(SHOWN_BOXES, {opened: opened, chosen: chosen})
        assert set(shown) == {opened, chosen}
        for name, box in shown.items():
            assert edge_contrast(tab, name, box) >= MIN_SHAPE_CONTRAST, name
        tab.page.keyboard.press("Escape")
        tab.wait(lambda opened=opened: not tab.page.evaluate(SHOWN_BOXES, {opened: opened}), 10)
    for name, box in shapes.items():
        assert edge_contrast(tab, name, box) >= MIN_SHAPE_CONTRAST, name


def check_tabs(viewer: Viewer, tab: Tab, scene: str) -> None:
    """In a narrow window, where the tabs are below the block with the buttons."""
    tab.page.wait_for_timeout(500)
    shapes = tab.page.evaluate(SHOWN_BOXES, {name: SHAPES[name] for name in ("chosen tab", "other tab")})
    assert len(shapes) == 2
    for name, box in shapes.items():
        assert edge_contrast(tab, name, box) >= MIN_SHAPE_CONTRAST, name


def check_dark(viewer: Viewer, tab: Tab, scene: str) -> None:
    tab.wait(lambda: tab.page.locator("html[data-mantine-color-scheme=dark]").count())
    tab.wait(lambda: not low_contrasts(tab), 20)  # colours change gradually


def enlarge(tab: Tab) -> None:
    tab.page.evaluate("localStorage.setItem('springtide-large', 'yes')")
    tab.page.reload()


def check_large(viewer: Viewer, tab: Tab, scene: str) -> None:
    tab.wait(lambda: tab.page.locator("html.springtide-large").count())
    tab.page.wait_for_timeout(500)
    assert tab.page.evaluate(CUT_OFF) == []
    assert faults(tab.page) == []
    tab.show("View")
    check_both_ends(tab)
    tab.show("Controls")


def check_zoomed(viewer: Viewer, tab: Tab, scene: str) -> None:
    tab.page.wait_for_timeout(1000)
    assert tab.page.evaluate("devicePixelRatio") == 2
    assert not tab.page.evaluate(SCROLLS_ACROSS)
    assert faults(tab.page) == []
    tab.show("View")
    check_both_ends(tab)
    tab.show("Controls")


def check_keyboard(viewer: Viewer, tab: Tab, scene: str) -> None:
    page, press = tab.page, tab.page.keyboard.press
    press("c")
    stops = [page.evaluate(STOP)]
    assert stops[0][0] != "body"
    for _ in range(90):
        press("Tab")
        stops.append(page.evaluate(STOP))
        if len(stops) > 5 and stops[-1][:2] == stops[0][:2]:
            break
    assert [stop for stop in stops if not stop[2]] == []  # each is seen to have the focus
    assert stops[-1][:2] == stops[0][:2], "Tab comes round"
    assert {"slider", "tab", "button"} <= {role for role, _, _ in stops}
    assert {"Scene", "Preset", "Play the recording"} <= {name for _, name, _ in stops}

    before = viewer.settings.params
    page.get_by_role("slider").and_(page.locator(".multi-slider-thumb")).first.focus()
    press("ArrowRight")
    tab.wait(lambda: viewer.settings.params != before, 20)
    after = viewer.settings.params
    press("Control+z")
    tab.wait(lambda: viewer.settings.params == before, 20)
    for redo in ("Control+Shift+z", "Control+y"):
        press(redo)
        tab.wait(lambda: viewer.settings.params == after, 20)
        press("Control+z")
        tab.wait(lambda: viewer.settings.params == before, 20)
    press("Meta+y")  # of the browser's history on a Mac
    page.wait_for_timeout(500)
    assert viewer.settings.params == before
    page.get_by_role("tab", selected=True).first.focus()
    press("ArrowRight")
    controls = page.get_by_role("tab", name="Controls", exact=True)
    tab.wait(lambda: controls.get_attribute("aria-selected") == "false", 20)
    press("ArrowLeft")
    tab.wait(lambda: controls.get_attribute("aria-selected") == "true", 20)
    first = viewer.settings.loaded
    page.get_by_label("Preset", exact=True).first.focus()
    for key in ("ArrowDown", "ArrowDown", "Enter"):
        press(key)
        page.wait_for_timeout(300)
    tab.wait(lambda: viewer.settings.loaded != first, 20)
    tab.wait(lambda: viewer.loop.run.running)
    press("Space")
    tab.wait(lambda: not viewer.loop.run.running, 20)


def check_targets(viewer: Viewer, tab: Tab, scene: str) -> None:
    tab.page.wait_for_timeout(1000)
    assert tab.page.evaluate("matchMedia('(pointer: coarse)').matches")
    assert tab.page.evaluate(SMALL_TARGETS) == []


def check_words(viewer: Viewer, tab: Tab, scene: str) -> None:
    """A screen reader hears the state of the scene, and not the cover; each control has a name."""
    assert "Preparing" not in tab.page.inner_text("body")
    name = f"{in_words(scene)}. {viewer.settings.loaded}."
    tab.wait(tab.page.get_by_role("img", name=f"{name} Paused t = ").count)
    viewer.loop.commands.put(Play())
    tab.wait(tab.page.get_by_role("img", name=f"{name} Running t = ").count)
    controls = tab.page.evaluate(CONTROLS)
    assert len(controls) > 10
    assert [control for control in controls if not control[0]] == []


def watch_motion(tab: Tab) -> None:
    tab.page.add_init_script(WATCH_MOTION)
    tab.page.reload()


def check_still(viewer: Viewer, tab: Tab, scene: str) -> None:
    """Nothing of the page moves gradually: lists, folders, tabs, the palette, and the cover of the next scene."""
    page = tab.page
    page.get_by_label("Preset", exact=True).first.click()
    page.wait_for_timeout(400)
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Main", exact=True).click()
    tab.show("View")
    tab.show("Controls")
    page.evaluate("document.activeElement?.blur()")
    page.keyboard.press("Control+k")
    page.wait_for_timeout(400)
    page.keyboard.press("Escape")
    page.wait_for_timeout(400)
    assert page.evaluate("[...window.moving]") == []


def check_layouts(viewer: Viewer, tab: Tab, scene: str) -> None:
    devtools = tab.page.context.new_cdp_session(tab.page)

    def press(key: str, code: str, modifiers: int = 0) -> None:
        for kind in ("rawKeyDown", "keyUp"):
            event = {"type": kind, "key": key, "code": code, "modifiers": modifiers}
            devtools.send("Input.dispatchKeyEvent", event)

    presets = list(viewer.settings.kind.presets)
    tab.page.evaluate("document.activeElement?.blur()")
    for layout, (letter, its_code, digit, digits_code, undo, undos_code) in LAYOUTS.items():
        before = viewer.settings.params
        press(letter, its_code)
        tab.wait(lambda before=before: viewer.settings.params != before, 20)
        assert viewer.settings.params.grid != before.grid, layout  # type: ignore[attr-defined]
        press(undo, undos_code, CTRL)
        tab.wait(lambda before=before: viewer.settings.params == before, 20)
        press(digit, digits_code)
        tab.wait(lambda: viewer.settings.loaded == presets[1], 20)
        viewer.settings.load(presets[0])
        tab.wait(lambda: viewer.settings.loaded == presets[0], 20)


WAYS = {
    "forced colours": Way(check_shapes, {"forced_colors": "active", "height": 1200}),
    "forced colours, narrow": Way(check_tabs, {"forced_colors": "active", "width": 420, "height": 800}),
    "dark": Way(check_dark, {"color_scheme": "dark"}),
    "large text": Way(check_large, begin=enlarge),
    "zoom 200 %": Way(check_zoomed, {"width": 640, "height": 400, "device_scale_factor": 2}),
    "keyboard alone": Way(check_keyboard),
    "touch": Way(check_targets, {"has_touch": True, "is_mobile": True}),
    "screen reader": Way(check_words),
    "reduced motion": Way(check_still, {"reduced_motion": "reduce"}, watch_motion),
    "other keyboard layouts": Way(check_layouts),
}


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize("way", WAYS)
def test_the_page_is_for_every_eye_and_hand_in_each_scene(way: str, open_tab: Callable[..., Tab]) -> None:
    row, viewer = WAYS[way], Viewer("127.0.0.1", 0)
    try:
        tab = open_tab(viewer.port, **row.device)
        row.begin(tab)
        for scene in NAMES:
            tab.follow(viewer, scene)
            viewer.loop.commands.put(Pause())
            try:
                row.check(viewer, tab, scene)
            except BaseException as error:
                error.add_note(f"in the scene {scene}")
                raise
    finally:
        viewer.shut()
