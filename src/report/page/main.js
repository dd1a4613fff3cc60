// Puts the page together: reads the data, makes the view and the sections, and draws when something has changed.

import { Camera } from "./camera.js";
import { load } from "./data.js";
import { channels, h, name, themed } from "./elements.js";
import { save, saveCsv } from "./export.js";
import { faceSection } from "./face.js";
import { count, percent, short, unitOf } from "./format.js";
import { center, normal, prepare } from "./geometry.js";
import { Input } from "./input.js";
import { looksSection } from "./looks.js";
import { dot } from "./matrix.js";
import { planesSection } from "./planes.js";
import { histogramSection } from "./plots.js";
import { scaleSection } from "./scale.js";
import { State } from "./state.js";
import { tables } from "./tables.js";
import { View } from "./view.js";

const byId = (id) => document.getElementById(id);
const isCalm = matchMedia("(prefers-reduced-motion: reduce)");

async function main() {
  const facts = JSON.parse(byId("facts").textContent);
  const models = (await load(facts)).map(prepare);
  const state = new State(facts, models);
  const view = new View(byId("view"), models);
  const camera = new Camera(facts.models[0].up);
  const stage = byId("stage");

  let isDirty = false;
  const look = lookOf(state);
  const draw = () => view.draw(camera, look);
  const redraw = () => {
    if (isDirty) return;
    isDirty = true;
    requestAnimationFrame(() => {
      isDirty = false;
      draw();
    });
  };
  const refresh = () => {
    Object.assign(look, lookOf(state));
    redraw();
  };

  // Moves the camera there; at once where motion is not wanted.
  let flight = 0;
  const move = (to) => {
    const from = { target: [...camera.target], distance: camera.distance, yaw: camera.yaw, pitch: camera.pitch };
    const goal = { ...from, ...to };
    goal.yaw = from.yaw + Math.atan2(Math.sin(goal.yaw - from.yaw), Math.cos(goal.yaw - from.yaw));
    const mine = ++flight;
    const begin = performance.now();
    const step = (now) => {
      if (mine !== flight) return;
      const t = isCalm.matches ? 1 : Math.min(1, Math.max(0, now - begin) / 380);
      const s = t * t * (3 - 2 * t);
      camera.target = from.target.map((c, i) => c + (goal.target[i] - c) * s);
      camera.distance = from.distance * (goal.distance / from.distance) ** s;
      camera.yaw = from.yaw + (goal.yaw - from.yaw) * s;
      camera.pitch = from.pitch + (goal.pitch - from.pitch) * s;
      camera.basis();
      draw();
      if (t < 1) requestAnimationFrame(step);
    };
    step(isCalm.matches ? Infinity : begin);
  };
  const shape = () => {
    const { width, height } = view.panes[0];
    return [width / height, Math.min(0.2, (56 * view.ratio) / height)];
  };
  const fit = (which) => {
    const [yaw, pitch] = which === "fit" ? [camera.yaw, camera.pitch] : camera.look(which);
    const probe = new Camera(camera.axis);
    Object.assign(probe, { yaw, pitch, parallel: camera.parallel });
    probe.basis();
    move({ yaw, pitch, ...probe.fit(models, ...shape()) });
  };
  // Goes to a face; with `turn`, until it is seen from the front.
  const fly = ({ model: m, face }, turn = true) => {
    const model = models[m];
    const span = Math.max(6 * model.scale * (model.radius[face] || 0), 0.06 * view.reach);
    const goal = { target: center(model, face), distance: Math.min(camera.distance, Math.max(3 * span, 0.05 * view.reach)) };
    if (turn) {
      const [a, b, up] = camera.level;
      let n = normal(model, face);
      // The side that is seen stays the one that is seen.
      if (model.facts.inspection.closed === false && dot(n, camera.back) < 0) n = n.map((c) => -c);
      goal.yaw = Math.atan2(dot(n, b), dot(n, a));
      goal.pitch = Math.asin(Math.max(-1, Math.min(1, dot(n, up)))) * 0.9;
    }
    move(goal);
  };

  header(state, models);
  const panel = byId("panel");
  panel.append(
    scaleSection(state),
    faceSection(state, view, fly, refresh),
    looksSection(state, camera, fit, refresh),
    planesSection(state),
    histogramSection(state),
    ...tables(state, fly),
  );
  const input = new Input(stage, { camera, view, state, fit, look: fly, redraw, lookNow: () => look });
  tools(stage, state, input, fit, () => save(state, view, draw));
  legend(state);

  state.on("quantity", () => {
    models.forEach((_, m) => view.setValues(m, state.values[m]));
    view.setPalette(state.colors());
    refresh();
  });
  state.on("range", () => {
    view.setPalette(state.colors());
    refresh();
  });
  state.on("selection", () => {
    models.forEach((_, m) => view.setMarks(m, state.marks[m]));
    refresh();
  });
  state.on("theme", refresh);
  view.canvas.addEventListener("webglcontextlost", () => say("The graphics driver has let go of the view; reload the page to see it again."));
  new ResizeObserver(() => {
    view.layout(stage.clientWidth, stage.clientHeight, Math.min(2, window.devicePixelRatio || 1));
    camera.version++;
    draw();
  }).observe(stage);

  view.layout(stage.clientWidth, stage.clientHeight, Math.min(2, window.devicePixelRatio || 1));
  state.emit("quantity");
  Object.assign(camera, camera.fit(models, ...shape()));
  refresh();
  document.body.dataset.ready = "true";
  // For those who look closer in the browser's console, and for tests.
  window.osculate = { state, view, camera, draw, look, fit };
}

