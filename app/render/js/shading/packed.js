// Unpacks the data of app/formats/packing.py into attributes of a mesh's vertices.

const BLOCK = 16, WIDTH_BITS = 5, WORD_BITS = 30; // as in app/formats/packing.py

// { count, offsets, fields: one Float32Array each } of packed numbers.
/** @param {Float32Array} numbers */
export function unpack(numbers) {
  const words = new Uint32Array(numbers.buffer, numbers.byteOffset, numbers.length);
  const [count, columns, fields] = numbers;
  let at = 3 + 3 * fields, used = 0;
  const read = (/** @type {number} */ width) => {
    let value = words[at] >>> used;
    const got = WORD_BITS - used;
    if (got <= width) {
      at += 1;
      used = width - got;
      if (used) value |= words[at] << got;
    } else used += width;
    return value & ((1 << width) - 1);
  };
  const q = new Int32Array(count);
  /** @type {{ count: number, offsets: number[], fields: Float32Array[] }} */
  const found = { count, offsets: [], fields: [] };
  for (let field = 0; field < fields; field++) {
    const step = numbers[3 + 3 * field];
    const values = new Float32Array(count);
    let column = 0;
    for (let first = 0; first < count; first += BLOCK) {
      const width = read(WIDTH_BITS);
      const end = Math.min(first + BLOCK, count);
      for (let i = first; i < end; i++) {
        const z = width ? read(width) : 0;
        let value = (z >>> 1) ^ -(z & 1);
        if (i >= columns) value += q[i - columns];
        if (column > 0) value += q[i - 1] - (i >= columns ? q[i - columns - 1] : 0);
        q[i] = value;
        values[i] = value * step;
        if (++column === columns) column = 0;
      }
    }
    found.offsets.push(numbers[4 + 3 * field]);
    found.fields.push(values);
  }
  return found;
}

/** @type {WeakSet<Float32Array>} */
const ownArrays = new WeakSet();

// A private copy of an attribute's numbers. viser's own are views of its messages, and equal arrays of a recording share memory.
/** @param {three.Attribute} attribute */
function ownArray(attribute) {
  if (!ownArrays.has(attribute.array)) ownArrays.add((attribute.array = attribute.array.slice()));
  return attribute.array;
}

// Write the first three fields into the positions of a mesh's vertices, added to their places at rest (an array; null: 0),
// and the next three into another attribute of three numbers, once for each data. False if the data belongs to another mesh.
// viser may replace the array of positions at any time: then it is written again.
/**
 * @param {three.Mesh} mesh @param {three.Mesh} data @param {string} attribute @param {Float32Array | null} rest
 */
export function applyPacked(mesh, data, attribute, rest) {
  const packed = data.geometry.attributes.position;
  const position = mesh.geometry.attributes.position;
  if (!packed || !position || packed.array[0] !== position.count || (rest && rest.length !== 3 * position.count)) {
    return false;
  }
  let own = mesh.geometry.attributes[attribute];
  const state = own && own.springtide;
  if (state && state.packed === packed.array && state.version === packed.version && state.written === position.version) {
    return true;
  }
  const { count, fields, offsets } = unpack(packed.array);
  if (!own || own.count !== count) {
    own = new position.constructor(new Float32Array(3 * count), 3);
    mesh.geometry.setAttribute(attribute, own);
  }
  const places = ownArray(position);
  for (let axis = 0; axis < 3; axis++) {
    const [values, others] = [fields[axis], fields[axis + 3]];
    for (let i = 0, k = axis; i < count; i++, k += 3) {
      places[k] = values[i] + offsets[axis] + (rest ? rest[k] : 0);
      own.array[k] = others[i] + offsets[axis + 3];
    }
  }
  position.needsUpdate = own.needsUpdate = true; // increments their versions
  position.springtideWrites = (position.springtideWrites ?? 0) + 1; // frames.js does not count them as changes
  own.springtide = { packed: packed.array, version: packed.version, written: position.version };
  mesh.geometry.computeVertexNormals();
  mesh.geometry.computeBoundingSphere();
  return true;
}
