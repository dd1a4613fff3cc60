// What is known of the inputs: counts, defects, settings, time, classes; and where the extremes are.

import { numberOf } from "./data.js";
import { facts, h, name, section, table } from "./elements.js";
import { count, percent, short, unitOf } from "./format.js";

const EXTREMES = 5;

export function tables(state, fly) {
  return [classSection(state), extremesSection(state, fly), ...state.models.map((model, m) => inputSection(state, model, m, fly))];
}

function classSection(state) {
  const total = (rows, key) => rows.reduce((sum, row) => sum + row[key], 0) || 1;
  const bodies = state.models.map(({ facts: { classes } }, m) => {
    const [faces, area] = [total(classes, "count"), total(classes, "area")];
    const rows = classes.filter((row) => row.count > 0).map((row) => {
      const { name: label } = state.facts.classes.find(({ code }) => code === row.class);
      const pick = h("button", { type: "button", class: "link", onclick: () => state.select(label, (n, f) => n === m && state.models[n].classes[f] === row.class) }, label);
      return [pick, count(row.count), percent(row.count / faces), percent(row.area / area)];
    });
    const heading = state.models.length > 1 ? h("h3", {}, "AB"[m]) : null;
    return [heading, table(["Class", "Faces", "Share", "Of the area"], rows, "Classes")];
  });
  return section("Classes", ...bodies.flat());
}

// The largest and smallest values of the shown quantity, far enough apart to be different places.
function extremesSection(state, fly) {
  const body = h("div", { id: "extremes" });
  const refresh = () => {
    body.replaceChildren();
    if (state.quantity === "class") {
      body.append(h("p", { class: "note" }, "Classes have no extremes; choose another quantity."));
      return;
    }
    const unit = unitOf(state.definition().dimension, state.models[0].facts.unit);
    state.models.forEach((model, m) => {
      const found = ["largest", "smallest"].map((kind, i) => [kind, peaks(state.values[m], model, i === 0)]);
      const rows = found.flatMap(([kind, faces]) => faces.map((face) => [
        h("button", { type: "button", class: "link", onclick: () => {
          state.choose({ model: m, face });
          fly({ model: m, face });
        } }, `face ${count(numberOf(model, face))}`),
        kind,
        short(state.values[m][face]),
        short(model.confidence[face], 2),
      ]));
      if (state.models.length > 1) body.append(h("h3", {}, "AB"[m]));
      body.append(table(["Place", "", unit ? `Value, ${unit}` : "Value", "Confidence"], rows, `Extremes of ${state.title()}`));
    });
  };
  state.on("quantity", refresh);
  refresh();
  return section("Extremes", h("p", { class: "note" }, "Of the shown quantity, each at least a twentieth of the mesh's size from the others."), body);
}

function peaks(values, model, largest) {
  const chosen = [];
  const apart = (0.05 * 2 * model.size) ** 2;
  const place = (f) => 3 * model.corners[3 * f];
  const { positions: p } = model;
  const isFar = (f) => chosen.every((g) => {
    const [a, b] = [place(f), place(g)];
    return (p[a] - p[b]) ** 2 + (p[a + 1] - p[b + 1]) ** 2 + (p[a + 2] - p[b + 2]) ** 2 >= apart;
  });
  while (chosen.length < EXTREMES) {
    let best = -1;
    for (let f = 0; f < values.length; f++) {
      const value = largest ? values[f] : -values[f];
      if (Number.isNaN(value) || (best >= 0 && value <= (largest ? values[best] : -values[best]))) continue;
      if (isFar(f)) best = f;
    }
    if (best < 0) break;
    chosen.push(best);
  }
  return chosen;
}

