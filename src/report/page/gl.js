// A little of WebGL2: programs whose uniforms are found once, and textures that hold one texel per item.

export function program(gl, vertex, fragment) {
  const source = (id) => document.getElementById(id).textContent;
  const linked = gl.createProgram();
  for (const [kind, id] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source(id));
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`${id}: ${gl.getShaderInfoLog(shader)}`);
    gl.attachShader(linked, shader);
  }
  gl.linkProgram(linked);
  if (!gl.getProgramParameter(linked, gl.LINK_STATUS)) throw new Error(`${vertex}: ${gl.getProgramInfoLog(linked)}`);
  const at = {};
  for (let i = 0; i < gl.getProgramParameter(linked, gl.ACTIVE_UNIFORMS); i++) {
    const { name } = gl.getActiveUniform(linked, i);
    at[name.replace("[0]", "")] = gl.getUniformLocation(linked, name);
  }
  return { linked, at };
}

// Texels in a row; every device has textures as wide as this.
export const ROW = 2048;

// Internal format, format, type and numbers per texel.
const KINDS = {
  float: (gl) => [gl.R32F, gl.RED, gl.FLOAT, 1],
  float3: (gl) => [gl.RGB32F, gl.RGB, gl.FLOAT, 3],
  uint3: (gl) => [gl.RGB32UI, gl.RGB_INTEGER, gl.UNSIGNED_INT, 3],
  byte: (gl) => [gl.R8UI, gl.RED_INTEGER, gl.UNSIGNED_BYTE, 1],
};

export class Table {
  constructor(gl, kind, count) {
    const [internal, format, type, components] = KINDS[kind](gl);
    Object.assign(this, { gl, format, type, components, count });
    const rows = Math.max(1, Math.ceil(count / ROW));
    if (rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) {
      throw new Error("this device's graphics cannot hold so many faces; make the report with a smaller --max-faces");
    }
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, internal, ROW, rows);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
  }

  // Whole rows, then what is left over: nothing is copied.
  set(data) {
    const { gl, components, format, type, count } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const rows = Math.floor(count / ROW);
    if (rows > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, rows, format, type, data, 0);
    const rest = count - rows * ROW;
    if (rest > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, rows, rest, 1, format, type, data, rows * ROW * components);
    return this;
  }
}
