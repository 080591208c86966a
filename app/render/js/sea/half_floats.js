// Half-precision numbers, which the graphics processor reads directly: half the bytes, and no work for the driver.

const oneFloat = new Float32Array(1), itsBits = new Uint32Array(oneFloat.buffer);
const SMALLEST_NORMAL = 2 ** -14, SUBNORMAL_STEP = 2 ** -24, LARGEST_HALF = 0x7bff; // 65504

// The bits of the nearest half-precision number, the even one of two. Larger numbers become the largest.
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

// The number for such bits, which must be finite.
/** @param {number} half */
export function fromHalf(half) {
  const exponent = (half >>> 10) & 0x1f, digits = half & 0x3ff, sign = half & 0x8000 ? -1 : 1;
  return sign * (exponent > 0 ? 2 ** (exponent - 25) * (1024 + digits) : SUBNORMAL_STEP * digits);
}

// The means of 2 x 2 texels of four numbers each: the next mipmap of a texture.
/** @param {Uint16Array} halves @param {number} width @param {number} height */
export function halvedTexture(halves, width, height) {
  const [wide, high] = [Math.max(width >> 1, 1), Math.max(height >> 1, 1)], small = new Uint16Array(4 * wide * high);
  for (let k = 0; k < small.length; k++) {
    const x = 2 * ((k >> 2) % wide), y = 2 * Math.floor((k >> 2) / wide);
    const right = Math.min(x + 1, width - 1), above = Math.min(y + 1, height - 1);
    let sum = 0;
    for (const texel of [y * width + x, y * width + right, above * width + x, above * width + right]) {
      sum += fromHalf(halves[4 * texel + (k & 3)]);
    }
    small[k] = toHalf(0.25 * sum);
  }
  return { halves: small, width: wide, height: high };
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
