// How finely this browser draws: its share of the screen's pixels, and how much detail the shaders of water and rain have.
//
// "Automatic" measures how long frames take while the picture moves, and goes down step by step where they are slow, and
// up again with care. The choice belongs to the browser: it is kept in its local storage and is part of no link, preset
// or set-up. A page with viser's "fixedDpr" in its address wants a picture that does not change: it is drawn as it says.
// Pictures that the server asks for have all pixels and details.

const QUALITY = (() => {
  const KEY = "springtide-quality"; // of the local storage
  const STEPS = [
    // Pixels first: fewer of them need no other program.
    { quality: "high", pixels: 1, details: 2 },
    { quality: "medium", pixels: 0.75, details: 2 },
    { quality: "medium", pixels: 0.75, details: 1 },
    { quality: "low", pixels: 0.5, details: 1 },
    { quality: "low", pixels: 0.5, details: 0 },
  ];
  const FIXED = { high: 0, medium: 2, low: 4 }; // step of each choice but "automatic"
  const SLOW = 38, FAST = 22; // [ms] of a frame: below 30 pictures a second, and safely above
  const VERY_SLOW = 100; // [ms] of a frame, from which on one window is enough, and two steps are taken at once
  const WINDOW = 2000; // [ms] of frames of which the median counts
  const LEAST_FRAMES = 3; // of a window
  const SKIPPED = 3; // frames after a change: they compile programs
  const PATIENCE = 20_000; // [ms] of fast frames before a step up; four times as long after a step up that was too much
  const TRIAL = 10_000; // [ms] after a step up in which slow frames mean that it was too much

  // The step of "automatic", from the lengths of frames [ms] that `take` is given.
  function makeJudge() {
    let step = 0, frames = [], spent = 0, skipped = SKIPPED, slowWindows = 0, fast = 0, patience = PATIENCE, trial = 0;
    const forget = () => {
      [frames, spent, skipped, slowWindows] = [[], 0, SKIPPED, 0];
    };
    const change = (by) => {
      step = Math.min(Math.max(step + by, 0), STEPS.length - 1);
      fast = 0;
      forget();
    };
    return {
      step: () => step,
      forget,
      take(length) {
        if (skipped > 0) return void (skipped -= 1);
        frames.push(length);
        spent += length;
        if (spent < WINDOW || frames.length < LEAST_FRAMES) return;
        const median = frames.sort((a, b) => a - b)[frames.length >> 1], window = spent;
        [frames, spent] = [[], 0];
        // One slow window may come from something else that the page had to do.
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

  const judge = makeJudge();
  const isFixed = new URLSearchParams(location.search).has("fixedDpr");
  let current = STEPS[0], pending = false, dismissed = false, choice = "automatic", line = null;

  function readChoice() {
    try {
      const stored = localStorage.getItem(KEY);
      choice = stored in FIXED ? stored : "automatic";
    } catch {
      choice = "automatic"; // a browser without storage
    }
  }

  function choose(name) {
    try {
      localStorage.setItem(KEY, name);
    } catch {
      // It is forgotten with the page.
    }
    choice = name;
    dismissed = false;
    judge.forget();
    show();
    window.__viserMutable.requestRender();
  }

  function button(text, press) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.style.cssText =
      "font:inherit;margin-left:8px;padding:1px 8px;border:1px solid currentColor;border-radius:3px;background:none;" +
      "color:inherit;cursor:pointer";
    made.addEventListener("click", press);
    return made;
  }

  function makeLine() {
    const made = document.createElement("div");
    made.id = "springtide-slow";
    made.setAttribute("role", "status");
    // Written here, because a replay has no style sheet of ours.
    made.style.cssText =
      "position:fixed;bottom:12px;left:16px;z-index:8;padding:4px 10px;border-radius:6px;" +
      "background:rgba(16,30,46,0.85);color:#fff;font:13px/1.5 system-ui,sans-serif;max-width:90vw";
    made.append("Drawing is slow here, so the quality is lower.");
    made.append(button("Keep high quality", () => choose("high")));
    made.append(button("OK", () => {
      dismissed = true;
      show();
    }));
    document.body.append(made);
    return made;
  }

  // Bring the line on the page and the control in the panel up to date.
  function show() {
    const step = choice === "automatic" ? judge.step() : FIXED[choice];
    if (STEPS[step] !== current) {
      if (step === 0) dismissed = false;
      current = STEPS[step];
    }
    const lowered = choice === "automatic" && step > 0 && !isFixed;
    if (lowered && !dismissed) line ??= makeLine();
    else if (line) {
      line.remove();
      line = null;
    }
    for (const select of document.querySelectorAll("[data-springtide-quality]")) {
      if (select.value !== choice) select.value = choice;
      const now = select.parentElement.querySelector("[data-springtide-quality-now]");
      const text = lowered ? `now ${current.quality}` : "";
      if (now && now.textContent !== text) now.textContent = text;
    }
  }

  function isCapturing() {
    return window.__viserMutable.getRenderRequestState === "capture";
  }

  readChoice();
  document.addEventListener("change", (event) => {
    if (event.target instanceof HTMLSelectElement && "springtideQuality" in event.target.dataset) choose(event.target.value);
  });
  document.addEventListener("visibilitychange", judge.forget);
  addEventListener("storage", (event) => {
    if (event.key !== KEY) return;
    readChoice();
    show();
    window.__viserMutable.requestRender();
  });
  // The control comes with each scene.
  new MutationObserver(show).observe(document.body, { childList: true, subtree: true });

  return {
    makeJudge,
    choice: () => choice,
    now: () => ({ ...current, step: STEPS.indexOf(current), steps: STEPS.length }),
    isCapturing, // a picture that the server asked for
    // How much detail the shaders of this frame have: 2 all, 1 less, 0 least.
    details: () => (isFixed || isCapturing() ? 2 : current.details),
    // Called before each frame is drawn: sets its pixels, and has its length measured.
    beforeRender(renderer) {
      if (isFixed) return;
      const capturing = isCapturing();
      const ratio = devicePixelRatio * (capturing ? 1 : current.pixels);
      if (Math.abs(renderer.getPixelRatio() - ratio) > 1e-3) renderer.setPixelRatio(ratio);
      // A clip whose pictures change their size in the middle cannot be played.
      const measured = choice === "automatic" && document.visibilityState === "visible" && !window.__springtideClip;
      if (capturing || !measured) return judge.forget();
      if (pending) return;
      pending = true;
      // The time to the next frame, where a frame was drawn: a scene that sends few pictures is not slow to draw.
      const drawn = performance.now();
      requestAnimationFrame(() => {
        pending = false;
        const before = judge.step();
        judge.take(performance.now() - drawn);
        if (judge.step() !== before) {
          show();
          window.__viserMutable.requestRender();
        }
      });
    },
  };
})();

// The text of a fragment shader, and the name of its program, with the details of this frame.
function withDetails(source) {
  return `#define DETAILS ${QUALITY.details()}\n${source}`;
}
function keyWithDetails(key) {
  return QUALITY.details() === 2 ? key : `${key} with details ${QUALITY.details()}`;
}
