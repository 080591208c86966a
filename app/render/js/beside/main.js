// The page with the panes. The labs keep one clock (app/server/loop/shared_clock.py). Here the cameras are linked, one scale bar
// is drawn for all, and the words above each pane say what differs.

import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { linkCameras } from "./cameras.js";
import { Pane } from "./panes.js";
import { drawScale } from "./scale.js";

const LOOK_INTERVAL = 200; // [ms]
/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
const clock = element("clock"), play = element("play");
const asked = location.search;
/** @type {Pane[]} */
const panes = [];
let leader = 0; // the pane in which a person acted last

springtide.beside = true;
springtide.areWhole = () => panes.every((pane) => pane.springtide?.isWhole);

function addPane() {
  const index = panes.length;
  panes.push(new Pane(index, asked, () => (leader = index)));
}

// Follow what the first lab says of all panes.
function followPanes() {
  const states = panes[0].springtide?.channel?.topicState("panes");
  if (!states) return;
  if (!states.length) location.replace(new URL("./", location.href)); // the first lab is alone again
  while (panes.length < states.length) addPane();
  while (panes.length > Math.max(states.length, 1)) panes.pop()?.remove();
  panes.forEach((pane, index) => states[index] && pane.show(states[index]));
  leader = Math.min(leader, panes.length - 1);
}

/** @param {HTMLElement} place @param {string} text */
function put(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

function showClocks() {
  const lines = panes.map(({ status }) => status), [first] = lines;
  for (const pane of panes) pane.showPanel();
  if (!first) return;
  const isRunning = first.dataset.state === "running";
  const times = [...new Set(lines.map((line) => line?.textContent.match(/t = [\d\u202f,.]+ s/)?.[0] ?? "…"))];
  const pace = isRunning ? first.querySelector(".springtide-speed")?.textContent.match(/×[\d.]+/)?.[0] : "";
  const stopped = lines.map((line) => line?.querySelector(".springtide-stopped")?.textContent).find(Boolean);
  const cut = panes.findIndex(({ isCut }) => isCut);
  const away = panes.findIndex(({ isConnected }) => !isConnected); // the clock stands still without it
  if (cut >= 0) put(clock, `No connection to lab ${cut + 1}: its picture is old`);
  else if (away >= 0) put(clock, `Waiting for lab ${away + 1} to connect`);
  else put(clock, stopped || `${isRunning ? "" : "Paused, "}${times[0]}${pace ? `, ${pace} real time` : ""}`);
  put(play, isRunning ? "Pause" : "Play");
}

function drawTogether() {
  const view = linkCameras(panes, panes[leader]);
  if (view) drawScale(view);
  requestAnimationFrame(drawTogether);
}

// Press a button of the first lab; the keys of the lab go to the leading pane.
/** @param {string} topic @param {string} value */
function say(topic, value) {
  panes[0].springtide?.channel?.say(topic, value);
  panes[leader].focus();
}

page.listen(play, "click", () => say("run", play.textContent));
page.listen(element("step"), "click", () => say("run", "Step"));
page.listen(element("reset"), "click", () => say("run", "Reset"));
page.listen(element("end"), "click", () => say("panes", "end"));
addPane();
history.replaceState(null, "", location.pathname);
panes[0].frame.addEventListener("load", () => panes[0].focus(), { once: true });
page.every(LOOK_INTERVAL, () => {
  followPanes();
  showClocks();
});
requestAnimationFrame(drawTogether);
