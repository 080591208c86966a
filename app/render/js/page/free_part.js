// The part of the picture that panels leave free.

const MIN_FREE = 120; // [pixels] of a side of the free rectangle: a smaller one is not used

// Part of a rectangle that a panel leaves free: the largest of the parts left of it, right of it, above and below.
/** @param {Box} box @param {Edges} panel @returns {Box} */
export function without(box, panel) {
  const right = box.x + box.width, bottom = box.y + box.height;
  if (panel.left >= right || panel.right <= box.x || panel.top >= bottom || panel.bottom <= box.y) return box;
  const parts = [
    { ...box, width: panel.left - box.x },
    { ...box, x: panel.right, width: right - panel.right },
    { ...box, height: panel.top - box.y },
    { ...box, y: panel.bottom, height: bottom - panel.bottom },
  ].filter((part) => part.width >= MIN_FREE && part.height >= MIN_FREE);
  const area = (/** @type {Box} */ part) => part.width * part.height;
  return parts.length ? parts.reduce((best, part) => (area(best) >= area(part) ? best : part)) : box;
}
