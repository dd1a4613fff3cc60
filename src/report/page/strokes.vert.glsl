#version 300 es
// Lines through a centre: principal directions of one length on the screen, or pieces of a disk as they are.
precision highp float;
precision highp int;

uniform mat4 clip;
uniform vec2 pane;
uniform float width;
uniform vec4 tint;
// Half the length in pixels; 0 for a line that is as long as its direction.
uniform float reach;
// Length of a pixel at distance 1.
uniform float pixel;
// Turned by a right angle in the surface: the direction of k_min.
uniform bool isAcross;

layout(location = 0) in vec3 centre;
layout(location = 1) in vec3 direction;
layout(location = 2) in vec3 normal;
out vec4 ink;
out float aside;

void main() {
  ink = tint;
  vec3 along = isAcross ? normalize(cross(normal, direction)) : direction;
  float scale = reach > 0.0 ? reach * pixel * (clip * vec4(centre, 1.0)).w : 1.0;
  vec4 a = clip * vec4(centre - scale * along, 1.0);
  vec4 b = clip * vec4(centre + scale * along, 1.0);
  float nearest = 1e-4 * max(abs(a.w), abs(b.w));
  if (a.w < nearest) a = mix(a, b, (nearest - a.w) / (b.w - a.w));
  if (b.w < nearest) b = mix(b, a, (nearest - b.w) / (a.w - b.w));
  vec2 line = (b.xy / b.w - a.xy / a.w) * pane;
  vec2 across = dot(line, line) > 0.0 ? normalize(vec2(-line.y, line.x)) : vec2(0.0);
  aside = gl_VertexID < 2 ? -1.0 : 1.0;
  vec4 p = (gl_VertexID & 1) == 1 ? b : a;
  p.xy += across * aside * (width + 1.0) / pane * p.w;
  p.z -= 4e-3 * p.w * (1.0 - p.z / p.w);
  gl_Position = a.w > 0.0 && b.w > 0.0 ? p : vec4(2.0, 2.0, 2.0, 1.0);
}
