// Clips of the view. A clip is recorded from a copy of the canvas on the sky that the page shows behind it (page.css), as a video
// is not transparent.
//
// Of viser this file uses window.__viserMutable.canvas, which keeps its pixels.

import { Life } from "../core/life.js";
import { notice } from "../core/notice.js";
import { springtide } from "../core/springtide.js";
import { startedViewer } from "../core/viewer.js";
import { withDuration } from "./webm.js";

const TYPES = ["video/mp4;codecs=avc1.640028", "video/webm;codecs=vp9", "video/webm"];
const RATE = 30; // [1/s] frames
const BITS = 12e6; // [bit/s]
const MAX_LENGTH = 300; // [s] after which a clip ends by itself
const MAX_EMPTY = 10; // [s] after which a clip ends if the browser has encoded nothing
const TOLD = 3000; // [ms] for which the button says that a clip is saved
const RECORD = "Record clip", NOTICE = "springtide-clips", CURE = "Save a replay instead, or use another browser.";
/** @type {MediaRecorder | null} */
let recorder = null; // of the clip under way

// Save a file. False if it is empty: then nothing is saved.
/** @param {Blob} content @param {string} name */
export function download(content, name) {
  if (content.size === 0) return false;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  return true;
}

// Words of the button. Each scene has its own button.
/** @param {string} words */
function label(words) {
  const button = document.querySelector("[data-springtide-act=clip]");
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

// Begin a clip, or end the one under way. What a browser cannot do is said, and leaves the page as it was.
export function toggleClip() {
  if (recorder) return recorder.stop();
  const type = TYPES.find((one) => window.MediaRecorder?.isTypeSupported(one));
  notice(NOTICE, type ? "" : `This browser cannot record clips. ${CURE}`);
  if (!type) return;
  const life = new Life();
  try {
    begin(type, life);
  } catch (error) {
    life.end();
    notice(NOTICE, `The clip did not start: ${error instanceof Error ? error.message : error}. ${CURE}`);
  }
}

// life: of the clip.
/** @param {string} type @param {Life} life */
function begin(type, life) {
  const { canvas: first } = startedViewer();
  const [width, height] = [first.width, first.height].map((size) => 2 * Math.floor(size / 2)); // as some formats require
  const copy = Object.assign(document.createElement("canvas"), { width, height });
  const pen = /** @type {CanvasRenderingContext2D} */ (copy.getContext("2d"));
  const paint = () => {
    const { canvas } = startedViewer(); // another one where viser has made a new one
    paintSky(pen, getComputedStyle(canvas).backgroundImage);
    const scale = Math.min(width / canvas.width, height / canvas.height); // the window may have changed its size
    const [wide, high] = [scale * canvas.width, scale * canvas.height];
    pen.drawImage(canvas, (width - wide) / 2, (height - high) / 2, wide, high);
  };
  paint();
  const stream = copy.captureStream(RATE);
  life.own(() => stream.getTracks().forEach((track) => track.stop()));
  const made = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: BITS });
  /** @type {Blob[]} */
  const parts = [];
  let size = 0, failure = "nothing was recorded";
  const started = performance.now(), seconds = () => (performance.now() - started) / 1000;
  made.ondataavailable = ({ data }) => {
    parts.push(data);
    size += data.size;
  };
  made.onerror = (event) => {
    failure = /** @type {{ error?: Error }} */ (event).error?.message ?? failure;
    if (made.state !== "inactive") made.stop();
  };
  made.onstop = async () => {
    const length = seconds();
    life.end();
    if (size === 0) {
      label(RECORD);
      return notice(NOTICE, `No clip was saved: ${failure}. ${CURE}`);
    }
    await save(new Blob(parts, { type }), length);
    label("Clip saved");
    setTimeout(() => recorder ?? label(RECORD), TOLD);
  };
  made.start(1000);
  recorder = made;
  springtide.isRecording = true; // the quality stays constant during the recording
  life.own(() => {
    recorder = null;
    springtide.isRecording = false;
  });
  const show = () => {
    label(`Stop clip (${seconds().toFixed(0)} s)`);
    if (seconds() >= (size ? MAX_LENGTH : MAX_EMPTY)) made.stop();
  };
  life.every(1000 / RATE, paint);
  life.every(500, show);
  show();
}
