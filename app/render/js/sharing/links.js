// Set-up for the lab in the address of the page, and in a replay.

const BLOCK = '<script type="application/json" id="springtide-setup">'; // holds the set-up file in a replay
const BLOCK_END = "</script>";
const VISER_NAMES = new Set([
  "darkMode", "dummyWindowDimensions", "dummyWindowTitle", "fixedDpr", "forceOrbitOriginTool", "hideViserLogo",
  "initialCameraLookAt", "initialCameraPosition", "initialCameraUp", "logCamera", "playbackPath", "showStats", "websocket",
]);

// The part of an address for the lab, without the names that viser's client reads.
/** @param {string} search */
export function ofLab(search) {
  const found = new URLSearchParams(search);
  for (const name of [...found.keys()]) if (VISER_NAMES.has(name)) found.delete(name);
  return `?${found}`;
}

// The address of the lab from that of the page; a pane of a comparison is below it.
/** @param {{ origin: string, pathname: string }} page */
export const labAt = ({ origin, pathname }) => origin + pathname.replace(/pane\/\d\/[^/]*$/, "");

// The set-up file in a replay; null without one.
/** @param {string} replay */
export function setupIn(replay) {
  const start = replay.lastIndexOf(BLOCK);
  return start < 0 ? null : replay.slice(start + BLOCK.length, replay.indexOf(BLOCK_END, start));
}
