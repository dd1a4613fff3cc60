// What follows from corners and positions: neighbours, normals, areas, edges.

// The corners around every vertex: those of vertex v are list[start[v]] up to list[start[v + 1]].
function aroundVertices({ corners, positions }) {
  const start = new Uint32Array(positions.length / 3 + 1);
  for (let c = 0; c < corners.length; c++) start[corners[c] + 1]++;
  for (let v = 1; v < start.length; v++) start[v] += start[v - 1];
  const next = start.slice();
  const list = new Uint32Array(corners.length);
  for (let c = 0; c < corners.length; c++) list[next[corners[c]]++] = c;
  return { start, list };
}

// Twice the area times the unit normal of every face, and the area of all.
export function areaVectors({ faces, corners, positions: p }) {
  const vectors = new Float32Array(3 * faces);
  let total = 0;
  for (let f = 0; f < faces; f++) {
    const [a, b, c] = [3 * corners[3 * f], 3 * corners[3 * f + 1], 3 * corners[3 * f + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    vectors[3 * f] = x;
    vectors[3 * f + 1] = y;
    vectors[3 * f + 2] = z;
    total += Math.sqrt(x * x + y * y + z * z) / 2;
  }
  return { vectors, total };
}

// Faces whose normals are further apart than this (its cosine) meet in a crease.
const CREASE = 0.766;

// A normal for every corner, by area, not across creases, as two 16-bit numbers: an octahedral map.
export function cornerNormals(model, vectors) {
  const { corners, faces } = model;
  const { start, list } = aroundVertices(model);
  const length = new Float32Array(faces);
  for (let f = 0; f < faces; f++) length[f] = Math.hypot(vectors[3 * f], vectors[3 * f + 1], vectors[3 * f + 2]);
  const packed = new Uint32Array(3 * faces);
  for (let c = 0; c < corners.length; c++) {
    const f = (c / 3) | 0;
    const [fx, fy, fz] = [vectors[3 * f], vectors[3 * f + 1], vectors[3 * f + 2]];
    let [x, y, z] = [0, 0, 0];
    for (let i = start[corners[c]], end = start[corners[c] + 1]; i < end; i++) {
      const g = (list[i] / 3) | 0;
      const [gx, gy, gz] = [vectors[3 * g], vectors[3 * g + 1], vectors[3 * g + 2]];
      if (fx * gx + fy * gy + fz * gz > CREASE * length[f] * length[g]) {
        x += gx;
        y += gy;
        z += gz;
      }
    }
    packed[c] = octahedral(x, y, z);
  }
  return packed;
}

function octahedral(x, y, z) {
  const sum = Math.abs(x) + Math.abs(y) + Math.abs(z);
  if (!(sum > 0)) return 0x7fff7fff;
  let [u, v] = [x / sum, y / sum];
  if (z < 0) [u, v] = [(1 - Math.abs(v)) * (u < 0 ? -1 : 1), (1 - Math.abs(u)) * (v < 0 ? -1 : 1)];
  return (((u * 0.5 + 0.5) * 65534) | 0) | ((((v * 0.5 + 0.5) * 65534) | 0) << 16);
}

export const NO_TWIN = -1;
const SEVERAL = -2;

// The half-edge on the other side of every half-edge (half-edge 3 f + i goes from corner i to the next of face f),
// or a negative number where there is none or more than one.
export function twins(model) {
  const { corners, faces } = model;
  const { start, list } = aroundVertices(model);
  const twin = new Int32Array(3 * faces).fill(NO_TWIN);
  const origin = (h) => corners[h];
  const target = (h) => corners[h % 3 === 2 ? h - 2 : h + 1];
  for (let h = 0; h < twin.length; h++) {
    const [a, b] = [origin(h), target(h)];
    if (a === b || twin[h] !== NO_TWIN) continue;
    let [found, many] = [NO_TWIN, false];
    // Every side of this edge begins or ends at a: it is a corner there or the side before it.
    for (let i = start[a], end = start[a + 1]; i < end; i++) {
      const c = list[i];
      const before = c % 3 === 0 ? c + 2 : c - 1;
      for (const other of [c, before]) {
        if (other === h || (other === c ? target(other) : origin(other)) !== b) continue;
        many ||= found !== NO_TWIN;
        found = other;
      }
    }
    if (found === NO_TWIN) continue;
    twin[h] = many ? SEVERAL : found;
    twin[found] = many ? SEVERAL : h;
  }
  return twin;
}

// Length in file units and dihedral angle (degrees; NaN without two faces) of every edge, and the faces beside it.
export function edgeValues(model, vectors) {
  const { corners, positions: p, twin, scale } = model;
  let size = 0;
  for (let h = 0; h < twin.length; h++) if (twin[h] < 0 || twin[h] > h) size++;
  const [lengths, angles] = [new Float32Array(size), new Float32Array(size)];
  const [first, second] = [new Uint32Array(size), new Int32Array(size)];
  let e = 0;
  for (let h = 0; h < twin.length; h++) {
    const other = twin[h];
    if (other >= 0 && other < h) continue;
    const [a, b] = [3 * corners[h], 3 * corners[h % 3 === 2 ? h - 2 : h + 1]];
    lengths[e] = Math.hypot(p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]) / scale;
    const [f, g] = [(h / 3) | 0, other < 0 ? -1 : (other / 3) | 0];
    first[e] = f;
    second[e] = g;
    angles[e] = g < 0 ? NaN : angleBetween(vectors, f, g, corners[h] === corners[other] ? -1 : 1);
    e++;
  }
  return { lengths, angles, first, second };
}

function angleBetween(n, f, g, sign) {
  const [ax, ay, az] = [n[3 * f], n[3 * f + 1], n[3 * f + 2]];
  const [bx, by, bz] = [sign * n[3 * g], sign * n[3 * g + 1], sign * n[3 * g + 2]];
  const cross = Math.hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
  const dot = ax * bx + ay * by + az * bz;
  return cross === 0 && dot === 0 ? NaN : (Math.atan2(cross, dot) * 180) / Math.PI;
}

// Ends and kinds (1 boundary, 2 feature, 3 non-manifold) of the edges that are drawn, each once.
export function drawnEdges({ edgeKinds, corners, twin }) {
  const [ends, kinds] = [[], []];
  for (let f = 0; f < edgeKinds.length; f++) {
    if (edgeKinds[f] === 0) continue;
    for (let i = 0; i < 3; i++) {
      const kind = (edgeKinds[f] >> (2 * i)) & 3;
      const h = 3 * f + i;
      if (kind === 0 || (twin[h] >= 0 && twin[h] < h)) continue;
      ends.push(corners[h], corners[3 * f + ((i + 1) % 3)]);
      kinds.push(kind);
    }
  }
  return { ends: Uint32Array.from(ends), kinds: Uint8Array.from(kinds) };
}

export function corner(model, face, i) {
  const v = 3 * model.corners[3 * face + i];
  return [model.positions[v], model.positions[v + 1], model.positions[v + 2]];
}

export function center(model, face) {
  const [a, b, c] = [0, 1, 2].map((i) => corner(model, face, i));
  return a.map((_, axis) => (a[axis] + b[axis] + c[axis]) / 3);
}

// Unit normal by the face's own winding.
export function normal(model, face) {
  const n = [0, 1, 2].map((axis) => model.vectors[3 * face + axis]);
  const length = Math.hypot(...n) || 1;
  return n.map((x) => x / length);
}

// Everything derived that the view needs from the start.
export function prepare(model) {
  const { vectors, total } = areaVectors(model);
  model.vectors = vectors;
  model.area = total;
  model.size = Math.hypot(...model.half) || 1;
  model.twin = twins(model);
  return model;
}
