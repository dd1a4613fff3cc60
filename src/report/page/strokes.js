// Principal directions as strokes, spread evenly over the surface: any number from the first on are evenly spread.

import { direction } from "./data.js";
import { center } from "./geometry.js";

export const MOST_STROKES = 60000;

// Centre and direction of k_max of a stroke after the other, and the normals.
export function strokes(model) {
  const order = alongCurve(model);
  const reached = new Float64Array(order.length);
  let sum = 0;
  for (let i = 0; i < order.length; i++) {
    const f = 3 * order[i];
    const { vectors: v } = model;
    sum += model.classes[order[i]] < 0 ? 0 : Math.hypot(v[f], v[f + 1], v[f + 2]);
    reached[i] = sum;
  }
  const size = sum > 0 ? Math.min(MOST_STROKES, 4 * model.faces) : 0;
  const data = new Float32Array(9 * size);
  for (let s = 0; s < size; s++) {
    const face = order[firstAbove(reached, mirrored(s) * sum)];
    const along = direction(model, face);
    const f = 3 * face;
    data.set(center(model, face), 9 * s);
    data.set(along, 9 * s + 3);
    data.set(model.vectors.subarray(f, f + 3), 9 * s + 6);
  }
  return { data, size };
}

// The bits of a number behind the point in reverse order: each next one falls into the widest gap.
function mirrored(number) {
  let [share, result] = [0.5, 0];
  for (let n = number + 1; n > 0; n >>>= 1, share /= 2) if (n & 1) result += share;
  return result;
}

function firstAbove(ascending, value) {
  let [low, high] = [0, ascending.length - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] > value) high = middle;
    else low = middle + 1;
  }
  return low;
}

// Faces along a curve through space that stays near itself (Morton's order, 9 bits an axis).
function alongCurve(model) {
  const keys = new Float64Array(model.faces);
  const { corners, positions: p, half } = model;
  const widest = 2 * Math.max(...half) || 1;
  for (let f = 0; f < model.faces; f++) {
    let key = 0;
    const v = 3 * corners[3 * f];
    for (let axis = 0; axis < 3; axis++) {
      key |= spaced(Math.min(511, ((p[v + axis] + half[axis]) / widest) * 512)) << axis;
    }
    keys[f] = key * 16777216 + (f & 16777215);
  }
  keys.sort();
  return Uint32Array.from(keys, (key) => key % 16777216);
}

function spaced(number) {
  let n = number | 0;
  n = (n | (n << 16)) & 0x030000ff;
  n = (n | (n << 8)) & 0x0300f00f;
  n = (n | (n << 4)) & 0x030c30c3;
  return (n | (n << 2)) & 0x09249249;
}
