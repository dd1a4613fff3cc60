// How the mesh is drawn.

import { choice, section, toggle, h } from "./elements.js";

export function looksSection(state, camera, fit, redraw) {
  const { look } = state;
  const change = (action) => (value) => {
    action(value);
    redraw();
  };
  const counts = state.models.map(({ facts }) => facts.inspection.edges);
  const total = (kind) => counts.reduce((sum, edges) => sum + edges[kind], 0);
  const kinds = [[1, "boundary", "Boundary"], [2, "feature", "Feature"], [3, "non_manifold", "Non-manifold"]];
  // So many that they would hide the surface begin hidden.
  const faces = state.models.reduce((sum, model) => sum + model.faces, 0);
  look.edges[2] = total("feature") < Math.max(5000, 0.08 * faces);
  const edges = kinds
    .filter(([, kind]) => total(kind) > 0)
    .map(([code, , label]) => toggle(label, look.edges[code], change((on) => (look.edges[code] = on)), `var(--edge-${code})`));
  return section(
    "View",
    choice("Surface", [["smooth", "smooth"], ["flat", "flat"], ["unlit", "unlit"]], look.shading, change((v) => (look.shading = v))),
    choice("Directions", [["none", "none"], ["max", "k_max"], ["min", "k_min"], ["both", "both"]], look.strokes, change((v) => (look.strokes = v))),
    choice("Projection", [["perspective", "perspective"], ["parallel", "parallel"]], "perspective", change((v) => {
      camera.parallel = v === "parallel";
      camera.version++;
    })),
    h("fieldset", { class: "choice" }, h("legend", {}, "Lines"), h("div", { class: "toggles" },
      toggle("Wireframe", look.wire, change((on) => (look.wire = on))),
      edges,
      toggle("Hatch values beyond the range", look.showBeyond, change((on) => (look.showBeyond = on))),
    )),
  );
}
