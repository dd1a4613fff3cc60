// What all plots are made of: a canvas that follows its width and the theme, and a brush.

import { h, section, themed } from "./elements.js";
import { short, ticks } from "./format.js";
import { edgeValues } from "./geometry.js";
import { fill, sorted, at } from "./quantities.js";

// How many values fall into each of so many equal parts; what lies beyond an end counts in its last part.
export function bins(values, low, high, size, marks) {
  const counts = new Uint32Array(size);
  const scale = size / (high - low);
  for (let i = 0; i < values.length; i++) {
    const value = values[i];
    if (Number.isNaN(value) || (marks && !marks[i])) continue;
    counts[Math.max(0, Math.min(size - 1, Math.floor((value - low) * scale)))]++;
  }
  return counts;
}

const FRAME = { left: 8, right: 8, top: 14, bottom: 30 };

export class Plot {
  constructor(state, { height, label, frame }) {
    this.state = state;
    this.height = height;
    this.frame = { ...FRAME, ...frame };
    this.canvas = h("canvas", { role: "img", "aria-label": label });
    this.rubber = h("div", { class: "rubber", hidden: true });
    this.element = h("div", { class: "plot", style: `height:${height}px` }, this.canvas, this.rubber);
    new ResizeObserver(() => this.draw()).observe(this.element);
    this.listen();
  }

  // Draws soon, once, however often it is asked for.
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      const width = this.element.clientWidth;
      if (width === 0) return;
      const ratio = window.devicePixelRatio || 1;
      const [w, h_] = [Math.round(width * ratio), Math.round(this.height * ratio)];
      if (this.canvas.width !== w || this.canvas.height !== h_) [this.canvas.width, this.canvas.height] = [w, h_];
      const context = this.canvas.getContext("2d");
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, this.height);
      context.font = `11px ${themed("--font")}`;
      this.box = {
        x: this.frame.left,
        y: this.frame.top,
        width: width - this.frame.left - this.frame.right,
        height: this.height - this.frame.top - this.frame.bottom,
      };
      this.paint(context, this.box);
    });
  }

  // A pointer's place in the box, 0 to 1 from the left and the bottom.
  point(event) {
    const bounds = this.canvas.getBoundingClientRect();
    const { box } = this;
    return [(event.clientX - bounds.left - box.x) / box.width, 1 - (event.clientY - bounds.top - box.y) / box.height];
  }

  listen() {
    let start = null;
    const inside = (p) => p.map((c) => Math.max(0, Math.min(1, c)));
    this.canvas.addEventListener("pointerdown", (event) => {
      if (!this.brushed || event.button !== 0) return;
      start = inside(this.point(event));
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!start) return;
      const end = inside(this.point(event));
      const { x, y, width, height } = this.box;
      const [x0, x1] = [start[0], end[0]].sort((a, b) => a - b);
      const [y0, y1] = this.isPlane ? [start[1], end[1]].sort((a, b) => a - b) : [0, 1];
      Object.assign(this.rubber.style, {
        left: `${x + x0 * width}px`, width: `${(x1 - x0) * width}px`,
        top: `${y + (1 - y1) * height}px`, height: `${(y1 - y0) * height}px`,
      });
      this.rubber.hidden = false;
    });
    const done = (event) => {
      if (!start) return;
      const end = inside(this.point(event));
      const [x0, x1] = [start[0], end[0]].sort((a, b) => a - b);
      const [y0, y1] = [start[1], end[1]].sort((a, b) => a - b);
      start = null;
      this.rubber.hidden = true;
      if ((x1 - x0) * this.box.width < 3) this.state.deselect();
      else this.brushed([x0, y0], [x1, y1], event.shiftKey);
    };
    this.canvas.addEventListener("pointerup", done);
    this.canvas.addEventListener("pointercancel", () => {
      start = null;
      this.rubber.hidden = true;
    });
  }
}

// A histogram of something that is not the shown quantity.
class Histogram extends Plot {
  // `columns` gives the values of each mesh, `marked` the marks of each.
  constructor(state, { label, columns, marked, domain, brush }) {
    super(state, { height: 110, label });
    Object.assign(this, { columns, marked, domain, brush });
    for (const event of ["selection", "theme"]) state.on(event, () => this.draw());
  }

  setLog(log) {
    this.log = log;
    this.draw();
  }

