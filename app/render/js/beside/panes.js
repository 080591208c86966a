// The panes: each shows a separate lab in a frame, below its title.
//
// The frames are of this page's own address. Of each, this page uses its channel to the lab (core/channel.js), the status line of
// its panel, and viser's window.__viserMutable.

const RETRY = 1000; // [ms] after which a pane without a lab is loaded again
const KEPT = /^(hideViserLogo|fixedDpr|showStats)$/; // names in an address that are for all panes: only viser reads them
const main = /** @type {HTMLElement} */ (document.querySelector("main"));

export class Pane {
  middle = [0, 0]; // [m] of its scene, in the scene's frame
  isBare = true; // its panel is hidden
  isConnected = true; // false once the first lab says that no browser is connected to its lab
  /** @type {number[] | null} */
  pose = null; // where its camera was put last
  #words = document.createElement("span");
  frame = document.createElement("iframe");

  // asked: the query of this page's address, all of it for the first lab. onLead: called when a person acts in the pane.
  /** @param {number} index @param {string} asked @param {() => void} onLead */
  constructor(index, asked, onLead) {
    const section = document.createElement("section"), heading = document.createElement("h2"), panel = document.createElement("button");
    panel.type = "button";
    panel.textContent = "Panel";
    panel.setAttribute("aria-pressed", "false");
    panel.addEventListener("click", () => {
      this.isBare = !this.isBare;
      panel.setAttribute("aria-pressed", String(!this.isBare));
      this.focus();
    });
    heading.append(this.#words, panel);
    section.append(heading, this.frame);
    main.insertBefore(section, document.getElementById("scale"));
    this.frame.addEventListener("load", () => {
      // The lab of a pane may open later than this page: then there are words of the server in its place.
      if (!this.document?.getElementById("springtide-cover")) setTimeout(() => this.frame.isConnected && this.#load(), RETRY);
      for (const name of ["pointerdown", "wheel", "keydown"]) {
        this.frame.contentWindow?.addEventListener(name, onLead, { capture: true, passive: true });
      }
    });
    const query = new URLSearchParams(asked);
    if (index > 0) for (const name of [...query.keys()]) if (!KEPT.test(name)) query.delete(name);
    this.frame.title = `Lab ${index + 1}`;
    this.address = `${index === 0 ? "" : `pane/${index + 1}/`}index.html?${query}`;
    this.#load();
  }

  #load() {
    this.frame.src = this.address;
  }

  get viewer() {
    return this.frame.contentWindow?.__viserMutable;
  }

  get document() {
    return this.frame.contentDocument;
  }

  // Its page's own name (core/springtide.js).
  get springtide() {
    return this.frame.contentWindow?.__springtide;
  }

  // The status line of its panel.
  get status() {
    return this.document?.querySelector(".springtide-panel[data-state]") ?? null;
  }

  // True if its picture is old.
  get isCut() {
    return Boolean(this.document?.documentElement?.dataset.springtideLine);
  }

  focus() {
    this.frame.contentWindow?.focus();
  }

  // Show the words of the first lab about this pane.
  /** @param {{ heading: string, middle: number[], connected: boolean }} state */
  show({ heading, middle, connected }) {
    if (this.#words.textContent !== heading) this.#words.textContent = heading;
    [this.middle, this.isConnected] = [middle, connected];
  }

  showPanel() {
    this.document?.documentElement?.classList.toggle("springtide-bare", this.isBare);
  }

  remove() {
    this.frame.closest("section")?.remove();
  }
}
