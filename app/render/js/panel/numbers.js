// Numbers as typed into fields: 0.5, 0,5, 1/60.

// The number in a text; null if it is none.
/** @param {string} text */
export function parse(text) {
  const [above, below, more] = text.replace(",", ".").split("/");
  const value = below === undefined ? Number(above) : Number(above) / Number(below);
  return text.trim() === "" || more !== undefined || !Number.isFinite(value) ? null : value;
}

// The text of the next number up or down, by one in its second digit, but at least by one for a whole number. null if the text is
// no number.
/** @param {string} text @param {boolean} up */
export function stepped(text, up) {
  const value = parse(text);
  if (value === null) return null;
  const digit = value === 0 ? 0.1 : 10 ** (Math.floor(Math.log10(Math.abs(value)) + 1e-9) - 1);
  const step = /^[-+]?\d+$/.test(text.trim()) ? Math.max(1, digit) : digit;
  const next = (Math.round(value / step) + (up ? 1 : -1)) * step;
  return String(Number(next.toPrecision(12)));
}
