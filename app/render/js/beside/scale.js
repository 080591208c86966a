// One scale bar for all panes, at the distance of the targets of their cameras.

const BAR = 150; // [pixels] that the bar has at most
const scale = /** @type {HTMLElement} */ (document.getElementById("scale"));
const words = /** @type {HTMLElement} */ (scale.querySelector("span")), bar = /** @type {HTMLElement} */ (scale.querySelector("i"));

// The length of a bar and its words. size: [m] of a pixel.
/** @param {number} size @returns {{ words: string, width: string }} */
export function barOf(size) {
  const decade = 10 ** Math.floor(Math.log10(BAR * size));
  const length = [5, 2, 1].map((digit) => digit * decade).find((one) => one <= BAR * size) ?? decade;
  const said = length >= 1000 ? `${length / 1000} km` : length >= 1 ? `${length} m` : `${Number((100 * length).toPrecision(3))} cm`;
  return { words: said, width: `${Math.round(length / size)}px` };
}

let shown = "";
/** @param {{ camera: three.Camera, canvas: HTMLCanvasElement, distance: number }} view */
export function drawScale({ camera, canvas, distance }) {
  const high = camera.view?.enabled ? camera.view.fullHeight : canvas.clientHeight;
  const size = (2 * distance * Math.tan((camera.fov * Math.PI) / 360)) / high;
  if (!(size > 0)) return;
  const now = barOf(size);
  if (shown === now.words + now.width) return;
  shown = now.words + now.width;
  scale.hidden = false;
  words.textContent = now.words;
  bar.style.width = now.width;
}
