"""Links, set-ups and recordings in the page."""

import base64
import json
from collections.abc import Callable
from pathlib import Path
from urllib.parse import quote

import imageio.v3 as iio
import numpy as np
import pytest

from app.panel.sharing.scene_switches import UNDO
from app.render.surroundings import LIGHT_SKY
from app.scenes import NAMES, scene_named
from app.scenes.own_setups import own_files
from app.scenes.setups import setup_block
from app.server.viewer import Viewer
from sim.parameters import check_record
from tests.browser.conftest import Tab

SCENE = "rope"
# Width and height of a clip, and the bytes of the first row of one of its pictures.
FIRST_ROW = """async clip => { const video = document.createElement("video");
    const bytes = Uint8Array.from(atob(clip), c => c.charCodeAt(0));
    video.muted = true, video.src = URL.createObjectURL(new Blob([bytes]));
    await new Promise(done => { video.onloadeddata = done; });
    await new Promise(done => { video.onseeked = done; video.currentTime = 0.3; });
    const { videoWidth: width, videoHeight: height } = video, pen = new OffscreenCanvas(width, height).getContext("2d");
    pen.drawImage(video, 0, 0);
    return [width, height, ...pen.getImageData(0, 0, width, 1).data]; }"""


@pytest.fixture
def opened(shown: tuple[Viewer, Tab]) -> tuple[Viewer, Tab]:
    """The tab, opened."""
    shown[1].show("Share")
    return shown


