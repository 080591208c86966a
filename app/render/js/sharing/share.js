// Links and set-ups: the lab opens the query of this page's address, and a chosen file, which is read here; of a replay, the
// set-up file in it. The lab checks both. A link from the lab is shown with this page's own address. After a change of a shared
// lab, the page that made it shows its own sentence.
// Plots are saved here as one picture.
//
// Of viser this file uses the charts of the page.

import { ask, say } from "../core/channel.js";
import { page } from "../core/life.js";
import { notice } from "../core/notice.js";
import { PAGE } from "../core/viewer.js";
import { onControls } from "../core/watch.js";
import { onPress } from "../panel/buttons.js";
import { chartsOfPage } from "../panel/charts.js";
import { rowsOf } from "../panel/rows.js";
import { download, toggleClip } from "./clip.js";
import { copy } from "./copy.js";
import { labAt, ofLab, setupIn } from "./links.js";
import { open } from "./open.js";

const MAX_LENGTH = 5000; // [characters] of a set-up file
const ANSWER_TIME = 10_000; // [ms] for the lab to make a link
const MAX_REPLAY = 2e8; // [bytes] of a replay
const asked = new URLSearchParams(location.search);
let showsLab = asked.has("task"); // show the tab "Lab", also of a scene that the link opens, until another is chosen

const own = `[data-page="${PAGE}"]`, sentences = document.createElement("style");
sentences.textContent =
  `.springtide-switch${own} .springtide-others, .springtide-switch:not(${own}) .springtide-own { display: none; }`;
document.head.append(sentences);

const KEYS = /Mac|iP/.test(navigator.platform) ? "⌘C" : "Ctrl+C";
let copied = { link: "", words: "" }; // the link of the last press of this page, and what came of it

async function copyLink() {
  notice("springtide-copy", "");
  copied = { link: "", words: "" };
  completeLinks();
  const link = ask("link", "", ANSWER_TIME).then((query) => labAt(location) + query);
  try {
    const isCopied = await copy(link, navigator.clipboard, Reflect.get(window, "ClipboardItem")); // some browsers have none
    const words = isCopied ? "Copied to the clipboard:" : `The browser did not copy it. Press ${KEYS} to copy this link:`;
    copied = { link: await link, words };
    completeLinks();
    const shown = document.querySelector(".springtide-link");
    if (!isCopied && shown) getSelection()?.selectAllChildren(shown);
  } catch (error) {
    if (error instanceof Error && error.message === "late") {
      notice("springtide-copy", "The lab sent no link, so nothing was copied. Press Copy link again.");
    }
  }
}

// Show a link with the address of this page, and above it what came of a press of this page.
function completeLinks() {
  /** @type {NodeListOf<HTMLAnchorElement>} */
  const links = document.querySelectorAll(".springtide-link");
  for (const link of links) {
    const address = labAt(location) + link.dataset.query;
    if (link.textContent !== address) link.href = link.textContent = address;
    const words = copied.link === address ? copied.words : "", above = link.previousElementSibling;
    if ((above?.textContent ?? "") === words) continue;
    above?.remove();
    if (!words) continue;
    const said = document.createElement("div");
    said.className = "springtide-copied";
    said.setAttribute("role", "status");
    said.textContent = words;
    link.before(said);
  }
}

function update() {
  completeLinks();
  if (showsLab) {
    const found = [...document.querySelectorAll('[role="tab"]')].find((one) => one.textContent.trim() === "Lab");
    if (found && found.ariaSelected !== "true") {
      for (const kind of ["pointerdown", "pointerup"]) { // viser hears no click
        found.dispatchEvent(new PointerEvent(kind, { bubbles: true, isPrimary: true, pointerId: 1 }));
      }
    }
  }
}

