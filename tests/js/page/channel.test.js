import assert from "node:assert/strict";
import { test } from "node:test";

// A page without a browser: topics of the lab, and the messages that it gets.
/** @type {Record<string, unknown>} */
let topics = {};
/** @type {[uuid: string, page: string, number: number, topic: string, value: unknown][]} */
let messages = [];
/** @type {() => void} */
let change = () => {};
/** @type {(() => void)[]} */
const timers = [];
const sendMessage = () => (/** @type {any} */ { uuid, updates }) => {
  const [head, body] = updates.value.split("\n"), [from, number, topic] = head.split(" ");
  messages.push([uuid, from, Number(number), topic, JSON.parse(body)]);
};
Object.assign(globalThis, {
  window: globalThis,
  addEventListener() {},
  matchMedia: () => ({ matches: false }),
  requestAnimationFrame() {},
  setInterval: (/** @type {() => void} */ call) => timers.push(call),
  Node: { ELEMENT_NODE: 1 },
  MutationObserver: class {
    /** @param {(changes: object[]) => void} call */
    constructor(call) {
      change = () => call([{ type: "childList", target: { nodeType: 0 }, addedNodes: [], removedNodes: [] }]);
    }
    observe() {}
    disconnect() {}
  },
  document: Object.assign(new EventTarget(), {
    documentElement: {},
    visibilityState: "visible",
    querySelector: () => null,
    querySelectorAll: () =>
      Object.entries(topics).map(([topic, state]) => ({ dataset: { springtideTopic: topic, value: JSON.stringify(state) } })),
  }),
  __springtide: { page: "own" },
  __viserMutable: { sendMessage: sendMessage() },
});
const { ask, onTopic, say, tell, topicState } = await import("./js/core/channel.js");

/** @param {Record<string, unknown>} now */
function show(now) {
  topics = now;
  messages = [];
  change();
}
const lab = (/** @type {string[]} */ ...listens) => ({ field: { uuid: "f", topics: listens }, answers: [] });

test("a state comes once for each change, and goes with the panel", () => {
  /** @type {unknown[]} */
  const seen = [];
  onTopic("acts", (state) => seen.push(state));
  show({ acts: { undo: "a" } });
  show({ acts: { undo: "a" }, time: 1 });
  show({ acts: { undo: "b" } });
  assert.deepEqual(topicState("acts"), { undo: "b" });
  show({});
  assert.deepEqual(seen, [undefined, { undo: "a" }, { undo: "b" }, undefined]);
});

test("a message goes only to a lab that listens, with numbers that grow", () => {
  show(lab("time"));
  assert.equal(say("other", 1), false);
  assert.ok(say("time", 1) && say("time", 1));
  const [[uuid, from, first, topic, value], [, , second]] = messages;
  assert.deepEqual([uuid, from, topic, value], ["f", "own", "time", 1]);
  assert.ok(second > first);
});

test("a lab knows the last state of the page in each panel and on each connection", () => {
  show({});
  tell("dark", true);
  tell("dark", false);
  assert.deepEqual(messages, []);
  show(lab("dark"));
  assert.deepEqual(messages.map((one) => one[4]), [false]);
  tell("dark", false);
  change();
  assert.equal(messages.length, 1);
  show({ ...lab("dark"), field: { uuid: "g", topics: ["dark"] } });
  assert.deepEqual(messages.map(([uuid, , , , value]) => [uuid, value]), [["g", false]]);
  messages = [];
  Object.assign(globalThis, { __viserMutable: { sendMessage: sendMessage() } });
  change();
  assert.equal(messages.length, 1);
});

test("a question is asked in each panel until it is answered, and each has its own answer", async () => {
  show({});
  const answer = ask("link", "");
  show(lab("link"));
  const number = messages[0][2];
  show({ ...lab("link"), field: { uuid: "g", topics: ["link"] } });
  assert.deepEqual(messages.map(([uuid, , again]) => [uuid, again]), [["g", number]]);
  show({ ...lab("link"), answers: [["other", number, "?other"], ["own", number, "?own"]] });
  assert.equal(await answer, "?own");
  show({ ...lab("link"), field: { uuid: "h", topics: ["link"] } });
  assert.deepEqual(messages, []);
  const second = ask("link", "");
  show({ ...lab("link"), answers: [["own", number, "?old"], ["own", messages[0][2], "?new"]] });
  assert.equal(await second, "?new");
});

test("a question that is not answered is late, and one that is asked again is not answered twice", async () => {
  show(lab("link"));
  const first = ask("link", ""), second = ask("link", "", -1);
  await assert.rejects(first, /asked again/);
  change();
  await assert.rejects(second, /late/);
});

test("a question is late where no lab listens too, and each has its own time", async () => {
  show({});
  const patient = ask("open", "?a=1"), hasty = ask("link", "", 5);
  await new Promise((resolve) => setTimeout(resolve, 10));
  change();
  await assert.rejects(hasty, /late/);
  show(lab("open", "link"));
  assert.deepEqual(messages.map(([, , , topic]) => topic), ["open"]);
  show({ ...lab("open"), answers: [["own", messages[0][2], "taken"]] });
  assert.equal(await patient, "taken");
});
