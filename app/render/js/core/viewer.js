// Access of all files to viser's window.__viserMutable, which its own tests read.

export const viewer = () => window.__viserMutable;

// The same for code that runs only after viser's client has begun to draw.
export const startedViewer = () => /** @type {viser.Started} */ (viewer());

// Set the value of an element of viser's panel. False without a connection or such an element.
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

// The number of the connection to the server, for which viser makes a new send function. State that mirrors the server's
// knowledge of this browser holds for one connection: on the next one it is a new client.
export function connectionNumber() {
  const now = viewer()?.sendMessage ?? null;
  if (now !== sender) [sender, connection] = [now, connection + 1];
  return connection;
}

export const PAGE = Math.random().toString(36).slice(2, 10); // distinguishes this page from others; viser passes on changes only
