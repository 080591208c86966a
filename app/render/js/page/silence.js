// The silence of the connection to the lab: its length, and its meaning.
//
// Time counts only while the page itself has responded: a page that has compiled shaders for ten seconds finds the messages of
// these seconds waiting, and its clock may look before it reads them.

export const OLD_AFTER = 5000; // [ms] without a message: the picture is old, as the lab sends a beat each 2 s
const LOST_AFTER = 10_000; // [ms] the same, after which the connection is given up
const WOKEN_LOST_AFTER = 3000; // [ms] the same for a page that was hidden or asleep
const MAX_LOOK = 1000; // [ms] that count between two looks
const ASLEEP = 10_000; // [ms] between two looks: the machine has slept
const NO_FLICKER = 1500; // [ms] without a connection that the page does not mention: most come back

/** @typedef {"open" | "silent" | "lost" | "closed"} State */

export class Silence {
  #heard = -1; // number of messages at the last look
  #quiet = 0; // [ms] since the last one
  #closed = 0; // [ms] without a connection
  #limit = LOST_AFTER; // [ms]
  #looked; // [ms] time of the last look

  /** @param {number} now [ms] */
  constructor(now) {
    this.#looked = now;
  }

  // The page is seen again, or has a network again: a connection that is alive has a beat soon.
  /** @param {{ heard: number }} line */
  wake({ heard }) {
    [this.#quiet, this.#limit, this.#heard] = [0, WOKEN_LOST_AFTER, heard];
  }

  // State of the line: "open", "silent" if the picture is old, "lost" if the connection should be given up, or "closed".
  /** @param {number} now [ms] @param {{ heard: number, beats: number, wait: number, isOpen: boolean }} line @returns {State} */
  look(now, line) {
    const since = now - this.#looked;
    this.#looked = now;
    const hasSlept = since > ASLEEP, counted = hasSlept ? 0 : Math.min(since, MAX_LOOK);
    if (hasSlept) this.wake(line);
    if (!line.isOpen) {
      this.#closed += counted;
      [this.#quiet, this.#limit] = [0, LOST_AFTER];
      return this.#closed > NO_FLICKER ? "closed" : "open";
    }
    this.#closed = 0;
    if (line.heard !== this.#heard) [this.#heard, this.#quiet, this.#limit] = [line.heard, 0, LOST_AFTER];
    else this.#quiet += counted;
    if (!line.beats) return "open"; // of a lab whose viser has changed inside
    const wait = 1000 * line.wait;
    if (this.#quiet >= this.#limit + wait) {
      [this.#quiet, this.#limit] = [0, LOST_AFTER];
      return "lost";
    }
    return this.#quiet >= OLD_AFTER + wait ? "silent" : "open";
  }
}
