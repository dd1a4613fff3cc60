// What is shown, and who wants to know when it changes.

import { palette } from "./data.js";
import { automatic, fill, spread, title, valueAt } from "./quantities.js";

export class State {
  constructor(facts, models) {
    Object.assign(this, { facts, models });
    this.definitions = facts.quantities.filter(
      ({ name }) => name !== "gauss_perimeter" || models.every((model) => model.gauss_perimeter),
    );
    this.listeners = {};
    // One array for the shown quantity of each mesh, filled anew when it changes.
    this.values = models.map((model) => new Float32Array(model.faces));
    this.marks = models.map((model) => new Uint8Array(model.faces));
    this.spreads = new Map();
    this.subtracts = false;
    this.selected = models.map(() => 0);
    this.selection = null;
    this.pointed = { model: -1, face: -1 };
    this.chosen = { model: -1, face: -1 };
    this.look = {
      shading: "smooth",
      wire: false,
      showBeyond: false,
      strokes: "none",
      edges: { 1: true, 2: true, 3: true },
    };
    this.show(facts.start.quantity, facts.start.map, facts.start.range);
  }

  on(event, listener) {
    (this.listeners[event] ??= []).push(listener);
  }

  emit(event) {
    for (const listener of this.listeners[event] ?? []) listener();
  }

  definition(name = this.quantity) {
    const definition = this.definitions.find((known) => known.name === name);
    return this.isDifference() ? { ...definition, signed: true, map: "blue-red" } : definition;
  }

  // Two meshes with the same faces can be subtracted.
  get canSubtract() {
    const [a, b] = this.models;
    return b !== undefined && a.faces === b.faces && !a.numbers && !b.numbers && a.corners.every((v, c) => v === b.corners[c]);
  }

  isDifference() {
    return this.subtracts && this.quantity !== "class";
  }

  title() {
    return this.isDifference() ? `${title(this.quantity)}, B − A` : title(this.quantity);
  }

  // The values of the shown quantity, or those of B less those of A for both.
  fill(name, m, out) {
    fill(this.models[this.subtracts && name !== "class" ? 1 : m], name, out);
    if (!this.subtracts || name === "class") return out;
    for (let f = 0; f < out.length; f++) out[f] -= valueAt(this.models[0], name, f);
    return out;
  }

  // The spread of a quantity in each mesh, worked out once.
  spreadOf(name) {
    return this.known(name, (m, out) => fill(this.models[m], name, out));
  }

  // The spread of what is shown.
  shownSpread() {
    if (!this.isDifference()) return this.spreadOf(this.quantity);
    return this.known(this.title(), (m, out) => this.fill(this.quantity, m, out));
  }

  known(key, values) {
    if (!this.spreads.has(key)) {
      this.spreads.set(key, this.models.map((model, m) => spread(values(m, new Float32Array(model.faces)))));
    }
    return this.spreads.get(key);
  }

  automaticRange() {
    return automatic(this.definition(), this.shownSpread(), this.isDifference());
  }

  subtract(on) {
    this.subtracts = on;
    this.show(this.quantity);
  }

  show(name, map, range) {
    this.quantity = this.definitions.some((known) => known.name === name) ? name : "mean";
    this.models.forEach((_, m) => this.fill(this.quantity, m, this.values[m]));
    this.map = map ?? this.definition().map;
    this.range = range ?? this.automaticRange();
    this.emit("quantity");
  }

  setMap(map) {
    this.map = map;
    this.emit("range");
  }

  setRange(low, high) {
    if (!(low < high)) return;
    this.range = [low, high];
    this.emit("range");
  }

  colors() {
    return palette(this.facts.palettes[this.map]);
  }

  // Selects the faces for which `test` holds; with `add`, besides those selected before. `bounds`: the least and
  // the greatest value of each quantity, where these decide.
  select(what, test, add = false, bounds = null) {
    this.models.forEach((model, m) => {
      const marks = this.marks[m];
      let size = 0;
      for (let f = 0; f < marks.length; f++) {
        marks[f] = (add && marks[f]) || test(m, f) ? 1 : 0;
        size += marks[f];
      }
      this.selected[m] = size;
    });
    this.selection = add && this.selection ? `${this.selection}, ${what}` : what;
    this.bounds = bounds;
    this.emit("selection");
  }

  deselect() {
    if (this.selection === null) return;
    for (const marks of this.marks) marks.fill(0);
    this.selected.fill(0);
    this.selection = null;
    this.emit("selection");
  }

  point(place) {
    const { model, face } = place ?? { model: -1, face: -1 };
    if (model === this.pointed.model && face === this.pointed.face) return;
    this.pointed = { model, face };
    this.emit("face");
  }

  choose(place) {
    this.chosen = place ?? { model: -1, face: -1 };
    this.emit("face");
  }
}