// The look as the renderer takes it.
function lookOf(state) {
  const ink = (variable, shown) => [...channels(themed(variable)), shown ? 1 : 0];
  const { edges, ...rest } = state.look;
  return {
    ...rest,
    range: state.range,
    isClass: state.quantity === "class",
    isSelecting: state.selection !== null,
    pointed: state.pointed,
    chosen: state.chosen,
    paper: channels(themed("--stage")),
    accent: channels(themed("--accent")),
    ink: [...channels(themed("--stroke")), 0.9],
    edges: Float32Array.from([0, 0, 0, 0, ...[1, 2, 3].flatMap((kind) => ink(`--edge-${kind}`, edges[kind]))]),
  };
}

function header(state, models) {
  const names = models.map(({ facts }, m) => [models.length > 1 ? h("i", { class: "letter" }, "AB"[m]) : null, name(facts.name)]);
  byId("title").replaceChildren(...names.flatMap((n, i) => (i > 0 ? [" ", ...n] : n)).filter(Boolean));
  const [{ facts }] = models;
  const estimator = models.map((m) => m.facts.settings.estimator).filter((e, i, all) => all.indexOf(e) === i).join(" and ");
  byId("subtitle").textContent = `Curvature of ${models.map((m) => count(m.facts.inspection.faces)).join(" and ")} faces, estimator ${estimator}, Osculate ${state.facts.version}`;
  document.title = `${models.map((m) => m.facts.name).join(" and ")} - curvature`;
  const sentences = models.flatMap((m) => m.facts.sentences);
  if (models.some((m) => m.facts.unit !== models[0].facts.unit)) {
    sentences.push("The two files are in different units; their numbers are compared as they are.");
  }
  byId("sentences").append(...sentences.map((sentence) => h("p", {}, sentence)));
  byId("sentences").hidden = sentences.length === 0;
  const theme = byId("theme");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  // What the system asks for, until somebody chooses.
  let chosen = null;
  const show = () => {
    const isDark = chosen ?? dark.matches;
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    theme.textContent = isDark ? "Light" : "Dark";
  };
  const change = () => {
    show();
    state.emit("theme");
  };
  theme.addEventListener("click", () => {
    chosen = !(chosen ?? dark.matches);
    change();
  });
  dark.addEventListener("change", change);
  show();
}

function tools(stage, state, input, fit, savePicture) {
  stage.classList.toggle("pair", state.models.length > 1);
  for (const button of stage.querySelectorAll("[data-view]")) button.addEventListener("click", () => fit(button.dataset.view));
  const brush = byId("brush");
  brush.addEventListener("click", () => {
    input.selecting = !input.selecting;
    brush.setAttribute("aria-pressed", input.selecting);
    stage.classList.toggle("selecting", input.selecting);
  });
  byId("save").addEventListener("click", savePicture);
  const bar = byId("selection");
  byId("csv").addEventListener("click", () => saveCsv(state));
  byId("clear").addEventListener("click", () => state.deselect());
  state.on("selection", () => {
    bar.hidden = state.selection === null;
    if (bar.hidden) return;
    const faces = state.selected.reduce((sum, n) => sum + n, 0);
    const all = state.models.reduce((sum, model) => sum + model.faces, 0);
    byId("selected").textContent = `${count(faces)} faces (${percent(faces / all)})`;
    byId("selected").dataset.count = faces;
    byId("criterion").textContent = state.selection;
  });
}

// The colour scale in the corner of the view.
function legend(state) {
  const bar = byId("legend-bar");
  const refresh = () => {
    const unit = unitOf(state.definition().dimension, state.models[0].facts.unit);
    byId("legend-title").textContent = `${state.title()}${unit ? `, ${unit}` : ""}`;
    const rgba = state.colors();
    const color = (i) => `rgb(${rgba[4 * i]} ${rgba[4 * i + 1]} ${rgba[4 * i + 2]})`;
    const isClass = state.quantity === "class";
    const names = state.facts.classes.filter(({ code }) => code >= 0);
    const stops = isClass
      ? names.map(({ index }, i) => `${color(index)} ${20 * i}% ${20 * (i + 1)}%`)
      : Array.from({ length: 33 }, (_, i) => color(Math.round((254 * i) / 32)));
    bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    const [low, high] = state.range;
    const labels = isClass ? names.map((c) => c.name) : [low, (low + high) / 2, high].map((v) => short(v, 3));
    byId("legend-labels").replaceChildren(...labels.map((text) => h("span", {}, text)));
    byId("legend").classList.toggle("classes", isClass);
  };
  state.on("quantity", refresh);
  state.on("range", refresh);
  refresh();
}

function say(text) {
  byId("message").hidden = false;
  byId("message").textContent = text;
}

main().catch((error) => {
  say(`The report cannot be shown: ${error.message}`);
  console.error(error);
}).finally(() => {
  byId("loading").hidden = true;
});
