// A sky by formula, for browsers that cannot draw into floats, as the photograph of the sky requires (photograph.js).

import { toHalf } from "../sea/half_floats.js";

/** @type {SkyColors} */
export const ROOM = { low: [0.7, 0.75, 0.8], high: [0.7, 0.75, 0.8] }; // without a sea
const FROM_BELOW = 0.3; // light from below over that from above
const BELOW = -0.1; // sine of the elevation up to which the horizon reaches
const OF_ALL = 0.8; // fraction of the radiance overhead in the light of the whole sky on a level surface
const FACE = 16, BLURS = 7; // [pixels] side of a face of the cube; blurs, the last of all directions

// The radiance of a sky by formula where the sine of the elevation is `up`.
/** @param {SkyColors} sky @param {number} up */
export function skyRadiance({ low, high }, up) {
  const share = up < BELOW ? OF_ALL : Math.sqrt(Math.max(up, 0)), factor = up < BELOW ? FROM_BELOW : 1;
  return low.map((light, i) => factor * (light + share * (high[i] - light)));
}

// The light of that sky, over pi, on a matt surface whose normal has this sine of elevation: exact for a level one, and
// otherwise to a tenth of the radiance at the horizon.
/** @param {SkyColors} sky @param {number} up */
export function skyIrradiance({ low, high }, up) {
  const above = 0.5 + 0.5 * up, share = OF_ALL - 0.2 * (1 - up), all = skyRadiance({ low, high }, -1);
  return low.map((light, i) => above * (light + share * (high[i] - light)) + (1 - above) * all[i]);
}

// The numbers of a sky by formula in three's layout of a blurred cube (cube_uv_reflection_fragment): blurs side by side,
// each with three faces above three.
/** @param {SkyColors} sky */
export function blurredCube(sky) {
  const width = 3 * FACE * BLURS, height = 4 * FACE, numbers = new Uint16Array(4 * width * height);
  for (let y = 0, at = 0; y < 2 * FACE; y++) {
    for (let x = 0; x < width; x++, at += 4) {
      const face = Math.floor(x / FACE) % 3 + (y < FACE ? 0 : 3), blur = (Math.floor(x / (3 * FACE)) / (BLURS - 1)) ** 2;
      const [u, v] = [x, y].map((pixel) => (2 * (pixel % FACE) - 1) / (FACE - 2) - 1);
      const up = (face === 1 ? 1 : face === 4 ? -1 : v) / Math.hypot(u, v, 1);
      const [sharp, even] = [skyRadiance(sky, up), skyIrradiance(sky, up)];
      for (let i = 0; i < 4; i++) numbers[at + i] = toHalf(i < 3 ? sharp[i] + blur * (even[i] - sharp[i]) : 1);
    }
  }
  return { numbers, width, height };
}
