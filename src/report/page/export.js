// What can be taken away: a picture of the view with its legend, and the selected faces as CSV.

import { numberOf } from "./data.js";
import { download, themed } from "./elements.js";
import { short, unitOf } from "./format.js";
import { valueAt } from "./quantities.js";

// The view as it is, with the colour scale below it.
export function picture(state, view, draw) {
  const { canvas } = view;
  const unit = Math.max(1, canvas.width / 1000);
  const strip = Math.round(84 * unit);
  const target = document.createElement("canvas");
  [target.width, target.height] = [canvas.width, canvas.height + strip];
  const context = target.getContext("2d");
  context.fillStyle = themed("--paper");
  context.fillRect(0, 0, target.width, target.height);
  // Drawn now, since a canvas keeps nothing between frames.
  draw();
  context.drawImage(canvas, 0, 0);
  drawLegend(context, state, target.width, canvas.height, unit);
  return new Promise((done) => target.toBlob(done, "image/png"));
}

function drawLegend(context, state, width, top, unit) {
  const bar = Math.min(0.8 * width, 560 * unit);
  const left = (width - bar) / 2;
  const rgba = state.colors();
  const color = (i) => `rgb(${rgba[4 * i]} ${rgba[4 * i + 1]} ${rgba[4 * i + 2]})`;
  context.font = `${13 * unit}px ${themed("--font")}`;
  context.fillStyle = themed("--ink");
  context.textBaseline = "top";
  const dimension = unitOf(state.definition().dimension, state.models[0].facts.unit);
  context.fillText(`${state.title()}${dimension ? `, ${dimension}` : ""}`, left, top + 10 * unit);
  const y = top + 32 * unit;
  const names = state.facts.classes.filter(({ code }) => code >= 0);
  const isClass = state.quantity === "class";
  for (let x = 0; x < bar; x++) {
    context.fillStyle = color(isClass ? 51 * Math.floor((x / bar) * 5) + 25 : Math.round((254 * x) / bar));
    context.fillRect(left + x, y, 1.5, 12 * unit);
  }
  context.fillStyle = themed("--ink");
  context.textAlign = "center";
  const marks = isClass ? names.map(({ name }, i) => [(i + 0.5) / 5, name]) : [0, 0.25, 0.5, 0.75, 1].map((s) => [s, short(state.range[0] + s * (state.range[1] - state.range[0]), 3)]);
  for (const [share, text] of marks) context.fillText(text, left + share * bar, y + 18 * unit);
}

// The selected faces, in the order of their numbers, with the columns that the program's CSV has too.
export function csv(state) {
  const names = state.definitions.map(({ name }) => name);
  const columns = ["class", "k_max", "k_min", "mean", "gauss", "gauss_perimeter", "shape_index", "curvedness"].filter((c) => names.includes(c));
  const several = state.models.length > 1;
  const lines = [[...(several ? ["mesh"] : []), "face", ...columns, "radius", "coverage", "confidence"].join(",")];
  state.models.forEach((model, m) => {
    for (let f = 0; f < model.faces; f++) {
      if (!state.marks[m][f]) continue;
      const values = columns.map((name) => (name === "class" ? model.classes[f] : text(valueAt(model, name, f))));
      const rest = [text(model.radius[f]), text(model.coverage[f]), text(model.confidence[f])];
      lines.push([...(several ? ["AB"[m]] : []), numberOf(model, f), ...values, ...rest].join(","));
    }
  });
  return lines.join("\n") + "\n";
}

// The shortest decimal that is this 32-bit float.
function text(value) {
  if (Number.isNaN(value)) return "";
  const single = Math.fround(value);
  for (let digits = 6; digits < 10; digits++) {
    const written = Number(single.toPrecision(digits));
    if (Math.fround(written) === single) return String(written);
  }
  return String(single);
}

export async function save(state, view, draw) {
  download(`${fileName(state)}.png`, await picture(state, view, draw));
}

export function saveCsv(state) {
  download(`${fileName(state)}-faces.csv`, new Blob([csv(state)], { type: "text/csv" }));
}

function fileName(state) {
  const names = state.models.map(({ facts }) => facts.name.replace(/[^\p{L}\p{N}._-]+/gu, "_"));
  return `${names.join("-and-")}-${state.quantity}`.slice(0, 120);
}
