// A page that is left lets go of the lab at once, so that the lab counts no browser that nobody sees.
//
// A browser may keep a page that was left, to show it again when the user goes back. It keeps the worker too in which
// viser's client holds its connection, and the connection stays open though nothing reads it. Ending the worker closes
// the connection, also while the page is being frozen. A page that is shown again loads anew.

(() => {
  "use strict";
  /** @type {Worker[]} */
  const workers = [];
  window.Worker = class extends Worker {
    /** @param {ConstructorParameters<typeof Worker>} all */
    constructor(...all) {
      super(...all);
      workers.push(this);
    }
  };
  addEventListener("pagehide", () => workers.forEach((worker) => worker.terminate()));
  addEventListener("pageshow", (event) => event.persisted && location.reload());
})();