// All charts below each other, each with its title above and the names of its lines below.
/** @param {HTMLElement} button */
function saveCharts(button) {
  const charts = chartsOfPage();
  /** @param {string} words */
  const refuse = (words) => {
    button.textContent = words;
    setTimeout(() => (button.textContent = "Save plots"), 3000);
  };
  if (!charts.length) return refuse("Open a plot first");
  const ratio = devicePixelRatio, line = 26 * ratio;
  const sheet = document.createElement("canvas");
  const pen = /** @type {CanvasRenderingContext2D} */ (sheet.getContext("2d"));
  const width = Math.max(...charts.map((chart) => chart.ctx.canvas.width));
  // The names of a chart's lines, in as many rows as they need.
  const keys = charts.map((chart) => {
    pen.font = `${11 * ratio}px sans-serif`;
    const shown = chart.series.slice(1).filter(({ show }) => show);
    const places = rowsOf(shown.map(({ label }) => pen.measureText(`— ${label}   `).width), 8 * ratio, width);
    return shown.map(({ label, _stroke: stroke }, k) => {
      const colour = typeof stroke === "string" ? stroke : "#888888";
      return { ...places[k], name: `— ${label}`, colour };
    });
  });
  const rows = keys.map((key) => 1 + Math.max(0, ...key.map(({ row }) => row)));
  sheet.width = width;
  sheet.height = charts.reduce((sum, chart, i) => sum + chart.ctx.canvas.height + (1 + rows[i]) * line, 0);
  const around = getComputedStyle(charts[0].root.parentElement ?? charts[0].root);
  pen.fillStyle = around.getPropertyValue("--mantine-color-body") || "#ffffff";
  pen.fillRect(0, 0, sheet.width, sheet.height);
  pen.textBaseline = "middle";
  let top = 0;
  charts.forEach((chart, i) => {
    const title = chart.root.querySelector(".u-title");
    pen.fillStyle = getComputedStyle(title || chart.root).color;
    pen.font = `bold ${13 * ratio}px sans-serif`;
    pen.fillText(title?.textContent || "", 8 * ratio, top + line / 2);
    pen.drawImage(chart.ctx.canvas, 0, top + line);
    const { left, top: under, width: long, height: tall } = chart.bbox; // the name of the axis at its end
    pen.font = `${11 * ratio}px sans-serif`;
    pen.textAlign = "right";
    pen.fillText(chart.series[0].label, left + long - 2 * ratio, top + line + under + tall - 8 * ratio);
    pen.textAlign = "left";
    top += line + chart.ctx.canvas.height;
    pen.font = `${11 * ratio}px sans-serif`;
    for (const { row, left, name, colour } of keys[i]) {
      pen.fillStyle = colour;
      pen.fillText(name, left, top + (row + 0.5) * line);
    }
    top += rows[i] * line;
  });
  sheet.toBlob((content) => {
    if (!content || !download(content, "springtide-plots.png")) refuse("No picture was made");
  });
}

page.listen(document, ["pointerdown", "keydown"], ({ isTrusted, target }) => {
  if (isTrusted && target instanceof Element && target.closest('[role="tab"]')) showsLab = false;
}, { capture: true });
// Choice in a list of the panel, if it is there.
/** @param {string} selector */
const choiceOf = (selector) => /** @type {HTMLSelectElement | null} */ (document.querySelector(selector))?.value;
onPress("link", copyLink);
onPress("save", () => say("save", ""));
onPress("clip", toggleClip);
onPress("plots", (button) => {
  const form = choiceOf("[data-springtide-choice=plots]");
  form === "PNG" ? saveCharts(button) : say("plots", `Plots as ${form}`);
});
page.listen(document, "change", async (event) => {
  const field = event.target;
  if (!(field instanceof HTMLInputElement) || !field.matches(".springtide-load input") || !field.files?.length) return;
  const file = field.files[0];
  let text = await file.slice(0, 4 * MAX_LENGTH).text();
  if (text.trimStart().startsWith("<") && file.size <= MAX_REPLAY) {
    text = setupIn(await file.text()) ?? text;
  }
  open(text.slice(0, MAX_LENGTH + 1)); // of a longer one the lab says so
  field.value = "";
});
if (["scene", "task", "compare"].some((name) => asked.has(name))) open(ofLab(location.search));
onControls(update);
