#version 300 es
precision highp float;
uniform float width;
in vec4 ink;
in float aside;
out vec4 shown;

void main() {
  float inside = (1.0 - abs(aside)) * (width + 1.0);
  shown = vec4(ink.rgb, ink.a * clamp(inside, 0.0, 1.0));
}
