import assert from "node:assert/strict";
import { test } from "node:test";
import { copy } from "./js/sharing/copy.js";

// A clipboard that takes what it is given, and the browser's class for contents that arrive later.
function clipboard({ takesItems = true, isRefused = false } = {}) {
  /** @type {string[]} */
  const texts = [];
  const put = async (/** @type {string} */ text) => {
    if (isRefused) throw new DOMException("refused", "NotAllowedError");
    texts.push(text);
  };
  return {
    texts,
    writeText: put,
    write: async (/** @type {any[]} */ [item]) => {
      if (!takesItems) throw new DOMException("refused", "NotAllowedError");
      await put(await (await item.content["text/plain"]).text());
    },
  };
}
const Item = /** @type {any} */ (class {
  /** @param {object} content */
  constructor(content) {
    this.content = content;
  }
});
const later = (/** @type {string} */ link) => new Promise((resolve) => setTimeout(() => resolve(link), 5));

for (const takesItems of [true, false]) {
  test(`each press copies its own link, ${takesItems ? "before" : "after"} it has arrived`, async () => {
    const own = clipboard({ takesItems });
    for (const link of ["?a=1", "?a=1", "?a=2"]) assert.equal(await copy(later(link), own, Item), true);
    assert.deepEqual(own.texts, ["?a=1", "?a=1", "?a=2"]);
  });
}

test("a refusal is no copy, and neither is a page without a clipboard", async () => {
  for (const own of [clipboard({ isRefused: true }), undefined, {}]) {
    for (const one of [Item, undefined]) assert.equal(await copy(later("?a=1"), own, one), false);
  }
});

test("a link that does not arrive is said", async () => {
  for (const takesItems of [true, false]) {
    const own = clipboard({ takesItems });
    await assert.rejects(copy(Promise.reject(new Error("late")), own, Item), /late/);
    assert.deepEqual(own.texts, []);
  }
});
