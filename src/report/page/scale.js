// The colour scale: quantity, map, and a histogram whose ends can be dragged.

import { choice, h, section, select, themed, toggle } from "./elements.js";
import { count, percent, short, ticks, unitOf } from "./format.js";
import { bins, Plot } from "./plots.js";
import { symbol, title } from "./quantities.js";

export function scaleSection(state) {
  const quantities = state.definitions.map(({ name }) => [name, title(name)]);
  const quantity = select("Quantity", quantities, state.quantity, (name) => state.show(name));
  quantity.element.id = "quantity";
  const maps = Object.keys(state.facts.palettes).filter((name) => name !== "classes");
  const map = select("Colours", maps.map((name) => [name, name]), state.map, (name) => state.setMap(name));
  map.element.id = "map";
  const plot = new ScalePlot(state);
  const log = choice("Counts", [["linear", "linear"], ["log", "log"]], "linear", (kind) => plot.setLog(kind === "log"));
  const difference = state.canSubtract ? toggle("Difference, B − A", false, (on) => state.subtract(on)) : null;
  const reset = h("button", { type: "button", class: "quiet", onclick: () => state.setRange(...state.automaticRange()) }, "Automatic");
  const within = h("button", { type: "button", class: "quiet", onclick: () => {
    const { values, range: [low, high] } = state;
    state.select(`${symbol(state.quantity)} from ${short(low, 3)} to ${short(high, 3)}`, (m, f) => values[m][f] >= low && values[m][f] <= high, false, { [state.quantity]: [low, high] });
  } }, "Select range");
  const summary = h("p", { class: "note", id: "clipped" });
  const percentiles = h("div", { class: "percentiles", id: "percentiles" });
  const refresh = () => {
    quantity.element.value = state.quantity;
    const isClass = state.quantity === "class";
    map.row.hidden = isClass;
    reset.hidden = within.hidden = isClass;
    if (!isClass) map.element.value = state.map;
    tell(state, summary, percentiles);
  };
  state.on("quantity", refresh);
  state.on("range", refresh);
  refresh();
  return section("Colour", h("div", { class: "fields" }, quantity.row, map.row), difference, plot.element, percentiles, h("div", { class: "bar" }, log, h("div", { class: "buttons" }, within, reset)), summary);
}

// How many faces lie outside, and the percentiles.
function tell(state, summary, percentiles) {
  const [low, high] = state.range;
  const isClass = state.quantity === "class";
  let [below, above, estimated] = [0, 0, 0];
  for (const values of state.values) {
    for (let f = 0; f < values.length; f++) {
      if (values[f] < low) below++;
      else if (values[f] > high) above++;
      if (!Number.isNaN(values[f])) estimated++;
    }
  }
  summary.replaceChildren();
  if (!isClass) {
    summary.textContent =
      below + above === 0
        ? "Every face lies within the range."
        : `${count(below)} faces below and ${count(above)} above the range (${percent((below + above) / estimated)}) have the colour of its ends.`;
  }
  percentiles.replaceChildren();
  if (isClass) return;
  const unit = unitOf(state.definition().dimension, state.models[0].facts.unit);
  state.shownSpread().forEach((s, m) => {
    if (!s) return;
    const cells = [["min", s.min], ["5 %", s.p5], ["25 %", s.p25], ["median", s.p50], ["75 %", s.p75], ["95 %", s.p95], ["max", s.max]];
    const label = state.models.length > 1 ? h("caption", {}, "AB"[m]) : null;
    percentiles.append(
      h("table", { "aria-label": `Percentiles of ${state.title()}, ${unit || "no unit"}` }, label,
        h("thead", {}, h("tr", {}, cells.map(([name]) => h("th", { scope: "col" }, name)))),
        h("tbody", {}, h("tr", {}, cells.map(([, value]) => h("td", {}, short(value, 3)))))),
    );
  });
}

// The histogram of the shown quantity with a handle at each end of the range.
class ScalePlot extends Plot {
  constructor(state) {
    super(state, { height: 150, label: "Histogram of the shown quantity with the range of the colours" });
    this.handles = ["low", "high"].map((end, i) => this.handle(end, i));
    this.element.append(...this.handles);
    for (const event of ["quantity", "range", "selection", "theme"]) state.on(event, () => this.refresh(event));
    this.refresh("quantity");
  }

  setLog(log) {
    this.log = log;
    this.draw();
  }

  refresh(event) {
    const { state } = this;
    if (event === "quantity" || !this.domain) {
      const spreads = state.shownSpread().filter(Boolean);
      const [low, high] = state.automaticRange();
      const least = Math.min(low, ...spreads.map((s) => s.p1));
      const most = Math.max(high, ...spreads.map((s) => s.p99));
      const room = state.quantity === "class" ? 0 : 0.06 * (most - least);
      const bounded = !state.isDifference() && ["shape_index", "coverage", "confidence", "class"].includes(state.quantity);
      this.domain = bounded ? [low, high] : [least - room, most + room];
      const isClass = state.quantity === "class";
      this.counts = state.values.map((values) => bins(values, ...this.domain, isClass ? 5 : 96));
      this.handles.forEach((handle) => (handle.hidden = isClass));
    }
    this.picked = state.selection === null ? null : state.values.map((values, m) => bins(values, ...this.domain, this.counts[0].length, state.marks[m]));
    this.draw();
  }

