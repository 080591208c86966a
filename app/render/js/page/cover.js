// Words of the page while nothing is drawn, and after the server has ended.
//
// The cover is shown from the first bytes of the page until the picture of the scene is complete (frames.js). While a scene is
// compiled it shows the panel's progress (an element of class "springtide-progress"). It returns when there is no connection
// and the server does not answer. If the page cannot start or may not connect, it shows the reason (before/failures.js).

import { topicState } from "../core/channel.js";
import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { connectionNumber } from "../core/viewer.js";
import { onChange, onLook } from "../core/watch.js";
import { awaitsPicture, pictured, showCover } from "../scene/cover.js";

const ALIVE_INTERVAL = 2000; // [ms] between two looks at the connection
const RETRY_INTERVAL = 1000; // [ms] between two questions to the server without one
const ANSWER_TIME = 5000; // [ms] after which a question has failed
const ATTEMPT_TIME = 2000; // [ms] for an attempt to connect to a server that answers
const MAX_UNANSWERED = 3; // failed questions in a row: a laptop that wakes up, or changes its network, misses one
// A path belongs to a proxy, such as a JupyterHub, or to a pane of a comparison.
const path = location.pathname.replace(/(pane\/\d+\/)?(index\.html)?$/, "");
const restart = path === "/" ? "Start it again with the command: springtide" : "Reload this page to start it again.";
let unanswered = 0, isSilent = false; // true if the last question had no answer in time, not even a refusal
let server = ""; // name of the server, which differs for each server
let refusal = ""; // reason why this page may not connect

let waiting = "Connecting to the lab …"; // while there is no panel
function update() {
  if (unanswered >= MAX_UNANSWERED) {
    return showCover(isSilent ? "The lab does not answer. This page goes on as soon as it does." : `The lab has stopped. ${restart}`, false);
  }
  const progress = document.querySelector(".springtide-progress");
  if (progress) {
    waiting = progress.textContent;
    return showCover(waiting, false);
  }
  if (document.querySelector(".springtide-panel")) {
    waiting = "Opening the scene …"; // the page is connected now
    const isAwaited = awaitsPicture(topicState("picture")?.scene ?? ""); // a lab that draws by viser's public interface has none
    return showCover(isAwaited && !pictured ? "Preparing the picture …" : null, !isAwaited);
  }
  return showCover(springtide.failure || refusal || waiting, false);
}

// The server's answer: its name, and the reason if this page may not connect. Null without an answer.
async function askServer() {
  try {
    const question = `springtide-alive?origin=${encodeURIComponent(location.origin)}`;
    const answer = await fetch(question, { cache: "no-store", signal: AbortSignal.timeout(ANSWER_TIME) });
    isSilent = false;
    return answer.ok ? (await answer.text()).split("\n") : null;
  } catch (error) {
    isSilent = error instanceof DOMException && error.name === "TimeoutError";
    return null;
  }
}

const isConnected = () => Boolean(springtide.line?.isOpen);

let known = -1; // number of the connection to which the name of the server belongs

// The connection itself says that the lab is there (line.js). Without one, a question says whether it has ended, and with each
// new one whether it is still the same.
async function ask() {
  const connection = connectionNumber();
  if (isConnected() && server && connection === known) {
    unanswered = 0;
  } else if (document.visibilityState === "visible") {
    const answer = await askServer();
    unanswered = answer || isConnected() ? 0 : unanswered + 1;
    const [name, reason = ""] = answer ?? [""];
    [server, refusal] = [server || name, reason];
    if (name && isConnected()) known = connection;
    // A new server does not know this page: reload, unless a clip is being recorded.
    if (name && name !== server && !springtide.isRecording) return void location.reload();
    if (name && !isConnected()) springtide.line?.hurry(ATTEMPT_TIME);
  }
  update();
  timer = setTimeout(ask, isConnected() ? ALIVE_INTERVAL : RETRY_INTERVAL);
}

let timer = setTimeout(ask, 0);
page.own(() => clearTimeout(timer));
onChange(update);
onLook(update);
