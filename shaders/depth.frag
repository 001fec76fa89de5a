#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// Half-size pass before the picture: normal and depth, for occlusion and shadow.
#include "frame.glsl"
#include "normal.glsl"
in vec3 position;
centroid in vec3 normal;
layout(location = 0) out vec4 normal_and_depth;

void main() {
    vec3 n = mat3(view_from_stage) * facing_normal(normal, position, eye.xyz);
    normal_and_depth = vec4(n, -(view_from_stage * vec4(position, 1.0)).z);
}
