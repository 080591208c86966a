// The time line along the foot of the scene: a bar as wide as the scene, with the recording and its shown moment.
//
// Its state and its actions are topic "time". The bar is beside the panel, or above it if the panel is a sheet at the foot. Other elements at the foot of the scene are placed by
// `--springtide-left`, `--springtide-right` and `--springtide-foot`, the bar's distances from the edges of the window, and
// `--springtide-bar`, its height.

import { onTopic, say as sayToLab } from "../core/channel.js";
import { page } from "../core/life.js";
import { onLook, wake } from "../core/watch.js";
import { footOf, wordsOf } from "./foot.js";
import { PANEL } from "./marks.js";

const SEND_INTERVAL = 40; // [ms] between two moments sent during a drag along the bar
const bar = document.createElement("div");
bar.id = "springtide-time";
bar.setAttribute("role", "group");
bar.setAttribute("aria-label", "Time line");
bar.innerHTML = `<div class="springtide-past springtide-switches"><output></output>
    <select aria-label="Speed of playing the recording" title="Speed of playing the recording"></select>
    <button type="button" data-act="loop" title="Play the recording again and again" aria-label="Loop">↻</button>
    <button type="button" data-act="live" title="Back to the present">Live</button>
    <button type="button" data-act="continue"><b>Continue from here</b></button></div>
  <button type="button" data-act="play"></button><input type="range" step="any" aria-label="Time of the recording"><span></span>`;
/** @template {"output" | "select" | "input" | "span"} K @param {K} name @returns {HTMLElementTagNameMap[K]} */
const part = (name) => /** @type {HTMLElementTagNameMap[K]} */ (bar.querySelector(name));
const back = part("output"), speed = part("select"), line = part("input"), moment = part("span");
/** @param {string} act @returns {HTMLButtonElement} */
const button = (act) => /** @type {HTMLButtonElement} */ (bar.querySelector(`[data-act=${act}]`));
/**
 * The panel's state: times are in seconds; shown: null at the present.
 * @typedef {{ run: number, low: number, high: number, shown: number | null, rate: number,
 *   rates: number[], loops: boolean, playing: boolean, resumable: boolean, size: string }} State
 */
/** @type {State} */
let state;
let held = false, sentAt = 0;
/** @type {ReturnType<typeof setTimeout> | 0} */
let waiting = 0;

/** @param {string} act @param {string | number} number */
function send(act, number) {
  sayToLab("time", [act, Number(number), state.run]);
}

/** @param {Element} element @param {string} text */
function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// Show the moment of the bar; during a drag, the one under the pointer.
/** @param {boolean} isPast */
function say(isPast) {
  const words = wordsOf(Number(line.value), state.high, isPast);
  put(moment, words.moment);
  put(back, words.back);
  line.setAttribute("aria-valuetext", `${moment.textContent}, ${back.textContent}`);
}

/** @param {State | undefined} now */
function update(now) {
  bar.hidden = !now;
  if (!now) return;
  state = now;
  const isPast = state.shown !== null;
  const shown = String(state.shown ?? "");
  if (bar.dataset.moment !== shown) {
    bar.dataset.moment = shown; // for the charts
    wake();
  }
  bar.classList.toggle("springtide-is-past", isPast);
  if (speed.options.length !== state.rates.length) {
    speed.replaceChildren(...state.rates.map((rate) => new Option(`×${rate}`, String(rate))));
  }
  speed.value = String(state.rate);
  button("loop").ariaPressed = String(state.loops);
  put(button("play"), state.playing ? "❚❚" : "▶");
  button("play").ariaLabel = button("play").title = state.playing ? "Stop playing the recording" : "Play the recording";
  button("continue").disabled = isPast && !state.resumable;
  button("continue").title = state.resumable ? "Resume from here; everything recorded later is discarded"
    : "Can't resume from this far back; pick a later moment";
  line.disabled = !(state.high > state.low);
  line.title = `Recorded: ${(state.high - state.low).toFixed(0)} s, ${state.size}. Drag or press an arrow key to look back; `
    + "Space plays the recording";
  if (held) return;
  [line.min, line.max] = [String(state.low), String(state.high)];
  line.value = String(state.shown ?? state.high);
  say(isPast);
}

function sendMoment() {
  waiting = 0;
  sentAt = performance.now();
  send("show", line.value);
}
page.listen(line, "input", () => {
  held = true;
  say(true);
  if (!waiting) waiting = setTimeout(sendMoment, Math.max(0, sentAt + SEND_INTERVAL - performance.now()));
});
page.listen(line, "change", () => {
  clearTimeout(waiting);
  sendMoment();
  held = false;
});
page.listen(line, "pointerup", () => setTimeout(() => line.blur())); // so that keys go to the lab again
page.listen(speed, "change", () => send("rate", speed.value));
page.listen(bar, "click", (event) => {
  const act = event.target instanceof Element && event.target.closest("button")?.dataset.act;
  if (act) send(act, act === "loop" ? Number(!state.loops) : line.value);
});
page.listen(bar, "keydown", (event) => {
  if (event.target === line && event.key === " ") {
    event.preventDefault();
    return send("play", line.value);
  }
  if (!/^(Arrow|Page|Home|End)/.test(event.key)) return;
  event.stopPropagation(); // they would move the camera
  const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
  if (event.target !== line || !by) return;
  event.preventDefault();
  send("step", by);
});

function place() {
  const canvas = document.querySelector("canvas[data-engine]");
  if (bar.hidden || !canvas) return;
  const panels = [...document.querySelectorAll(PANEL)].map((one) => one.getBoundingClientRect());
  const high = bar.offsetHeight;
  const { left, right, bottom } = footOf(canvas.getBoundingClientRect(), panels, high);
  const edges = { left, right: innerWidth - right, foot: innerHeight - bottom, bar: high };
  const { style } = document.documentElement;
  for (const [name, value] of Object.entries(edges)) {
    const [property, size] = [`--springtide-${name}`, `${Math.round(value)}px`];
    if (style.getPropertyValue(property) !== size) style.setProperty(property, size);
  }
}

bar.hidden = true;
document.body.append(bar);
onTopic("time", update);
onLook(place);
