// The camera: turns around a target, the up axis stays up. Updating it allocates nothing.

export const HALF_OPENING = 0.26;
const MARGIN = 0.05;
const QUARTER = Math.PI / 2;

// Yaw and pitch of the views by name, per up axis.
const VIEWS = {
  iso: () => [-Math.PI / 4, Math.atan(0.8 / Math.SQRT2)],
  x: () => [0, 0],
  y: (up) => (up === "z" ? [QUARTER, 0] : [-QUARTER, QUARTER]),
  z: (up) => (up === "z" ? [-QUARTER, QUARTER] : [-QUARTER, 0]),
};

export class Camera {
  constructor(up) {
    this.axis = up;
    // Two level axes and the one upwards, right-handed.
    this.level = up === "z" ? [[1, 0, 0], [0, 1, 0], [0, 0, 1]] : [[1, 0, 0], [0, 0, -1], [0, 1, 0]];
    this.target = [0, 0, 0];
    this.distance = 1;
    [this.yaw, this.pitch] = VIEWS.iso(up);
    this.parallel = false;
    this.right = new Float64Array(3);
    this.up = new Float64Array(3);
    this.back = new Float64Array(3);
    this.clip = new Float32Array(16);
    this.turn = new Float32Array(9);
    this.version = 0;
    this.basis();
  }

  // The directions right, up and towards the viewer.
  basis() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const [a, b, up] = this.level;
    for (let i = 0; i < 3; i++) {
      const level = cy * a[i] + sy * b[i];
      this.back[i] = cp * level + sp * up[i];
      this.right[i] = -sy * a[i] + cy * b[i];
      this.up[i] = -sp * level + cp * up[i];
    }
    this.version++;
  }

  // The matrices for a pane of this shape; everything drawn lies within `reach` of the origin.
  update(aspect, reach) {
    const { right, up, back, clip, turn, target, distance } = this;
    const slope = Math.tan(HALF_OPENING);
    const tr = this.along(right, target);
    const tu = this.along(up, target);
    const tb = this.along(back, target);
    const off = Math.hypot(target[0], target[1], target[2]) + reach;
    const near = Math.max(distance - off, 1e-3 * distance);
    const far = distance + off;
    const sx = 1 / (slope * aspect);
    const sy = 1 / slope;
    for (let i = 0; i < 3; i++) {
      clip[4 * i] = sx * right[i];
      clip[4 * i + 1] = sy * up[i];
      if (this.parallel) {
        clip[4 * i + 2] = (-2 * distance * back[i]) / (far - near);
        clip[4 * i + 3] = 0;
      } else {
        clip[4 * i + 2] = (-(far + near) / (far - near)) * back[i];
        clip[4 * i + 3] = -back[i];
      }
      turn[3 * i] = right[i];
      turn[3 * i + 1] = up[i];
      turn[3 * i + 2] = back[i];
    }
    clip[12] = -sx * tr;
    clip[13] = -sy * tu;
    // Depth along the view: distance - (p - target) . back.
    const depth = distance + tb;
    if (this.parallel) {
      clip[14] = (distance * (2 * depth - far - near)) / (far - near);
      clip[15] = distance;
    } else {
      clip[14] = ((far + near) * depth - 2 * far * near) / (far - near);
      clip[15] = depth;
    }
  }

  along(axis, p) {
    return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
  }

  rotate(dx, dy) {
    this.yaw -= dx;
    this.pitch = Math.max(-QUARTER, Math.min(QUARTER, this.pitch + dy));
    this.basis();
  }

  // Moves the target by parts of the pane's height.
  pan(dx, dy) {
    const height = 2 * Math.tan(HALF_OPENING) * this.distance;
    for (let i = 0; i < 3; i++) this.target[i] -= height * (dx * this.right[i] - dy * this.up[i]);
    this.version++;
  }

  // Comes nearer by a factor; the point at (x, y), from the middle in parts of the height, stays where it is.
  zoom(factor, x, y, size) {
    const before = this.distance;
    this.distance = Math.max(1e-4 * size, Math.min(40 * size, before * factor));
    const moved = 2 * Math.tan(HALF_OPENING) * (before - this.distance);
    for (let i = 0; i < 3; i++) this.target[i] += moved * (x * this.right[i] - y * this.up[i]);
    this.version++;
  }

  look(name) {
    return VIEWS[name](this.axis);
  }

  // The target and the distance from which the meshes fill the pane, looked at from yaw and pitch. Of the pane's
  // height a share stays free above and below, where buttons and the legend are.
  fit(models, aspect, free = 0) {
    const { right, up, back } = this;
    const slope = Math.tan(HALF_OPENING);
    const [sx, sy] = [slope * (1 - 2 * MARGIN) * aspect, slope * (1 - 2 * Math.max(MARGIN, free))];
    // How far vertices reach beyond lines of sight: to the right, the left, above and below.
    let [r, l, a, b] = [-Infinity, -Infinity, -Infinity, -Infinity];
    for (const { positions: p } of models) {
      for (let i = 0; i < p.length; i += 3) {
        const x = p[i] * right[0] + p[i + 1] * right[1] + p[i + 2] * right[2];
        const y = p[i] * up[0] + p[i + 1] * up[1] + p[i + 2] * up[2];
        const z = this.parallel ? 0 : p[i] * back[0] + p[i + 1] * back[1] + p[i + 2] * back[2];
        r = Math.max(r, x + sx * z);
        l = Math.max(l, -x + sx * z);
        a = Math.max(a, y + sy * z);
        b = Math.max(b, -y + sy * z);
      }
    }
    const [x, y] = [(r - l) / 2, (a - b) / 2];
    const distance = Math.max((r + l) / (2 * sx), (a + b) / (2 * sy));
    const target = [0, 1, 2].map((i) => x * right[i] + y * up[i]);
    return { target, distance: distance > 0 && Number.isFinite(distance) ? distance : 1 };
  }
}
