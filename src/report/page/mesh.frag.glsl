#version 300 es
precision highp float;
precision highp int;

uniform sampler2D palette;
// 0 smooth, 1 one normal a face, 2 the colours as they are.
uniform int shading;
uniform float wire;
uniform bool showBeyond;
uniform bool isSelecting;
uniform uint pointed;
uniform uint chosen;
uniform vec3 paper;
uniform vec3 accent;

in vec3 share;
in vec3 smoothNormal;
in vec3 place;
flat in int color;
flat in int beyond;
flat in uint mark;
flat in uint face;
out vec4 shown;

const float AMBIENT = 0.32;
const vec3 LIGHT = vec3(-0.2526, 0.4210, 0.8711);

vec3 linear(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}

vec3 coded(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

void main() {
  vec3 flatNormal = cross(dFdx(place), dFdy(place));
  vec3 normal = shading == 0 && dot(smoothNormal, smoothNormal) > 0.0 ? smoothNormal : flatNormal;
  normal = normalize(normal.z < 0.0 ? -normal : normal);
  float light = shading == 2 ? 1.0 : AMBIENT + (1.0 - AMBIENT) * max(dot(normal, LIGHT), 0.0);
  vec3 surface = texelFetch(palette, ivec2(color, 0), 0).rgb;
  if (isSelecting && mark == 0u) surface = mix(surface, paper, 0.78);
  if (showBeyond && beyond != 0) {
    float stripe = fract((gl_FragCoord.x + float(beyond) * gl_FragCoord.y) / 7.0);
    surface = mix(surface, beyond > 0 ? vec3(1.0) : vec3(0.05), 0.65 * step(0.55, stripe));
  }
  vec3 lit = light == 1.0 ? surface : coded(linear(surface) * light);
  vec3 width = fwidth(share);
  float edge = 1.0 - min(min(smoothstep(0.0, width.x, share.x), smoothstep(0.0, width.y, share.y)), smoothstep(0.0, width.z, share.z));
  // Where faces are smaller than pixels, wires would hide them.
  float fine = 1.0 - smoothstep(0.25, 0.8, max(width.x, max(width.y, width.z)));
  lit = mix(lit, vec3(0.08, 0.09, 0.1), wire * edge * fine);
  bool isMarked = face + 1u == pointed || face + 1u == chosen;
  if (isMarked) {
    float border = 1.0 - min(min(smoothstep(width.x, 2.5 * width.x, share.x), smoothstep(width.y, 2.5 * width.y, share.y)), smoothstep(width.z, 2.5 * width.z, share.z));
    lit = mix(lit, accent, max(border, 0.18));
  }
  shown = vec4(lit, 1.0);
}