function inputSection(state, model, m, fly) {
  const { facts: f } = model;
  const i = f.inspection;
  const length = f.unit ? ` ${f.unit}` : "";
  const size = i.bounds && [0, 1, 2].map((axis) => short(i.bounds.max[axis] - i.bounds.min[axis])).join(" × ") + length;
  const surface = [
    i.closed ? "closed" : "open",
    i.non_orientable_components > 0 ? "not orientable" : i.oriented ? "oriented" : "not oriented",
    i.manifold ? "manifold" : "not manifold",
  ].join(", ");
  const rows = facts([
    ["File", name(i.input)],
    ["Format", { gltf: "glTF" }[i.format] ?? i.format.toUpperCase()],
    ["Faces", count(i.faces)],
    ["Vertices", count(i.vertices)],
    ["Estimated", f.estimated === i.faces ? "every face" : `${count(f.estimated)} faces`],
    ["Surface", surface],
    ["Components", count(i.components)],
    ["Boundary loops", count(i.boundary_loops)],
    ["Inner edges", count(i.edges.inner)],
    ["Boundary edges", count(i.edges.boundary)],
    [`Feature edges, above ${i.feature_angle}°`, count(i.edges.feature)],
    ["Non-manifold edges", count(i.edges.non_manifold)],
    ["Size", size],
    ["Area", `${short(i.area)}${f.unit ? ` ${f.unit}²` : ""}`],
    ["Median edge", i.edge_lengths && `${short(i.edge_lengths.p50)}${length}`],
    ["Groups", i.groups > 0 ? count(i.groups) : null],
  ]);
  const settings = facts(Object.entries(f.settings).filter(([, v]) => v !== null).map(([key, v]) => [key.replace(/_/g, " "), String(v)]));
  const time = facts(f.seconds.map(([stage, seconds]) => [{ read: "Reading", weld: "Welding, edges", estimate: "Estimation" }[stage], `${seconds.toFixed(2)} s`]));
  const label = state.models.length > 1 ? `${"AB"[m]}: ` : "";
  return section(
    `${label}Input`,
    rows,
    ...defects(f, m, state, fly),
    h("h3", {}, "Settings"),
    settings,
    h("h3", {}, "Time"),
    time,
    ...groups(state, model, m),
  );
}

// Each defect with buttons to its first faces, then notes and suggestions.
function defects(f, m, state, fly) {
  const model = state.models[m];
  const items = f.defects.map((sentence, d) => {
    const places = (f.inspection.defects[d]?.places ?? []).map(({ face }) => face).filter((face) => face !== undefined);
    const index = (face) => (model.numbers ? model.numbers.indexOf(face) : face);
    const buttons = places.filter((face) => index(face) >= 0).map((face) =>
      h("button", { type: "button", class: "link", onclick: () => {
        state.choose({ model: m, face: index(face) });
        fly({ model: m, face: index(face) });
      } }, count(face)));
    return h("li", {}, sentence.replace(/ \(face [^)]*\)/, ""), buttons.length > 0 ? [": face ", ...buttons.flatMap((b, i) => (i > 0 ? [", ", b] : [b]))] : null);
  });
  const notes = [...f.notes.map((note) => note.message), ...f.inspection.suggestions].map((text) => h("li", {}, text));
  return [
    items.length > 0 ? [h("h3", {}, "Defects"), h("ul", { class: "defects" }, items)] : [],
    notes.length > 0 ? [h("h3", {}, "Notes"), h("ul", {}, notes)] : [],
  ].flat();
}

function groups(state, model, m) {
  const { groups: all, groups_left_out: more } = model.facts;
  if (all.length === 0) return [];
  const rows = all.map(({ name: text, from, to }) => [
    h("button", { type: "button", class: "link", onclick: () => state.select(`group ${text}`, (n, f) => {
      const number = n === m ? numberOf(model, f) : -1;
      return number >= from && number < to;
    }) }, name(text)),
    count(to - from),
  ]);
  return [h("h3", {}, "Groups"), table(["Name", "Faces"], rows, "Groups"), more > 0 ? h("p", { class: "note" }, `${count(more)} more are not listed.`) : null];
}
