import assert from "node:assert/strict";
import { test } from "node:test";

// The parts of a browser that the connection uses.
/** @type {any[]} */
const sent = [];
class FakeWorker extends EventTarget {
  /** @param {any} message */
  postMessage(message) { sent.push(message.type); }
  terminate() {}
}
const globals = /** @type {any} */ (globalThis);
Object.assign(globals, { window: globals, Worker: FakeWorker, addEventListener() {}, dispatchEvent() {} });
globals.document = { visibilityState: "visible", addEventListener() {} };
await import("./js/before/connection.js");

// What a worker of viser's client tells its page.
/** @param {EventTarget} worker @param {any} data */
const tell = (worker, data) => worker.dispatchEvent(new MessageEvent("message", { data }));

test("a page of another version says so, and tries no more", () => {
  const worker = new globals.Worker("");
  worker.postMessage({ type: "set_server", server: "ws://lab" });
  tell(worker, { type: "connected" });
  tell(worker, { type: "closed", closeReason: "" });
  worker.postMessage({ type: "retry" });
  assert.deepEqual(sent, ["set_server", "retry"]);
  assert.equal(globals.__springtide.failure, undefined);
  tell(worker, { type: "closed", versionMismatch: true, closeReason: "Version mismatch. Client: 1, Server: 2" });
  worker.postMessage({ type: "retry" });
  assert.deepEqual(sent, ["set_server", "retry"]);
  assert.equal(globals.__springtide.failure, "This page is of another version than the lab: reload it.");
});
