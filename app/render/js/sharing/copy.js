// "Copy link": the lab makes the link, with the camera of the page that asks, and this page copies it and says what came of it.
//
// Browsers copy only soon after a press. So the clipboard is given the link before it has arrived, where the browser has that.

const ASKED = 10_000; // [ms] after a press for the link to arrive

/** @typedef {{ write?: (items: ClipboardItem[]) => Promise<void>, writeText?: (text: string) => Promise<void> }} Clipboard */

/** @type {{ resolve: (text: string) => void, reject: (reason: Error) => void } | null} */
let asked = null; // the press that waits for its link

// Copy a link once it has arrived. True if it is in the clipboard, false if the browser refused. Throws an Error if the link does
// not arrive, or if the button was pressed again.
/** @param {Clipboard | undefined} clipboard @param {typeof ClipboardItem | undefined} Item @param {number} patience [ms] */
export async function copyNext(clipboard, Item, patience = ASKED) {
  asked?.reject(new Error("pressed again"));
  /** @type {Promise<string>} */
  const link = new Promise((resolve, reject) => {
    const late = setTimeout(() => reject(new Error("late")), patience);
    asked = { resolve: (text) => { clearTimeout(late); resolve(text); }, reject: (reason) => { clearTimeout(late); reject(reason); } };
  });
  link.catch(() => {}); // it is awaited below
  if (Item && clipboard?.write) {
    const content = link.then((text) => new Blob([text], { type: "text/plain" }));
    content.catch(() => {});
    try {
      await clipboard.write([new Item({ "text/plain": content })]);
      return true;
    } catch {
      // Some browsers take no content that arrives later.
    }
  }
  const text = await link;
  try {
    if (!clipboard?.writeText) return false; // the page has no encryption
    await clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}

// The link of the lab for the last press. Returns true if this page has pressed.
/** @param {string} text */
export function arrive(text) {
  if (!asked) return false;
  asked.resolve(text);
  asked = null;
  return true;
}
