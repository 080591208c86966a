// Set-ups for the lab: the query of a link, or the text of a file.

import { ask } from "../core/channel.js";

// Have the lab open a text, once it has a panel. The lab says what it refuses; another text takes the place of one that waits.
/** @param {string} text */
export function open(text) {
  ask("open", text).catch(() => {});
}
