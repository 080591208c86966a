// Access of all files to viser's window.__viserMutable, which its own tests read.

export const viewer = () => window.__viserMutable;

// The same for code that runs only after viser's client has begun to draw.
export const startedViewer = () => /** @type {viser.Started} */ (viewer());

// Set the value of an element of viser's panel. False where there is no connection, or no such element.
/** @param {string | undefined} uuid @param {unknown} value */
export function send(uuid, value) {
  const post = viewer()?.sendMessage;
  if (!uuid || !post) return false;
  post({ type: "GuiUpdateMessage", uuid, updates: { value } });
  return true;
}

let connection = 0;
/** @type {viser.Mutable["sendMessage"]} */
let sender = null;

// The number of the connection to the server. viser makes the function that sends anew with each. What mirrors the
// server's knowledge of this browser holds for one connection: the next one is another client to the server.
export function connectionNumber() {
  const now = viewer()?.sendMessage ?? null;
  if (now !== sender) [sender, connection] = [now, connection + 1];
  return connection;
}

export const PAGE = Math.random().toString(36).slice(2, 10); // tells this page from others; viser passes on changes only
