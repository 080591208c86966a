// Words of the page while nothing is drawn, and after the server has ended.
//
// The cover is shown from the first bytes of the page until the picture of the scene is complete (frames.js). While a scene is
// compiled it shows the panel's progress (an element of class "springtide-progress"). It returns when the server does not
// answer. If the page cannot start, it shows the reason (before/failures.js).

import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { onChange, onLook } from "../core/watch.js";

const ALIVE_INTERVAL = 2000; // [ms] between two checks that the server answers
const RETRY_INTERVAL = 1000; // [ms] the same after a check without an answer
const ANSWER_TIME = 5000; // [ms] after which a check has failed
const MAX_UNANSWERED = 3; // failed checks in a row: a laptop that wakes up, or changes its network, misses one
const SETTLING = 300; // [ms] after a panel, in which the objects of its scene arrive
const UNDRAWN = 10_000; // [ms] after which the cover goes if no frame has begun
const PATIENCE = 60_000; // [ms] after which it goes in any case
const cover = /** @type {HTMLElement} */ (document.getElementById("springtide-cover"));
const words = /** @type {HTMLElement} */ (document.getElementById("springtide-cover-words"));
// A path belongs to a proxy, such as a JupyterHub, or to a pane of a comparison.
const path = location.pathname.replace(/(pane\/\d+\/)?(index\.html)?$/, "");
const restart = path === "/" ? "Start it again with the command: springtide" : "Reload this page to start it again.";
let unanswered = 0;
let server = ""; // name of the server, which differs for each server

/** @param {string | null} text @param {boolean} hidden */
function say(text, hidden) {
  if (text !== null && words.textContent !== text) words.textContent = text;
  cover.classList.toggle("springtide-hidden", hidden);
}

/** @type {string | null} */
let opened = null; // the panel whose picture is awaited, by its field for reports
let openedAt = 0; // [ms] since when
let pictured = ""; // the panel whose picture was complete

// True if the picture of the panel's scene is not complete yet. A lab that draws by viser's public interface has no such field;
// otherwise it follows the status line.
function awaitsPicture() {
  const field = document.querySelector("[data-springtide-shaders]")?.dataset.springtideShaders ?? "";
  if (field && field === pictured) return false;
  const now = performance.now();
  if (field !== opened) {
    [opened, openedAt] = [field, now];
    springtide.awaitPicture?.();
  }
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
    waiting = "Opening the scene …"; // the page is connected now
    const isAwaited = awaitsPicture();
    return say(isAwaited && !pictured ? "Preparing the picture …" : null, !isAwaited);
  }
  return say(springtide.failure || waiting, false);
}

// Name of the server; "" if it does not answer.
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
    // A new server does not know this page: reload, unless a clip is being recorded.
    if (name && name !== server && !springtide.isRecording) return void location.reload();
    update();
  }
  timer = setTimeout(ask, unanswered ? RETRY_INTERVAL : ALIVE_INTERVAL);
}

let timer = setTimeout(ask, 0);
page.own(() => clearTimeout(timer));
onChange(update);
onLook(update);
