// The foot of the scene, where the time line stands: as wide as panels leave it.

const NEAR = 12; // [pixels] above a bar within which a panel is in its way
const MIN_WIDTH = 160; // [pixels] of a bar

// The edges that panels leave at the foot of a canvas for a bar of this height: above a sheet at its foot, else beside them.
/** @param {Edges} canvas @param {Edges[]} panels @param {number} height */
export function footOf(canvas, panels, height) {
  let { left, right, bottom } = canvas;
  const middle = (left + right) / 2;
  for (const box of panels) {
    if (box.right === box.left || box.bottom < bottom - height - NEAR || box.top > bottom) continue;
    if (box.right <= left || box.left >= right) continue;
    const isSheet = box.left < middle && box.right > middle;
    // There is no space above a panel that reaches the edge of the window.
    if (isSheet && box.top - height >= Math.max(canvas.top, 0)) bottom = Math.min(bottom, box.top);
    else if (isSheet ? box.left - left >= right - box.right : box.left >= middle) right = Math.min(right, box.left);
    else left = Math.max(left, box.right);
  }
  return right - left < MIN_WIDTH ? { left: canvas.left, right: canvas.right, bottom: canvas.bottom } : { left, right, bottom };
}

// Words of the time line for a moment [s] of a recording up to `high` [s]: the moment, and how far back it is.
/** @param {number} at @param {number} high @param {boolean} isPast */
export const wordsOf = (at, high, isPast) =>
  ({ moment: isPast ? `t = ${at.toFixed(2)} s` : "Live", back: `${(high - at).toFixed(1)} s back` });
