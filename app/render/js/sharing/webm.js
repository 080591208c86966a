// The duration of a clip in WebM, which MediaRecorder leaves out: without it players cannot seek.
//
// WebM is Matroska (RFC 9559): elements of an identifier, a size and data, in the notation of EBML (RFC 8794). The duration is
// an element of the segment's information, in units of its timestamp scale.

const EBML = 0x1a45dfa3, SEGMENT = 0x18538067, INFO = 0x1549a966, SCALE = 0x2ad7b1, DURATION = 0x4489;
const UNIT = 1e6; // [ns] default unit of the timestamps
const ADDED = 11; // bytes of a duration: identifier, size, and a number of double precision

/** @typedef {{ id: number, at: number, data: number, end: number, width: number }} Element */

// The element at a place: { id, at: of its size, data: start of its data, end, width: bytes of its size }. An unknown size
// extends to the last byte. Null after the last element.
/** @param {Uint8Array} bytes @param {number} start @returns {Element | null} */
function elementAt(bytes, start) {
  const long = Math.clz32(bytes[start]) - 23, at = start + long, width = Math.clz32(bytes[at]) - 23;
  if (!(long <= 4) || !(width <= 8) || at + width > bytes.length) return null;
  let id = 0, size = bytes[at] & (0xff >> width), isUnknown = size === 0xff >> width;
  for (let k = start; k < at; k++) id = 256 * id + bytes[k];
  for (let k = at + 1; k < at + width; k++) {
    size = 256 * size + bytes[k];
    isUnknown &&= bytes[k] === 0xff;
  }
  return { id, at, data: at + width, end: isUnknown ? bytes.length : at + width + size, width };
}

// The bytes of a clip with its duration [s]; unchanged if they have one already or are not in the expected form.
/** @param {Uint8Array<ArrayBuffer>} bytes @param {number} seconds */
export function withDuration(bytes, seconds) {
  const head = elementAt(bytes, 0), segment = head?.id === EBML ? elementAt(bytes, head.end) : null;
  // The segment's size has to be unknown, and no table of places may precede the information: both would become wrong.
  const info = segment?.id === SEGMENT && segment.end === bytes.length ? elementAt(bytes, segment.data) : null;
  if (info?.id !== INFO || info.end > bytes.length) return bytes;
  let scale = UNIT;
  for (let one = elementAt(bytes, info.data); one && one.at < info.end; one = elementAt(bytes, one.end)) {
    if (one.id === DURATION) return bytes;
    if (one.id === SCALE) scale = bytes.subarray(one.data, one.end).reduce((sum, byte) => 256 * sum + byte, 0);
  }
  const size = info.end - info.data + ADDED;
  if (size >= 2 ** (7 * info.width) - 1) return bytes;
  const made = new Uint8Array(bytes.length + ADDED), view = new DataView(made.buffer);
  made.set(bytes.subarray(0, info.end));
  for (let k = 0, left = size; k < info.width; k++, left = Math.floor(left / 256)) made[info.data - 1 - k] = left % 256;
  made[info.at] |= 0x80 >> (info.width - 1);
  view.setUint16(info.end, DURATION);
  made[info.end + 2] = 0x88;
  view.setFloat64(info.end + 3, (1e9 * seconds) / scale);
  made.set(bytes.subarray(info.end), info.end + ADDED);
  return made;
}
