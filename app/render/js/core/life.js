// An owner of listeners, timers, observers and other resources, which its end disposes of.

export class Life {
  #controller = new AbortController();
  /** @type {(() => void)[]} */
  #disposals = [];

  get signal() {
    return this.#controller.signal;
  }

  // kinds: of events, one or several.
  /**
   * @template {keyof PageEvents} K
   * @param {EventTarget} target @param {K | K[]} kinds @param {(event: PageEvents[K]) => void} call
   * @param {AddEventListenerOptions} options
   */
  listen(target, kinds, call, options = {}) {
    const listener = /** @type {EventListener} */ (call);
    for (const kind of [kinds].flat()) target.addEventListener(kind, listener, { ...options, signal: this.signal });
  }

  // interval: [ms]
  /** @param {number} interval @param {() => void} call */
  every(interval, call) {
    const timer = setInterval(call, interval);
    this.own(() => clearInterval(timer));
  }

  // Call a function when this ends.
  /** @param {() => void} dispose */
  own(dispose) {
    this.#disposals.push(dispose);
  }

  end() {
    this.#controller.abort();
    for (const dispose of this.#disposals.splice(0).reverse()) dispose();
  }
}

// The page itself; the browser ends it.
export const page = new Life();
