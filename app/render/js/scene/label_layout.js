// Places of labels: one that would cover another is raised above it.

const GAP = 0.15; // between two labels, in heights of a label
const MAX_RAISE = 12; // [heights of a label] by which one is raised at most; a label that needs more is hidden

// The shift of each label upwards, in label heights, so that no two overlap; null for a hidden label.
// labels: the lowest first; in coordinates of the picture.
/** @typedef {{ left: number, right: number, bottom: number, height: number }} Label */
/** @param {Label[]} labels @returns {(number | null)[]} */
export function raises(labels) {
  /** @type {Label[]} */
  const placed = [];
  return labels.map(({ left, right, bottom: start, height }) => {
    const gap = GAP * height;
    let bottom = start;
    const covers = (/** @type {Label} */ other) => left < other.right && right > other.left &&
      bottom < other.bottom + other.height + gap && bottom + height + gap > other.bottom;
    for (let other = placed.find(covers); other; other = placed.find(covers)) {
      bottom = other.bottom + other.height + 1.01 * gap;
    }
    const raise = (bottom - start) / height;
    if (raise > MAX_RAISE) return null;
    placed.push({ left, right, bottom, height });
    return raise;
  });
}
