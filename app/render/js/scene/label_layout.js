// Places of labels: one that would cover another is raised above it, or lowered where the picture ends.

const GAP = 0.15; // between two labels, in heights of a label
const MAX_RAISE = 12; // [heights of a label] by which one is moved at most; a label that needs more is hidden

// The shift of each label upwards, in label heights, so that no two overlap; null for a hidden label. A label that begins below
// `top`, the upper edge of the picture, ends below it.
// labels: the lowest first; in coordinates of the picture.
/** @typedef {{ left: number, right: number, bottom: number, height: number }} Label */
/** @param {Label[]} labels @param {number} [top] @returns {(number | null)[]} */
export function raises(labels, top = Infinity) {
  /** @type {Label[]} */
  const placed = [];
  return labels.map(({ left, right, bottom: start, height }) => {
    const gap = GAP * height, highest = start < top ? top - height : Infinity;
    const free = (/** @type {number} */ bottom, /** @type {(other: Label) => number} */ next) => {
      const covers = (/** @type {Label} */ other) => left < other.right && right > other.left &&
        bottom < other.bottom + other.height + gap && bottom + height + gap > other.bottom;
      for (let other = placed.find(covers); other; other = placed.find(covers)) bottom = next(other);
      return bottom;
    };
    const from = Math.min(start, highest);
    let bottom = free(from, (other) => other.bottom + other.height + 1.01 * gap);
    if (bottom > highest) bottom = free(from, (other) => other.bottom - height - 1.01 * gap);
    const raise = (bottom - start) / height;
    if (Math.abs(raise) > MAX_RAISE) return null;
    placed.push({ left, right, bottom, height });
    return raise;
  });
}
