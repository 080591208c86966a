// The keys of the lab on keyboards of all layouts: letters and digits. Where a key has none, because the layout is of another
// script or gives digits with Shift only, its place on the keyboard counts.

// The letter or digit of a press, and whether Shift counts.
/** @param {{ key: string, code: string, shiftKey: boolean, altKey: boolean }} event */
export function latinKey({ key, code, shiftKey, altKey }) {
  const [, kind, name] = /^(Key|Digit)(.)$/.exec(code) ?? [];
  if (kind === "Digit" && shiftKey === /^\d$/.test(key)) return { key: shiftKey ? key : name, shiftKey: false };
  const isOther = kind === "Key" && !altKey && key.length === 1 && key > "\u007f";
  return { key: isOther ? name.toLowerCase() : key, shiftKey };
}
