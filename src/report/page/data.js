// The arrays of the page: base64, deflate, byte planes, and what stands behind them (docs/report.md).

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Whole numbers from planes of their bytes, the lowest first.
export function fromPlanes(bytes, size, planes) {
  const numbers = new Uint32Array(size);
  for (let p = 0; p < planes; p++) {
    const [from, shift] = [p * size, 8 * p];
    for (let i = 0; i < size; i++) numbers[i] |= bytes[from + i] << shift;
  }
  return numbers;
}

async function numbers(id, { name, count, planes }) {
  const element = document.getElementById(`${id}-${name}`);
  const bytes = await inflate(fromBase64(element.textContent));
  element.remove();
  return fromPlanes(bytes, count, planes);
}

// Corners count backwards from the newest vertex; 0 is the next new one.
function corners(codes) {
  let newest = 0;
  for (let i = 0; i < codes.length; i++) codes[i] = codes[i] === 0 ? newest++ : newest - codes[i];
  return codes;
}

// Steps from vertex to vertex, axis after axis; relative to the middle of the box.
function positions(codes, step) {
  const size = codes.length / 3;
  const placed = new Float32Array(codes.length);
  const half = [0, 0, 0];
  for (let axis = 0; axis < 3; axis++) {
    let [at, greatest] = [0, 0];
    for (let i = 0; i < size; i++) {
      const code = codes[axis * size + i];
      at += (code >>> 1) ^ -(code & 1);
      if (at > greatest) greatest = at;
      placed[3 * i + axis] = at;
    }
    const middle = greatest / 2;
    half[axis] = middle * step;
    for (let i = axis; i < placed.length; i += 3) placed[i] = (placed[i] - middle) * step;
  }
  return { placed, half };
}

const floats = (bits) => new Float32Array(bits.buffer);
const shares = (codes) => Float32Array.from(codes, (code) => code / 255);

// One mesh with its arrays by name, one number for each face, and the corners of faces. What is drawn is `scale`
// times as large as in the file, so that 32-bit floats hold it whatever the unit.
async function model(facts, id, scale) {
  const found = await Promise.all(facts.arrays.map((array) => numbers(id, array)));
  const raw = Object.fromEntries(facts.arrays.map((array, i) => [array.name, found[i]]));
  const { placed, half } = positions(raw.positions, facts.step * scale);
  let face = 0;
  return {
    id,
    facts,
    faces: facts.faces,
    corners: corners(raw.corners),
    positions: placed,
    half,
    scale,
    k_max: floats(raw.k_max),
    k_min: floats(raw.k_min),
    gauss_perimeter: raw.gauss_perimeter && floats(raw.gauss_perimeter),
    radius: floats(raw.radius),
    coverage: shares(raw.coverage),
    confidence: shares(raw.confidence),
    classes: Int8Array.from(raw.kind, (kind) => (kind & 7) - 1),
    methods: Uint8Array.from(raw.kind, (kind) => kind >> 3),
    directions: Uint16Array.from(raw.direction),
    edgeKinds: Uint8Array.from(raw.edges),
    numbers: raw.numbers?.map((step) => (face += step)),
  };
}

export async function load(facts) {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("this browser cannot unpack the data; one from 2023 or later can");
  }
  const size = Math.max(...facts.models.map((m) => m.size));
  const scale = 2 ** -Math.floor(Math.log2(size));
  return Promise.all(facts.models.map((m, id) => model(m, id, scale)));
}

// The number in the input of the face at an index.
export function numberOf(model, index) {
  return model.numbers ? model.numbers[index] : index;
}

// The direction of k_max, of length 1.
export function direction(model, index) {
  const code = model.directions[index];
  const [a, b] = [(code & 255) / 127 - 1, (code >> 8) / 127 - 1];
  const [x, y] = [(a + b) / 2, (a - b) / 2];
  const z = Math.max(0, 1 - Math.abs(x) - Math.abs(y));
  const length = Math.hypot(x, y, z) || 1;
  return [x / length, y / length, z / length];
}

export function palette(text) {
  const rgb = fromBase64(text);
  const rgba = new Uint8Array(1024).fill(255);
  for (let i = 0; i < 256; i++) rgba.set(rgb.subarray(3 * i, 3 * i + 3), 4 * i);
  return rgba;
}
