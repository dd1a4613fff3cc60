// The disk of a face: legs walked over the mesh in planes through its centre, each as long as the face's radius.
// As in the program, a vertex exactly on a plane counts as above it, so a section never meets a special case.

import { direction } from "./data.js";
import { center, corner, normal } from "./geometry.js";
import { add, cross, dot, minus, times, unit } from "./matrix.js";

const LEGS = 24;
// Faces that a leg passes at most: a radius may be larger than the mesh.
const MOST = 4000;

// Chains of points: the legs, the rim through their ends, and the two principal directions.
export function disk(model, face) {
  const radius = model.radius[face] * scaleOf(model, face) * model.scale;
  if (!(radius > 0) || model.classes[face] < 0) return null;
  const frame = { centre: center(model, face), normal: normal(model, face) };
  const along = direction(model, face);
  const x = unit(minus(along, times(dot(along, frame.normal), frame.normal)));
  const y = cross(frame.normal, x);
  const legs = [];
  for (let i = 0; i < LEGS; i++) {
    const angle = (2 * Math.PI * i) / LEGS;
    const ahead = add(times(Math.cos(angle), x), times(Math.sin(angle), y));
    legs.push(leg(model, face, frame, ahead, radius));
  }
  const ends = legs.map((points) => points.at(-1));
  const arm = (axis, length) => [-1, 1].map((side) => add(frame.centre, times((side * length * radius) / 2, axis)));
  return { legs, rim: [...ends, ends[0]], max: arm(x, 1.6), min: arm(y, 0.8) };
}

// Lengths of a body grow by this where the scene puts it.
function scaleOf(model, face) {
  const number = model.numbers ? model.numbers[face] : face;
  return model.facts.bodies.find((body) => number >= body.from && number < body.to)?.scale ?? 1;
}

function leg(model, face, { centre, normal: up }, ahead, radius) {
  const across = cross(up, ahead);
  const above = (p) => dot(minus(p, centre), across) >= 0;
  const points = [centre];
  let [room, at, entered] = [radius, face, -1];
  for (let steps = 0; steps < MOST; steps++) {
    const exit = leave(model, at, entered, above, centre, across, ahead);
    if (!exit) break;
    const last = points.at(-1);
    const length = Math.hypot(...minus(exit.point, last));
    // Turned by a right angle, it says nothing of its centre any more.
    if (length > 1e-9 * radius && dot(minus(exit.point, last), ahead) <= 0) break;
    if (length >= room) {
      points.push(add(last, times(room / length, minus(exit.point, last))));
      break;
    }
    room -= length;
    points.push(exit.point);
    const { edge } = exit;
    const kind = (model.edgeKinds[at] >> (2 * (edge % 3))) & 3;
    if (kind !== 0 || model.twin[edge] < 0) break;
    entered = model.twin[edge];
    at = (entered / 3) | 0;
    if (at === face) break;
  }
  return points;
}

// The edge by which a section leaves a face: the crossed one that it did not come by, the one ahead at the start.
function leave(model, face, entered, above, centre, across, ahead) {
  let best = null;
  for (let i = 0; i < 3; i++) {
    const edge = 3 * face + i;
    if (edge === entered) continue;
    const [a, b] = [corner(model, face, i), corner(model, face, (i + 1) % 3)];
    if (above(a) === above(b)) continue;
    const [da, db] = [a, b].map((p) => dot(minus(p, centre), across));
    const point = add(a, times(da / (da - db), minus(b, a)));
    const forward = dot(minus(point, centre), ahead);
    if (!best || forward > best.forward) best = { edge, point, forward };
  }
  return best;
}
