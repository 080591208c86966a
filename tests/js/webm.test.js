import assert from "node:assert/strict";
import { test } from "node:test";
import { withDuration } from "./js/sharing/webm.js";

const HEAD = [0x1a, 0x45, 0xdf, 0xa3, 0x84, 0x42, 0x86, 0x81, 1];
const UNKNOWN = [0x01, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff];
const SCALE = [0x2a, 0xd7, 0xb1, 0x83, 0x0f, 0x42, 0x40]; // 1,000,000 ns
const CLUSTER = [0x1f, 0x43, 0xb6, 0x75, ...UNKNOWN, 1, 2, 3];

// A clip with this information in a segment of this size.
/** @param {number[]} info @param {number[]} size */
const clip = (info, size = UNKNOWN) => new Uint8Array([...HEAD, 0x18, 0x53, 0x80, 0x67, ...size, 0x15, 0x49, 0xa9, 0x66, ...info, ...CLUSTER]);

test("a clip has its duration at the end of its information, in units of its timestamps", () => {
  const number = [...new Uint8Array(new Float64Array([12_500]).buffer)].reverse(), added = [0x44, 0x89, 0x88, ...number];
  for (const [before, after] of [[[0x87], [0x92]], [[0x40, 7], [0x40, 18]], [[0x01, 0, 0, 0, 0, 0, 0, 7], [0x01, 0, 0, 0, 0, 0, 0, 18]]]) {
    assert.deepEqual(withDuration(clip([...before, ...SCALE]), 12.5), clip([...after, ...SCALE, ...added]));
  }
  const [twice, half] = [[...SCALE.slice(0, 4), 0x1e, 0x84, 0x80], [...new Uint8Array(new Float64Array([6_250]).buffer)].reverse()];
  assert.deepEqual(withDuration(clip([0x87, ...twice]), 12.5), clip([0x92, ...twice, 0x44, 0x89, 0x88, ...half]));
});

test("a clip that has a duration, is of another kind, or could not be right afterwards is left as it is", () => {
  const made = withDuration(clip([0x87, ...SCALE]), 3);
  const seekHead = clip([0x87, ...SCALE]);
  seekHead.set([0x11, 0x4d, 0x9b, 0x74], HEAD.length + 12);
  const known = clip([0x87, ...SCALE], [0x9f]); // the size of the segment
  for (const bytes of [made, seekHead, known, new Uint8Array([0, 0, 0, 0x20, 0x66, 0x74, 0x79, 0x70]), new Uint8Array(0)]) {
    assert.equal(withDuration(bytes, 12.5), bytes);
  }
});
