#version 300 es
// The number of the face at every pixel, from 1; what is pointed at is read from here.
precision highp float;
precision highp int;
flat in uint face;
out uvec4 number;

void main() {
  number = uvec4(face + 1u, 0u, 0u, 1u);
}
