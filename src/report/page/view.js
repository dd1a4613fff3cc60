// Draws the meshes: a handful of calls a frame, nothing sent or allocated while the camera moves.

import { HALF_OPENING } from "./camera.js";
import { cornerNormals, drawnEdges } from "./geometry.js";
import { program, Table } from "./gl.js";
import { MOST_STROKES, strokes } from "./strokes.js";

// Strokes lie about so many pixels apart.
const STROKE_SPACING = 17;
const SHADINGS = ["smooth", "flat", "unlit"];

export class View {
  constructor(canvas, models) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: false });
    if (!gl) throw new Error("this browser has no WebGL2, which the 3D view needs");
    Object.assign(this, { canvas, gl, models });
    this.programs = {
      mesh: program(gl, "mesh.vert", "mesh.frag"),
      number: program(gl, "mesh.vert", "number.frag"),
      edges: program(gl, "edges.vert", "line.frag"),
      strokes: program(gl, "strokes.vert", "line.frag"),
    };
    this.empty = gl.createVertexArray();
    this.palette = gl.createTexture();
    this.parts = models.map((model) => this.upload(model));
    this.panes = models.map(() => ({ x: 0, y: 0, width: 1, height: 1 }));
    this.reach = Math.max(...models.map((model) => model.size));
    this.numbers = { version: -1 };
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  upload(model) {
    const { gl } = this;
    const { ends, kinds } = drawnEdges(model);
    return {
      count: 3 * model.faces,
      area: model.area,
      corners: new Table(gl, "uint3", model.faces).set(model.corners),
      positions: new Table(gl, "float3", model.positions.length / 3).set(model.positions),
      normals: new Table(gl, "uint3", model.faces).set(cornerNormals(model, model.vectors)),
      values: new Table(gl, "float", model.faces),
      marks: new Table(gl, "byte", model.faces),
      edges: { size: kinds.length, array: this.instances([[ends, 2], [kinds, 1]]) },
      strokes: null,
      disk: [],
    };
  }

  // A vertex array whose attributes go on with every instance.
  instances(columns) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    columns.forEach(([data, size], location) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribIPointer(location, size, data instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.UNSIGNED_INT, 0, 0);
      gl.vertexAttribDivisor(location, 1);
    });
    gl.bindVertexArray(null);
    return array;
  }

  // The same for centre, direction and normal.
  segments(data) {
    const { gl } = this;
    const array = gl.createVertexArray();
    const buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    for (let location = 0; location < 3; location++) {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 36, 12 * location);
      gl.vertexAttribDivisor(location, 1);
    }
    gl.bindVertexArray(null);
    return { array, buffer, size: data.length / 9 };
  }

  setPalette(rgba) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
  }

  setValues(m, values) {
    this.parts[m].values.set(values);
  }

  setMarks(m, marks) {
    this.parts[m].marks.set(marks);
  }

  // The chains of a disk, each with its colour; none to show none.
  setDisk(m, chains) {
    const { gl } = this;
    const part = this.parts[m];
    for (const { array, buffer } of part.disk) {
      gl.deleteVertexArray(array);
      gl.deleteBuffer(buffer);
    }
    part.disk = chains.map(({ points, color, width }) => {
      const data = new Float32Array(9 * Math.max(0, points.length - 1));
      for (let i = 0; i + 1 < points.length; i++) {
        for (let axis = 0; axis < 3; axis++) {
          data[9 * i + axis] = (points[i][axis] + points[i + 1][axis]) / 2;
          data[9 * i + 3 + axis] = (points[i + 1][axis] - points[i][axis]) / 2;
        }
      }
      return { ...this.segments(data), color, width };
    });
  }

  // Divides the canvas among the meshes, side by side or above one another.
  layout(width, height, ratio) {
    const { canvas, panes } = this;
    const [w, h] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    this.ratio = ratio;
    const beside = w >= h;
    panes.forEach((pane, m) => {
      pane.width = beside ? Math.floor(w / panes.length) : w;
      pane.height = beside ? h : Math.floor(h / panes.length);
      pane.x = beside ? m * pane.width : 0;
      pane.y = beside ? 0 : (panes.length - 1 - m) * pane.height;
    });
    this.numbers.version = -1;
  }

  draw(camera, look) {
    const { gl, panes, parts, programs } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(look.paper[0], look.paper[1], look.paper[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (let m = 0; m < parts.length; m++) {
      const pane = panes[m];
      camera.update(pane.width / pane.height, this.reach);
      gl.viewport(pane.x, pane.y, pane.width, pane.height);
      this.drawMesh(programs.mesh, parts[m], camera, look, m);
      gl.enable(gl.BLEND);
      this.drawEdges(parts[m], pane, camera, look);
      this.drawStrokes(m, pane, camera, look);
      this.drawDisk(parts[m], pane, camera);
      gl.disable(gl.BLEND);
    }
  }

  drawMesh({ linked, at }, part, camera, look, m) {
    const { gl } = this;
    gl.useProgram(linked);
    gl.bindVertexArray(this.empty);
    this.bind(0, part.corners.texture, at.corners);
    this.bind(1, part.positions.texture, at.positions);
    this.bind(2, part.normals.texture, at.normals);
    this.bind(3, part.values.texture, at.values);
    this.bind(4, part.marks.texture, at.marks);
    this.bind(5, this.palette, at.palette);
    gl.uniformMatrix4fv(at.clip, false, camera.clip);
    gl.uniformMatrix3fv(at.turn, false, camera.turn);
    gl.uniform2f(at.range, look.range[0], look.range[1]);
    gl.uniform1i(at.isClass, look.isClass);
    gl.uniform1i(at.shading, SHADINGS.indexOf(look.shading));
    gl.uniform1f(at.wire, look.wire ? 0.55 : 0);
    gl.uniform1i(at.showBeyond, look.showBeyond);
    gl.uniform1i(at.isSelecting, look.isSelecting);
    gl.uniform1ui(at.pointed, look.pointed.model === m ? look.pointed.face + 1 : 0);
    gl.uniform1ui(at.chosen, look.chosen.model === m ? look.chosen.face + 1 : 0);
    gl.uniform3fv(at.paper, look.paper);
    gl.uniform3fv(at.accent, look.accent);
    gl.drawArrays(gl.TRIANGLES, 0, part.count);
  }

  bind(unit, texture, location) {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(location, unit);
  }

  drawEdges(part, pane, camera, look) {
    if (part.edges.size === 0) return;
    const { gl } = this;
    const { linked, at } = this.programs.edges;
    gl.useProgram(linked);
    this.bind(0, part.positions.texture, at.positions);
    gl.uniformMatrix4fv(at.clip, false, camera.clip);
    gl.uniform2f(at.pane, pane.width, pane.height);
    gl.uniform1f(at.width, 1.4 * this.ratio);
    gl.uniform4fv(at.colors, look.edges);
    gl.bindVertexArray(part.edges.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, part.edges.size);
  }

  lines(pane, camera) {
    const { gl } = this;
    const { linked, at } = this.programs.strokes;
    gl.useProgram(linked);
    gl.uniformMatrix4fv(at.clip, false, camera.clip);
    gl.uniform2f(at.pane, pane.width, pane.height);
    gl.uniform1f(at.pixel, (2 * Math.tan(HALF_OPENING)) / pane.height);
    return at;
  }

  // As many strokes as keep their distance on the screen, whatever the camera's.
  drawStrokes(m, pane, camera, look) {
    if (look.strokes === "none") return;
    const { gl } = this;
    const part = this.parts[m];
    if (!part.strokes) part.strokes = this.segments(strokes(this.models[m]).data);
    const spacing = STROKE_SPACING * this.ratio;
    const pixel = (2 * Math.tan(HALF_OPENING) * camera.distance) / pane.height;
    const wanted = Math.ceil(part.area / (pixel * spacing) ** 2);
    const size = Math.min(part.strokes.size, wanted, MOST_STROKES);
    const at = this.lines(pane, camera);
    gl.bindVertexArray(part.strokes.array);
    gl.uniform4fv(at.tint, look.ink);
    for (let across = 0; across < 2; across++) {
      if (look.strokes !== "both" && (look.strokes === "min") !== (across === 1)) continue;
      gl.uniform1i(at.isAcross, across);
      gl.uniform1f(at.width, (across === 1 && look.strokes === "both" ? 0.6 : 1.1) * this.ratio);
      gl.uniform1f(at.reach, (across === 1 && look.strokes === "both" ? 0.2 : 0.42) * spacing);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, size);
    }
  }

  drawDisk(part, pane, camera) {
    if (part.disk.length === 0) return;
    const { gl } = this;
    const at = this.lines(pane, camera);
    gl.uniform1f(at.reach, 0);
    gl.uniform1i(at.isAcross, 0);
    for (let i = 0; i < part.disk.length; i++) {
      const { array, size, color, width } = part.disk[i];
      gl.uniform1f(at.width, width * this.ratio);
      gl.uniform4fv(at.tint, color);
      gl.bindVertexArray(array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, size);
    }
  }

  // Draws the faces' numbers where the camera or the size has changed since they were drawn last.
  drawNumbers(camera, look) {
    const { gl, numbers, canvas } = this;
    if (numbers.version === camera.version) return;
    if (numbers.width !== canvas.width || numbers.height !== canvas.height) {
      gl.deleteFramebuffer(numbers.frame);
      gl.deleteTexture(numbers.texture);
      gl.deleteRenderbuffer(numbers.depth);
      [numbers.width, numbers.height] = [canvas.width, canvas.height];
      numbers.texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, numbers.texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R32UI, canvas.width, canvas.height);
      numbers.depth = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, numbers.depth);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, canvas.width, canvas.height);
      numbers.frame = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, numbers.frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, numbers.texture, 0);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, numbers.depth);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, numbers.frame);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    for (let m = 0; m < this.parts.length; m++) {
      const pane = this.panes[m];
      camera.update(pane.width / pane.height, this.reach);
      gl.viewport(pane.x, pane.y, pane.width, pane.height);
      this.drawMesh(this.programs.number, this.parts[m], camera, look, m);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    numbers.version = camera.version;
  }

  // The faces seen in a rectangle of the canvas (pixels from the left and the bottom): numbers from 1, 0 for none.
  facesIn(camera, look, x, y, width, height) {
    const { gl } = this;
    this.drawNumbers(camera, look);
    const seen = new Uint32Array(4 * width * height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.numbers.frame);
    gl.readPixels(x, y, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, seen);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return seen;
  }

  // The mesh whose pane a point of the canvas (from the left and the bottom) lies in.
  paneAt(x, y) {
    return Math.max(0, this.panes.findIndex((p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height));
  }

  faceAt(camera, look, x, y) {
    const inside = x >= 0 && y >= 0 && x < this.canvas.width && y < this.canvas.height;
    const number = inside ? this.facesIn(camera, look, x, y, 1, 1)[0] : 0;
    return number > 0 ? { model: this.paneAt(x, y), face: number - 1 } : null;
  }
}
