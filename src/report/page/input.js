// Mouse, touch and keys: turning, moving, zooming, pointing, and dragging a rectangle to select.

const CLICK = 4;
const TURN = 0.006;

export class Input {
  constructor(stage, { camera, view, state, fit, look, redraw, lookNow }) {
    Object.assign(this, { stage, canvas: view.canvas, camera, view, state, fit, look, redraw, lookNow });
    this.pointers = new Map();
    this.selecting = false;
    this.frame = stage.querySelector("#rubber");
    const on = (name, action) => this.canvas.addEventListener(name, action, { passive: false });
    on("pointerdown", (event) => this.down(event));
    on("pointermove", (event) => this.move(event));
    on("pointerup", (event) => this.up(event));
    on("pointercancel", (event) => this.up(event, true));
    on("pointerleave", () => this.pointers.size === 0 && this.hover(null));
    on("wheel", (event) => this.wheel(event));
    on("contextmenu", (event) => event.preventDefault());
    on("dblclick", (event) => this.center(event));
    on("keydown", (event) => this.key(event));
  }

  // Pixels of the canvas from the left and the bottom.
  pixel(event) {
    const box = this.canvas.getBoundingClientRect();
    const { ratio } = this.view;
    return [Math.floor((event.clientX - box.left) * ratio), Math.floor((box.bottom - event.clientY) * ratio)];
  }

  paneHeight() {
    return this.view.panes[0].height / this.view.ratio;
  }

  down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const { clientX: x, clientY: y } = event;
    this.pointers.set(event.pointerId, { x, y });
    this.start = this.pointers.size === 1 ? { x, y, moved: false } : { moved: true };
    this.brush = this.pointers.size === 1 && event.button === 0 && (this.selecting || event.altKey) ? { x, y } : null;
    this.panning = event.button === 1 || event.button === 2 || event.shiftKey || event.ctrlKey;
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") this.hover(event);
      return;
    }
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    if (Math.hypot(event.clientX - this.start.x, event.clientY - this.start.y) > CLICK) this.start.moved = true;
    if (!this.start.moved) return;
    const height = this.paneHeight();
    if (this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
      const gap = (p) => Math.hypot(p.x - other.x, p.y - other.y) || 1;
      const [x, y] = this.fromMiddle((event.clientX + other.x) / 2, (event.clientY + other.y) / 2);
      this.camera.zoom(gap(before) / gap({ x: event.clientX, y: event.clientY }), x, y, this.view.reach);
      this.camera.pan(dx / 2 / height, dy / 2 / height);
    } else if (this.brush) {
      this.showFrame(event);
    } else if (this.panning) {
      this.camera.pan(dx / height, dy / height);
    } else {
      this.camera.rotate(TURN * dx, TURN * dy);
    }
    before.x = event.clientX;
    before.y = event.clientY;
    this.redraw();
  }

  up(event, cancelled = false) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (cancelled) this.brush = null;
    if (this.brush && this.start.moved) this.selectFrame(event);
    else if (!this.start.moved && !cancelled && event.button === 0) this.tap(event);
    this.brush = null;
    this.frame.hidden = true;
    if (this.pointers.size === 1) this.start = { moved: true };
  }

  fromMiddle(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const { ratio, panes } = this.view;
    const [x, y] = [(clientX - box.left) * ratio, (box.bottom - clientY) * ratio];
    const pane = panes[this.view.paneAt(x, y)];
    return [(x - pane.x - pane.width / 2) / pane.height, (pane.y + pane.height / 2 - y) / pane.height];
  }

  wheel(event) {
    event.preventDefault();
    const [x, y] = this.fromMiddle(event.clientX, event.clientY);
    const steps = event.deltaMode === 0 ? event.deltaY / 100 : event.deltaY / 3;
    this.camera.zoom(1.12 ** Math.max(-5, Math.min(5, steps)), x, y, this.view.reach);
    this.redraw();
  }

  // Looks at most once a frame, and only while the picture stands still.
  hover(event) {
    this.wanted = event;
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      if (this.pointers.size > 0) return;
      this.state.point(this.wanted && this.view.faceAt(this.camera, this.lookNow(), ...this.pixel(this.wanted)));
    });
  }

  tap(event) {
    const place = this.view.faceAt(this.camera, this.lookNow(), ...this.pixel(event));
    this.state.choose(place);
  }

  center(event) {
    const place = this.view.faceAt(this.camera, this.lookNow(), ...this.pixel(event));
    if (place) this.look(place, false);
  }

  showFrame(event) {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX, event.clientY];
    const { style } = this.frame;
    style.left = `${Math.min(x, this.brush.x) - box.left}px`;
    style.top = `${Math.min(y, this.brush.y) - box.top}px`;
    style.width = `${Math.abs(x - this.brush.x)}px`;
    style.height = `${Math.abs(y - this.brush.y)}px`;
    this.frame.hidden = false;
  }

  // Selects the faces seen inside the rectangle.
  selectFrame(event) {
    const from = this.pixel({ clientX: this.brush.x, clientY: this.brush.y });
    const to = this.pixel(event);
    const { canvas, view } = this;
    const clamp = (value, most) => Math.max(0, Math.min(most - 1, value));
    const [x0, x1] = [from[0], to[0]].map((x) => clamp(x, canvas.width)).sort((a, b) => a - b);
    const [y0, y1] = [from[1], to[1]].map((y) => clamp(y, canvas.height)).sort((a, b) => a - b);
    const [width, height] = [x1 - x0 + 1, y1 - y0 + 1];
    const seen = view.facesIn(this.camera, this.lookNow(), x0, y0, width, height);
    const found = view.models.map(() => new Set());
    for (let i = 0; i < width * height; i++) {
      if (seen[4 * i] > 0) found[view.paneAt(x0 + (i % width), y0 + Math.floor(i / width))].add(seen[4 * i] - 1);
    }
    this.state.select("seen in a rectangle", (m, f) => found[m].has(f), event.shiftKey);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { camera } = this;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = arrows[event.key];
    if (step) {
      if (event.shiftKey) camera.pan(-step[0] * 0.05, -step[1] * 0.05);
      else camera.rotate(step[0] * 0.1, step[1] * 0.1);
    } else if (event.key === "+" || event.key === "=") camera.zoom(1 / 1.2, 0, 0, this.view.reach);
    else if (event.key === "-") camera.zoom(1.2, 0, 0, this.view.reach);
    else if (event.key === "Escape") {
      this.state.deselect();
      this.state.choose(null);
    } else {
      const view = { f: "fit", i: "iso", x: "x", y: "y", z: "z" }[event.key.toLowerCase()];
      if (!view) return;
      this.fit(view);
    }
    event.preventDefault();
    this.redraw();
  }
}
