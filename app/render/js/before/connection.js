// The connection to the lab, which viser's client holds in a worker.
//
// A page that is left lets go of the lab at once, so that the lab counts no browser that nobody sees. A browser may keep a
// page that was left, to show it again when the user goes back. It keeps the worker too, and the connection stays open though
// nothing reads it. Ending the worker closes the connection, also while the page is being frozen. A page that is shown again
// reloads.
//
// A connection can die without being closed: a laptop sleeps, or changes its network. Therefore the lab sends a beat on each
// connection (app/server/web/beat.py). Here the time of each message is noted, for page/line.js, which judges it. A beat is not
// for viser's client, which would not know it.
//
// Without a connection viser's client has its worker try again each second, which ends the attempt under way. Chromium delays
// attempts by up to five seconds once many have failed, so that after a minute none would succeed: here each has its time.
// Messages that a newer viser adds pass unchanged. The lab ends an earlier connection of the page that connects again, which
// it knows by a name in the address.
//
// A page of another version than the lab's is refused by the lab, whose terminal names both versions. It does not try again: the
// cover says what to do (page/cover.js).
//
// viser's client tries again only while its page has the focus. A page that is seen without it, on a projector or in a frame
// beside others, would stand still. Here a page that is visible counts as one with the focus.

(() => {
  "use strict";
  const PATIENCE = 6000; // [ms] for an attempt, which viser's client itself ends after five seconds
  const BEAT = "SpringtideBeat"; // the type of a beat
  const springtide = (window.__springtide ??= {});
  springtide.page = Math.random().toString(36).slice(2, 10);
  /** @type {Worker[]} */
  const workers = [];
  let lasting = PATIENCE; // [ms] that the attempt under way has
  /** @type {Line} */
  const line = (springtide.line = { heard: 0, beats: 0, wait: 0, isOpen: false, close: () => {}, hurry: (time) => { lasting = time; } });

  window.Worker = class extends Worker {
    #began = -Infinity; // [ms] the attempt under way
    #isRefused = false; // true for a page of another version

    /** @param {ConstructorParameters<typeof Worker>} all */
    constructor(...all) {
      super(...all);
      workers.push(this);
      this.addEventListener("message", (event) => this.#note(event));
    }

    /** @param {MessageEvent} event */
    #note(event) {
      const { data } = event;
      if (data?.type === "connected") {
        Object.assign(line, { isOpen: true, wait: 0, heard: line.heard + 1 });
        // As if the connection had ended: viser's client connects again.
        line.close = () => this.dispatchEvent(new MessageEvent("message", { data: { type: "closed", closeReason: "silent" } }));
      }
      if (data?.type === "closed") [this.#began, line.isOpen] = [-Infinity, false];
      if (data?.versionMismatch) {
        this.#isRefused = true;
        springtide.failure ??= "This page is of another version than the lab: reload it.";
      }
      if (data?.type !== "message_batch") return;
      line.heard += 1;
      line.wait = 0;
      if (data.messages?.[0]?.type !== BEAT) return;
      line.beats += 1;
      line.wait = data.messages[0].wait;
      event.stopImmediatePropagation();
    }

    /** @param {any} message @param {any} [how] */
    postMessage(message, how) {
      const now = performance.now(), kind = message?.type;
      if (kind === "retry" && (this.#isRefused || now < this.#began + lasting)) return;
      if (kind === "retry" || kind === "set_server") [this.#began, lasting] = [now, PATIENCE];
      if (kind === "set_server") message = { ...message, server: `${message.server}?page=${springtide.page}` };
      super.postMessage(message, how);
    }
  };
  const isVisible = () => document.visibilityState === "visible";
  document.hasFocus = isVisible;
  document.addEventListener("visibilitychange", () => dispatchEvent(new Event(isVisible() ? "focus" : "blur")));
  addEventListener("pagehide", () => workers.forEach((worker) => worker.terminate()));
  addEventListener("pageshow", (event) => event.persisted && location.reload());
})();