def test_the_tab_has_three_groups_and_few_buttons(
    opened: tuple[Viewer, Tab], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPRINGTIDE_DATA", str(tmp_path))
    lab, tab = opened
    lab.panel.share.remove.visible = False  # a list without presets of the user
    groups = tab.page.locator(".mantine-Paper-root > .mantine-Paper-root:first-child").all_inner_texts()
    assert [name for name in groups if name in ("Recording", "Curves", "This run", "This set-up", "Files")] == [
        "This run", "This set-up", "Files",
    ]  # fmt: skip
    names = ("Keep curves", "Replay (last 20 s)", "Data (.npz)", "Copy link", "Save set-up", "Keep as preset",
             "Save plots", "Record clip", "Picture")  # fmt: skip
    for name in names:
        tab.wait(tab.page.get_by_role("button", name=name, exact=True).is_visible, 20)
    buttons = [tab.page.get_by_role("button", name=name, exact=True) for name in names]
    heights = [one.bounding_box()["height"] for one in (*buttons, tab.page.locator(".springtide-load"))]
    assert max(heights) - min(heights) < 0.5, heights
    assert not tab.page.get_by_role("button", name="Remove preset").is_visible()
    tab.page.get_by_role("button", name="Keep curves").click()
    tab.wait(tab.page.get_by_role("button", name="Drop curves").is_visible, 20)
    tab.page.get_by_role("button", name="Drop curves").click()
    tab.wait(tab.page.get_by_role("button", name="Keep curves").is_visible, 20)


def load(tab: Tab, path: Path, content: object) -> None:
    """Choose a file in the page."""
    path.write_text(content if isinstance(content, str) else json.dumps(content), "utf-8")
    tab.page.locator(".springtide-load input").set_input_files(str(path))


@pytest.mark.long
def test_a_link_is_taken_shown_to_the_others_and_made_again(
    opened: tuple[Viewer, Tab], open_tab: Callable[..., Tab], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a second visitor, who follows a link."""
    lab, tab = opened
    monkeypatch.setattr("app.panel.sharing.scene_switches.SHOWN_TIME", 60.0)  # of a slow machine
    query = "&scene=rope&stiffness=2k&time_step=1/600&camera=3,-4,2,0,0,1.5"
    other = open_tab(lab.port, query=query)
    base = f"http://127.0.0.1:{lab.port}/"
    tab.wait(lambda: vars(lab.settings.params)["stiffness"] == 2000.0, 60)
    tab.wait(tab.page.get_by_text("Someone else switched everyone to Rope").is_visible, 20)
    other.wait(other.page.get_by_text("You switched everyone to Rope").is_visible, 20)
    assert not tab.page.get_by_text("You switched everyone to Rope").is_visible()
    assert not other.page.get_by_text("Someone else switched everyone to Rope").is_visible()
    tab.page.get_by_role("button", name=UNDO).click()
    tab.wait(lambda: vars(lab.settings.params)["stiffness"] == 800.0, 20)
    tab.wait(lambda: not tab.page.get_by_text("Someone else switched everyone to Rope").is_visible(), 20)
    other.page.reload()
    tab.wait(lambda: vars(lab.settings.params)["stiffness"] == 2000.0, 60)
    assert vars(lab.settings.params)["time_step"] == 1 / 600
    # The link that is made has the same parameters, and the camera of the browser that asks.
    tab.wait(lambda: len({tuple(c.camera.position.round(2)) for c in lab.server.get_clients().values()}) == 2, 30)
    tab.page.get_by_role("button", name="Copy link").click()
    words = f"{base}?scene=rope&time_step={quote('1/600', safe='')}&stiffness=2000&camera="
    tab.wait(lambda: tab.page.locator(".springtide-link").count() > 0, 20)
    link = tab.wait(lambda: tab.page.locator(".springtide-link").get_attribute("href"), 20)
    assert link.startswith(words)
    assert not link.endswith("camera=3,-4,2,0,0,1.5")


def test_a_file_is_loaded_or_refused_in_one_line(opened: tuple[Viewer, Tab], tmp_path: Path) -> None:
    lab, tab = opened
    load(tab, tmp_path / "a.json", {"scene": "rope", "parameters": {"points": 23}})
    tab.wait(lambda: vars(lab.settings.params)["points"] == 23, 20)
    for content, words in (
        ({"scene": "rope", "parameters": {"points": -4}}, "points: -4 is not allowed"),
        ("<script>alert(1)</script>", "or a recording (.npz) of Springtide"),
        ("PK\x03\x04", "'a recording (.npz)' is not allowed"),
        ("x" * 100_000, "'more than 5000 characters' is not allowed"),
        ("x" * 5000, "not a JSON file"),
    ):
        load(tab, tmp_path / "b.json", content)
        tab.wait(lambda words=words: words in tab.page.locator("body").inner_text(), 20)
        # Closed, as it would cover what other tests click.
        notice = tab.page.locator(".mantine-Notification-root", has_text="Couldn't open this set-up")
        notice.get_by_role("button").click()
        tab.wait(lambda notice=notice: notice.count() == 0, 20)
    assert vars(lab.settings.params)["points"] == 23
    rope = scene_named("rope")
    block = setup_block(rope, check_record(rope.params, {"points": 24}))
    load(tab, tmp_path / "c.html", f"<!doctype html><html><body>{'x' * 100_000}{block}</body></html>")
    tab.wait(lambda: vars(lab.settings.params)["points"] == 24, 20)


@pytest.mark.long
def test_an_own_preset_is_kept_listed_loaded_and_there_after_a_reload(
    opened: tuple[Viewer, Tab], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPRINGTIDE_DATA", str(tmp_path))
    lab, tab = opened
    lab.settings.set("points", 17)
    lab.panel.share.name.value = "Seventeen beads"
    tab.page.get_by_role("button", name="Keep as preset").click()
    tab.wait(lambda: lab.settings.loaded == "Mine: Seventeen beads", 20)
    assert "Seventeen beads" in own_files(lab.panel.kind)
    # Reopened, as by a later lab: the list is read from the files.
    tab.follow(lab, SCENE)
    assert vars(lab.settings.params)["points"] != 17
    tab.page.reload()
    preset = tab.page.get_by_label("Preset")
    tab.wait(lambda: preset.count() == 1 and preset.is_visible(), 60)
    preset.click()
    tab.page.get_by_role("option", name="Mine: Seventeen beads").click()
    tab.wait(lambda: vars(lab.settings.params)["points"] == 17, 20)
    assert preset.input_value() == "Mine: Seventeen beads"


@pytest.mark.long
def test_clip_picture_and_plots_are_made_as_files(
    one_page: tuple[Viewer, Tab], open_tab: Callable[..., Tab], tmp_path: Path
) -> None:
    lab, _ = one_page
    tab = open_tab(lab.port, drawn="colorMap")  # draws the background image too: the sky of the picture is checked
    tab.follow(lab, SCENE)
    tab.show("Share")
    lab.settings.set("plot_tip", True)
    tab.wait(lambda: len(lab.panel.recorder.frames) > 10 and "plot_tip" in lab.panel.plots.charts, 30)
    tab.page.get_by_role("button", name="Record clip", exact=True).click()
    tab.page.wait_for_timeout(800)

    def saved(button: str) -> Path:
        with tab.page.expect_download(timeout=60_000) as download:
            tab.page.get_by_role("button", name=button, exact=True).click()
        download.value.save_as(tmp_path / download.value.suggested_filename)
        return tmp_path / download.value.suggested_filename

    with tab.page.expect_download(timeout=60_000) as download:
        tab.page.locator("[data-springtide-act=clip]").click()  # its name says how long the clip is by now
    clip = Path(download.value.path()).read_bytes()
    assert clip[4:8] == b"ftyp" or clip[:4] == b"\x1a\x45\xdf\xa3"  # MP4 or WebM
    tab.wait(lambda: tab.page.locator("[data-springtide-act=clip]").inner_text() == "Clip saved")
    width, height, *top = tab.page.evaluate(FIRST_ROW, base64.b64encode(clip).decode())
    sky = LIGHT_SKY.pixels(height, width)  # that the page shows
    assert np.median(abs(np.reshape(top, (width, 4))[:, :3] - sky[0])) < 5.0
    tab.wait(lambda: tab.page.locator("[data-springtide-act=clip]").inner_text() == "Record clip")
    for form, begin in (("CSV", b"t [s],"), ("SVG", b"<?xml"), ("PNG", b"\x89PNG")):
        tab.page.locator("[data-springtide-choice=plots]").select_option(form)
        made = saved("Save plots").read_bytes()
        assert made.startswith(begin)
    assert iio.imread(made).std() > 1.0
    picture = iio.imread(saved("Picture"))
    sky = LIGHT_SKY.pixels(*picture.shape[:2])  # that the page shows
    assert picture[0].mean(axis=0) == pytest.approx(sky[0].mean(axis=0), abs=3)
    lab.settings.set("plot_tip", False)


def test_no_preset_has_a_name_that_the_address_bar_would_change() -> None:
    """viser's client writes the address anew without escaping it."""
    for name in NAMES:
        for preset in scene_named(name).presets:
            assert not set(preset) & set("&+#%="), preset
