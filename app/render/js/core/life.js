// An owner of what a part of the scripts makes: listeners, timers, observers, and all else that its end disposes of.

export class Life {
  #controller = new AbortController();
  #disposals = [];

  get signal() {
    return this.#controller.signal;
  }

  // kinds: of events, one or several.
  listen(target, kinds, call, options = {}) {
    for (const kind of [kinds].flat()) target.addEventListener(kind, call, { ...options, signal: this.signal });
  }

  // interval: [ms]
  every(interval, call) {
    const timer = setInterval(call, interval);
    this.own(() => clearInterval(timer));
  }

  // Call a function when this ends.
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
