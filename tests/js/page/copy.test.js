import assert from "node:assert/strict";
import { test } from "node:test";
import { arrive, copyNext } from "./js/sharing/copy.js";

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

for (const takesItems of [true, false]) {
  test(`each press copies its own link, ${takesItems ? "before" : "after"} it has arrived`, async () => {
    const own = clipboard({ takesItems });
    for (const link of ["?a=1", "?a=1", "?a=2"]) {
      const copied = copyNext(own, Item);
      assert.equal(arrive(link), true);
      assert.equal(await copied, true);
    }
    assert.deepEqual(own.texts, ["?a=1", "?a=1", "?a=2"]);
  });
}

test("a refusal is no copy, and neither is a page without a clipboard", async () => {
  for (const own of [clipboard({ isRefused: true }), undefined, {}]) {
    for (const one of [Item, undefined]) {
      const copied = copyNext(own, one);
      arrive("?a=1");
      assert.equal(await copied, false);
    }
  }
});

test("a link that another page has asked for is not copied here", async () => {
  const own = clipboard(), copied = copyNext(own, Item);
  arrive("?own");
  await copied;
  assert.equal(arrive("?other"), false);
  assert.deepEqual(own.texts, ["?own"]);
});

test("a link that does not arrive is said, and a second press takes the place of the first", async () => {
  const own = clipboard();
  await assert.rejects(copyNext(own, Item, 10), /late/);
  const first = copyNext(own, Item), second = copyNext(own, Item);
  arrive("?a=2");
  await assert.rejects(first, /pressed again/);
  assert.equal(await second, true);
  assert.deepEqual(own.texts, ["?a=2"]);
});
