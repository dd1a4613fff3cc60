// Densities of faces in a plane of two quantities: k_min against k_max with the classes, shape index against
// curvedness.

import { palette } from "./data.js";
import { channels, h, section, themed } from "./elements.js";
import { short, ticks, unitOf } from "./format.js";
import { Plot } from "./plots.js";
import { valueAt } from "./quantities.js";

const CELLS = 120;

class Plane extends Plot {
  // Each axis: quantity, title, domain().
  constructor(state, { label, x, y, under, over, square }) {
    super(state, { height: square ? 330 : 230, label, frame: { left: 46, bottom: 34, top: 10 } });
    Object.assign(this, { x, y, under, over, isPlane: true });
    this.picture = document.createElement("canvas");
    [this.picture.width, this.picture.height] = [CELLS, CELLS];
    for (const event of ["selection", "theme"]) state.on(event, () => this.draw());
  }

  setLog(log) {
    this.log = log;
    this.cells = null;
    this.draw();
  }

  // Linear, or of even steps in the magnitude away from zero.
  scaled(axis) {
    const [low, high] = axis.domain();
    if (!this.log || axis.linear) return { to: (v) => (v - low) / (high - low), from: (s) => low + s * (high - low), low, high };
    const unit = Math.max(Math.abs(low), Math.abs(high)) / 200;
    const [a, b] = [Math.asinh(low / unit), Math.asinh(high / unit)];
    return { to: (v) => (Math.asinh(v / unit) - a) / (b - a), from: (s) => unit * Math.sinh(a + s * (b - a)), low, high };
  }

  // The cell of every face, worked out once for each kind of scale.
  place() {
    const [sx, sy] = [this.scaled(this.x), this.scaled(this.y)];
    this.cells = this.state.models.map((model) => {
      const cells = new Int32Array(model.faces);
      for (let f = 0; f < model.faces; f++) {
        const [x, y] = [sx.to(valueAt(model, this.x.name, f)), sy.to(valueAt(model, this.y.name, f))];
        const inside = x >= 0 && x <= 1 && y >= 0 && y <= 1;
        cells[f] = inside ? Math.min(CELLS - 1, Math.floor(x * CELLS)) + CELLS * Math.min(CELLS - 1, Math.floor(y * CELLS)) : -1;
      }
      return cells;
    });
  }

  count(marks) {
    const counts = new Uint32Array(CELLS * CELLS);
    this.cells.forEach((cells, m) => {
      for (let f = 0; f < cells.length; f++) if (cells[f] >= 0 && (!marks || marks[m][f])) counts[cells[f]]++;
    });
    return counts;
  }

