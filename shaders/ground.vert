#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// A square of ground, four corners of a strip.
#include "frame.glsl"
out vec3 position;
centroid out vec3 normal;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    position = vec3(corner.x * ground.z, ground.x, -corner.y * ground.z);
    normal = vec3(0.0, 1.0, 0.0);
    gl_Position = clip_from_stage * vec4(position, 1.0);
}
