// Words in rows, as in a text: a word that does not fit into a row begins the next one.

// The row and left end of each of things with these widths, in rows that begin at `start` and end at `end`.
/** @param {number[]} widths @param {number} start @param {number} end */
export function rowsOf(widths, start, end) {
  let row = 0, next = start;
  return widths.map((width) => {
    if (next + width > end && next > start) [row, next] = [row + 1, start];
    next += width;
    return { row, left: next - width };
  });
}
