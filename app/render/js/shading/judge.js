// The automatic choice of quality: the step that follows from frame times.

// The finest first; pixels: fraction of the screen's; details: of the shaders, 2 all, 1 less, 0 least.
export const STEPS = [
  // Pixels first: fewer of them need no other program, and remove no foam, sky or sun.
  { quality: "high", pixels: 1, details: 2 },
  { quality: "medium", pixels: 0.75, details: 2 },
  { quality: "medium", pixels: 0.6, details: 2 },
  { quality: "low", pixels: 0.5, details: 1 },
  { quality: "low", pixels: 0.5, details: 0 },
];
const SLOW = 38, FAST = 22; // [ms] of a frame: below 30 frames a second, and safely above
const VERY_SLOW = 100; // [ms] of a frame: one window of these is enough for two steps at once
const WINDOW = 2000; // [ms] of frames; their median counts
const LEAST_FRAMES = 3; // of a window
const SKIPPED = 3; // frames after a change: they compile programs
const LONG = 300; // [ms] of a frame: one of these is enough for a step
const TERRIBLE = 500; // [ms] of a frame: one of these is enough for the lowest step
const HOPELESS = 2000; // [ms] of two frames in a row: the lowest step, even if they compiled programs
const PATIENCE = 20_000; // [ms] of fast frames before a step up; four times as long after one that failed
const TRIAL = 10_000; // [ms] after a step up in which slow frames mean that it failed

// Names of software renderers. Others show by their frame times: WebKit says "Apple GPU" everywhere.
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|microsoft basic render|paravirtual/i;

// True if the renderer's name is that of a software renderer.
/** @param {string} renderer */
export const isSoftware = (renderer) => SOFTWARE.test(renderer);

// The first step: the one stored for this renderer, else the finest, or the lowest without a graphics card.
/** @param {unknown} kept @param {string} renderer */
export function firstStep(kept, renderer) {
  if (typeof kept === "number" && kept in STEPS) return kept;
  return isSoftware(renderer) ? STEPS.length - 1 : 0;
}

// The step of "automatic", from the frame times [ms] passed to `take`.
export function makeJudge(step = 0) {
  /** @type {number[]} */
  let frames = [];
  let spent = 0, skipped = SKIPPED, slowWindows = 0, fast = 0, patience = PATIENCE, trial = 0, last = 0;
  const forget = () => {
    [frames, spent, skipped, slowWindows, last] = [[], 0, SKIPPED, 0, 0];
  };
  const change = (/** @type {number} */ by) => {
    step = Math.min(Math.max(step + by, 0), STEPS.length - 1);
    fast = 0;
    forget();
  };
  return {
    step: () => step,
    forget,
    // compiled: true if the frame compiled programs, and says little about others.
    /** @param {number} length @param {boolean} compiled */
    take(length, compiled = false) {
      if (length > HOPELESS && last > HOPELESS && step < STEPS.length - 1) return void change(STEPS.length);
      last = length;
      if (compiled) return;
      if (skipped > 0) return void (skipped = length > LONG ? 0 : skipped - 1);
      if (length > TERRIBLE && step < STEPS.length - 1) return void change(STEPS.length);
      frames.push(length);
      spent += length;
      if (spent < WINDOW || frames.length < LEAST_FRAMES) return;
      const median = frames.sort((a, b) => a - b)[frames.length >> 1], window = spent;
      [frames, spent] = [[], 0];
      // One slow window may be due to other work of the page.
      slowWindows = median > SLOW ? slowWindows + (median > VERY_SLOW ? 2 : 1) : 0;
      if (slowWindows >= 2) {
        if (trial > 0) patience *= 4;
        trial = 0;
        change(median > VERY_SLOW ? 2 : 1);
        return;
      }
      trial = Math.max(trial - window, 0);
      fast = median < FAST ? fast + window : 0;
      if (step > 0 && fast >= patience) {
        change(-1);
        trial = TRIAL;
      }
    },
  };
}
