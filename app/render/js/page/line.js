// The connection to the lab as the page shows it: while nothing comes, the picture is marked as old, and after a while the page
// connects again.
//
// `data-springtide-line` of the document is the state, "silent" or "closed". The style sheet greys the picture, and its words
// take the place of "Running" (page.css).

import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { Silence } from "./silence.js";

const LOOK_INTERVAL = 500; // [ms]
const WORDS = {
  open: "",
  silent: "Nothing arrives from the lab: this picture is old.",
  closed: "No connection to the lab: this picture is old. Connecting again …",
};
const root = document.documentElement;
const silence = new Silence(performance.now());
let isOpened = false; // true once there has been a connection

const words = document.createElement("div");
words.id = "springtide-line";
words.setAttribute("role", "status");
document.body.append(words);

function look() {
  const { line } = springtide;
  if (!line || document.visibilityState === "hidden") return;
  isOpened ||= line.isOpen;
  if (!isOpened) return; // the cover says that the page connects
  const state = silence.look(performance.now(), line);
  if (state === "lost") line.close();
  const shown = state === "lost" ? "closed" : state;
  if ((root.dataset.springtideLine ?? "open") === shown) return;
  if (shown === "open") delete root.dataset.springtideLine;
  else root.dataset.springtideLine = shown;
  words.textContent = WORDS[shown];
}

// A beat comes soon if the connection is alive.
function wake() {
  if (springtide.line) silence.wake(springtide.line);
  look();
}

page.every(LOOK_INTERVAL, look);
page.listen(document, "visibilitychange", wake);
page.listen(window, "online", wake);
document.addEventListener("resume", wake, { signal: page.signal }); // the page was frozen