  paint(context, box) {
    if (!this.cells) {
      this.place();
      this.counts = this.count(null);
    }
    const [sx, sy] = [this.scaled(this.x), this.scaled(this.y)];
    const at = (x, y) => [box.x + sx.to(x) * box.width, box.y + (1 - sy.to(y)) * box.height];
    context.save();
    context.beginPath();
    context.rect(box.x, box.y, box.width, box.height);
    context.clip();
    this.under?.(context, at, sx, sy, box);
    const picked = this.state.selection === null ? null : this.count(this.state.marks);
    this.smear(this.counts, channels(themed("--ink")), picked ? 0.35 : 1);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.picture, box.x, box.y, box.width, box.height);
    if (picked) {
      this.smear(picked, channels(themed("--accent")), 1);
      context.drawImage(this.picture, box.x, box.y, box.width, box.height);
    }
    this.over?.(context, at, sx, sy);
    context.restore();
    this.axes(context, box, sx, sy);
  }

  // Cells of more faces are more opaque, by the logarithm of their number.
  smear(counts, [r, g, b], strength) {
    const image = new ImageData(CELLS, CELLS);
    const top = Math.log1p(Math.max(1, ...counts));
    for (let i = 0; i < counts.length; i++) {
      if (counts[i] === 0) continue;
      const at = 4 * ((CELLS - 1 - Math.floor(i / CELLS)) * CELLS + (i % CELLS));
      image.data[at] = 255 * r;
      image.data[at + 1] = 255 * g;
      image.data[at + 2] = 255 * b;
      image.data[at + 3] = 255 * strength * (0.18 + (0.82 * Math.log1p(counts[i])) / top);
    }
    this.picture.getContext("2d").putImageData(image, 0, 0);
  }

  axes(context, box, sx, sy) {
    context.strokeStyle = themed("--rule");
    context.strokeRect(box.x + 0.5, box.y + 0.5, box.width - 1, box.height - 1);
    context.fillStyle = themed("--muted");
    const marks = (scale, about) => {
      if (!this.log || scale.linear) return ticks(scale.low, scale.high, about);
      const reach = Math.max(Math.abs(scale.low), Math.abs(scale.high));
      const power = 10 ** Math.floor(Math.log10(reach));
      return [-power, -power / 10, 0, power / 10, power].filter((v) => v >= scale.low && v <= scale.high);
    };
    context.textBaseline = "top";
    context.textAlign = "center";
    for (const v of marks({ ...sx, linear: this.x.linear }, box.width / 70)) {
      context.fillText(short(v, 3), box.x + sx.to(v) * box.width, box.y + box.height + 5);
    }
    context.fillText(this.x.title, box.x + box.width / 2, box.y + box.height + 20);
    context.textBaseline = "middle";
    context.textAlign = "right";
    for (const v of marks({ ...sy, linear: this.y.linear }, box.height / 45)) {
      context.fillText(short(v, 3), box.x - 5, box.y + (1 - sy.to(v)) * box.height);
    }
    context.save();
    context.translate(7, box.y + box.height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(this.y.title, 0, 0);
    context.restore();
  }

  brushed([x0, y0], [x1, y1], add) {
    const [sx, sy] = [this.scaled(this.x), this.scaled(this.y)];
    const [left, right, low, high] = [sx.from(x0), sx.from(x1), sy.from(y0), sy.from(y1)];
    const { models } = this.state;
    const inside = (m, f) => {
      const [x, y] = [valueAt(models[m], this.x.name, f), valueAt(models[m], this.y.name, f)];
      return x >= left && x <= right && y >= low && y <= high;
    };
    this.state.select(`${this.x.title} ${short(left, 3)} to ${short(right, 3)} and ${this.y.title} ${short(low, 3)} to ${short(high, 3)}`, inside, add, { [this.x.name]: [left, right], [this.y.name]: [low, high] });
  }
}

export function planesSection(state) {
  const { models } = state;
  const unit = unitOf(-1, models[0].facts.unit);
  const spread = (name) => state.spreadOf(name).filter(Boolean);
  // Both axes alike, so that the diagonal is one; zero always shows.
  const reach = () => {
    const all = ["k_max", "k_min"].flatMap((name) => spread(name).flatMap((s) => [s.p1, s.p99]));
    const [low, high] = [Math.min(0, ...all), Math.max(0, ...all)];
    const room = 0.08 * (high - low) || 1;
    return [low - room, high + room];
  };
  const curved = () => [0, Math.max(...spread("curvedness").map((s) => s.p99), 0) * 1.08 || 1];
  const principal = new Plane(state, {
    label: "Density of faces by smallest and largest curvature, with the regions of the classes",
    x: { name: "k_min", title: `k_min, ${unit}`, domain: reach },
    y: { name: "k_max", title: `k_max, ${unit}`, domain: reach },
    under: (...place) => regions(state, ...place),
    over: names,
    square: true,
  });
  const shape = new Plane(state, {
    label: "Density of faces by shape index and curvedness",
    x: { name: "shape_index", title: "shape index: cup, saddle, cap", domain: () => [-1, 1], linear: true },
    y: { name: "curvedness", title: `curvedness, ${unit}`, domain: curved },
  });
  const log = h("input", { type: "checkbox", onchange: () => [principal, shape].forEach((p) => p.setLog(log.checked)) });
  return section(
    "Shape",
    h("p", { class: "note" }, "How many faces have which pair of values. Drag a rectangle to select faces."),
    h("figure", {}, h("figcaption", {}, "Principal curvatures"), principal.element),
    h("figure", {}, h("figcaption", {}, "Shape index and curvedness"), shape.element),
    h("label", { class: "toggle" }, log, h("span", {}, "Logarithmic scales")),
  );
}

