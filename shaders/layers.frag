#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen in the middle of a pixel: its normal, folded to two numbers, its depth and whose it
// is.
#include "frame.glsl"
#include "normal.glsl"
in vec3 position;
in vec3 normal;
uniform vec4 number;
layout(location = 0) out vec4 layer;

void main() {
    vec3 n = facing_normal(normal, position, eye.xyz);
    n /= abs(n.x) + abs(n.y) + abs(n.z);
    vec2 side = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    vec2 folded = n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * side;
    layer = vec4(folded, -(view_from_stage * vec4(position, 1.0)).z, number.x);
}