  paint(context, box) {
    const values = this.columns();
    const [low, high] = this.domain();
    const size = 64;
    const counts = (this.counts ??= values.map((v) => bins(v, low, high, size)));
    const picked = this.state.selection === null ? null : values.map((v, m) => bins(v, low, high, size, this.marked(m)));
    const top = Math.max(1, ...counts.flatMap((c) => [...c]));
    const level = (n) => (this.log ? Math.log1p(n) / Math.log1p(top) : n / top) * box.height;
    const width = box.width / size;
    // The second mesh as a line over the first.
    const outline = new Path2D();
    counts.forEach((count, m) => {
      for (let i = 0; i < size; i++) {
        const x = box.x + i * width;
        const y = box.y + box.height - level(count[i]);
        context.fillStyle = themed("--bars");
        if (m === 0) context.fillRect(x + 0.5, y, width - 0.5, level(count[i]));
        else {
          outline.lineTo(x, y);
          outline.lineTo(x + width, y);
        }
        if (picked) {
          context.fillStyle = themed("--accent");
          context.fillRect(x + 0.5, box.y + box.height - level(picked[m][i]), width - 0.5, level(picked[m][i]));
        }
      }
    });
    context.strokeStyle = themed("--ink");
    context.stroke(outline);
    context.fillStyle = themed("--rule");
    context.fillRect(box.x, box.y + box.height, box.width, 1);
    context.fillStyle = themed("--muted");
    context.textBaseline = "top";
    context.textAlign = "center";
    for (const mark of ticks(low, high, Math.max(2, box.width / 70))) {
      context.fillText(short(mark, 3), box.x + ((mark - low) / (high - low)) * box.width, box.y + box.height + 5);
    }
  }

  brushed([x0], [x1], add) {
    const [low, high] = this.domain();
    this.brush(low + x0 * (high - low), low + x1 * (high - low), x0 <= 0, x1 >= 1, add);
  }
}

// Coverage and confidence, edge lengths and dihedral angles.
export function histogramSection(state) {
  const { models } = state;
  const unit = models[0].facts.unit;
  const perFace = (name, title) => {
    const columns = once(() => models.map((model) => fill(model, name, new Float32Array(model.faces))));
    return figure(title, new Histogram(state, {
      label: `Histogram of ${title}`,
      columns,
      marked: (m) => state.marks[m],
      domain: () => [0, 1],
      brush: (from, to, first, last, add) => {
        const values = columns();
        const [low, high] = [first ? -Infinity : from, last ? Infinity : to];
        state.select(`${title.toLowerCase()} from ${short(from, 2)} to ${short(to, 2)}`, (m, f) => values[m][f] >= low && values[m][f] <= high, add, { [name]: [low, high] });
      },
    }));
  };
  const edges = once(() => models.map((model) => edgeValues(model, model.vectors)));
  const perEdge = (name, title, domain) =>
    figure(title, new Histogram(state, {
      label: `Histogram of ${title}`,
      columns: () => edges().map((e) => e[name]),
      marked: (m) => {
        const { first, second } = edges()[m];
        const marks = state.marks[m];
        return Uint8Array.from(first, (f, e) => marks[f] || (second[e] >= 0 && marks[second[e]]));
      },
      domain,
      // The faces beside the edges.
      brush: (from, to, isFirst, isLast, add) => {
        const [low, high] = [isFirst ? -Infinity : from, isLast ? Infinity : to];
        const beside = edges().map((e, m) => {
          const found = new Uint8Array(models[m].faces);
          e[name].forEach((value, i) => {
            if (!(value >= low && value <= high)) return;
            found[e.first[i]] = 1;
            if (e.second[i] >= 0) found[e.second[i]] = 1;
          });
          return found;
        });
        state.select(`beside edges with ${title.toLowerCase()} ${short(from, 3)} to ${short(to, 3)}`, (m, f) => beside[m][f], add);
      },
    }));
  const longest = once(() => Math.max(...edges().map((e) => at(sorted(e.lengths), 0.99) ?? 1)) * 1.05 || 1);
  const plots = [
    perFace("coverage", "Coverage"),
    perFace("confidence", "Confidence"),
    perEdge("lengths", `Edge length${unit ? `, ${unit}` : ""}`, () => [0, longest()]),
    perEdge("angles", "Dihedral angle, °", once(() => [0, Math.min(180, Math.max(1, ...edges().map((e) => 1.1 * (at(sorted(e.angles), 0.99) ?? 90))))])),
  ];
  const log = h("input", { type: "checkbox", onchange: () => plots.forEach((p) => p.plot.setLog(log.checked)) });
  return section(
    "Distributions",
    h("p", { class: "note" }, "Drag across a plot to select faces; a click clears."),
    h("div", { class: "figures" }, plots.map((p) => p.element)),
    h("label", { class: "toggle" }, log, h("span", {}, "Logarithmic counts")),
  );
}

function figure(title, plot) {
  return { plot, element: h("figure", {}, h("figcaption", {}, title), plot.element) };
}

// What a function returns, worked out when it is first asked for.
export function once(work) {
  let result;
  return () => (result ??= work());
}
