// The height of drawn water.

// Height [m] of the water at a point of its frame: the highest of the nearest vertices of its mesh (`numbers`). A square
// tile is repeated.
/** @param {ArrayLike<number>} numbers @param {{ x: number, y: number }} point */
export function waterHeight(numbers, point) {
  const last = numbers.length - 3;
  let { x, y } = point;
  // The last vertex of a square tile is the first one, shifted by its side along x and y.
  const side = numbers[last] - numbers[0];
  if (side > 0 && Math.abs(numbers[last + 1] - numbers[1] - side) < 1e-3 * side) {
    x -= side * Math.floor(x / side);
    y -= side * Math.floor(y / side);
  }
  let nearest = Infinity;
  for (let k = 0; k <= last; k += 3) {
    const d = (numbers[k] - x) ** 2 + (numbers[k + 1] - y) ** 2;
    if (d < nearest) nearest = d;
  }
  let height = -Infinity;
  for (let k = 0; k <= last; k += 3) {
    const d = (numbers[k] - x) ** 2 + (numbers[k + 1] - y) ** 2;
    if (d <= 2.5 * nearest && numbers[k + 2] > height) height = numbers[k + 2];
  }
  return height;
}
