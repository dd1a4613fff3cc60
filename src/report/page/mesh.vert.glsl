#version 300 es
// No attributes: a vertex knows its number, a face is three of them, and everything else is looked up.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;

uniform usampler2D corners;
uniform usampler2D normals;
uniform usampler2D marks;
uniform sampler2D positions;
uniform sampler2D values;
uniform mat4 clip;
uniform mat3 turn;
// The values of the first and last colour.
uniform vec2 range;
// Classes have one colour each.
uniform bool isClass;

out vec3 share;
out vec3 smoothNormal;
out vec3 place;
flat out int color;
// -1 and 1 where the value lies below and above the range.
flat out int beyond;
flat out uint mark;
flat out uint face;

const int ROW = 2048;
const int SCALE = 254;
const int NONE = 255;

ivec2 texel(uint i) {
  return ivec2(int(i) % ROW, int(i) / ROW);
}

vec3 unpacked(uint code) {
  vec2 p = vec2(float(code & 65535u), float(code >> 16)) / 32767.0 - 1.0;
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  float fold = max(-n.z, 0.0);
  n.xy += vec2(n.x < 0.0 ? fold : -fold, n.y < 0.0 ? fold : -fold);
  return n;
}

void main() {
  face = uint(gl_VertexID / 3);
  int i = gl_VertexID % 3;
  ivec2 at = texel(face);
  vec3 p = texelFetch(positions, texel(texelFetch(corners, at, 0)[i]), 0).xyz;
  float value = texelFetch(values, at, 0).x;
  float position = (value - range.x) / (range.y - range.x);
  // Some compilers take it for granted that nothing is NaN; its bits they cannot.
  bool isValue = (floatBitsToUint(value) & 0x7fffffffu) <= 0x7f800000u;
  color = !isValue ? NONE
    : isClass ? 51 * int(value) + 25
    : int(clamp(floor(position * float(SCALE) + 0.5), 0.0, float(SCALE)));
  beyond = !isValue || isClass ? 0 : value < range.x ? -1 : value > range.y ? 1 : 0;
  mark = texelFetch(marks, at, 0).x;
  share = vec3(i == 0, i == 1, i == 2);
  smoothNormal = turn * unpacked(texelFetch(normals, at, 0)[i]);
  place = turn * p;
  gl_Position = clip * vec4(p, 1.0);
}
