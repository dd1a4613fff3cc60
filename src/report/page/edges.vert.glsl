#version 300 es
// Classified edges as lines of some pixels' width: four corners for each edge.
precision highp float;
precision highp int;
precision highp sampler2D;

uniform sampler2D positions;
uniform mat4 clip;
uniform vec2 pane;
uniform float width;
uniform vec4 colors[4];

layout(location = 0) in uvec2 ends;
layout(location = 1) in uint kind;
out vec4 ink;
out float aside;

const int ROW = 2048;

vec4 projected(uint v) {
  return clip * vec4(texelFetch(positions, ivec2(int(v) % ROW, int(v) / ROW), 0).xyz, 1.0);
}

void main() {
  ink = colors[kind];
  vec4 a = projected(ends.x);
  vec4 b = projected(ends.y);
  float nearest = 1e-4 * max(abs(a.w), abs(b.w));
  if (a.w < nearest) a = mix(a, b, (nearest - a.w) / (b.w - a.w));
  if (b.w < nearest) b = mix(b, a, (nearest - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * pane;
  vec2 across = dot(along, along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(0.0);
  bool isEnd = (gl_VertexID & 1) == 1;
  aside = gl_VertexID < 2 ? -1.0 : 1.0;
  vec4 p = isEnd ? b : a;
  p.xy += across * aside * (width + 1.0) / pane * p.w;
  p.z -= 2e-3 * p.w * (1.0 - p.z / p.w);
  gl_Position = ink.a > 0.0 && a.w > 0.0 && b.w > 0.0 ? p : vec4(2.0, 2.0, 2.0, 1.0);
}
