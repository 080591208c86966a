// Clips of the view. A clip is recorded from a copy of the canvas on the sky that the page shows behind it (page.css), as a video
// is not transparent.
//
// Of viser this file uses window.__viserMutable.canvas, which keeps its pixels.

import { notice } from "../core/notice.js";
import { springtide } from "../core/springtide.js";
import { startedViewer } from "../core/viewer.js";
import { withDuration } from "./webm.js";

const TYPES = ["video/mp4;codecs=avc1.640028", "video/webm;codecs=vp9", "video/webm"];
const RATE = 30; // [1/s] frames
const BITS = 12e6; // [bit/s]
const MAX_LENGTH = 300; // [s] after which a clip ends by itself
const TOLD = 3000; // [ms] for which the button says that a clip is saved
/** @type {MediaRecorder | null} */
let recorder = null; // of the clip under way

/** @param {Blob} content @param {string} name */
export function download(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

// Words of the button. Each scene has its own button.
/** @param {string} words */
function label(words) {
  const button = document.querySelector("[data-springtide-clip]");
  if (button) button.textContent = words;
}

// Paint the sky: an ellipse of three colours, brightest in the middle, that goes through the farthest corner; or one colour.
/** @param {CanvasRenderingContext2D} pen @param {string} background as the style sheet has it */
function paintSky(pen, background) {
  const { width, height } = pen.canvas, [inner = "white", around = inner, outer = around] = background.match(/rgba?\([^)]*\)/g) ?? [];
  const [x = 0.5, y = 0.5, share = 0.5] = (background.match(/[\d.]+(?=%)/g) ?? []).map((found) => Number(found) / 100);
  const sides = [width * Math.max(x, 1 - x), height * Math.max(y, 1 - y)];
  const sky = pen.createRadialGradient(0, 0, 0, 0, 0, Math.SQRT2);
  sky.addColorStop(0, inner);
  sky.addColorStop(share, around);
  sky.addColorStop(1, outer);
  pen.setTransform(sides[0], 0, 0, sides[1], x * width, y * height);
  pen.fillStyle = sky;
  pen.fillRect(-2, -2, 4, 4);
  pen.resetTransform();
}

// Save a clip of a duration [s].
/** @param {Blob} made @param {number} seconds */
async function save(made, seconds) {
  const { type } = made;
  if (type.startsWith("video/mp4")) return download(made, "springtide.mp4");
  const bytes = withDuration(new Uint8Array(await made.arrayBuffer()), seconds);
  download(new Blob([bytes], { type }), "springtide.webm");
}

// Begin a clip, or end the one under way.
export function toggleClip() {
  if (recorder) return recorder.stop();
  const type = TYPES.find((one) => window.MediaRecorder?.isTypeSupported(one));
  if (!type) {
    notice("springtide-clips", "This browser cannot record clips. Save a replay instead, or use another browser.");
    return;
  }
  const { width, height } = startedViewer().canvas, copy = Object.assign(document.createElement("canvas"), { width, height });
  const pen = /** @type {CanvasRenderingContext2D} */ (copy.getContext("2d"));
  const paint = () => {
    const { canvas } = startedViewer(); // another one where viser has made a new one
    paintSky(pen, getComputedStyle(canvas).backgroundImage);
    pen.drawImage(canvas, 0, 0, width, height);
  };
  /** @type {Blob[]} */
  const parts = [];
  const started = performance.now();
  const made = (recorder = new MediaRecorder(copy.captureStream(RATE), { mimeType: type, videoBitsPerSecond: BITS }));
  const show = () => {
    const seconds = (performance.now() - started) / 1000;
    label(`Stop clip (${seconds.toFixed(0)} s)`);
    if (seconds >= MAX_LENGTH) made.stop();
  };
  springtide.isRecording = true; // the quality stays constant during the recording
  const timers = [setInterval(paint, 1000 / RATE), setInterval(show, 500)];
  made.ondataavailable = (event) => parts.push(event.data);
  made.onstop = async () => {
    for (const timer of timers) clearInterval(timer);
    for (const track of made.stream.getTracks()) track.stop();
    recorder = null;
    springtide.isRecording = false;
    await save(new Blob(parts, { type }), (performance.now() - started) / 1000);
    label("Clip saved");
    setTimeout(() => recorder ?? label("Record clip"), TOLD);
  };
  paint();
  made.start(1000);
  show();
}
