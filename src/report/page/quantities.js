// Values of faces from k_max and k_min, their spread, and the range that colours span.

const TITLES = {
  mean: "Mean curvature", gauss: "Gaussian curvature", k_max: "Largest curvature", k_min: "Smallest curvature",
  shape_index: "Shape index", curvedness: "Curvedness", class: "Class", coverage: "Coverage",
  confidence: "Confidence", gauss_perimeter: "Gaussian curvature (perimeter)",
};
const SYMBOLS = {
  mean: "H", gauss: "K", k_max: "k_max", k_min: "k_min", shape_index: "S", curvedness: "C", class: "class",
  coverage: "coverage", confidence: "confidence", gauss_perimeter: "K_p",
};

export const title = (name) => TITLES[name] ?? name;
export const symbol = (name) => SYMBOLS[name] ?? name;

const FORMULAS = {
  mean: (max, min) => (max + min) / 2,
  gauss: (max, min) => max * min,
  shape_index: (max, min) => (2 / Math.PI) * Math.atan2(max + min, max - min),
  curvedness: (max, min) => Math.sqrt((max * max + min * min) / 2),
};

// The value of one face; NaN without an estimate.
export function valueAt(model, name, face) {
  if (model.classes[face] < 0) return NaN;
  if (name === "class") return model.classes[face];
  const formula = FORMULAS[name];
  return formula ? formula(model.k_max[face], model.k_min[face]) : model[name] ? model[name][face] : NaN;
}

// The values of all faces, into an array that is there already.
export function fill(model, name, out) {
  const { classes, k_max: max, k_min: min } = model;
  const formula = FORMULAS[name];
  const own = name === "class" ? classes : model[name];
  for (let f = 0; f < out.length; f++) {
    out[f] = classes[f] < 0 || (!formula && !own) ? NaN : formula ? formula(max[f], min[f]) : own[f];
  }
  return out;
}

// Numbers in order, without those that are none.
export function sorted(values) {
  const copy = Float32Array.from(values).sort();
  let end = copy.length;
  while (end > 0 && Number.isNaN(copy[end - 1])) end--;
  return copy.subarray(0, end);
}

export function at(ordered, share) {
  return ordered[Math.round((ordered.length - 1) * share)];
}

// Least, greatest and a few percentiles; null where there is no value.
export function spread(values) {
  const ordered = sorted(values);
  if (ordered.length === 0) return null;
  const shares = { min: 0, p1: 0.01, p5: 0.05, p25: 0.25, p50: 0.5, p75: 0.75, p95: 0.95, p99: 0.99, max: 1 };
  const found = Object.fromEntries(Object.entries(shares).map(([name, share]) => [name, at(ordered, share)]));
  // The least magnitude that 95 of 100 values stay within, from both ends inwards.
  const left_out = ordered.length - 1 - Math.round((ordered.length - 1) * 0.95);
  let [low, high] = [0, ordered.length - 1];
  const magnitude = () => Math.max(Math.abs(ordered[low]), Math.abs(ordered[high]));
  const largest = magnitude();
  for (let i = 0; i < left_out; i++) {
    if (Math.abs(ordered[low]) >= Math.abs(ordered[high])) low++;
    else high--;
  }
  found.reach = magnitude() || largest || 1;
  found.values = ordered.length;
  return found;
}

// The automatic range of a quantity over all meshes shown, as the program chooses it.
export function automatic(definition, spreads, isDifference) {
  if (definition.name === "class") return [0, 5];
  if (definition.name === "shape_index" && !isDifference) return [-1, 1];
  const reach = Math.max(0, ...spreads.filter(Boolean).map((s) => s.reach)) || 1;
  return definition.signed ? [-reach, reach] : [0, reach];
}
