// "Copy link": the lab makes the link, with the camera of the page that asks, and this page copies it.
//
// Browsers copy only soon after a press. So the clipboard is given the link before it has arrived, where the browser has that.

/** @typedef {{ write?: (items: ClipboardItem[]) => Promise<void>, writeText?: (text: string) => Promise<void> }} Clipboard */

// Copy a text that arrives later. True if it is in the clipboard, false if the browser refused. Throws the error of a text that
// does not arrive.
/** @param {Promise<string>} link @param {Clipboard | undefined} clipboard @param {typeof ClipboardItem | undefined} Item */
export async function copy(link, clipboard, Item) {
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
