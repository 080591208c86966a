// Words of the page while nothing is drawn, and after the server has ended.
//
// The cover is there from the first bytes of the page. It goes when the whole picture of the scene is drawn (frames.js);
// while a scene is compiled it shows what the panel says of that (an element of class "springtide-progress"). It comes
// back when the server does not answer.
// Where the page cannot start it says why (before/failures.js).

import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { onChange, onLook } from "../core/watch.js";

const ALIVE_INTERVAL = 2000; // [ms] between two questions whether the server is still there
const RETRY_INTERVAL = 1000; // [ms] the same after a question without an answer
const ANSWER_TIME = 5000; // [ms] after which a question counts as not answered
const MAX_UNANSWERED = 3; // questions in a row: a laptop that wakes, or changes its network, misses one
const SETTLING = 300; // [ms] after a panel, in which the things of its scene come
const UNDRAWN = 10_000; // [ms] after which the cover goes where no frame has begun
const PATIENCE = 60_000; // [ms] after which it goes in any case
const cover = /** @type {HTMLElement} */ (document.getElementById("springtide-cover"));
const words = /** @type {HTMLElement} */ (document.getElementById("springtide-cover-words"));
// A path is that of a proxy, such as a JupyterHub, or of a pane of several.
const path = location.pathname.replace(/(pane\/\d+\/)?(index\.html)?$/, "");
const restart = path === "/" ? "Start it again with the command: springtide" : "Reload this page to start it again.";
let unanswered = 0;
let server = ""; // name of the server: another one has another name

/** @param {string | null} text @param {boolean} hidden */
function say(text, hidden) {
  if (text !== null && words.textContent !== text) words.textContent = text;
  cover.classList.toggle("springtide-hidden", hidden);
}

/** @type {string | null} */
let opened = null; // the panel whose picture is awaited, by its field for reports
let openedAt = 0; // [ms] since when
let pictured = ""; // the panel whose picture was whole

// True if the picture of the panel's scene is still to come. A lab that draws by viser's public interface has no such field,
// and another one has it after its status line.
function awaitsPicture() {
  const field = document.querySelector("[data-springtide-shaders]")?.dataset.springtideShaders ?? "";
  if (field && field === pictured) return false;
  const now = performance.now();
  if (field !== opened) [opened, openedAt] = [field, now];
  const since = now - openedAt, { showsWhole } = springtide;
  if (!field) return since < SETTLING;
  if (since < (showsWhole ? PATIENCE : UNDRAWN) && (since < SETTLING || !showsWhole?.())) return true;
  pictured = field;
  return false;
}

let waiting = "Connecting to the lab …"; // while there is no panel
function update() {
  if (unanswered >= MAX_UNANSWERED) return say(`The lab has stopped. ${restart}`, false);
  const progress = document.querySelector(".springtide-progress");
  if (progress) {
    waiting = progress.textContent;
    return say(waiting, false);
  }
  if (document.querySelector(".springtide-panel")) {
    waiting = "Opening the scene …"; // the page is connected from now on
    const isAwaited = awaitsPicture();
    return say(isAwaited && !pictured ? "Preparing the picture …" : null, !isAwaited);
  }
  return say(springtide.failure || waiting, false);
}

// Name of the server; "" where it does not answer.
async function askServer() {
  try {
    const answer = await fetch("springtide-alive", { cache: "no-store", signal: AbortSignal.timeout(ANSWER_TIME) });
    return answer.ok ? await answer.text() : "";
  } catch {
    return "";
  }
}

async function ask() {
  const name = document.visibilityState === "visible" ? await askServer() : null;
  if (name !== null) {
    unanswered = name ? 0 : unanswered + 1;
    server ||= name;
    // Another server knows nothing of this page. What is being recorded is lost with a reload.
    if (name && name !== server && !springtide.isRecording) return void location.reload();
    update();
  }
  timer = setTimeout(ask, unanswered ? RETRY_INTERVAL : ALIVE_INTERVAL);
}

let timer = setTimeout(ask, 0);
page.own(() => clearTimeout(timer));
onChange(update);
onLook(update);
