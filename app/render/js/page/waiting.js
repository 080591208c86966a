// The wait for the first picture of a new run.

const NO_FLICKER = 300; // [ms] of a wait that the page does not mention
const PATIENCE = 60_000; // [ms] after which the veil goes in any case

/** @typedef {{ panel: string, awaited: string, placed: string }} Runs */

export class Waiting {
  #panel = ""; // the panel that was seen last
  #awaited = ""; // the run that was requested last
  #before = ""; // the run that was shown then
  #since = -Infinity; // [ms] time of the request; -Infinity: nothing is awaited
  #isDrawing = false; // true once the new run has arrived, until its picture is complete

  // True if the shown picture is old and the page says so.
  //
  // runs: the panel, as another scene has a cover instead, and the numbers of the requested and of the shown run. isWhole(): the
  // picture is complete. begin(): only frames that begin from now on count.
  /** @param {number} now [ms] @param {Runs} runs @param {() => boolean} isWhole @param {() => void} begin */
  look(now, { panel, awaited, placed }, isWhole, begin) {
    if (panel !== this.#panel) [this.#panel, this.#awaited, this.#since, this.#isDrawing] = [panel, awaited, -Infinity, false];
    if (awaited !== this.#awaited) {
      [this.#awaited, this.#before, this.#isDrawing] = [awaited, placed, false];
      if (this.#since === -Infinity) this.#since = now;
    }
    if (this.#since === -Infinity) return false;
    if (!this.#isDrawing && (placed === awaited || placed !== this.#before)) {
      this.#isDrawing = true;
      begin();
    }
    if ((this.#isDrawing && isWhole()) || now - this.#since > PATIENCE) {
      [this.#since, this.#isDrawing] = [-Infinity, false];
      return false;
    }
    return now - this.#since > NO_FLICKER;
  }
}