// The classes where they lie for a face of median radius: bands around zero and around the diagonal.
function regions(state, context, at, sx, sy, box) {
  const rgba = palette(state.facts.palettes.classes);
  const tint = (code, alpha) => {
    const i = 4 * (51 * code + 25);
    return `rgb(${rgba[i]} ${rgba[i + 1]} ${rgba[i + 2]} / ${alpha})`;
  };
  const [model] = state.models;
  // Without a radius, as files may leave it out, only the borders of the regions are known.
  const radius = medianRadius(model);
  const tolerance = radius ? (model.facts.settings.class_tolerance ?? 0.05) / radius : 0;
  const { low, high } = sx;
  const rectangle = (x0, x1, y0, y1, code) => {
    const [[left, top], [right, bottom]] = [at(x0, y1), at(x1, y0)];
    context.fillStyle = tint(code, 0.22);
    context.fillRect(left, top, right - left, bottom - top);
  };
  const t = Math.min(tolerance, (high - low) / 2);
  context.clearRect(box.x, box.y, box.width, box.height);
  rectangle(t, high, t, high, 2);
  rectangle(low, -t, low, -t, 2);
  rectangle(low, -t, t, high, 4);
  rectangle(-t, t, t, high, 1);
  rectangle(low, -t, -t, t, 1);
  rectangle(-t, t, -t, t, 0);
  // Below the diagonal there is nothing: k_max is never less than k_min.
  const steps = 48;
  const diagonal = (shift) => Array.from({ length: steps + 1 }, (_, i) => sx.from(i / steps)).map((k) => at(k, k + shift));
  context.beginPath();
  for (const [x, y] of diagonal(t)) context.lineTo(x, y);
  for (const [x, y] of diagonal(0).reverse()) context.lineTo(x, y);
  context.fillStyle = tint(3, 0.35);
  context.fill();
  context.beginPath();
  for (const [x, y] of diagonal(0)) context.lineTo(x, y);
  context.lineTo(...at(high, low));
  context.lineTo(...at(low, low));
  context.fillStyle = themed("--panel");
  context.fill();
  context.strokeStyle = themed("--rule");
  context.beginPath();
  for (const [x, y] of diagonal(0)) context.lineTo(x, y);
  for (const [from, to] of [[[low, 0], [0, 0]], [[0, 0], [0, high]]]) {
    context.moveTo(...at(...from));
    context.lineTo(...at(...to));
  }
  context.stroke();
}

function names(context, at, sx, sy) {
  context.fillStyle = themed("--ink");
  context.textAlign = "left";
  context.textBaseline = "top";
  const label = (text, x, y) => context.fillText(text, ...at(sx.from(x), sy.from(y)).map((c) => c + 6));
  const zero = sx.to(0);
  if (zero > 0.3) label("hyperbolic", 0, 1);
  if (zero < 0.7) label("elliptic, bulging", zero, 1);
  if (zero > 0.45) label("elliptic, hollow", 0, zero);
}

function medianRadius(model) {
  const some = [];
  for (let f = 0; f < model.faces; f += Math.max(1, Math.floor(model.faces / 2000))) {
    if (model.radius[f] > 0) some.push(model.radius[f]);
  }
  return some.sort((a, b) => a - b)[some.length >> 1];
}
