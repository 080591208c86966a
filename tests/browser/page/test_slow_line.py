"""How soon the page shows the effect of a key over a line of 20 Mbit/s and a round trip of 80 ms, with a sea running.

A router, or a tunnel, takes in a megabyte before the line: what is there cannot be replaced by what is newer.
`tests/app/server/web/test_rate_limit.py` counts what is on the way, in the normal suite.
"""

import json
import math
import statistics
from typing import Any

import pytest

from app.render.material import WATER_UNIFORMS
from tests.browser.conftest import new_page
from tests.browser.slow_line import slow_line
from tests.stress.served import served

RATE, DELAY, BUFFER = 20e6 / 8, 0.04, 1_000_000  # [bytes/s], [s] each way, [bytes]
CHANGES = 40
MAX_REACTION = 0.25  # [s] in the median, on a machine with no other work
# In each frame of the page: whether the box "Grid" is ticked, which the server does, and whether the sea that is drawn
# has its grid; after a key G the times [ms] until each has changed.
WATCH = """row => {
    const watch = window.springtideWatch = {ticked: [], drawn: [], pictures: 0, waits: {}}, now = {};
    const numbers = suffix => {
        const nodes = window.__viserMutable?.nodeRefFromName ?? {};
        const node = nodes[Object.keys(nodes).find(name => name.endsWith(suffix))];
        let found = null;
        if (node) node.traverse(o => { if (o.isMesh && !found) found = o.geometry.attributes.position.array; });
        return found;
    };
    addEventListener("keydown", event => {
        if (event.key !== "g") return;
        watch.waits = {ticked: [event.timeStamp, now.ticked], drawn: [event.timeStamp, now.drawn]};
    }, true);
    let last = null;
    const look = () => {
        const label = [...document.querySelectorAll("label")].find(label => label.textContent === "Grid");
        now.ticked = label && document.getElementById(label.htmlFor)?.checked;
        now.drawn = numbers("/water_material")?.[3 * row + 2];
        const surface = numbers("/water_surface");
        if (surface && surface !== last) { last = surface; watch.pictures += 1; }
        for (const [what, [start, before]] of Object.entries(watch.waits))
            if (now[what] !== before) { watch[what].push(performance.now() - start); delete watch.waits[what]; }
        watch.ready = watch.pictures > 20 && now.ticked !== undefined && now.drawn !== undefined;
        requestAnimationFrame(look);
    };
    look();
}"""


def of_95(times: list[float]) -> float:
    """What 95 of 100 stay below."""
    return sorted(times)[math.ceil(0.95 * len(times)) - 1]


@pytest.mark.stress
@pytest.mark.parametrize("scene", ["square_sea", "radial_sea"])
def test_a_key_answers_soon_over_a_slow_line(chromium: Any, scene: str) -> None:
    with served("--scene", scene) as lab, slow_line(lab.port, RATE, DELAY, BUFFER) as line:
        page = new_page(chromium, 480, 320, drawn=False)
        page.goto(f"http://127.0.0.1:{line.port}/?hideViserLogo&fixedDpr=0.2", timeout=60_000)
        page.get_by_role("tab", name="View", exact=True).click(timeout=60_000)
        page.evaluate(WATCH, WATER_UNIFORMS.index("extent"))
        page.wait_for_function("springtideWatch.ready", timeout=60_000)
        page.wait_for_timeout(3000)
        for number in range(CHANGES):
            page.keyboard.press("g")
            page.wait_for_function("Object.keys(springtideWatch.waits).length === 0", timeout=20_000)
            page.wait_for_timeout(300 + 37 * (number % 7))
        watch = page.evaluate("springtideWatch")
        page.close()
    for what in ("ticked", "drawn"):
        times = [time / 1000 for time in watch[what]]
        print(f"{scene}, {what}: median {statistics.median(times):.3f} s, 95 % below {of_95(times):.3f} s")
        assert len(times) == CHANGES
        assert statistics.median(times) < MAX_REACTION, json.dumps(times)
