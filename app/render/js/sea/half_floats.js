// Half-precision numbers, which the graphics processor takes as they are: half the bytes, and nothing for the driver to do.

const oneFloat = new Float32Array(1), itsBits = new Uint32Array(oneFloat.buffer);
const SMALLEST_NORMAL = 2 ** -14, SUBNORMAL_STEP = 2 ** -24, LARGEST_HALF = 0x7bff; // 65504

// The bits of the half-precision number next to a number, of two the even one. Larger numbers become the largest.
/** @param {number} number */
export function toHalf(number) {
  oneFloat[0] = number;
  const bits = itsBits[0], sign = (bits >>> 16) & 0x8000, size = bits & 0x7fffffff;
  if (Math.abs(number) < SMALLEST_NORMAL) {
    const steps = Math.abs(oneFloat[0]) / SUBNORMAL_STEP, below = Math.floor(steps), part = steps - below;
    return sign | (below + (part > 0.5 || (part === 0.5 && below % 2 === 1) ? 1 : 0));
  }
  return sign | Math.min((size - 0x38000000 + 0x0fff + ((size >>> 13) & 1)) >>> 13, LARGEST_HALF);
}

/**
 * @param {Uint16Array} halves @param {number} at
 * @param {number} a @param {number} b @param {number} c @param {number} d
 */
export function writeHalfFloats(halves, at, a, b, c, d) {
  halves[at] = toHalf(a);
  halves[at + 1] = toHalf(b);
  halves[at + 2] = toHalf(c);
  halves[at + 3] = toHalf(d);
}
