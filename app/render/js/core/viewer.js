// Access of all files to viser's window.__viserMutable, which its own tests read.

import { springtide } from "./springtide.js";

export const viewer = () => window.__viserMutable;

// The same for code that runs only after viser's client has begun to draw.
export const startedViewer = () => /** @type {viser.Started} */ (viewer());

/** @type {object[]} */
const waiting = []; // messages that the server does not accept yet

// Set the value of an element of viser's panel. False without a connection or such an element.
/** @param {string | undefined} uuid @param {unknown} value */
export function send(uuid, value) {
  if (!uuid || !viewer()?.sendMessage) return false;
  waiting.push({ type: "GuiUpdateMessage", uuid, updates: { value } });
  post();
  return true;
}

// viser's server knows a browser from its first camera on, and tells nobody of what the browser sends before. viser's client
// sends the camera some time after it is connected, so that a quick page would lose the link in its address. Therefore the
// camera goes first here, and all else AFTER_CAMERA later: viser holds a camera that follows another back for 20 ms.
const AFTER_CAMERA = 50; // [ms]
let known = 0; // the connection on which the camera was sent
let asking = false;

function post() {
  const { sendCamera, sendMessage } = startedViewer(), now = connectionNumber();
  if (known !== now && sendCamera !== undefined) introduce(now); // undefined: viser has renamed it
  else for (const message of waiting.splice(0)) sendMessage?.(message);
}

/** @param {number} now */
function introduce(now) {
  if (asking) return;
  asking = true;
  const { cameraControl, sendCamera } = startedViewer(), isReady = Boolean(cameraControl && sendCamera);
  if (isReady) sendCamera?.();
  setTimeout(() => {
    asking = false;
    if (isReady) known = now;
    post();
  }, AFTER_CAMERA);
}

let connection = 0;
/** @type {viser.Mutable["sendMessage"]} */
let sender = null;

// The number of the connection to the server, for which viser makes a new send function. State that mirrors the server's
// knowledge of this browser holds for one connection: on the next one it is a new client.
export function connectionNumber() {
  const now = viewer()?.sendMessage ?? null;
  if (now !== sender) [sender, connection] = [now, connection + 1];
  return connection;
}

export const PAGE = springtide.page ?? ""; // distinguishes this page from others; viser passes on changes only
