// The face that is pointed at or chosen: its number, class and values, and its disk on the surface.

import { numberOf } from "./data.js";
import { disk } from "./disk.js";
import { facts, h, name, section, channels, themed } from "./elements.js";
import { count, short, unitOf } from "./format.js";
import { title, valueAt } from "./quantities.js";

export function faceSection(state, view, fly, redraw) {
  const body = h("div", { id: "face", "aria-live": "polite" });
  const drawn = state.models.map(() => false);
  const refresh = () => {
    const place = state.pointed.face >= 0 ? state.pointed : state.chosen;
    body.replaceChildren(place.face >= 0 ? card(state, place, fly) : hint());
    state.models.forEach((model, m) => {
      const chains = place.model === m ? chainsOf(model, place.face) : [];
      if (chains.length > 0 || drawn[m]) view.setDisk(m, chains);
      drawn[m] = chains.length > 0;
    });
    redraw();
  };
  state.on("face", refresh);
  state.on("theme", refresh);
  refresh();
  return section("Face", body, finder(state, fly));
}

function hint() {
  return h("p", { class: "note" }, "Point at a face, or tap it, to read its values and to see the disk that its radius spans.");
}

// Finds a face by its number, for those who cannot point.
function finder(state, fly) {
  const input = h("input", { type: "number", min: 0, step: 1, inputmode: "numeric", "aria-label": "Face number", placeholder: "number" });
  const which = state.models.length > 1 ? h("select", { "aria-label": "Mesh" }, ["A", "B"].map((m, i) => h("option", { value: i }, m))) : null;
  const onsubmit = (event) => {
    event.preventDefault();
    const m = Number(which?.value ?? 0);
    const model = state.models[m];
    const wanted = Number(input.value);
    const face = model.numbers ? model.numbers.indexOf(wanted) : wanted;
    const found = input.value !== "" && face >= 0 && face < model.faces && Number.isInteger(face);
    input.setCustomValidity(found ? "" : model.numbers ? "This face is not drawn" : `Faces are 0 to ${model.faces - 1}`);
    if (!found) return input.reportValidity();
    state.choose({ model: m, face });
    fly({ model: m, face });
  };
  input.addEventListener("input", () => input.setCustomValidity(""));
  return h("form", { class: "finder", onsubmit }, which, input, h("button", { type: "submit", class: "quiet" }, "Go to face"));
}

function chainsOf(model, face) {
  const found = disk(model, face);
  if (!found) return [];
  const color = (variable, alpha) => [...channels(themed(variable)), alpha];
  const legs = found.legs.map((points) => ({ points, color: color("--leg", 0.75), width: 0.7 }));
  return [
    ...legs,
    { points: found.rim, color: color("--leg", 1), width: 1.6 },
    { points: found.max, color: color("--max", 1), width: 2.4 },
    { points: found.min, color: color("--min", 1), width: 2.4 },
  ];
}

function card(state, { model: m, face }, fly) {
  const model = state.models[m];
  const number = numberOf(model, face);
  const unit = model.facts.unit;
  const code = model.classes[face];
  const group = model.facts.groups.find(({ from, to }) => number >= from && number < to);
  const className = state.facts.classes.find((c) => c.code === code).name;
  const rows = state.definitions
    .filter(({ name: q }) => q !== "class")
    .map(({ name: q, dimension }) => [title(q), h("span", { "data-value": q }, value(valueAt(model, q, face), unitOf(dimension, unit), SHARES.includes(q) ? 2 : 4))]);
  if (state.isDifference()) {
    const { dimension } = state.definition();
    rows.unshift([state.title(), h("span", { "data-value": "difference" }, value(state.values[m][face], unitOf(dimension, unit)))]);
  }
  return h(
    "div",
    { class: "card" },
    h("h3", {}, state.models.length > 1 ? `${"AB"[m]}, face ` : "Face ", h("span", { "data-value": "number" }, count(number)), h("span", { class: "tag", "data-value": "class" }, className)),
    facts([
      ...rows,
      ["Radius", h("span", { "data-value": "radius" }, value(model.radius[face], unitOf(1, unit)))],
      ["Method", state.facts.methods[model.methods[face]].replace("_", "-")],
      ["Group", group ? name(group.name) : null],
    ]),
  );
}

// Kept in a byte.
const SHARES = ["coverage", "confidence"];
const value = (number, unit, digits = 4) => (unit && !Number.isNaN(number) ? `${short(number, digits)} ${unit}` : short(number, digits));
