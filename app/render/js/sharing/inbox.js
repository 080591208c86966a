// Texts for the lab: the query of a link, or a file.
//
// Each scene's panel has a hidden field for them. A text sent while a panel is being replaced, or while the line is cut, is lost.
// Therefore the last text is sent again to each new field and on each new connection, for a while. It has a number, and the lab
// takes each number once.

import { connectionNumber, PAGE, send } from "../core/viewer.js";
import { onControls } from "../core/watch.js";

const PATIENCE = 60_000; // [ms] after the first time that a text was sent
let count = 0;
/** @type {{ text: string, sentTo: string, until: number } | null} */
let last = null;

function post() {
  const field = document.querySelector("[data-springtide-inbox]")?.dataset.springtideInbox, now = performance.now();
  if (!last || now > last.until || !document.querySelector(".springtide-panel[data-state]")) return;
  const to = `${connectionNumber()} ${field}`;
  if (to === last.sentTo || !send(field, last.text)) return;
  last.sentTo = to;
  last.until = Math.min(last.until, now + PATIENCE);
}

// Send a text to the lab once there is a panel; an earlier text is not sent again.
/** @param {string} text */
export function sendText(text) {
  last = { text: `${PAGE} ${++count}\n${text}`, sentTo: "", until: Infinity };
  post();
}

onControls(post);
