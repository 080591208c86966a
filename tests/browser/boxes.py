"""Measures the boxes of a page: text over text, controls out of reach, and the picture hidden behind panels."""

from typing import Any

from app.server.viewer import Viewer
from tests.browser.conftest import Tab

SIZES = ((1920, 1080), (1280, 800), (800, 600), (390, 844))  # [pixels]
MIN_PICTURE_SHARE = 0.12  # of the window that must show the picture
# Texts that a reader sees on top of each other, controls that no scrolling brings into the window, charts narrower than
# their words, and the share of the window in which the picture is on top.
MEASURE = """() => {
    const wide = innerWidth, high = innerHeight;
    // The part of a box that its scrolling ancestors let through.
    const seen = (element, box) => {
        let { left, top, right, bottom } = box;
        for (let parent = element; parent; parent = parent.parentElement) {
            const style = getComputedStyle(parent);
            if (style.visibility === "hidden" || Number(style.opacity) === 0) return null;
            if (parent !== element && style.overflow !== "visible") {
                const outer = parent.getBoundingClientRect();
                [left, top] = [Math.max(left, outer.left), Math.max(top, outer.top)];
                [right, bottom] = [Math.min(right, outer.right), Math.min(bottom, outer.bottom)];
            }
            if (style.position === "fixed") break;
        }
        [left, top] = [Math.max(left, 0), Math.max(top, 0)];
        [right, bottom] = [Math.min(right, wide), Math.min(bottom, high)];
        return right - left > 1 && bottom - top > 1 ? { left, top, right, bottom } : null;
    };
    const texts = [];
    const walker = document.createTreeWalker(document.getElementById("root"), NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const node = walker.currentNode, element = node.parentElement;
        if (!node.textContent.trim() || ["STYLE", "SCRIPT"].includes(element.tagName)) continue;
        const range = document.createRange();
        range.selectNodeContents(node);
        for (const box of range.getClientRects()) {
            // A line box is higher than its letters.
            const inner = { left: box.left + 1, right: box.right - 1, top: box.top + 0.2 * box.height,
                bottom: box.bottom - 0.2 * box.height };
            const part = seen(element, inner);
            if (part) texts.push({ element, words: node.textContent.trim().slice(0, 30), ...part });
        }
    }
    const opaque = (element) => {
        const style = getComputedStyle(element), colour = style.backgroundColor.match(/[\\d.]+/g) || [0, 0, 0, 0];
        return element.tagName === "CANVAS" || (colour.length < 4 ? 1 : Number(colour[3])) > 0.9;
    };
    const overlaps = [];
    texts.sort((a, b) => a.top - b.top);
    for (let i = 0; i < texts.length; i++) {
        for (let j = i + 1; j < texts.length && texts[j].top < texts[i].bottom; j++) {
            const a = texts[i], b = texts[j];
            const left = Math.max(a.left, b.left), right = Math.min(a.right, b.right);
            const top = Math.max(a.top, b.top), bottom = Math.min(a.bottom, b.bottom);
            if (right - left < 2 || bottom - top < 2) continue;
            const stack = document.elementsFromPoint((left + right) / 2, (top + bottom) / 2);
            const [first, second] = [stack.indexOf(a.element), stack.indexOf(b.element)].sort((m, n) => m - n);
            if (first < 0 || second < 0) continue; // one of them is behind something else, or takes no pointer
            if (first !== second && stack.slice(first, second).some(opaque)) continue;
            overlaps.push(`${a.words} / ${b.words}`);
        }
    }
    const outside = [];
    for (const control of document.querySelectorAll("#root :is(button, input, [role=button], [role=slider])")) {
        const box = control.getBoundingClientRect();
        if (!box.width || !box.height || getComputedStyle(control).visibility === "hidden") continue;
        let left = 0, right = wide, scrolls = false;
        for (let parent = control.parentElement; parent; parent = parent.parentElement) {
            const style = getComputedStyle(parent), outer = parent.getBoundingClientRect();
            if (style.overflowX !== "visible") {
                [left, right] = [Math.max(left, outer.left), Math.min(right, outer.right)];
            }
            scrolls ||= ["auto", "scroll"].includes(style.overflowY) && parent.scrollHeight > parent.clientHeight;
            if (style.position === "fixed") break;
        }
        const across = box.left < left - 2 || box.right > right + 2;
        const down = !scrolls && (box.top < -2 || box.bottom > high + 2);
        const name = control.getAttribute("aria-label") || control.textContent || control.id || control.tagName;
        if (across || down) outside.push(name.trim().slice(0, 40));
    }
    let pictures = 0, points = 0;
    for (let x = 8; x < wide; x += 16) {
        for (let y = 8; y < high; y += 16) {
            points++;
            const top = document.elementFromPoint(x, y);
            pictures += Boolean(top && (top.tagName === "CANVAS" || top.querySelector(":scope canvas[data-engine]")));
        }
    }
    const charts = [...document.querySelectorAll(".uplot")].map((chart) => chart.getBoundingClientRect().width);
    return { overlaps, outside, picture: pictures / points, narrow: charts.filter((width) => width < 200) };
}"""


PLOTS_OPEN = "() => document.querySelectorAll('.uplot').length > 0"


def faults_after_change(tab: Tab, lab: Viewer, size: tuple[int, int], *, plots: bool) -> list[str]:
    """What is wrong at this size [pixels] with the plots open or closed, once viser has laid the page out."""
    tab.page.set_viewport_size({"width": size[0], "height": size[1]})
    if bool(lab.panel.plots.open) != plots:
        lab.settings.toggle_plots()
    tab.wait(lambda: bool(lab.panel.plots.open) == tab.page.evaluate(PLOTS_OPEN) == plots)
    found: list[str] = []
    for _ in range(40):
        tab.page.wait_for_timeout(250)
        found = faults(tab.page)
        if not found:
            break
    return found


def faults(page: Any) -> list[str]:
    """What is wrong with the boxes of a page now, in words."""
    found = page.evaluate(MEASURE)
    words = [f"text over text: {pair}" for pair in found["overlaps"]]
    words += [f"out of reach: {name}" for name in found["outside"]]
    words += [f"a chart {width:.0f} pixels wide" for width in found["narrow"]]
    if found["picture"] < MIN_PICTURE_SHARE:
        words.append(f"the picture shows in {100 * found['picture']:.0f} % of the window")
    return words