  paint(context, box) {
    const { state, domain, counts, picked } = this;
    const rgba = state.colors();
    const isClass = state.quantity === "class";
    const size = counts[0].length;
    const [low, high] = state.range;
    const top = Math.max(1, ...counts.flatMap((c) => [...c]));
    const level = (n) => (this.log ? Math.log1p(n) / Math.log1p(top) : n / top) * (box.height - 2);
    const width = box.width / size;
    const color = (share) => {
      const i = 4 * (isClass ? 51 * Math.floor(share * 5) + 25 : Math.round(254 * Math.max(0, Math.min(1, share))));
      return `rgb(${rgba[i]} ${rgba[i + 1]} ${rgba[i + 2]})`;
    };
    const outline = new Path2D();
    counts.forEach((count, m) => {
      for (let i = 0; i < size; i++) {
        const value = domain[0] + ((i + 0.5) / size) * (domain[1] - domain[0]);
        const [x, y] = [box.x + i * width, box.y + box.height - level(count[i])];
        if (m === 0) {
          context.globalAlpha = picked ? 0.3 : 1;
          context.fillStyle = color(isClass ? (i + 0.5) / 5 : (value - low) / (high - low));
          context.fillRect(x + (isClass ? 2 : 0.5), y, width - (isClass ? 4 : 0.5), box.y + box.height - y);
          context.globalAlpha = 1;
        } else {
          // The second mesh as a line over the first.
          outline.lineTo(x, y);
          outline.lineTo(x + width, y);
        }
        if (picked) {
          const above = level(picked[m][i]);
          context.fillStyle = themed("--accent");
          context.fillRect(x + 0.5, box.y + box.height - above, width - 0.5, above);
        }
      }
    });
    context.strokeStyle = themed("--ink");
    context.stroke(outline);
    const bar = box.y + box.height + 3;
    for (let x = 0; x < box.width; x++) {
      const value = domain[0] + (x / box.width) * (domain[1] - domain[0]);
      context.fillStyle = color(isClass ? Math.min(0.999, x / box.width) : (value - low) / (high - low));
      context.fillRect(box.x + x, bar, 1.5, 8);
    }
    if (isClass) this.axisOfClasses(context, box, bar + 12);
    else this.axis(context, box, domain, bar + 13);
    const at = (value) => (100 * (value - domain[0])) / (domain[1] - domain[0]);
    this.handles.forEach((handle, i) => {
      const share = Math.max(0, Math.min(100, at(state.range[i])));
      handle.style.left = `${box.x + (box.width * share) / 100}px`;
      handle.setAttribute("aria-valuenow", state.range[i]);
      handle.setAttribute("aria-valuetext", short(state.range[i]));
      handle.setAttribute("aria-valuemin", Math.min(domain[0], state.range[0]));
      handle.setAttribute("aria-valuemax", Math.max(domain[1], state.range[1]));
    });
  }

  axis(context, box, [low, high], y) {
    context.fillStyle = themed("--muted");
    context.textBaseline = "top";
    context.textAlign = "center";
    for (const mark of ticks(low, high, Math.max(2, box.width / 80))) {
      context.fillText(short(mark, 3), box.x + ((mark - low) / (high - low)) * box.width, y);
    }
    const { name, dimension } = this.state.definition();
    const unit = unitOf(dimension, this.state.models[0].facts.unit);
    context.textAlign = "right";
    context.fillText(unit ? `${symbol(name)}, ${unit}` : symbol(name), box.x + box.width, 0);
  }

  axisOfClasses(context, box, y) {
    context.fillStyle = themed("--muted");
    context.textBaseline = "top";
    context.textAlign = "center";
    const names = this.state.facts.classes.filter(({ code }) => code >= 0);
    names.forEach(({ name }, i) => context.fillText(name, box.x + ((i + 0.5) / names.length) * box.width, y));
  }

  handle(end, i) {
    const element = h("div", { class: "handle", role: "slider", tabindex: 0, "data-end": end, "aria-label": `${end === "low" ? "Lower" : "Upper"} end of the range` });
    const set = (value) => {
      const range = [...this.state.range];
      range[i] = value;
      this.state.setRange(...range);
    };
    element.addEventListener("pointerdown", (event) => {
      event.stopPropagation();
      element.setPointerCapture(event.pointerId);
    });
    element.addEventListener("pointermove", (event) => {
      if (!element.hasPointerCapture(event.pointerId)) return;
      const [x] = this.point(event);
      set(this.domain[0] + Math.max(0, Math.min(1, x)) * (this.domain[1] - this.domain[0]));
    });
    element.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 }[event.key];
      if (!step) return;
      event.preventDefault();
      set(this.state.range[i] + (step * (this.domain[1] - this.domain[0])) / 100);
    });
    return element;
  }

  // Dragging across the histogram selects the faces of its bars.
  brushed([x0], [x1], add) {
    const [low, high] = this.domain;
    const [from, to] = [x0, x1].map((x) => low + x * (high - low));
    const { values } = this.state;
    // A bar at the border of the plot holds all that lies beyond it.
    const [least, most] = [x0 <= 0 ? -Infinity : from, x1 >= 1 ? Infinity : to];
    if (this.state.quantity === "class") {
      const [a, b] = [Math.floor(x0 * 5), Math.min(4, Math.floor(x1 * 5))];
      const names = this.state.facts.classes.filter(({ code }) => code >= a && code <= b).map(({ name }) => name);
      this.state.select(names.join(", "), (m, f) => values[m][f] >= a && values[m][f] <= b, add);
      return;
    }
    this.state.select(`${symbol(this.state.quantity)} from ${short(from, 3)} to ${short(to, 3)}`, (m, f) => values[m][f] >= least && values[m][f] <= most, add, { [this.state.quantity]: [least, most] });
  }
}
